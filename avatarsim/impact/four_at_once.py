"""What a contact sees of two bodies and what an impulse does to them, four numbers at a time.

Nearly all time of bodies in motion goes by in these sums. The compiler does not find that they go side by side, so its vector
code is written out here; the Python below says what it computes, bit for bit.
"""

from typing import Any

import numba
import numpy as np
from llvmlite import ir
from numba.extending import intrinsic, overload
from numpy.typing import NDArray

from avatarsim.impact.contacts import MOTION, ROW
from avatarsim.impact.solver_rows import ALL_WISHES, GIFT, LANES, PARTS, SIDE_GIFT
from avatarsim.spatial.vec3 import Vec3

types: Any = numba.types
Array = NDArray[np.float64]

_REAL, _WHOLE, _LANE = ir.DoubleType(), ir.IntType(64), ir.IntType(32)
_FOUR = ir.VectorType(_REAL, LANES)


def wishes(rows: Array, k: int, motion: Array, a: int, b: int) -> Vec3:
    """Impulses that would stop contact k of bodies a and b along each axis of its frame, by ``motion`` (nb, MOTION) as it is."""
    found = [0.0, 0.0, 0.0]
    for i in range(3):
        t = [float(rows[k, ALL_WISHES + LANES * c + i] * s) for c, s in enumerate(seen(motion, a, b))]
        found[i] = (t[0] + t[1] + t[2]) + ((t[3] + t[4] + t[5]) - (t[6] + t[7] + t[8]))
    return found[0], found[1], found[2]


def seen(motion: Array, a: int, b: int) -> list[float]:
    """Velocity of a's centre as seen from b's, angular velocities of a and of b."""
    apart = [float(motion[a, x] - motion[b, x]) for x in range(3)]
    return apart + [float(motion[a, LANES + x]) for x in range(3)] + [float(motion[b, LANES + x]) for x in range(3)]


def give(rows: Array, k: int, d: Vec3, motion: Array, a: int, b: int) -> None:
    """Give bodies a and b the impulse d in the frame of contact k."""
    for part in range(PARTS):
        for x in range(3):
            on, at = LANES * (part % 2) + x, LANES * part + x
            sides = rows[k, SIDE_GIFT + at] * d[1] + rows[k, SIDE_GIFT + LANES * PARTS + at] * d[2]
            if part < 2:
                motion[a, on] += rows[k, GIFT + at] * d[0] + sides
            else:
                motion[b, on] -= rows[k, GIFT + at] * d[0] + sides


def give_along_normal(rows: Array, k: int, d: float, motion: Array, a: int, b: int) -> None:
    """`give` of an impulse d along the normal."""
    for x in range(3):
        for turns in range(2):
            motion[a, LANES * turns + x] += rows[k, GIFT + LANES * turns + x] * d
            motion[b, LANES * turns + x] -= rows[k, GIFT + LANES * (2 + turns) + x] * d


def _of(context: Any, b: ir.IRBuilder, kind: Any, array: ir.Value, i: ir.Value, width: int) -> ir.Value:
    """Where row i of an array of rows of this width begins."""
    return b.gep(context.make_array(kind)(context, b, array).data, [b.mul(i, _WHOLE(width))])


def _four(b: ir.IRBuilder, start: ir.Value, at: int) -> ir.Value:
    """Where four numbers lie, from number ``at`` of a row on."""
    return b.bitcast(b.gep(start, [_WHOLE(at)]), _FOUR.as_pointer())


def _times(b: ir.IRBuilder, start: ir.Value, at: int, s: ir.Value) -> ir.Value:
    """Four numbers of a row, times s."""
    nothing, all_first = ir.Constant(_FOUR, ir.Undefined), ir.Constant(ir.VectorType(_LANE, LANES), [0] * LANES)
    same = b.shuffle_vector(b.insert_element(nothing, s, _LANE(0)), nothing, all_first)
    return b.fmul(b.load(_four(b, start, at), align=8), same)


