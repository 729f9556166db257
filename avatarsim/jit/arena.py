"""Arena: nested named tuples of arrays in one piece of memory, which kernels read by the names of their fields.

To call a kernel from Python costs 0.1 to 0.2 microseconds per array, nested or not: for the hundred arrays of a world and its
memory as much as the kernel itself takes. Here they lie in one array of 64-bit words. `pack` lays out a named tuple, and
returns it over views, for use in Python; `view_arena(words, Kind)` is the same tuple again, in a kernel by reference
(`by_reference`).

The type of a field is given by its annotation alone: an array (`Line`, `Vectors`, ...), a record or a table (`record`), another
named tuple, a number, a flag.

Words: for which address of the words the image is right, how many addresses are in it, where these are listed, at which byte the
image begins, the tag of the layout; per array or number a row with its place; then all data, the image, and the list. The image
is the tuple as compiled code keeps it (`Image`). Copied words lie elsewhere: `view_arena` sees that and puts the addresses right.
"""

from collections.abc import Iterator
from ctypes import c_int64
from math import prod
from typing import Any, TypeVar, cast

import numpy as np
from numba.extending import overload
from numpy.typing import NDArray

from avatarsim.errors import AvatarsimError
from avatarsim.jit.by_reference import lying_at, referred
from avatarsim.jit.kernel import config, kernel
from avatarsim.jit.layout import NUMBERS, Axes, Index, axes_of, fields, layout_tag
from avatarsim.jit.record import RECORDS, TABLES

Tree = TypeVar("Tree")

ADDRESS, MANY, LIST, IMAGE, TAG, FIRST = range(6)
"""The first words of an arena, in the order above; the last begins the first row."""

AXES_MOST = 4
"""Most axes of an array."""

ROW = 1 + AXES_MOST
"""Words about one array or number: its first element, counted in elements of its own type, and its lengths."""

WORD = 8
"""Bytes of a word."""

NO_LAYOUT = -1
"""Tag of a tuple without names, which is packed but never viewed."""

OTHER_LAYOUT = "an arena of another layout: this is a defect"
"""Message of the error for words that were packed from another named tuple."""


