"""Vector code over four contacts of balls at once, piece by piece: what `impact.visit_fours` says in Python."""

from collections.abc import Sequence
from typing import Any

from llvmlite import ir

from avatarsim.impact.contacts import LANE, MOTION, ROW
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
)
from avatarsim.impact.solver_rows import LANES

_REAL, _WHOLE, _LANE = ir.DoubleType(), ir.IntType(64), ir.IntType(32)
_FOUR = ir.VectorType(_REAL, LANES)


class Builder:
    """What one four has and gets, as values of LLVM."""

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


def visiting(rough: bool) -> Any:
    """What writes the code of `visit_fours.visit_four`."""
    def build(context: Any, b: ir.IRBuilder, signature: Any, values: Any) -> ir.Value:
        four = Builder(context, b, signature, values)
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


def going_on(rough: bool) -> Any:
    """What writes the code of `visit_fours.go_on_four`."""
    def build(context: Any, b: ir.IRBuilder, signature: Any, values: Any) -> ir.Value:
        four = Builder(context, b, signature, values)
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
