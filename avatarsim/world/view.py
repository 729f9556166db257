"""An array of an arena, seen where it lies: its words are written down, and nothing is sliced or shaped again.

A kernel that opens an arena makes a hundred views. Each is some ten instructions here; as slices and shapes of numba's they were
a hundred, with care for negative bounds and strides, and to compile them took a tenth of the whole engine.
"""

from collections.abc import Callable
from typing import Any

import numba
import numpy as np
from llvmlite import ir
from numba.core import cgutils
from numba.extending import intrinsic
from numba.np.arrayobj import populate_array

from avatarsim.kernel import config

types: Any = numba.types

START_AND_SHAPE = 5
"""Words that describe an array: its first element, counted in elements of its own type, and up to four lengths."""


def next_view(kind: type[np.generic], axes: int, *tail: int) -> Callable[[Any], tuple[Any]]:
    """The function, for kernels and for plain Python, that takes the next array of an opening.

    The array is of one kind of element and in C order; its last axes are the lengths in `tail`, those before are written in the
    arena. It comes in a tuple of one: without reference counting a compiled function may not return a bare array.
    """

    def plain(o: Any) -> tuple[Any]:
        k, words = int(o.words[0]), o.words
        words[0] = k + START_AND_SHAPE
        shape = (*words[k + 1 : k + 1 + axes].tolist(), *tail)
        return (words.view(kind)[words[k] : words[k] + int(np.prod(shape))].reshape(shape),)

    if config.DISABLE_JIT:
        return plain
    array = types.Array(numba.from_dtype(np.dtype(kind)), axes + len(tail), "C")
    size = np.dtype(kind).itemsize

    def build(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        words = context.make_array(signature.args[0].types[0])(context, builder, builder.extract_value(values[0], 0)).data
        whole = ir.IntType(64)
        k = builder.load(words)
        builder.store(builder.add(k, whole(START_AND_SHAPE)), words)
        described = builder.gep(words, [k])
        start, *lengths = (builder.load(builder.gep(described, [whole(i)])) for i in range(1 + axes))
        shape = [*lengths, *(whole(length) for length in tail)]
        strides = [whole(size)]
        for length in reversed(shape[1:]):
            strides.insert(0, builder.mul(strides[0], length))
        first = builder.bitcast(words, context.get_data_type(array.dtype).as_pointer())
        view = context.make_array(array)(context, builder)
        populate_array(view, builder.gep(first, [start]), shape, strides, whole(size), None)
        return cgutils.pack_array(builder, [view._getvalue()])

    @intrinsic  # type: ignore[untyped-decorator]  # numba's are
    def taken(typing_context: Any, o: Any) -> Any:
        return types.Tuple((array,))(o), build

    found: Callable[[Any], tuple[Any]] = taken
    return found
