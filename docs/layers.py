"""The layers of the package, computed from its imports: ``docs/architecture.svg``."""

import ast
from collections import defaultdict
from dataclasses import dataclass
from functools import cached_property
from html import escape
from itertools import pairwise
from pathlib import Path

PACKAGE = Path(__file__).parents[1] / "python" / "forcefeel"
PICTURE = Path(__file__).with_name("architecture.svg")

Arrows = dict[str, set[str]]


@dataclass(frozen=True)
class Package:
    """Modules and their imports.

    Attributes:
        paths: Path of each module below the package, by its dotted name.
        imports: Modules that each module imports, also inside functions and for type checkers.
    """

    paths: dict[str, Path]
    imports: Arrows

    @classmethod
    def of(cls, package: Path = PACKAGE) -> "Package":
        """Read every file of the package except its list of public names."""
        files = [path for path in sorted(package.rglob("*.py")) if path.parent != package or path.stem != "__init__"]
        paths = {_dotted(path.relative_to(package.parent)): path.relative_to(package) for path in files}
        return cls(paths, {name: _imported(package / path, paths) - {name} for name, path in paths.items()})

    def subpackage(self, module: str) -> str:
        """The folder of a module; a top-level module stands for itself."""
        path = self.paths[module]
        return path.parent.as_posix() if len(path.parts) > 1 else path.stem

    @cached_property
    def arrows(self) -> Arrows:
        """Subpackages that each subpackage imports from."""
        arrows: Arrows = {self.subpackage(module): set() for module in self.paths}
        for module, others in self.imports.items():
            arrows[self.subpackage(module)] |= {self.subpackage(other) for other in others} - {self.subpackage(module)}
        return arrows

    @cached_property
    def layers(self) -> list[list[str]]:
        """The subpackages, lowest layer first; each is one layer above the highest that it imports from.

        Raises:
            ValueError: If subpackages import name another in a cycle.
        """
        if circular := cycles(self.arrows):
            raise ValueError(f"expected no cycle among the subpackages, got {circular}")
        level: dict[str, int] = {}

        def height(name: str) -> int:
            if name not in level:
                level[name] = 1 + max(map(height, self.arrows[name]), default=-1)
            return level[name]

        layers: dict[int, list[str]] = defaultdict(list)
        for name in sorted(self.arrows):
            layers[height(name)].append(name)
        return [layers[k] for k in range(len(layers))]


def cycles(arrows: Arrows) -> list[list[str]]:
    """Sets of nodes that reach name another, sorted."""
    left = {node: set(others) for node, others in arrows.items()}
    while ends := [node for node in left if not left[node] & left.keys()]:
        for node in ends:
            del left[node]
    reach = {node: _reached(node, left) & left.keys() for node in left}
    groups = {frozenset(other for other in reach[node] if node in reach[other]) for node in left if node in reach[node]}
    return sorted(sorted(group) for group in groups)


def drawing(package: Package) -> str:
    """The layers as an SVG, without implied arrows; an arrow that crosses a layer has its own gap there."""
    paths = _paths(package)
    layers = _ordered(package.layers, paths)
    at = {node: place for level, row in enumerate(layers) for node, place in _row(row, len(layers) - 1 - level).items()}
    lines = [
        f'<polyline points="{" ".join(_through(at[node]) for node in path)}"/>'
        for path in sorted(paths, key=lambda path: (path[0], path[-1]))
    ]
    boxes = [
        f'<rect x="{x - wide / 2:.0f}" y="{y}" width="{wide:.0f}" height="{_BOX}" rx="4"/>'
        f'<text x="{x:.0f}" y="{y + 20}">{escape(node)}</text>'
        for node, (x, y, wide) in at.items()
        if isinstance(node, str)
    ]
    count = len(layers)
    marks = [f'<text class="layer" x="24" y="{_TOP + (count - 1 - k) * _LAYER + 20}">{k}</text>' for k in range(count)]
    height = _TOP + count * _LAYER
    return "\n".join(
        (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {height}" font-family="sans-serif" font-size="13">',
            "<title>Layers of the package forcefeel and their imports</title>",
            "<style>rect{fill:#f4f7fa;stroke:#5a6b7b}polyline{fill:none;stroke:#9fb0c0}text{fill:#1c2733;text-anchor:middle}"
            ".layer{fill:#5a6b7b}</style>",
            f'<rect x="0" y="0" width="{_WIDTH}" height="{height}" style="fill:#fff;stroke:none"/>',
            '<text class="layer" x="24" y="24">layer</text>',
            *lines,
            *boxes,
            *marks,
            "</svg>\n",
        )
    )


