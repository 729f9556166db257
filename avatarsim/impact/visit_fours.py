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

from avatarsim.impact.contacts import LANE, MOTION, ROW, Contacts
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

_REAL, _WHOLE, _LANE = ir.DoubleType(), ir.IntType(64), ir.IntType(32)
_FOUR = ir.VectorType(_REAL, LANES)


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


class _Builder:
    """Vector code over one four."""

    def __init__(self, context: Any, b: ir.IRBuilder, signature: Any, values: Any) -> None:
        def start(i: int, row: ir.Value, width: int) -> ir.Value:
            array = context.make_array(signature.args[i])(context, b, values[i])
            return b.gep(array.data, [b.mul(row, _WHOLE(width))])

        self.b, self.start = b, start

    def over(self, g: ir.Value) -> None:
        self.places = self.start(0, g, ROWS_OF_FOUR * ROW)

    def beside(self, g: ir.Value) -> None:
        self.lanes = self.start(1, g, LANES * LANE)

    def there(self, at: int) -> ir.Value:
        return self.b.bitcast(self.b.gep(self.places, [_WHOLE(LANES * at)]), _FOUR.as_pointer())

    def get(self, at: int, count: int) -> list[ir.Value]:
        return [self.b.load(self.there(at + i), align=8) for i in range(count)]

    def put(self, at: int, x: ir.Value) -> None:
        self.b.store(x, self.there(at), align=8)

    def call(self, name: str, x: ir.Value) -> ir.Value:
        kind = ir.FunctionType(_FOUR, [_FOUR])
        return self.b.call(self.b.module.declare_intrinsic(f"{name}.v{LANES}f64", fnty=kind), [x])

    def mixed(self, x: ir.Value, y: ir.Value, lanes: Sequence[int]) -> ir.Value:
        return self.b.shuffle_vector(x, y, ir.Constant(ir.VectorType(_LANE, LANES), list(lanes)))

    def turned(self, x: Sequence[ir.Value]) -> list[ir.Value]:
        """Four by four numbers, rows for columns."""
        low, high = [0, 4, 2, 6], [1, 5, 3, 7]
        pairs = [self.mixed(x[i], x[i + 1], half) for half in (low, high) for i in (0, 2)]
        halves = ((0, [0, 1, 4, 5]), (2, [0, 1, 4, 5]), (0, [2, 3, 6, 7]), (2, [2, 3, 6, 7]))
        return [self.mixed(pairs[i], pairs[i + 1], lanes) for i, lanes in halves]

    def where(self, column: int, lane: int, part: int) -> ir.Value:
        """Where velocities (part 0) or angular velocities (1) of the body named in this column of a lane lie."""
        body = self.b.load(self.b.gep(self.lanes, [_WHOLE(LANE * lane + column)]))
        return self.b.bitcast(self.b.gep(self.start(3, body, MOTION), [_WHOLE(LANES * part)]), _FOUR.as_pointer())

    def seen(self, side: int, part: int) -> list[ir.Value]:
        return self.turned([self.b.load(self.where(READ + side, i, part), align=8) for i in range(LANES)])[:3]

    def write(self, side: int, part: int, x: Sequence[ir.Value]) -> None:
        for i, four in enumerate(self.turned([*x, ir.Constant(_FOUR, [0.0] * LANES)])):
            self.b.store(four, self.where(WRITTEN + side, i, part), align=8)

    def dot(self, x: Sequence[ir.Value], y: Sequence[ir.Value]) -> ir.Value:
        xx, yy, zz = (self.b.fmul(p, q) for p, q in zip(x, y, strict=True))
        return self.b.fadd(self.b.fadd(xx, yy), zz)

    def larger(self, x: ir.Value, y: ir.Value) -> ir.Value:
        return self.b.select(self.b.fcmp_ordered(">", x, y), x, y)

    def give(self, d: Sequence[ir.Value], seen: Sequence[Sequence[list[ir.Value]]]) -> None:
        b = self.b
        n, t, s = (self.get(3 * i, 3) for i in range(3))
        j = [b.fmul(x, d[0]) for x in n]
        if len(d) > 1:
            j = [b.fadd(j[i], b.fadd(b.fmul(t[i], d[1]), b.fmul(s[i], d[2]))) for i in range(3)]
        for side in range(2):
            add = b.fsub if side else b.fadd
            mass, turn = self.get(MASS + side, 1)[0], self.get(TURN + side, 1)[0]
            self.write(side, 0, [add(seen[side][0][i], b.fmul(j[i], mass)) for i in range(3)])
            if len(d) > 1:
                q = [b.fsub(b.fmul(s[i], d[1]), b.fmul(t[i], d[2])) for i in range(3)]
                self.write(side, 1, [add(seen[side][1][i], b.fmul(q[i], turn)) for i in range(3)])

    def both(self, rough: bool) -> list[list[list[ir.Value]]]:
        return [[self.seen(side, part) for part in range(2 if rough else 1)] for side in range(2)]

    def numbers(self, x: ir.Value) -> list[ir.Value]:
        return [self.b.extract_element(x, _LANE(i)) for i in range(LANES)]


