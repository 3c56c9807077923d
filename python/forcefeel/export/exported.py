"""What is exported: a law, the loader that it was made for, and the name under which it goes."""

import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError
from forcefeel.laws.law import Law, LawLike
from forcefeel.laws.sampled.sampled_law import SampledLaw
from forcefeel.loader.feel_settings import check_feel_range, own_feel
from forcefeel.loader.loader import Loader
from forcefeel.units import show

_IDENTIFIER = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_LONGEST_NAME = 20
"""C99 tells names apart by 31 characters at least; suffixes such as ``_law_reset`` are added."""


@dataclass(frozen=True, eq=False)
class Exported:
    """A law for one loader, checked.

    Attributes:
        loader: The loader.
        law: Its law, for one setting of the feel or many.
        name: By which files and names in them begin.

    Raises:
        InputError: If the law was made for another loader, rate or drive, is gains of an analog law on a digital controller, has a
            setting that no loader may have, or the name is no identifier of C.

    Example:
        >>> import forcefeel as ff
        >>> loader = ff.digital_elevator()
        >>> ff.export.Exported.of("robust", loader, "pitch").settings.shape
        (1, 3)
    """

    loader: Loader
    law: Law
    name: str = "loader"

    def __post_init__(self) -> None:
        if not _IDENTIFIER.fullmatch(self.name) or len(self.name) > _LONGEST_NAME:
            raise InputError(
                f"name: expected an identifier of C of at most {_LONGEST_NAME} letters, digits and _, such as pitch, "
                f"got {show(self.name)}"
            )
        self.law.check(self.loader)
        self._check_time()
        check_feel_range(self.settings, lambda setting: f"in setting {setting + 1}")
        if remark := self.law.made_for_another(self.loader):
            raise InputError(f"law: {remark.rstrip('.')}")

    @classmethod
    def of(
        cls, law: LawLike, loader: Loader, name: str = "loader", feel: NDArray[np.float64] | None = None
    ) -> "Exported":
        """A law as ``Law.of`` makes it, for the settings I, B, G in ``feel`` (settings, 3), SI units; else the loader's own.

        Raises:
            InputError: As ``Law.of`` and ``Exported``.

        Example:
            >>> import forcefeel as ff
            >>> import numpy as np
            >>> feel = np.array([[8.0, 60.0, 325.0], [6.8, 34.0, 1085.0]])
            >>> ff.export.Exported.of("robust", ff.digital_elevator(), "pitch", feel).settings.shape
            (2, 3)
        """
        return cls(loader, Law.of(law, loader, feel), name)

    def _check_time(self) -> None:
        """Refuses gains on a digital controller, which are neither a sampled law nor a loop in continuous time."""
        if self.law.period_s and self.law.sampled is None:
            raise InputError(
                f"law: {self.law.name} is gains of an analog law, and {self.loader.name} has a digital controller; expected a "
                "sampled law, such as robust"
            )

    def sampled(self) -> SampledLaw:
        """The numbers of its sampled law, which is what runs on a digital target.

        Raises:
            InputError: If it is an analog law.

        Example:
            >>> import forcefeel as ff
            >>> ff.export.Exported.of("robust", ff.digital_elevator()).sampled().states
            9
        """
        if self.law.sampled is None:
            raise InputError(
                f"law: {self.law.name} is an analog law, and the target is digital; give the loader a controller.period, such as "
                "--set 'controller.period=0.5 ms', and a sampled law such as robust"
            )
        return self.law.sampled

    @property
    def settings(self) -> NDArray[np.float64]:
        """The settings I, B, G, (settings, 3): the law's, or where it holds for any, the loader's own."""
        return own_feel(self.loader) if self.law.feel is None else self.law.feel
