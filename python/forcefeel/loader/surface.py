"""The control surface of a loader."""

from forcefeel.loader.loader import Loader


def has_surface(loader: Loader) -> bool:
    """Whether a flight acts on the loader: it has a surface or a bobweight."""
    return bool(loader["surface.area"] or loader["surface.bobweight"])