@intrinsic  # type: ignore[untyped-decorator]  # so are all of numba's
def _wishes(typing_context: object, rows: Any, k: Any, motion: Any, a: Any, b: Any) -> Any:
    def build(context: Any, b: ir.IRBuilder, signature: Any, values: Any) -> ir.Value:
        row = _of(context, b, signature.args[0], values[0], values[1], ROW)
        one, other = (_of(context, b, signature.args[2], values[2], i, MOTION) for i in values[3:])

        def number(start: ir.Value, at: int) -> ir.Value:
            return b.load(b.gep(start, [_WHOLE(at)]))

        sight = [b.fsub(number(one, x), number(other, x)) for x in range(3)]
        sight += [number(start, LANES + x) for start in (one, other) for x in range(3)]
        t = [_times(b, row, ALL_WISHES + LANES * c, s) for c, s in enumerate(sight)]
        u, w_a, w_b = (b.fadd(b.fadd(t[c], t[c + 1]), t[c + 2]) for c in (0, 3, 6))
        total = b.fadd(u, b.fsub(w_a, w_b))
        return context.make_tuple(b, signature.return_type, [b.extract_element(total, _LANE(i)) for i in range(3)])

    return types.UniTuple(types.float64, 3)(rows, types.int64, motion, types.int64, types.int64), build


def _giving(signature: Any, sources: tuple[int, ...]) -> Any:
    """What writes the code of a gift: ``sources`` say where those of each axis begin in a row."""

    def build(context: Any, b: ir.IRBuilder, signature: Any, values: Any) -> ir.Value:
        d = values[2 : 2 + len(sources)]
        row = _of(context, b, signature.args[0], values[0], values[1], ROW)
        motion = signature.args[-3], values[-3]
        for part in range(PARTS):
            start, add = _of(context, b, *motion, values[-2 + part // 2], MOTION), b.fadd if part < 2 else b.fsub
            terms = [_times(b, row, source + LANES * part, s) for source, s in zip(sources, d, strict=True)]
            given = terms[0] if len(terms) == 1 else b.fadd(terms[0], b.fadd(terms[1], terms[2]))
            there = _four(b, start, LANES * (part % 2))
            b.store(add(b.load(there, align=8), given), there, align=8)
        return context.get_dummy_value()

    return signature, build


@intrinsic  # type: ignore[untyped-decorator]
def _give(typing_context: object, rows: Any, k: Any, x: Any, y: Any, z: Any, motion: Any, a: Any, b: Any) -> Any:
    whole, real = types.int64, types.float64
    return _giving(types.none(rows, whole, real, real, real, motion, whole, whole), (GIFT, SIDE_GIFT, SIDE_GIFT + LANES * PARTS))


@intrinsic  # type: ignore[untyped-decorator]
def _give_along_normal(typing_context: object, rows: Any, k: Any, d: Any, motion: Any, a: Any, b: Any) -> Any:
    whole, real = types.int64, types.float64
    return _giving(types.none(rows, whole, real, motion, whole, whole), (GIFT,))


def _ours(*arrays: Any) -> bool:
    return all(array.layout == "C" and array.dtype == types.float64 for array in arrays)


@overload(wishes)  # type: ignore[untyped-decorator]
def _compiled_wishes(rows: Any, k: Any, motion: Any, a: Any, b: Any) -> Any:
    # numba wants the same annotations on both
    def body(rows: Any, k: Any, motion: Any, a: Any, b: Any) -> Any:
        return _wishes(rows, k, motion, a, b)

    return body if _ours(rows, motion) else None  # numba then says that there is no such function


@overload(give)  # type: ignore[untyped-decorator]
def _compiled_give(rows: Any, k: Any, d: Any, motion: Any, a: Any, b: Any) -> Any:
    def body(rows: Any, k: Any, d: Any, motion: Any, a: Any, b: Any) -> Any:
        _give(rows, k, d[0], d[1], d[2], motion, a, b)

    return body if _ours(rows, motion) else None


@overload(give_along_normal)  # type: ignore[untyped-decorator]
def _compiled_along_normal(rows: Any, k: Any, d: Any, motion: Any, a: Any, b: Any) -> Any:
    def body(rows: Any, k: Any, d: Any, motion: Any, a: Any, b: Any) -> Any:
        _give_along_normal(rows, k, d, motion, a, b)

    return body if _ours(rows, motion) else None
