"""An array of an arena, seen where it lies: nothing is sliced or shaped again.

In plain Python an array is made of its description. Compiled code has no need to: `image` has written the array down as compiled
code keeps it, and there it is read. What is read first of all is of which type it is; a function that opens an arena says that
when it is called with a `Declaring` in place of the arena.
"""

from collections.abc import Callable
from functools import cache, update_wrapper
from typing import Any, NamedTuple

import numba
import numpy as np
from llvmlite import ir
from numba.core.extending import _Intrinsic, intrinsic
from numba.core.types.containers import BaseNamedTuple

from avatarsim.jit.by_reference import Reference, parts
from avatarsim.jit.kernel import config

types: Any = numba.types

START_AND_SHAPE = 5
"""Words that describe an array: its first element, counted in elements of its own type, and up to four lengths."""

ROW = START_AND_SHAPE + 1
"""Words about one leaf of the packed tuples: what describes it, and where compiled code finds it, in bytes."""


def address(words: Any) -> int:
    """Where an array of words lies; plain Python, which reads no image, leaves the one that it has as it is."""
    return int(words[1])


if not config.DISABLE_JIT:

    @intrinsic
    def address(context: Any, words: Any) -> Any:
        def build(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            array = context.make_array(signature.args[0])(context, builder, values[0])
            return builder.ptrtoint(array.data, ir.IntType(64))

        return types.int64(words), build


class Declaring(NamedTuple):
    """Stands for an arena where types are asked for; one of `leaves` for every array or number that was opened."""

    leaves: list[None]


def next_view(kind: type[np.generic], axes: int, *tail: int) -> Callable[[Any], tuple[Any]]:
    """The function, for kernels and for plain Python, that takes the next array of an opening.

    The array is of one kind of element and in C order; its last axes are the lengths in `tail`, those before are written in the
    arena. It comes in a tuple of one: without reference counting a compiled function may not return a bare array.
    """
    array = types.Array(numba.from_dtype(np.dtype(kind)), axes + len(tail), "C")

    def plain(o: Any) -> tuple[Any]:
        if isinstance(o, Declaring):
            o.leaves.append(None)
            return (array,)
        k, words = int(o.words[0]), o.words
        words[0] = k + ROW
        shape = (*words[k + 1 : k + 1 + axes].tolist(), *tail)
        return (words.view(kind)[words[k] : words[k] + int(np.prod(shape))].reshape(shape),)

    return opened(plain)


def next_number(kind: Any, read: Callable[[Any, int], Any]) -> Callable[[Any], Any]:
    """The function, for kernels and for plain Python, that takes the next number of an opening: of a type of numba's, and as
    `read` finds it at a place in the words."""

    def plain(o: Any) -> Any:
        if isinstance(o, Declaring):
            o.leaves.append(None)
            return kind
        k = int(o.words[0])
        o.words[0] = k + ROW
        return read(o.words, int(o.words[k]))

    return opened(plain)


def opened(plain: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """A function that opens the next part of an arena, for kernels too: there a named tuple is opened by reference.

    Called with a `Declaring` it says of what types the part is.
    """
    return plain if config.DISABLE_JIT else Opened(plain)


class Opened(_Intrinsic):  # type: ignore[misc]  # numba has no annotations here
    """What `opened` makes of a function."""

    def __init__(self, plain: Callable[[Any], Any]) -> None:
        super().__init__(plain.__qualname__, self.define)
        update_wrapper(self, plain)
        self.plain = plain
        self._register()

    def __call__(self, o: Any) -> Any:
        return self.plain(o)

    def define(self, typing_context: Any, o: Any) -> Any:
        """Type and code, as numba asks for them."""
        found, leaves = declared(self.plain)
        kind = Reference(found) if isinstance(found, BaseNamedTuple) else found

        def build(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            words = context.make_array(signature.args[0].types[0])(context, builder, builder.extract_value(values[0], 0)).data
            whole = ir.IntType(64)
            k = builder.load(words)
            builder.store(builder.add(k, whole(ROW * leaves)), words)
            place = builder.load(builder.gep(words, [builder.add(k, whole(START_AND_SHAPE))]))
            first = builder.gep(builder.bitcast(words, ir.IntType(8).as_pointer()), [place])
            if kind is not found:
                return builder.bitcast(first, context.get_value_type(kind))
            return parts(builder, builder.bitcast(first, context.get_value_type(kind).as_pointer()))

        return kind(o), build


@cache
def declared(plain: Callable[[Any], Any]) -> tuple[Any, int]:
    """The type of what a function opens, and of how many arrays and numbers it is."""
    arena = Declaring([])
    return as_type(plain(arena)), len(arena.leaves)


def as_type(tree: Any) -> Any:
    """Nested tuples of numba's types as the type of such a tuple."""
    return types.BaseTuple.from_types(tuple(map(as_type, tree)), type(tree)) if isinstance(tree, tuple) else tree