def pack(tree: Tree) -> tuple[Index, Tree]:
    """Copy the arrays, records and numbers of nested tuples into one array of words.

    Returns the words, and the tuples with views of them in place of the arrays and records; numbers stay as they are. An array
    that occurs twice is laid out once: a write to one of them is a write to both. Arrays: C order, float64, int64 or bool, up to
    four axes; or one axis of records that fill whole words.
    """
    leaves: list[object] = []
    _collect(tree, leaves)
    known: dict[int, int] = {}
    arrays, starts, end = [], [], FIRST + ROW * len(leaves)
    for leaf in leaves:
        array = _as_array(leaf)
        if not isinstance(leaf, np.ndarray | np.void) or id(leaf) not in known:
            known[id(leaf)] = end
            end += -(-array.nbytes // WORD)
        arrays.append(array)
        starts.append(known[id(leaf)] * WORD)
    image = Image()
    image.lay(tree, dict(zip(map(id, leaves), starts, strict=True)))
    image.fill(WORD)
    listed = end + len(image.data) // WORD
    words = np.zeros(listed + len(image.addresses), dtype=np.int64)
    words[:FIRST] = 0, len(image.addresses), listed, end * WORD, layout_tag(type(tree)) if hasattr(tree, "_fields") else NO_LAYOUT
    words[end:listed] = np.frombuffer(bytes(image.data), dtype=np.int64)
    words[listed:] = end + np.array(image.addresses, dtype=np.int64) // WORD
    views: list[object] = []
    for k, (leaf, array, start) in enumerate(zip(leaves, arrays, starts, strict=True)):
        row, first = FIRST + ROW * k, start // array.itemsize
        words[row], words[row + 1 : row + 1 + array.ndim] = first, array.shape
        view = words.view(array.dtype)[first : first + array.size].reshape(array.shape)
        view[...] = array
        views.append(_like(leaf, view))
    views.reverse()
    return words, _rebuilt(tree, views)


def _as_array(leaf: object) -> NDArray[np.generic]:
    if isinstance(leaf, np.ndarray):
        array = leaf if leaf.dtype.fields is None or leaf.ndim != 1 else leaf.view(np.ndarray).view(np.int64)
    elif isinstance(leaf, np.void):
        array = np.asarray(leaf).reshape(1).view(np.int64)
    else:
        array = np.array([leaf], dtype=np.float64 if isinstance(leaf, float) else np.int64)
    if array.dtype not in (np.float64, np.int64, np.bool_) or not 1 <= array.ndim <= AXES_MOST:
        raise AvatarsimError(f"an arena holds no array of {array.dtype} with {array.ndim} axes: this is a defect")
    return array


def _like(leaf: object, view: NDArray[np.generic]) -> object:
    """Return the placeholder of a leaf: an array as it is, a record or an array of records again as such, a number itself."""
    if isinstance(leaf, np.void):
        return view.view(leaf.dtype)[0]
    if isinstance(leaf, np.ndarray):
        return view if leaf.dtype.fields is None else view.view(leaf.dtype).view(type(leaf))
    return leaf


def _collect(tree: object, leaves: list[object]) -> None:
    if isinstance(tree, tuple):
        for branch in tree:
            _collect(branch, leaves)
    else:
        leaves.append(tree)


def _rebuilt(tree: Tree, views: list[object]) -> Tree:
    """Return the tree again, its leaves taken from the end of `views`."""
    if not isinstance(tree, tuple):
        return views.pop()  # type: ignore[return-value]  # a view of an array, or a number itself
    branches = [_rebuilt(branch, views) for branch in tree]
    made = tree._make(branches) if hasattr(tree, "_make") else tuple(branches)
    return made  # type: ignore[return-value]  # the type of `tree`, which mypy cannot follow


class Image:
    """Bytes of nested tuples as compiled code keeps them, and the words in them that hold addresses.

    Structures within structures: a number is a number, a flag one byte, a record the word where it lies, an array numba's fields:
    two words for memory that is counted (here none is), the number of elements, their size in bytes, their address, the lengths,
    and the strides.
    """

    def __init__(self) -> None:
        self.data = bytearray()
        self.addresses: list[int] = []
        """Places, in bytes, of the words that are addresses."""

    def lay(self, tree: object, starts: dict[int, int]) -> None:
        """Lay down a tree; `starts`: by its id, the byte at which an array or record lies."""
        self.fill(aligned(tree))
        if isinstance(tree, tuple):
            for branch in tree:
                self.lay(branch, starts)
            self.fill(aligned(tree))
        elif isinstance(tree, bool | np.bool_):
            self.data.append(bool(tree))
        elif isinstance(tree, float):
            self.data += np.float64(tree).tobytes()
        elif isinstance(tree, np.ndarray):
            self.words(0, 0, tree.size, tree.itemsize)
            self.address(starts[id(tree)])
            self.words(*tree.shape, *(tree.itemsize * prod(tree.shape[k + 1 :]) for k in range(tree.ndim)))
        elif isinstance(tree, np.void):
            self.address(starts[id(tree)])
        else:
            self.words(int(tree))  # type: ignore[call-overload]  # an int, the only other kind

    def fill(self, alignment: int) -> None:
        """Leave room up to a multiple of so many bytes."""
        self.data += bytes(-len(self.data) % alignment)

    def words(self, *values: int) -> None:
        """Lay down whole numbers."""
        self.data += np.array(values, dtype=np.int64).tobytes()

    def address(self, byte: int) -> None:
        """Lay down a word that is an address."""
        self.addresses.append(len(self.data))
        self.words(byte)


def aligned(tree: object) -> int:
    """Return the alignment in bytes of a number, an array or a tuple: a structure's is that of its strictest part."""
    if isinstance(tree, tuple):
        return max(map(aligned, tree), default=1)
    return 1 if isinstance(tree, bool | np.bool_) else WORD


def view_arena(words: Index, kind: type[Tree]) -> Tree:
    """Return the named tuple of class `kind` that was packed into `words`, which must outlive it.

    Raises ValueError for words of another class: their tag differs."""
    if words[TAG] != layout_tag(kind):
        raise ValueError(OTHER_LAYOUT)
    return cast(Tree, _read(words, kind, iter(range(FIRST, len(words), ROW))))


def _read(words: Index, kind: Any, rows: Iterator[int]) -> object:
    """Return the value of a field with this annotation, from the next rows."""
    if not (kind in NUMBERS or kind in RECORDS or kind in TABLES or axes_of(kind)):
        return kind(*(_read(words, one, rows) for one in fields(kind)))
    row = next(rows)
    first = int(words[row])
    if kind in NUMBERS:
        return kind(words.view(np.float64)[first] if kind is float else words[first])
    axes = axes_of(kind) or Axes(1, np.int64)
    shape = words[row + 1 : row + 1 + axes.count].tolist()
    view = words.view(axes.kind)[first : first + prod(shape)].reshape(shape)
    if kind in RECORDS:
        return view.view(RECORDS[kind].layout)[0]
    return view.view(TABLES[kind]).view(kind) if kind in TABLES else view


def words_at(place: int, count: int) -> Index:
    """Return the `count` words at an address, which must outlive the result: so a kernel takes many arenas at once."""
    return np.ctypeslib.as_array((c_int64 * int(count)).from_address(int(place))) if count else np.zeros(0, dtype=np.int64)


if not config.DISABLE_JIT:
    # a function of numba's may return no array whose memory it does not count; an intrinsic may
    words_at = lying_at

    @kernel
    def put_right(words: Index) -> None:
        """Correct the addresses of an image whose words have been moved."""
        moved = np.int64(words.ctypes.data) - words[ADDRESS]
        if moved != 0:
            for k in range(words[LIST], words[LIST] + words[MANY]):
                words[words[k]] += moved
            words[ADDRESS] += moved

    @overload(view_arena)  # type: ignore[untyped-decorator]  # so are all of numba's
    def _compiled(words: Any, kind: Any) -> Any:
        # numba wants the same annotations on both
        tag = layout_tag(kind.instance_class)

        def body(words: Any, kind: Any) -> Any:
            if words[TAG] != tag:
                raise ValueError(OTHER_LAYOUT)
            put_right(words)
            return referred(words, words[IMAGE], kind)

        return body
