"""The farthest of many points in a direction, eight at a time if they are many.

Most of the time of a query between hulls goes into this scan. The compiler does not vectorise a search for the largest of
something and where it is, so its vector code is written out here; the Python below says what it computes.
"""

from typing import Any

import numba
from llvmlite import ir
from numba.extending import intrinsic, overload

from avatarsim.spatial.vec3 import Rows, Vec3, dot, row

types: Any = numba.types

LANES = 8
"""Points at a time. More: another kind of processor, and more to fold in the end."""

MANY = 16
"""Points from which eight at a time are quicker than one after the other; not below LANES."""

_REAL, _WHOLE = ir.DoubleType(), ir.IntType(64)
_REALS, _WHOLES = ir.VectorType(_REAL, LANES), ir.VectorType(_WHOLE, LANES)
_NONE = 2**63 - 1


def farthest(vertices: Rows, first: int, last: int, d: Vec3) -> int:
    """The row among first .. last - 1 whose product with d is largest; of equal ones the lowest.

    Every row is tried; below some hundred vertices that beats walking along the edges of a hull. The products are those of
    `dot`, bit for bit. Where none is a number: the first row.
    """
    best, found = dot(row(vertices, first), d), first
    for i in range(first + 1, last):
        t = dot(row(vertices, i), d)
        if t > best:
            best, found = t, i
    return found


def _splat(b: ir.IRBuilder, value: ir.Value) -> ir.Value:
    """The same number in all lanes."""
    one = b.insert_element(ir.Constant(ir.VectorType(value.type, LANES), ir.Undefined), value, ir.Constant(ir.IntType(32), 0))
    return _lanes(b, one, one, [0] * LANES)


def _lanes(b: ir.IRBuilder, p: ir.Value, q: ir.Value, which: list[int]) -> ir.Value:
    """Lanes of p, and from number LANES on of q."""
    return b.shuffle_vector(p, q, ir.Constant(ir.VectorType(ir.IntType(32), len(which)), which))


def _products(b: ir.IRBuilder, rows: ir.Value, j: ir.Value, d: list[ir.Value]) -> ir.Value:
    """x.d of rows j .. j + 7: three vectors hold their 24 coordinates, of which lane i of coordinate k is number 3 i + k."""
    parts = []
    for part in range(3):
        at = b.gep(rows, [b.add(b.mul(j, _WHOLE(3)), _WHOLE(part * LANES))])
        parts.append(b.load(b.bitcast(at, _REALS.as_pointer()), align=8))
    terms = []
    for k in range(3):
        wanted = [3 * i + k for i in range(LANES)]
        low = _lanes(b, parts[0], parts[1], [w if w < 2 * LANES else 0 for w in wanted])
        all_ = _lanes(b, low, parts[2], [i if w < 2 * LANES else w - LANES for i, w in enumerate(wanted)])
        terms.append(b.fmul(all_, d[k]))
    return b.fadd(b.fadd(terms[0], terms[1]), terms[2])


def _folded(b: ir.IRBuilder, values: ir.Value, better: Any) -> ir.Value:
    """The best of all lanes, by halves."""
    for half in (4, 2, 1):
        other = _lanes(b, values, values, [(i + half) % LANES for i in range(LANES)])
        values = b.select(better(other, values), other, values)
    return b.extract_element(values, ir.Constant(ir.IntType(32), 0))


