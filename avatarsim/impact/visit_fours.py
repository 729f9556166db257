"""`impact.visit` for contacts that `impact.fours` laid out: four take what they want at once.

Written out as vector code, since the compiler does not find that four contacts go side by side; the Python says what it computes,
bit for bit.
"""

from collections.abc import Sequence
from typing import Any

import numba
import numpy as np
from llvmlite import ir
from numba.extending import intrinsic, overload
from numpy.typing import NDArray

from avatarsim.impact.code_of_fours import Builder, going_on, visiting
from avatarsim.impact.contacts import Contacts
from avatarsim.impact.fours import (
    ARM,
    BEFORE,
    DIRECTION,
    EASE,
    FRICTION,
    HELD,
    MASS,
    NORMAL,
    PER,
    READ,
    ROWS_OF_FOUR,
    SLIDE,
    TANGENTS,
    TARGET,
    TURN,
    WRITTEN,
    place,
)
from avatarsim.impact.solver_rows import LANES
from avatarsim.kernel import kernel

types: Any = numba.types
Array = NDArray[np.float64]
Index = NDArray[np.int64]


def visit_four(rows: Array, lanes: Index, g: int, motion: Array, rough: bool) -> float:
    """Four g takes what it wants, friction too if ``rough``; returns the largest change [m/s]."""
    at, see, write = _places(rows, g), lanes[LANES * g : LANES * (g + 1), READ:], lanes[LANES * g : LANES * (g + 1), WRITTEN:]
    n, t, s, h = at[NORMAL:TANGENTS], at[TANGENTS : TANGENTS + 3], at[TANGENTS + 3 : ARM], at[HELD:BEFORE]
    (v_a, w_a), (v_b, w_b) = _seen(motion, see[:, 0]), _seen(motion, see[:, 1])
    u = v_a - v_b
    normal = (h[0] + at[TARGET]) - _dot(n, u) * at[PER]
    normal = np.where(normal > 0.0, normal, 0.0)
    d = [normal - h[0]]
    moved = abs(d[0]) * at[EASE]
    if rough:
        c = at[ARM] * w_a - at[ARM + 1] * w_b
        x = (h[1] + at[SLIDE]) - (_dot(t, u) + _dot(s, c)) * at[PER + 1]
        y = (h[2] + at[SLIDE + 1]) - (_dot(s, u) - _dot(t, c)) * at[PER + 1]
        limit, length = at[FRICTION] * normal, x * x + y * y
        over = length > limit * limit
        share = limit / np.sqrt(np.where(over, length, 1.0))
        d += [np.where(over, x * share, x) - h[1], np.where(over, y * share, y) - h[2]]
        across = (abs(d[1]) + abs(d[2])) * at[EASE + 1]
        moved = np.where(across > moved, across, moved)
    h[: len(d)] += d
    _give(at, d, motion, write, ((v_a, w_a), (v_b, w_b)))
    return float(moved.max())


def go_on_four(rows: Array, lanes: Index, g: int, motion: Array, rough: bool, beta: float) -> None:
    """Four g goes on by ``beta`` times its way of last time; its direction becomes that and the way since it was `kept`."""
    at, see, write = _places(rows, g), lanes[LANES * g : LANES * (g + 1), READ:], lanes[LANES * g : LANES * (g + 1), WRITTEN:]
    axes, d = range(3 if rough else 1), []
    for x in axes:
        way = at[HELD + x] - at[BEFORE + x]
        d.append(at[DIRECTION + x] * beta)
        at[DIRECTION + x] = way + d[x]
        at[HELD + x] += d[x]
    _give(at, d, motion, write, (_seen(motion, see[:, 0]), _seen(motion, see[:, 1])))


def begin_four(rows: Array, g: int) -> None:
    """The direction of four g becomes its way since it was kept."""
    at = _places(rows, g)
    at[DIRECTION : DIRECTION + 3] = at[HELD : HELD + 3] - at[BEFORE : BEFORE + 3]


