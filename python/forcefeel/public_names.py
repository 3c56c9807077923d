"""Public names of a package, fetched when first used, so that a name costs the import of nothing but its own module.

Each package with public names has an ``__init__.pyi`` that imports them from where they are defined. Type checkers read it, and
so does ``public_names``: a name is spelled once.
"""

import ast
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

from forcefeel.errors import named_extra


def public_names(package: str, init_file: str) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """``__getattr__``, ``__dir__`` and ``__all__`` of the package with this ``__name__`` and ``__file__``, from its stub."""
    homes = imports_of(Path(init_file).with_suffix(".pyi"))

    def fetch(name: str) -> Any:
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        module, its_name = homes[name]
        with named_extra():
            return getattr(import_module(module), its_name) if its_name else import_module(module)

    return fetch, lambda: sorted(homes), [name for name, (_, its_name) in homes.items() if its_name]


def imports_of(stub: Path) -> dict[str, tuple[str, str]]:
    """Module and name there of each name that a stub imports; of a submodule, which a stub imports from its package, no name."""
    package = f"forcefeel.{stub.parent.name}" if stub.parent.name != "forcefeel" else "forcefeel"
    modules = {}
    for node in ast.parse(stub.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.ImportFrom) and node.module:
            for alias in node.names:
                home = (f"{package}.{alias.name}", "") if node.module == package else (node.module, alias.name)
                modules[alias.asname or alias.name] = home
    return modules