def _written_out(module: ir.Module) -> ir.Function:
    """A function (rows, number of rows, x, y, z) -> row with the largest product. Not inlined: its calls take five registers."""
    kind = ir.FunctionType(_WHOLE, [_REAL.as_pointer(), _WHOLE, _REAL, _REAL, _REAL])
    function = ir.Function(module, kind, f"{__name__}.scan")
    function.linkage = "internal"
    function.attributes.add("noinline")
    rows, many, *direction = function.args
    entry, few, eights = (function.append_basic_block(name) for name in ("entry", "few", "eights"))
    b = ir.IRBuilder(entry)
    b.cbranch(b.icmp_signed("<", many, _WHOLE(MANY)), few, eights)
    _one_by_one(ir.IRBuilder(few), rows, many, direction)
    b = ir.IRBuilder(eights)
    loop, done, alone, several = (function.append_basic_block(name) for name in ("loop", "done", "alone", "several"))
    d = [_splat(b, value) for value in direction]
    iota = ir.Constant(_WHOLES, list(range(LANES)))
    final = b.sub(many, _WHOLE(LANES))
    at_start, start = _products(b, rows, _WHOLE(0), d), b.block
    b.cbranch(b.icmp_signed(">", final, _WHOLE(0)), loop, done)
    b.position_at_end(loop)
    j, best, where = b.phi(_WHOLE), b.phi(_REALS), b.phi(_WHOLES)
    # the last eight may have been looked at in part, which changes nothing
    full = b.icmp_signed("<", j, final)
    here = b.select(full, j, final)
    t = _products(b, rows, here, d)
    more = b.fcmp_ordered(">", t, best)
    best_after, where_after = b.select(more, t, best), b.select(more, b.add(_splat(b, here), iota), where)
    j_after = b.add(j, _WHOLE(LANES))
    b.cbranch(full, loop, done)
    _join(j, (_WHOLE(LANES), start), (j_after, loop))
    _join(best, (at_start, start), (best_after, loop))
    _join(where, (iota, start), (where_after, loop))
    b.position_at_end(done)
    best, where = b.phi(_REALS), b.phi(_WHOLES)
    _join(best, (at_start, start), (best_after, loop))
    _join(where, (iota, start), (where_after, loop))
    most = _folded(b, best, lambda p, q: b.fcmp_ordered(">", p, q))
    alike = b.fcmp_ordered("==", best, _splat(b, most))
    mask = b.bitcast(alike, ir.IntType(LANES))
    b.cbranch(b.icmp_unsigned("==", b.ctpop(mask), mask.type(1)), alone, several)
    b.position_at_end(alone)
    b.ret(b.extract_element(where, b.zext(b.cttz(mask, ir.IntType(1)(1)), ir.IntType(32))))
    b.position_at_end(several)
    lowest = _folded(b, b.select(alike, where, _splat(b, _WHOLE(_NONE))), lambda p, q: b.icmp_signed("<", p, q))
    b.ret(b.select(b.icmp_signed("==", lowest, _WHOLE(_NONE)), _WHOLE(0), lowest))
    return function


def _one_by_one(b: ir.IRBuilder, rows: ir.Value, many: ir.Value, d: list[ir.Value]) -> None:
    """The same for a few rows."""
    def product(i: ir.Value) -> ir.Value:
        at = b.mul(i, _WHOLE(3))
        terms = [b.fmul(b.load(b.gep(rows, [b.add(at, _WHOLE(k))])), d[k]) for k in range(3)]
        return b.fadd(b.fadd(terms[0], terms[1]), terms[2])

    before, at_start = b.block, product(_WHOLE(0))
    loop, done = b.append_basic_block("row"), b.append_basic_block("last_row")
    b.cbranch(b.icmp_signed(">", many, _WHOLE(1)), loop, done)
    b.position_at_end(loop)
    i, best, found = b.phi(_WHOLE), b.phi(_REAL), b.phi(_WHOLE)
    t = product(i)
    more = b.fcmp_ordered(">", t, best)
    best_after, found_after, i_after = b.select(more, t, best), b.select(more, i, found), b.add(i, _WHOLE(1))
    b.cbranch(b.icmp_signed("<", i_after, many), loop, done)
    _join(i, (_WHOLE(1), before), (i_after, loop))
    _join(best, (at_start, before), (best_after, loop))
    _join(found, (_WHOLE(0), before), (found_after, loop))
    b.position_at_end(done)
    found = b.phi(_WHOLE)
    _join(found, (_WHOLE(0), before), (found_after, loop))
    b.ret(found)


def _join(phi: Any, *edges: tuple[ir.Value, ir.Block]) -> None:
    for value, block in edges:
        phi.add_incoming(value, block)


@intrinsic  # type: ignore[untyped-decorator]  # so are all of numba's
def _scan(typing_context: object, vertices: Any, first: Any, last: Any, x: Any, y: Any, z: Any) -> Any:
    def build(context: Any, b: ir.IRBuilder, signature: Any, values: Any) -> ir.Value:
        array = context.make_array(signature.args[0])(context, b, values[0])
        first, last, *d = values[1:]
        known = b.module.globals.get(f"{__name__}.scan")
        rows = b.gep(array.data, [b.mul(first, _WHOLE(3))])
        return b.add(first, b.call(known or _written_out(b.module), [rows, b.sub(last, first), *d]))

    whole, real = types.int64, types.float64
    return whole(vertices, whole, whole, real, real, real), build


@overload(farthest)  # type: ignore[untyped-decorator]
def _compiled(vertices: Any, first: Any, last: Any, d: Any) -> Any:
    if vertices.layout != "C" or vertices.dtype != types.float64:
        return None  # numba then says that there is no such function

    def body(vertices: Any, first: Any, last: Any, d: Any) -> Any:
        return _scan(vertices, first, last, d[0], d[1], d[2])

    return body
