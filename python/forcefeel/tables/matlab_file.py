"""Safe reader of MATLAB files of Level 5 (versions 5 to 7) and Level 4.

A damaged file can crash a reader in C; here every tag is checked against the available bytes. Numbers, lines of text and the fields
of a structure are read; cells, sparse matrices, objects and functions are skipped.

Source: MathWorks, MAT-File Format, R2014a: Level 5 in chapter 1, Level 4 in its appendix.
"""

import math
import struct
import zlib
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from forcefeel.tables.table import MOST_BYTES, MOST_COLUMNS

Variable = NDArray[np.generic] | str
"""Numbers in the shape that the file gives them, or one line of text."""
Variables = list[tuple[str, Variable]]
"""By name, in the file's order; a structure's fields stand for themselves."""

MOST_INFLATED = 4 * MOST_BYTES
"""Largest size of the decompressed variables of a file, bytes."""

_HEADER = 128
_NAME, _DIMENSIONS, _MATRIX, _COMPRESSED = (1, 2, 16), (5, 6), 14, 15
_TYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
"""NumPy's types by the number of a data type, miINT8 to miUINT64."""
_TEXTS = {1: "latin-1", 2: "latin-1", 4: "utf-16", 16: "utf-8", 17: "utf-16", 18: "utf-32"}
"""Encodings of a text by its data type."""
_STRUCTURE, _TEXT, _NUMBERS = 2, 4, range(6, 16)
"""Classes of an array, mxSTRUCT_CLASS, mxCHAR_CLASS and mxDOUBLE_CLASS to mxUINT64_CLASS."""
_COMPLEX = 0x0800
_MOST_DIMENSIONS = 32

_LEVEL_4 = 20
"""Length of the header of a Level 4 matrix: type, rows, columns, whether it is complex, length of its name."""
_LEVEL_4_TYPES = ("f8", "f4", "i4", "i2", "u2", "u1")


class NewerFormatError(ValueError):
    """Version 7.3, which is HDF5."""


class DamagedError(ValueError):
    """A fault of a file."""


def read_variables(data: bytes) -> Variables:
    """The variables of a file.

    Raises:
        NewerFormatError: If it is of version 7.3.
        DamagedError: If it is no MATLAB file, or a damaged one.
    """
    if len(data) >= _LEVEL_4 and 0 in data[:4]:  # a Level 5 file begins with text
        return list(_level_4(memoryview(data)))
    if len(data) < _HEADER or data[126:128] not in (b"IM", b"MI"):
        raise DamagedError("it does not begin as one")
    order = "<" if data[126:128] == b"IM" else ">"
    (version,) = struct.unpack_from(f"{order}H", data, 124)
    if version == 0x0200:
        raise NewerFormatError
    if version != 0x0100:
        raise DamagedError(f"version {version:#06x} is not known")
    variables: Variables = []
    for name, value in _level_5(memoryview(data)[_HEADER:], order):
        variables += value if isinstance(value, list) else [(name, value)]
        if len(variables) > MOST_COLUMNS:
            raise DamagedError(f"it has more than {MOST_COLUMNS:,} variables")
    return variables


def _level_5(data: memoryview, order: str) -> Iterator[tuple[str, Variable | Variables]]:
    budget = MOST_INFLATED
    for kind, element in _elements(data, order):
        matrices = iter([(kind, element)])
        if kind == _COMPRESSED:
            inflated = _inflated(element, budget)
            budget -= len(inflated)
            matrices = _elements(memoryview(inflated), order)
        for inner, matrix in matrices:
            if inner != _MATRIX:
                raise DamagedError(f"a variable is of data type {inner}, expected {_MATRIX}")
            name, value = _matrix(matrix, order, fields=True)
            if name and value is not None:  # what objects hold is in an array without a name
                yield name, value


def _inflated(element: memoryview, limit: int) -> bytes:
    inflater = zlib.decompressobj()
    try:
        inflated = inflater.decompress(element, limit + 1)
    except zlib.error as error:
        raise DamagedError(f"a variable cannot be inflated: {error}") from error
    if len(inflated) > limit:
        raise DamagedError(f"its variables hold more than {MOST_INFLATED // 2**20:,} MB")
    if not inflater.eof:
        raise DamagedError("a variable ends too early")
    return inflated


def _elements(data: memoryview, order: str) -> Iterator[tuple[int, memoryview]]:
    """Data type and data of each element: a tag of two words, or of one in which the upper half is the size."""
    at = 0
    while at < len(data):
        if len(data) - at < 8:
            raise DamagedError("it ends within a tag")
        kind, size = struct.unpack_from(f"{order}II", data, at)
        small = kind >> 16
        begin = at + (4 if small else 8)
        if small:
            kind, size = kind & 0xFFFF, small
        if (small and size > 4) or size > len(data) - begin:
            raise DamagedError(f"an element of data type {kind} has {size} bytes, and {len(data) - begin} are left")
        yield kind, data[begin : begin + size]
        at = at + 8 if small else begin + size + (0 if kind == _COMPRESSED else -size % 8)


