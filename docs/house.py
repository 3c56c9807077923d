"""The floors of the package, reckoned from its imports: ``docs/architecture.svg``, which cannot lie."""

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
class House:
    """Modules and what each imports.

    Attributes:
        paths: Path of each module below the package, by its dotted name.
        imports: Modules that each imports, at whatever place of the file, for type checkers too.
    """

    paths: dict[str, Path]
    imports: Arrows

    @classmethod
    def of(cls, package: Path = PACKAGE) -> "House":
        """Reads every file of the package but its list of public names."""
        files = [path for path in sorted(package.rglob("*.py")) if path.parent != package or path.stem != "__init__"]
        paths = {_dotted(path.relative_to(package.parent)): path.relative_to(package) for path in files}
        return cls(paths, {name: _imported(package / path, paths) - {name} for name, path in paths.items()})

    def room(self, module: str) -> str:
        """The folder of a module; a module that lies loose in the package is a room of its own."""
        path = self.paths[module]
        return path.parent.as_posix() if len(path.parts) > 1 else path.stem

    @cached_property
    def arrows(self) -> Arrows:
        """Rooms that each room imports from."""
        found: Arrows = {self.room(module): set() for module in self.paths}
        for module, others in self.imports.items():
            found[self.room(module)] |= {self.room(other) for other in others} - {self.room(module)}
        return found

    @cached_property
    def floors(self) -> list[list[str]]:
        """The rooms, ground floor first; a room stands on the floor above the highest that it imports from.

        Raises:
            ValueError: If rooms import from one another in a circle.
        """
        if found := circles(self.arrows):
            raise ValueError(f"expected no circle among the rooms, got {found}")
        level: dict[str, int] = {}

        def height(room: str) -> int:
            if room not in level:
                level[room] = 1 + max(map(height, self.arrows[room]), default=-1)
            return level[room]

        floors: dict[int, list[str]] = defaultdict(list)
        for room in sorted(self.arrows):
            floors[height(room)].append(room)
        return [floors[k] for k in range(len(floors))]


def circles(arrows: Arrows) -> list[list[str]]:
    """The sets of nodes that reach one another: what is left when whatever has no arrow out, or none in, is taken away."""
    left = {node: set(others) for node, others in arrows.items()}
    while ends := [node for node in left if not left[node] & left.keys()]:
        for node in ends:
            del left[node]
    reach = {node: _reached(node, left) & left.keys() for node in left}
    groups = {frozenset(other for other in reach[node] if node in reach[other]) for node in left if node in reach[node]}
    return sorted(sorted(group) for group in groups)


def drawing(house: House) -> str:
    """The floors as an SVG. Arrows that follow from others are left out; one that passes a floor has a gap of its own there."""
    paths = _paths(house)
    floors = _ordered(house.floors, paths)
    at = {node: place for level, row in enumerate(floors) for node, place in _row(row, len(floors) - 1 - level).items()}
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
    count = len(floors)
    marks = [f'<text class="floor" x="24" y="{_TOP + (count - 1 - k) * _FLOOR + 20}">{k}</text>' for k in range(count)]
    height = _TOP + count * _FLOOR
    return "\n".join(
        (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {height}" font-family="sans-serif" font-size="13">',
            "<title>Floors of the package forcefeel, and who imports from whom</title>",
            "<style>rect{fill:#f4f7fa;stroke:#5a6b7b}polyline{fill:none;stroke:#9fb0c0}text{fill:#1c2733;text-anchor:middle}"
            ".floor{fill:#5a6b7b}</style>",
            f'<rect x="0" y="0" width="{_WIDTH}" height="{height}" style="fill:#fff;stroke:none"/>',
            '<text class="floor" x="24" y="24">floor</text>',
            *lines,
            *boxes,
            *marks,
            "</svg>\n",
        )
    )


_WIDTH, _FLOOR, _BOX, _TOP, _LEFT = 1280, 78, 30, 46, 50

Gap = tuple[str, str, int]
"""Where an arrow passes a floor: from which room to which, on which floor."""

Node = str | Gap


def _paths(house: House) -> list[list[Node]]:
    """Each arrow as the nodes that it goes through, from above."""
    level = {room: k for k, rooms in enumerate(house.floors) for room in rooms}
    return [
        [one, *((one, other, k) for k in range(level[one] - 1, level[other], -1)), other]
        for one, others in _reduced(house.arrows).items()
        for other in sorted(others)
    ]


def _ordered(floors: list[list[str]], paths: list[list[Node]]) -> list[list[Node]]:
    """The nodes of each floor, so that arrows cross little: each by the mean place of its neighbours, up and down in turn."""
    gaps: list[list[Node]] = [
        [node for path in paths for node in path[1:-1] if node[2] == k] for k in range(len(floors))
    ]
    rows: list[list[Node]] = [[*rooms, *passing] for rooms, passing in zip(floors, gaps, strict=True)]
    near: dict[Node, list[Node]] = defaultdict(list)
    for path in paths:
        for one, other in pairwise(path):
            near[one].append(other)
            near[other].append(one)
    for sweep in range(_SWEEPS):
        for row in rows[:: 1 if sweep % 2 else -1]:
            place = {node: (k + 1) / (len(other) + 1) for other in rows for k, node in enumerate(other)}
            row.sort(key=lambda node: sum(place[one] for one in near[node]) / len(near[node]) if near[node] else 0.5)
    return rows


_SWEEPS = 24


def _row(row: list[Node], down: int) -> dict[Node, tuple[float, float, float]]:
    """Middle, upper edge and width of each node of a floor."""
    size = [7.4 * len(node) + 18 if isinstance(node, str) else 0.0 for node in row]
    gap = (_WIDTH - _LEFT - sum(size)) / (len(row) + 1)
    found, x = {}, _LEFT + gap
    for node, wide in zip(row, size, strict=True):
        found[node] = (x + wide / 2, float(_TOP + down * _FLOOR), wide)
        x += wide + gap
    return found


def _through(place: tuple[float, float, float]) -> str:
    """An arrow passes a floor straight down; behind a box it is not seen."""
    x, y, _ = place
    return f"{x:.0f},{y:.0f} {x:.0f},{y + _BOX:.0f}"


def _dotted(path: Path) -> str:
    return ".".join(path.with_suffix("").parts).removesuffix(".__init__")


def _imported(path: Path, known: dict[str, Path]) -> set[str]:
    """The modules of the package that a file imports."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module:
            for alias in node.names:
                whole = f"{node.module}.{alias.name}"
                found.add(whole if whole in known else node.module)
    return found & known.keys()


def _reached(start: str, arrows: Arrows) -> set[str]:
    found: set[str] = set()
    todo = list(arrows.get(start, ()))
    while todo:
        node = todo.pop()
        if node not in found:
            found.add(node)
            todo.extend(arrows.get(node, ()))
    return found


def _reduced(arrows: Arrows) -> Arrows:
    """The arrows without those that follow from others."""
    below = {node: _reached(node, arrows) for node in arrows}
    return {node: {one for one in out if not any(one in below[two] for two in out)} for node, out in arrows.items()}


if __name__ == "__main__":
    PICTURE.write_text(drawing(House.of()), encoding="utf-8")
