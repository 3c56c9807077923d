from forcefeel.findings import *  # noqa: F403  temporary
