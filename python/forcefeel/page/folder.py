"""The folder of a command: what it may hold, checked before the work, and written whole or not at all after it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from forcefeel.errors import InputError
from forcefeel.files import check_output_file, check_output_folder, is_same, output_kind
from forcefeel.page.script import SCRIPT, script
from forcefeel.page.staging import put


@dataclass(frozen=True)
class OutputFolder:
    """The folder of a command.

    Attributes:
        what: What it is for, as a message names it: ``the envelope``.
        files: Names of the files that the command writes, whether or not each time; one that a run does not write goes.
        folders: Names of folders within, of files that differ from run to run; what else is in them stays.
        plots: Whether a page with plots is among the files: the script that draws them is written beside it.
    """

    what: str
    files: tuple[str, ...]
    folders: tuple[str, ...] = ()
    plots: bool = True

    def check(self, out: Path, *, replace: bool = True, inputs: Sequence[Path] = ()) -> None:
        """Refuses what would fail halfway, before any work: a file where a folder is wanted, or the other way round.

        Args:
            out: The folder.
            replace: Whether the files may take the place of others.
            inputs: Files that the work is made from; none of them is ever replaced.

        Raises:
            InputError: If so, or there is a file that is not to be replaced.
        """
        for target in (out / name for name in self.files):
            if any(is_same(given, target) for given in inputs):
                raise InputError(
                    f"{target}: is what {self.what} is made from, and stays as it is; name another folder with --out"
                )
        check_output_folder(out, f"a folder for {self.what}")
        for name in (*self.files, *self._scripts):
            check_output_file(out / name)
            if name in self.files and output_kind(out / name) and not replace:
                raise InputError(
                    f"{out}: holds {name} already; name another folder with --out, or --replace to replace it"
                )
        if not replace:
            self.check_script(out)
        for name in self.folders:
            check_output_folder(out / name, "a folder of that name")

    def check_script(self, out: Path) -> None:
        """Refuses a folder that holds another script under the name of the pages'; theirs is the same in every folder.

        Raises:
            InputError: If so.
        """
        for name, text in self._scripts.items():
            if output_kind(out / name) and (out / name).read_bytes() != str(text).encode():
                raise InputError(
                    f"{out}: holds another {name}; name another folder with --out, or --replace to replace it"
                )

    def write(self, out: Path, contents: Mapping[str, str | bytes]) -> None:
        """Writes all files, or none.

        Args:
            out: The folder; made if it is not there.
            contents: Each file's text or bytes by its name within the folder, in the order in which they move into place.

        Raises:
            InputError: If the folder cannot be made or written.
        """
        put(out, {**self._scripts, **contents}, self.files)

    @property
    def _scripts(self) -> dict[str, str | bytes]:
        return {SCRIPT: script()} if self.plots else {}