def _matrix(data: memoryview, order: str, *, fields: bool) -> tuple[str, Variable | Variables | None]:
    """Name and value of an array; no value for a skipped kind. ``fields``: it may be a structure of arrays."""
    parts = _elements(data, order)
    flags = _integers(_next(parts, "flags", (6,))[1], f"{order}u4")
    kind = flags[0] & 0xFF if flags else 0
    if kind not in (_STRUCTURE, _TEXT, *_NUMBERS):
        return "", None
    shape = _integers(_next(parts, "dimensions", _DIMENSIONS)[1], f"{order}i4")
    if not 2 <= len(shape) <= _MOST_DIMENSIONS or min(shape) < 0:
        raise DamagedError(f"an array has the dimensions {shape}")
    name = bytes(_next(parts, "a name", _NAME)[1]).decode(errors="replace")
    if kind == _STRUCTURE:
        return name, _fields(parts, order) if fields and math.prod(shape) == 1 else None
    if math.prod(shape) == 0:
        return name, None
    if kind == _TEXT:
        return name, _text(*_next(parts, "a text", tuple(_TEXTS)), order) if shape[0] == 1 else None
    values = _array(parts, shape, order)
    return name, _complex(values, _array(parts, shape, order)) if flags[0] & _COMPLEX else values


def _next(parts: Iterator[tuple[int, memoryview]], what: str, kinds: Sequence[int]) -> tuple[int, memoryview]:
    kind, data = next(parts, (0, memoryview(b"")))
    if kind not in kinds:
        raise DamagedError(f"an array has data type {kind} where {what} should be")
    return kind, data


def _integers(data: memoryview, kind: str) -> list[int]:
    if len(data) % 4:
        raise DamagedError(f"{len(data)} bytes are no whole number of integers")
    return [int(number) for number in np.frombuffer(data, kind)]


def _array(parts: Iterator[tuple[int, memoryview]], shape: Sequence[int], order: str) -> NDArray[np.generic]:
    """Numbers in a data type that may be smaller than the array's class."""
    kind, data = _next(parts, "numbers", tuple(_TYPES))
    return _shaped(data, np.dtype(order + _TYPES[kind]), shape)


def _shaped(data: memoryview, dtype: np.dtype[np.generic], shape: Sequence[int]) -> NDArray[np.generic]:
    if len(data) != math.prod(shape) * dtype.itemsize:
        raise DamagedError(
            f"an array of {'x'.join(map(str, shape))} numbers of {dtype.itemsize} bytes has {len(data)} bytes"
        )
    return np.frombuffer(data, dtype).reshape(shape, order="F")


def _complex(real: NDArray[np.generic], imaginary: NDArray[np.generic]) -> NDArray[np.generic]:
    with np.errstate(all="ignore"):  # a damaged file may hold any value
        return np.asarray(real + np.multiply(1j, imaginary))


def _text(kind: int, data: memoryview, order: str) -> str:
    encoding = _TEXTS[kind]
    if encoding in ("utf-16", "utf-32"):  # without a mark of their order
        encoding += "-le" if order == "<" else "-be"
    return bytes(data).decode(encoding, errors="replace")


def _fields(parts: Iterator[tuple[int, memoryview]], order: str) -> Variables:
    """The fields of one structure; nested structures are skipped."""
    lengths = _integers(_next(parts, "the length of field names", (5,))[1], f"{order}i4")
    names = bytes(_next(parts, "field names", _NAME)[1])
    if len(lengths) != 1 or lengths[0] < 1 or len(names) % lengths[0]:
        raise DamagedError(f"field names of {len(names)} bytes are said to have {lengths} each")
    variables: Variables = []
    for at in range(0, len(names), lengths[0]):
        name = names[at : at + lengths[0]].split(b"\0")[0].decode(errors="replace")
        matrix = _next(parts, f"the field {name!r}", (_MATRIX,))[1]
        value = _matrix(matrix, order, fields=False)[1] if len(matrix) else None
        if value is not None and not isinstance(value, list):
            variables.append((name, value))
    return variables


def _level_4(data: memoryview) -> Iterator[tuple[str, Variable]]:
    """Real parts, then imaginary ones, column by column; a text as the numbers of its characters."""
    (mark,) = struct.unpack_from("<i", data)
    order = "<" if 0 <= mark <= 5000 else ">"
    at = count = 0
    while at < len(data):
        if len(data) - at < _LEVEL_4 or count == MOST_COLUMNS:
            raise DamagedError(
                "it ends within a header" if count < MOST_COLUMNS else f"it has more than {count:,} variables"
            )
        mark, rows, columns, is_complex, length = struct.unpack_from(f"{order}5i", data, at)
        machine, rest = divmod(mark, 1000)
        kind, content = rest // 10, rest % 10
        if machine != (order == ">") or kind >= len(_LEVEL_4_TYPES) or content > 2 or min(rows, columns, length) < 0:
            raise DamagedError(f"a header of Level 4 says {mark}, {rows} x {columns}, {length} bytes of name")
        dtype = np.dtype(order + _LEVEL_4_TYPES[kind])
        size, begin = rows * columns * dtype.itemsize, at + _LEVEL_4 + length
        at, count = begin + size * (2 if is_complex else 1), count + 1
        if at > len(data):
            raise DamagedError(f"it ends {at - len(data)} bytes too early")
        name = bytes(data[begin - length : begin]).split(b"\0")[0].decode(errors="replace")
        values = _shaped(data[begin : begin + size], dtype, (rows, columns))
        if content == 0 and values.size:
            yield (
                name,
                _complex(values, _shaped(data[begin + size : at], dtype, (rows, columns))) if is_complex else values,
            )
        elif content == 1 and rows == 1:
            yield name, "".join(chr(int(code)) for code in values[0] if 0 < code < 0x110000)
