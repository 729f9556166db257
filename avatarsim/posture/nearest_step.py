"""The step nearest to the wanted one that obeys linear conditions: min (x - e)^T W (x - e) / 2 with J x >= c, lo <= x <= hi.

Dual coordinate ascent on the Gram matrix J W^-1 J^T, and where that is slow the rows that press are solved for
together (`active_set.py`). Bounds join as unit rows only when they are violated, since most of them never are.
"""

from avatarsim.kernel import kernel
from avatarsim.posture.active_set import settle
from avatarsim.posture.closeness import solve_down, solve_up
from avatarsim.posture.workspace import BOUND, BUILT, COUNT, COUPLED, Goal, Rows
from avatarsim.world.geometry import Array, Index

SOFTNESS = 1e-6
"""Added to the diagonal of the Gram matrix: parallel rows then share the load instead of dividing by zero."""

MULTIPLIER_CAP = 1e4
"""Infeasible rows (squeezed between two walls) would drive multipliers to infinity; the certificate refuses such steps anyway."""

FIRST_SWEEPS = 4
"""Sweeps after which rows that still change are solved for together (`active_set.py`)."""

BOUND_ROUNDS = 4
"""Rounds in which violated bounds join. What is still outside after them is clipped."""

BOUNDS_PER_ROUND = 8
"""More at once, and rows that would never bind slow the ascent down."""

OUTSIDE = 1e-9
"""[rad or m] a bound is violated beyond this; smaller excess is clipped away at the end."""


@kernel
def nearest_step(goal: Goal, rows_out: Rows, sweeps: int, tolerance: float) -> int:
    """Solve for rows_out.x; violated bounds join the rows. Return the sweeps used; `tolerance` [m] ends the ascent."""
    r, nd, used, count = rows_out, goal.step.shape[0], 0, rows_out.size[COUNT]
    coupled = goal.closeness.mode[COUPLED] > 0.0
    if coupled:
        # a step that is not along each joint's own way breaks limits of hinges of itself
        count += add_broken_bounds(goal.low, goal.high, goal.step, r, count)
    for _ in range(BOUND_ROUNDS):
        build_gram(goal, r, count)
        look(goal.step, r, count)
        first = min(sweeps, FIRST_SWEEPS)
        done = ascend(r, count, first, tolerance)
        used += done
        if done > first and not settle(r, count, tolerance):
            look(goal.step, r, count)
            used += ascend(r, count, sweeps - first, tolerance)
        assemble(goal, r, count)
        added = add_broken_bounds(goal.low, goal.high, r.x, r, count) if count > 0 or coupled else 0
        count += added
        if added == 0:
            break
    for j in range(nd):
        r.x[j] = min(max(r.x[j], goal.low[j]), goal.high[j])
    r.size[COUNT] = count
    return used


@kernel
def add_broken_bounds(low: Array, high: Array, x: Array, rows_out: Rows, count: int) -> int:
    """Rows from `count` on for bounds that a step (nd) breaks and that have none yet; returns their number."""
    added = 0
    for j in range(x.shape[0]):
        if count + added == rows_out.bound.shape[0] or added == BOUNDS_PER_ROUND:
            break
        below, above = x[j] < low[j] - OUTSIDE, x[j] > high[j] + OUTSIDE
        if (below or above) and not has_bound(rows_out.pair, count + added, j):
            add_bound(rows_out, count + added, j, 1.0 if below else -1.0, low[j] if below else -high[j])
            added += 1
    return added


@kernel
def assemble(goal: Goal, rows_out: Rows, count: int) -> None:
    """x = e + W^-1 J^T multipliers."""
    x, weighted, multiplier, step, pushed = rows_out.x, rows_out.weighted, rows_out.multiplier, goal.step, False
    nd = step.shape[0]
    for j in range(nd):
        x[j] = 0.0
    for k in range(count):
        push = multiplier[k]
        if push > 0.0:
            pushed = True
            for j in range(nd):
                x[j] += weighted[k, j] * push
    if pushed and goal.closeness.mode[COUPLED] > 0.0:
        solve_down(goal.closeness, x)
    for j in range(nd):
        x[j] += step[j]


@kernel
def has_bound(pair: Index, count: int, j: int) -> bool:
    """Whether one of the rows is the bound of degree j."""
    for q in range(count):
        if pair[q, 0] == BOUND and pair[q, 1] == j:
            return True
    return False


@kernel
def add_bound(rows_out: Rows, k: int, j: int, sign: float, bound: float) -> None:
    """Make row k the condition sign x_j >= bound."""
    for i in range(rows_out.x.shape[0]):
        rows_out.jacobian[k, i] = 0.0
    rows_out.jacobian[k, j] = sign
    rows_out.bound[k] = bound
    rows_out.multiplier[k] = 0.0
    rows_out.pair[k, 0] = BOUND
    rows_out.pair[k, 1] = j


@kernel
def build_gram(goal: Goal, rows_out: Rows, count: int) -> None:
    """Extend the Gram matrix by the rows that came since it was last built.

    Weighted rows are W^-1 J^T; where the metric is M = L^T L they are L^-T J^T, and half of the way is left to `assemble`.
    """
    r, nd, coupled = rows_out, goal.step.shape[0], goal.closeness.mode[COUPLED] > 0.0
    for k in range(r.size[BUILT], count):
        for j in range(nd):
            r.weighted[k, j] = r.jacobian[k, j] if coupled else r.jacobian[k, j] * goal.inverse_weight[j]
        if coupled:
            solve_up(goal.closeness, r.weighted[k])
        weighted, gram = r.weighted, r.gram
        other = weighted if coupled else r.jacobian
        for q in range(k + 1):
            t = 0.0
            for j in range(nd):
                t += weighted[k, j] * other[q, j]
            gram[k, q] = t
            gram[q, k] = t
    r.size[BUILT] = count


@kernel
def look(wanted: Array, rows_out: Rows, count: int) -> None:
    """The residual of row k is J_k x - c_k with x = e + W^-1 J^T multipliers."""
    jacobian, bound, gram, multiplier, residual = (
        rows_out.jacobian, rows_out.bound, rows_out.gram, rows_out.multiplier, rows_out.residual
    )
    for k in range(count):
        t = -bound[k]
        for j in range(wanted.shape[0]):
            t += jacobian[k, j] * wanted[j]
        for q in range(count):
            t += gram[k, q] * multiplier[q]
        residual[k] = t


@kernel
def ascend(rows_out: Rows, count: int, sweeps: int, tolerance: float) -> int:
    """Coordinate ascent on the multipliers, residuals kept up to date; the sweeps used, one more than given if the last one still
    changed something by `tolerance` [m]."""
    gram, multiplier, residual = rows_out.gram, rows_out.multiplier, rows_out.residual
    for sweep in range(sweeps):
        change = 0.0
        for k in range(count):
            before = multiplier[k]
            if before == 0.0 and residual[k] >= 0.0:
                continue
            stiffness = gram[k, k] + SOFTNESS
            after = min(max(0.0, before - residual[k] / stiffness), MULTIPLIER_CAP)
            step = after - before
            if step != 0.0:
                multiplier[k] = after
                change = max(change, abs(step) * gram[k, k])
                for q in range(count):
                    residual[q] += gram[k, q] * step
        if change < tolerance:
            return sweep + 1
    return sweeps + 1
