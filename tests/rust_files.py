"""Which file of a Rust crate uses which: paths of the source, followed through re-exports to the file that declares the name."""

import re
from dataclasses import dataclass, field
from pathlib import Path

CRATES = Path(__file__).parents[1] / "crates"

Names = tuple[str, ...]
"""A module by the names from the crate's root, or a path within a module."""

_NO_CODE = re.compile(r"//[^\n]*|/\*.*?\*/|b?r?(#*)\"(?:\\.|[^\"\\])*?\"\1|'(?:\\.|[^'\\])'", re.S)
_USE = re.compile(r"\b(pub(?:\([^)]*\))?\s+)?use\s+([^;]+);")
_MODULE = re.compile(r"\bmod\s+(\w+)\s*;")
_PATH = re.compile(r"(?<![\w:])(?:\w+::)+\w+")
_LEADING = ("crate", "self", "super")


@dataclass
class Module:
    """One file.

    Attributes:
        path: Below the crate's ``src``.
        code: Text without comments, strings and ``use``.
        children: Names of the modules that it declares.
        imports: What each name that it imports or re-exports stands for.
        exported: The names among these that it only passes on.
    """

    path: str
    code: str
    children: set[str]
    imports: dict[str, Names] = field(default_factory=dict)
    globs: list[Names] = field(default_factory=list)
    exported: set[str] = field(default_factory=set)


def uses(source: Path) -> dict[str, set[str]]:
    """For each file below a crate's ``src`` the files whose names it uses.

    Declaring a module and passing a name on are no uses. Methods are not looked at: a method belongs to its type.
    """
    modules = _modules(source)
    arrows: dict[str, set[str]] = {}
    for at, module in modules.items():
        paths = [path for name, path in module.imports.items() if name not in module.exported or _says(module, name)]
        paths += [*module.globs, *(tuple(found.split("::")) for found in _PATH.findall(module.code))]
        files = {modules[owner].path for path in paths if (owner := _owner(modules, at, path)) is not None}
        arrows[module.path] = files - {module.path}
    return arrows


def _modules(source: Path) -> dict[Names, Module]:
    modules: dict[Names, Module] = {}
    open_: list[tuple[Names, Path]] = [((), source / "lib.rs")]
    while open_:
        at, path = open_.pop()
        text = _NO_CODE.sub(" ", path.read_text(encoding="utf-8"))
        code, children = _USE.sub(" ", text), set(_MODULE.findall(text))
        module = Module(path.relative_to(source).as_posix(), _MODULE.sub(" ", code), children)
        for public, tree in _USE.findall(text):
            for name, target in _flat(tree):
                if name == "*":
                    module.globs.append(target)
                else:
                    module.imports[name] = target
                    module.exported |= {name} if public else set()
        modules[at] = module
        folder = source.joinpath(*at)
        for child in children:
            flat = folder / f"{child}.rs"
            open_.append(((*at, child), flat if flat.exists() else folder / child / "mod.rs"))
    return modules


def _flat(tree: str, before: Names = ()) -> list[tuple[str, Names]]:
    """The names that a ``use`` tree brings, each with its path."""
    tree = tree.strip()
    if tree.endswith("}"):
        head, _, inner = tree.partition("{")
        start = before + tuple(part for part in head.strip().split("::") if part)
        return [pair for branch in _branches(inner[:-1]) for pair in _flat(branch, start)]
    path, _, alias = tree.partition(" as ")
    full = before + tuple(path.strip().split("::"))
    if full[-1] == "*":
        return [("*", full[:-1])]
    full = full[:-1] if full[-1] == "self" else full
    return [(alias.strip() or full[-1], full)]


def _branches(inner: str) -> list[str]:
    parts, depth = [""], 0
    for letter in inner:
        depth += (letter == "{") - (letter == "}")
        if letter == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += letter
    return [part for part in parts if part.strip()]


def _says(module: Module, name: str) -> bool:
    return re.search(rf"(?<!::)\b{name}\b", module.code) is not None


def _owner(modules: dict[Names, Module], at: Names, path: Names) -> Names | None:
    """The module that declares what a path of the module `at` names; none of another crate's."""
    while path and path[0] in _LEADING:
        at = {"crate": (), "self": at, "super": at[:-1]}[path[0]]
        path = path[1:]
        if not path or path[0] not in _LEADING:
            break
    else:
        # A path that begins with a name: one that is in scope.
        module = modules[at]
        if path[0] not in module.children and path[0] not in module.imports:
            return None
    for _ in range(len(modules) + len(path)):
        module = modules[at]
        if not path:
            return at
        if path[0] in module.children:
            at, path = (*at, path[0]), path[1:]
        elif path[0] in module.imports:
            target = module.imports[path[0]]
            if target[0] not in _LEADING and target[0] not in module.children | module.imports.keys() - {path[0]}:
                return None
            return _owner(modules, at, target + path[1:])
        else:
            return at
    return None
