from forcefeel.workflow import *  # noqa: F403  temporary
