"""A loader that runs on a busy machine in real time: late cycles do not stop it."""

import forcefeel as ff


def unhurried_elevator() -> ff.Loader:
    """``elevator-2khz`` that only a whole second of late cycles stops."""
    return ff.digital_elevator().replace({"safety.overrun_time": 1.0}, si=True)