def keep_four(rows: Array, g: int) -> None:
    """The impulses of four g are those before a double sweep."""
    at = _places(rows, g)
    at[BEFORE : BEFORE + 3] = at[HELD : HELD + 3]


def way_of_four(rows: Array, g: int) -> float:
    """Sum of squares of the way that four g went since it was kept, times the ease along the normal."""
    at = _places(rows, g)
    w = at[HELD : HELD + 3] - at[BEFORE : BEFORE + 3]
    square = ((w[0] * w[0] + w[1] * w[1]) + w[2] * w[2]) * at[EASE]
    return float((square[0] + square[1]) + (square[2] + square[3]))


def _places(rows: Array, g: int) -> Array:
    """The places of four g, each with its four numbers."""
    return rows[ROWS_OF_FOUR * g : ROWS_OF_FOUR * (g + 1)].reshape(-1, LANES)


def _dot(a: Array, b: Array) -> Array:
    total: Array = (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]
    return total


def _seen(motion: Array, who: Index) -> tuple[Array, Array]:
    """Velocities (3, 4) and angular velocities (3, 4) of four bodies."""
    return motion[who, :3].T, motion[who, LANES : LANES + 3].T


def _give(at: Array, d: Sequence[Array], motion: Array, write: Index, seen: Sequence[tuple[Array, Array]]) -> None:
    """Give the bodies of a four, whose velocities were ``seen``, the impulses d along the normal, or along all three axes."""
    n, t, s = at[NORMAL:TANGENTS], at[TANGENTS : TANGENTS + 3], at[TANGENTS + 3 : ARM]
    j = n * d[0] if len(d) == 1 else n * d[0] + (t * d[1] + s * d[2])
    for side in range(2):
        v, w = seen[side]
        j_v = j * at[MASS + side]
        motion[write[:, side], :3] = (v + j_v if side == 0 else v - j_v).T
        if len(d) > 1:
            j_w = (s * d[1] - t * d[2]) * at[TURN + side]
            motion[write[:, side], LANES : LANES + 3] = (w + j_w if side == 0 else w - j_w).T


_WHERE = types.Array(types.float64, 2, "C"), types.Array(types.int64, 2, "C"), types.int64, types.Array(types.float64, 2, "C")


@intrinsic  # type: ignore[untyped-decorator]  # so are all of numba's
def _visit_rough(typing_context: object, rows: Any, lanes: Any, g: Any, motion: Any) -> Any:
    return types.float64(*_WHERE), visiting(True)


@intrinsic  # type: ignore[untyped-decorator]
def _visit_smooth(typing_context: object, rows: Any, lanes: Any, g: Any, motion: Any) -> Any:
    return types.float64(*_WHERE), visiting(False)


@intrinsic  # type: ignore[untyped-decorator]
def _go_on_rough(typing_context: object, rows: Any, lanes: Any, g: Any, motion: Any, beta: Any) -> Any:
    return types.none(*_WHERE, types.float64), going_on(True)


@intrinsic  # type: ignore[untyped-decorator]
def _go_on_smooth(typing_context: object, rows: Any, lanes: Any, g: Any, motion: Any, beta: Any) -> Any:
    return types.none(*_WHERE, types.float64), going_on(False)


@intrinsic  # type: ignore[untyped-decorator]
def _keep(typing_context: object, rows: Any, g: Any) -> Any:
    def build(context: Any, b: ir.IRBuilder, signature: Any, values: Any) -> ir.Value:
        four = Builder(context, b, signature, values)
        four.over(values[1])
        for i, held in enumerate(four.get(HELD, 3)):
            four.put(BEFORE + i, held)
        return context.get_dummy_value()

    return types.none(_WHERE[0], types.int64), build