def _visit(rough: bool) -> Any:
    def build(context: Any, b: ir.IRBuilder, signature: Any, values: Any) -> ir.Value:
        four = _Builder(context, b, signature, values)
        four.over(values[2])
        four.beside(values[2])
        seen = four.both(rough)
        n, t, s, h = four.get(NORMAL, 3), four.get(TANGENTS, 3), four.get(TANGENTS + 3, 3), four.get(HELD, 3)
        (per, per_side), (target,), (slide_x, slide_y) = four.get(PER, 2), four.get(TARGET, 1), four.get(SLIDE, 2)
        (ease, ease_side), (friction,), arms = four.get(EASE, 2), four.get(FRICTION, 1), four.get(ARM, 2)
        zero = ir.Constant(_FOUR, [0.0] * LANES)
        u = [b.fsub(seen[0][0][i], seen[1][0][i]) for i in range(3)]
        normal = four.larger(b.fsub(b.fadd(h[0], target), b.fmul(four.dot(n, u), per)), zero)
        d = [b.fsub(normal, h[0])]
        moved = b.fmul(four.call("llvm.fabs", d[0]), ease)
        if rough:
            c = [b.fsub(b.fmul(arms[0], seen[0][1][i]), b.fmul(arms[1], seen[1][1][i])) for i in range(3)]
            x = b.fsub(b.fadd(h[1], slide_x), b.fmul(b.fadd(four.dot(t, u), four.dot(s, c)), per_side))
            y = b.fsub(b.fadd(h[2], slide_y), b.fmul(b.fsub(four.dot(s, u), four.dot(t, c)), per_side))
            limit, length = b.fmul(friction, normal), b.fadd(b.fmul(x, x), b.fmul(y, y))
            over = b.fcmp_ordered(">", length, b.fmul(limit, limit))
            one = ir.Constant(_FOUR, [1.0] * LANES)
            share = b.fdiv(limit, four.call("llvm.sqrt", b.select(over, length, one)))
            d += [b.fsub(b.select(over, b.fmul(z, share), z), held) for z, held in ((x, h[1]), (y, h[2]))]
            across = b.fmul(b.fadd(four.call("llvm.fabs", d[1]), four.call("llvm.fabs", d[2])), ease_side)
            moved = four.larger(across, moved)
        for i, change in enumerate(d):
            four.put(HELD + i, b.fadd(h[i], change))
        four.give(d, seen)
        largest, *others = four.numbers(moved)
        for other in others:
            largest = b.select(b.fcmp_ordered(">", other, largest), other, largest)
        return largest

    return build


def _go_on(rough: bool) -> Any:
    def build(context: Any, b: ir.IRBuilder, signature: Any, values: Any) -> ir.Value:
        four = _Builder(context, b, signature, values)
        four.over(values[2])
        four.beside(values[2])
        seen, d = four.both(rough), []
        some = b.insert_element(ir.Constant(_FOUR, ir.Undefined), values[4], _LANE(0))
        beta = four.mixed(some, some, [0] * LANES)
        for i in range(3 if rough else 1):
            (held,), (before,), (last) = four.get(HELD + i, 1), four.get(BEFORE + i, 1), four.get(DIRECTION + i, 1)
            d.append(b.fmul(last[0], beta))
            four.put(DIRECTION + i, b.fadd(b.fsub(held, before), d[i]))
            four.put(HELD + i, b.fadd(held, d[i]))
        four.give(d, seen)
        return context.get_dummy_value()

    return build


_WHERE = types.Array(types.float64, 2, "C"), types.Array(types.int64, 2, "C"), types.int64, types.Array(types.float64, 2, "C")


@intrinsic  # type: ignore[untyped-decorator]  # so are all of numba's
def _visit_rough(typing_context: object, rows: Any, lanes: Any, g: Any, motion: Any) -> Any:
    return types.float64(*_WHERE), _visit(True)


@intrinsic  # type: ignore[untyped-decorator]
def _visit_smooth(typing_context: object, rows: Any, lanes: Any, g: Any, motion: Any) -> Any:
    return types.float64(*_WHERE), _visit(False)


@intrinsic  # type: ignore[untyped-decorator]
def _go_on_rough(typing_context: object, rows: Any, lanes: Any, g: Any, motion: Any, beta: Any) -> Any:
    return types.none(*_WHERE, types.float64), _go_on(True)


@intrinsic  # type: ignore[untyped-decorator]
def _go_on_smooth(typing_context: object, rows: Any, lanes: Any, g: Any, motion: Any, beta: Any) -> Any:
    return types.none(*_WHERE, types.float64), _go_on(False)


@intrinsic  # type: ignore[untyped-decorator]
def _keep(typing_context: object, rows: Any, g: Any) -> Any:
    def build(context: Any, b: ir.IRBuilder, signature: Any, values: Any) -> ir.Value:
        four = _Builder(context, b, signature, values)
        four.over(values[1])
        for i, held in enumerate(four.get(HELD, 3)):
            four.put(BEFORE + i, held)
        return context.get_dummy_value()

    return types.none(_WHERE[0], types.int64), build


@intrinsic  # type: ignore[untyped-decorator]
def _begin(typing_context: object, rows: Any, g: Any) -> Any:
    def build(context: Any, b: ir.IRBuilder, signature: Any, values: Any) -> ir.Value:
        four = _Builder(context, b, signature, values)
        four.over(values[1])
        for i, (held, before) in enumerate(zip(four.get(HELD, 3), four.get(BEFORE, 3), strict=True)):
            four.put(DIRECTION + i, b.fsub(held, before))
        return context.get_dummy_value()

    return types.none(_WHERE[0], types.int64), build


@intrinsic  # type: ignore[untyped-decorator]
def _way(typing_context: object, rows: Any, g: Any) -> Any:
    def build(context: Any, b: ir.IRBuilder, signature: Any, values: Any) -> ir.Value:
        four = _Builder(context, b, signature, values)
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
