"""A loader that runs on a busy machine in real time: late cycles, which other tests are about, do not stop it."""

import forcefeel as ff


def unhurried_elevator() -> ff.Loader:
    """``elevator-2khz`` that is stopped only after a whole second of late cycles."""
    return ff.digital_elevator().replace({"safety.overrun_time": "1 s"})