@intrinsic  # type: ignore[untyped-decorator]
def _begin(typing_context: object, rows: Any, g: Any) -> Any:
    def build(context: Any, b: ir.IRBuilder, signature: Any, values: Any) -> ir.Value:
        four = Builder(context, b, signature, values)
        four.over(values[1])
        for i, (held, before) in enumerate(zip(four.get(HELD, 3), four.get(BEFORE, 3), strict=True)):
            four.put(DIRECTION + i, b.fsub(held, before))
        return context.get_dummy_value()

    return types.none(_WHERE[0], types.int64), build


@intrinsic  # type: ignore[untyped-decorator]
def _way(typing_context: object, rows: Any, g: Any) -> Any:
    def build(context: Any, b: ir.IRBuilder, signature: Any, values: Any) -> ir.Value:
        four = Builder(context, b, signature, values)
        four.over(values[1])
        w = [b.fsub(held, before) for held, before in zip(four.get(HELD, 3), four.get(BEFORE, 3), strict=True)]
        x = four.numbers(b.fmul(four.dot(w, w), four.get(EASE, 1)[0]))
        return b.fadd(b.fadd(x[0], x[1]), b.fadd(x[2], x[3]))

    return types.float64(_WHERE[0], types.int64), build


@overload(visit_four)  # type: ignore[untyped-decorator]
def _compiled_visit(rows: Any, lanes: Any, g: Any, motion: Any, rough: Any) -> Any:
    # numba wants the same annotations on both
    def body(rows: Any, lanes: Any, g: Any, motion: Any, rough: Any) -> Any:
        return _visit_rough(rows, lanes, g, motion) if rough else _visit_smooth(rows, lanes, g, motion)

    return body


@overload(go_on_four)  # type: ignore[untyped-decorator]
def _compiled_go_on(rows: Any, lanes: Any, g: Any, motion: Any, rough: Any, beta: Any) -> Any:
    def body(rows: Any, lanes: Any, g: Any, motion: Any, rough: Any, beta: Any) -> Any:
        if rough:
            _go_on_rough(rows, lanes, g, motion, beta)
        else:
            _go_on_smooth(rows, lanes, g, motion, beta)

    return body


@overload(keep_four)  # type: ignore[untyped-decorator]
def _compiled_keep(rows: Any, g: Any) -> Any:
    def body(rows: Any, g: Any) -> Any:
        _keep(rows, g)

    return body


@overload(begin_four)  # type: ignore[untyped-decorator]
def _compiled_begin(rows: Any, g: Any) -> Any:
    def body(rows: Any, g: Any) -> Any:
        _begin(rows, g)

    return body


@overload(way_of_four)  # type: ignore[untyped-decorator]
def _compiled_way(rows: Any, g: Any) -> Any:
    def body(rows: Any, g: Any) -> Any:
        return _way(rows, g)

    return body


@kernel
def visit_fours(contacts: Contacts, fours: int, back: bool, grip: bool) -> tuple[float, float]:
    """`visit.visit_all` of so many fours, one after the other; returns what that returns."""
    rows, lanes, motion, worst, square = contacts.rows, contacts.lanes, contacts.motion, 0.0, 0.0
    for turn in range(fours):
        g = fours - 1 - turn if back else turn
        if not back:
            keep_four(rows, g)
        # the first of a four is there always, and all of a four have friction or none
        worst = max(worst, visit_four(rows, lanes, g, motion, grip and rows[place(rows, g, FRICTION, 0)] > 0.0))
        if back:
            square += way_of_four(rows, g)
    return worst, square


@kernel
def go_on_fours(contacts: Contacts, fours: int, beta: float, grip: bool) -> None:
    """`visit.go_on_along` of so many fours."""
    rows, lanes, motion = contacts.rows, contacts.lanes, contacts.motion
    for g in range(fours):
        if beta > 0.0:
            go_on_four(rows, lanes, g, motion, grip and rows[place(rows, g, FRICTION, 0)] > 0.0, beta)
        else:
            begin_four(rows, g)