_WIDTH, _LAYER, _BOX, _TOP, _LEFT = 1280, 78, 30, 46, 50

Gap = tuple[str, str, int]
"""Where an arrow crosses a layer: its start, its end, the layer."""

Node = str | Gap


def _paths(package: Package) -> list[list[Node]]:
    """Each arrow as the nodes that it passes, from above."""
    level = {name: k for k, names in enumerate(package.layers) for name in names}
    return [
        [name, *((name, other, k) for k in range(level[name] - 1, level[other], -1)), other]
        for name, others in _reduced(package.arrows).items()
        for other in sorted(others)
    ]


def _ordered(layers: list[list[str]], paths: list[list[Node]]) -> list[list[Node]]:
    """Nodes of each layer, sorted by the mean position of their neighbors, up and down in turn, for few crossings."""
    gaps: list[list[Node]] = [
        [node for path in paths for node in path[1:-1] if node[2] == k] for k in range(len(layers))
    ]
    rows: list[list[Node]] = [[*names, *passing] for names, passing in zip(layers, gaps, strict=True)]
    near: dict[Node, list[Node]] = defaultdict(list)
    for path in paths:
        for name, other in pairwise(path):
            near[name].append(other)
            near[other].append(name)
    for sweep in range(_SWEEPS):
        for row in rows[:: 1 if sweep % 2 else -1]:
            place = {node: (k + 1) / (len(other) + 1) for other in rows for k, node in enumerate(other)}
            row.sort(key=lambda node: sum(place[name] for name in near[node]) / len(near[node]) if near[node] else 0.5)
    return rows


_SWEEPS = 24


def _row(row: list[Node], down: int) -> dict[Node, tuple[float, float, float]]:
    """Middle, upper edge and width of each node of a layer."""
    size = [7.4 * len(node) + 18 if isinstance(node, str) else 0.0 for node in row]
    gap = (_WIDTH - _LEFT - sum(size)) / (len(row) + 1)
    nodes, x = {}, _LEFT + gap
    for node, wide in zip(row, size, strict=True):
        nodes[node] = (x + wide / 2, float(_TOP + down * _LAYER), wide)
        x += wide + gap
    return nodes


def _through(place: tuple[float, float, float]) -> str:
    """Points of an arrow across a layer: straight down, hidden behind a box."""
    x, y, _ = place
    return f"{x:.0f},{y:.0f} {x:.0f},{y + _BOX:.0f}"


def _dotted(path: Path) -> str:
    return ".".join(path.with_suffix("").parts).removesuffix(".__init__")


def _imported(path: Path, known: dict[str, Path]) -> set[str]:
    """Modules of the package that a file imports."""
    imported = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module:
            for alias in node.names:
                whole = f"{node.module}.{alias.name}"
                imported.add(whole if whole in known else node.module)
    return imported & known.keys()


def _reached(start: str, arrows: Arrows) -> set[str]:
    reached: set[str] = set()
    todo = list(arrows.get(start, ()))
    while todo:
        node = todo.pop()
        if node not in reached:
            reached.add(node)
            todo.extend(arrows.get(node, ()))
    return reached


def _reduced(arrows: Arrows) -> Arrows:
    """The arrows without implied ones."""
    below = {node: _reached(node, arrows) for node in arrows}
    return {node: {name for name in out if not any(name in below[two] for two in out)} for node, out in arrows.items()}


if __name__ == "__main__":
    PICTURE.write_text(drawing(Package.of()), encoding="utf-8")
