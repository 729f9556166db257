"""All arrays of one side of the engine in one piece of memory, so that one argument hands them all to a kernel.

To call a kernel from Python costs 0.1 to 0.2 microseconds per array, nested or not: for the hundred arrays of a world and
its memory as much as the kernel itself takes. Here they lie in one array of 64-bit words, and an entry kernel finds them again.

`packed` lays out nested tuples and returns the same tuples over views, with which Python goes on. In a kernel `opening` begins
at the first array, and each of `line`, `vectors`, `grid`, `whole` and so on takes the next one: what opens a tuple reads
its fields in the order in which the tuple has them, and is one of `view.opened`. Only within such a function may an array be
made a record or a table: a kernel finds each part as what it is.

Words: which row comes next; for which address of the words `image` is right, how many addresses are in it, and where these
are listed; per array or number a row of ROW words; then all data, the image, and the list. Whoever copies the words moves them:
`opening` sees that and puts the addresses right.
"""

from typing import NamedTuple, TypeVar

import numba
import numpy as np
from numpy.typing import NDArray

from avatarsim.errors import AvatarsimError
from avatarsim.jit.kernel import kernel
from avatarsim.world.image import WORD, Image
from avatarsim.world.view import ROW, START_AND_SHAPE, address, next_number, next_view

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Flags = NDArray[np.bool_]
Tree = TypeVar("Tree")

NEXT, ADDRESS, MANY, LIST, FIRST = range(5)
"""The first words of an arena, as said above; the fifth begins the first row."""


class Opening(NamedTuple):
    """An arena in which a kernel has begun to read."""

    words: Index


def packed(tree: Tree) -> tuple[Index, Tree]:
    """Copy the arrays, records and numbers of nested tuples into one array of words.

    Returns the words, and the tuples with views of them in place of the arrays and records; numbers stay as they are. What
    occurs twice is laid out once: who writes to one of them writes to both. Arrays: C order, float64, int64 or bool, up to four
    axes; or one axis of records that fill whole words. A record or an array of records is opened as the words that it is.
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
    words[:FIRST] = FIRST, 0, len(image.addresses), listed
    words[end:listed] = np.frombuffer(bytes(image.data), dtype=np.int64)
    words[listed:] = end + np.array(image.addresses, dtype=np.int64) // WORD
    views: list[object] = []
    for k, (leaf, array, start) in enumerate(zip(leaves, arrays, starts, strict=True)):
        row = FIRST + ROW * k
        first = start // array.itemsize
        words[row], words[row + 1 : row + 1 + array.ndim] = first, array.shape
        words[row + START_AND_SHAPE] = end * WORD + image.places[k]
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
    if array.dtype not in (np.float64, np.int64, np.bool_) or array.ndim not in range(1, START_AND_SHAPE):
        raise AvatarsimError(f"an arena holds no array of {array.dtype} with {array.ndim} axes: this is a defect")
    return array


def _like(leaf: object, view: NDArray[np.generic]) -> object:
    """What stands for a leaf: an array as it is, a record or an array of records again as such, a number itself."""
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
    """The tree again, its leaves taken from the end of `views`."""
    if not isinstance(tree, tuple):
        return views.pop()  # type: ignore[return-value]  # a view of an array, or a number itself
    branches = [_rebuilt(branch, views) for branch in tree]
    made = tree._make(branches) if hasattr(tree, "_make") else tuple(branches)
    return made  # type: ignore[return-value]  # the type of `tree`, which mypy cannot follow


@kernel
def opening(words: Index) -> Opening:
    """Begin at the first array. The words must outlive every view."""
    words[NEXT] = FIRST
    moved = address(words) - words[ADDRESS]
    if moved != 0:
        for k in range(words[LIST], words[LIST] + words[MANY]):
            words[words[k]] += moved
        words[ADDRESS] += moved
    return Opening(words)


line = next_view(np.float64, 1)
"""The next array, of numbers, one axis."""

vectors = next_view(np.float64, 1, 3)
"""The next array, of numbers, (n, 3)."""

matrices = next_view(np.float64, 1, 3, 3)
"""The next array, of numbers, (n, 3, 3)."""

grid = next_view(np.float64, 2)
"""The next array, of numbers, two axes."""

cube = next_view(np.float64, 3)
"""The next array, of numbers, three axes."""

stack = next_view(np.float64, 4)
"""The next array, of numbers, four axes."""

index_line = next_view(np.int64, 1)
"""The next array, of integers, one axis."""

index_grid = next_view(np.int64, 2)
"""The next array, of integers, two axes."""

flag_line = next_view(np.bool_, 1)
"""The next array, of flags, one axis."""

flag_grid = next_view(np.bool_, 2)
"""The next array, of flags, two axes."""


real = next_number(numba.float64, lambda words, k: float(words.view(np.float64)[k]))
"""The next number."""

whole = next_number(numba.int64, lambda words, k: int(words[k]))
"""The next integer."""

yes = next_number(numba.boolean, lambda words, k: bool(words[k] == 1))
"""The next flag that stands alone."""
