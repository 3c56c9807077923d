from forcefeel.figure_data import *  # noqa: F403  temporary
