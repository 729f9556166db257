"""Strictly convex QP of a step: min 1/2 |x - p|_M^2 such that J x >= bound, low <= x <= high.

With M = L^T L and y = L x it is a least-distance problem, min 1/2 |y - L p|^2 such that (J L^-1) y >= bound (Lawson and Hanson
1974, chapter 23), solved in the dual by projected Gauss-Seidel without a Gram matrix; rows that are nearly the same, as the
corners of a foot on a floor are, make that slow, and then an active-set method on the Gram matrix of the active rows ends it.
Bounds join as unit rows only when they are violated, since most of them never are.

Active set of a least-distance problem: non-negative least squares on the Gram matrix of the active rows (Lawson and Hanson
1974, chapter 23), from where projected Gauss-Seidel has come.

Sweeps find at once which of few rows press. Where several nearly coincide, as those of the corners of a foot on the floor do,
they come no nearer for dozens of sweeps; a step that breaks its rows is then refused, and the limb is shown behind.
"""

from math import sqrt

from avatarsim.ik.constraints import along_row, clear_row
from avatarsim.ik.motion_budget import keep_budget
from avatarsim.ik.objective import solve_down, solve_up
from avatarsim.ik.state import MOST_PRESSED, PRODUCTS, SWEEPS, Avatars, ConstraintRows, IkScratch, IkState, Rig, RowKind
from avatarsim.jit.kernel import kernel
from avatarsim.model.couplings import follow_leaders
from avatarsim.model.skeleton import FREE
from avatarsim.tolerances import JUDGED, NOTHING, REGULAR

CHANGES = 24
"""Rows that come or go at most; the result is then as good as of more sweeps. Fewer: more answers come of sweeps alone, which
break rows; more: steps in crowds take longer."""

MET = 1e-3
"""Share of the sweeps' tolerance by which a condition may stay broken. Larger: the certificate sees it; smaller: rounding makes
rows come and go."""


@kernel
def finish(tolerance: float, rows_out: ConstraintRows) -> bool:
    """Solve for the multipliers from the present ones; if the active set is not found they are left as they were."""
    r = rows_out
    for k in range(r.used[0]):
        r.before[k] = r.multiplier[k]
    if find_active(tolerance, r):
        return True
    for k in range(r.used[0]):
        r.multiplier[k] = r.before[k]
    return False


@kernel
def find_active(tolerance: float, rows_out: ConstraintRows) -> bool:
    """Solve for the active set; if it is not found, multipliers and residuals are arbitrary."""
    r, size, done = rows_out, 0, 0
    for k in range(r.used[0]):
        if r.least[k] < r.multiplier[k] < r.most[k]:
            if size == r.active.shape[0]:
                return False
            r.active[size] = k
            size += 1
    for _ in range(CHANGES):
        if not extend(done, size, r):
            return False
        solve_change(size, r)
        share, first, end = 1.0, -1, 0.0
        for i in range(size):
            k = r.active[i]
            here, change = r.multiplier[k], r.change[i]
            if not (here + change < MOST_PRESSED):
                return False
            reached = min(max(r.least[k], here + share * change), r.most[k])
            if reached != here + share * change:
                share, first, end = (reached - here) / change, i, reached
        change_multipliers(size, share, r)
        done = size
        if first >= 0:
            r.multiplier[r.active[first]] = end
            size -= 1
            for i in range(first, size):
                r.active[i] = r.active[i + 1]
            done = first
            continue
        worst, found = -MET * tolerance, -1
        for k in range(r.used[0]):
            if r.multiplier[k] <= r.least[k] and r.residual[k] < worst:
                worst, found = r.residual[k], k
            if r.multiplier[k] >= r.most[k] and -r.residual[k] < worst:
                worst, found = -r.residual[k], k
        if found < 0:
            return True
        if size == r.active.shape[0]:
            return False
        r.active[size] = found
        size += 1
    return False


@kernel
def change_multipliers(size: int, share: float, rows_out: ConstraintRows) -> None:
    """Apply a share of the change, and bring the residuals of all rows up to date."""
    r = rows_out
    for i in range(size):
        k, step = r.active[i], share * r.change[i]
        r.multiplier[k] = min(max(r.least[k], r.multiplier[k] + step), r.most[k])
        for q in range(r.used[0]):
            r.residual[q] += r.gram[k, q] * step


@kernel
def extend(done: int, size: int, rows_out: ConstraintRows) -> bool:
    """Extend Cholesky's factor of the active rows' Gram matrix from row `done` on, its diagonal inverted; False without one."""
    f = rows_out.factor
    for i in range(done, size):
        k = rows_out.active[i]
        rest = rows_out.gram[k, k] * (1.0 + REGULAR)
        for j in range(i):
            t = rows_out.gram[k, rows_out.active[j]]
            for e in range(j):
                t -= f[i, e] * f[j, e]
            t *= f[j, j]
            f[i, j] = t
            rest -= t * t
        if not (rest > 0.0):
            return False
        f[i, i] = 1.0 / sqrt(rest)
    return True


@kernel
def solve_change(size: int, rows_out: ConstraintRows) -> None:
    """Solve for the change of the active multipliers that takes their residuals to zero."""
    f, change = rows_out.factor, rows_out.change
    for i in range(size):
        t = -rows_out.residual[rows_out.active[i]]
        for e in range(i):
            t -= f[i, e] * change[e]
        change[i] = t * f[i, i]
    for i in range(size - 1, -1, -1):
        t = change[i] * f[i, i]
        change[i] = t
        for e in range(i):
            change[e] -= f[i, e] * t


BOUND, BUDGET = int(RowKind.BOUND), int(RowKind.BUDGET)

FIRST_SWEEPS, SWEEPS_MOST = 4, 15
"""Sweeps after which the active set is solved for, and after which the answer is taken where that does not succeed. Fewer:
more solves, or answers that break rows; more: time."""

SOFTNESS = JUDGED
"""Added to the diagonal of the dual: parallel rows then share the load instead of dividing by zero."""

CUTS = 4
"""Rounds in which the conditions that an answer breaks join as rows, and it is solved for again (cutting planes: Kelley 1960):
bounds and budgets within a QP, where a step that is still outside is then clipped; pairs and limits at a trial; and QPs in such a
round. 8: the slowest frames take 2.5 times as long."""

BOUNDS_PER_ROUND = 8
"""Violated bounds of an avatar that join in a round. More: rows that press nothing; fewer: more rounds."""


@kernel
def solve_qp(rig: Rig, first: int, last: int, tolerance: float, state: IkState, scratch_out: IkScratch) -> None:
    """Solve for the step of members first .. last by the model of each, the rows, and the bounds; `tolerance` [m] ends sweeps."""
    avatars = rig.avatars
    s = scratch_out
    for m in range(first, last):
        for j in range(avatars.first_dof[s.members[m]], avatars.first_dof[s.members[m] + 1]):
            s.step[j] = s.objective.newton[j]
    add_broken_bounds(rig, first, last, state, s)
    for _ in range(CUTS):
        solve_dual(avatars, first, last, tolerance, s)
        if add_broken_bounds(rig, first, last, state, s) == 0:
            break
    for m in range(first, last):
        for j in range(avatars.first_dof[s.members[m]], avatars.first_dof[s.members[m] + 1]):
            s.step[j] = min(max(s.step[j], s.low[j]), s.high[j])
        keep_budget(rig, s.members[m], state.budget, True, s.step)
        follow_leaders(rig.skel, avatars.first_dof[s.members[m]], avatars.first_dof[s.members[m] + 1], s.step)


@kernel
def solve_dual(avatars: Avatars, first: int, last: int, tolerance: float, scratch_out: IkScratch) -> None:
    """Solve for the step of members first .. last by the model of each and the present rows; `tolerance` [m] ends the sweeps."""
    s, r = scratch_out, scratch_out.rows
    transform(avatars, s)
    find_residuals(avatars, s)
    before = s.counts[SWEEPS]
    s.counts[SWEEPS] += sweep(r, FIRST_SWEEPS, tolerance)
    if not r.is_solved[0] and not finish(tolerance, r):
        find_residuals(avatars, s)
        s.counts[SWEEPS] += sweep(r, SWEEPS_MOST - FIRST_SWEEPS, tolerance)
    s.counts[PRODUCTS] += (s.counts[SWEEPS] - before) * r.used[0] // 2
    assemble(avatars, first, last, s)


@kernel
def transform(avatars: Avatars, scratch_out: IkScratch) -> None:
    """Transform the rows that came since this was last done, weighted = L^-T J^T, and extend the Gram matrix by them."""
    s, r = scratch_out, scratch_out.rows
    for k in range(r.ready[0], r.used[0]):
        for side in range(2):
            avatar = r.owner[k, side]
            if avatar >= 0:
                low, high = avatars.first_dof[avatar], avatars.first_dof[avatar + 1]
                for j in range(low, high):
                    r.weighted[k, j] = r.jacobian[k, j]
                solve_up(avatars, low, high, s.objective.factor, r.weighted[k])
        s.counts[PRODUCTS] += k + 3
        for q in range(k + 1):
            r.gram[k, q] = r.gram[q, k] = product_of(avatars, k, q, r)
    r.ready[0] = r.used[0]


@kernel
def product_of(avatars: Avatars, k: int, q: int, rows: ConstraintRows) -> float:
    """Return weighted[k] . weighted[q], over the degrees of avatars that both rows are of."""
    total = 0.0
    for side in range(2):
        avatar = rows.owner[k, side]
        if avatar >= 0 and (rows.owner[q, 0] == avatar or rows.owner[q, 1] == avatar):
            for j in range(avatars.first_dof[avatar], avatars.first_dof[avatar + 1]):
                total += rows.weighted[k, j] * rows.weighted[q, j]
    return total


@kernel
def find_residuals(avatars: Avatars, scratch_out: IkScratch) -> None:
    """Compute the residuals: of row k J_k x - bound_k with x = p + M^-1 J^T multipliers."""
    r = scratch_out.rows
    scratch_out.counts[PRODUCTS] += 2 * r.used[0]
    for k in range(r.used[0]):
        total = along_row(avatars, k, scratch_out.objective.newton, r.jacobian, r) - r.bound[k]
        for q in range(r.used[0]):
            total += r.gram[k, q] * r.multiplier[q]
        r.residual[k] = total


@kernel
def sweep(rows_out: ConstraintRows, most: int, tolerance: float) -> int:
    """Run projected Gauss-Seidel on the multipliers until a sweep changes no row by `tolerance` [m]; return the sweeps."""
    r, gram, multiplier, residual = rows_out, rows_out.gram, rows_out.multiplier, rows_out.residual
    r.is_solved[0] = False
    for done in range(most):
        change = 0.0
        for k in range(r.used[0]):
            before = multiplier[k]
            if before == r.least[k] and residual[k] >= 0.0:
                continue
            after = min(max(r.least[k], before - residual[k] / (gram[k, k] + SOFTNESS)), r.most[k])
            step = after - before
            if step != 0.0:
                multiplier[k] = after
                change = max(change, abs(step) * gram[k, k])
                for q in range(r.used[0]):
                    residual[q] += gram[k, q] * step
        if change < tolerance:
            r.is_solved[0] = True
            return done + 1
    return most


@kernel
def assemble(avatars: Avatars, first: int, last: int, scratch_out: IkScratch) -> None:
    """Compute x = p + L^-1 (sum of weighted rows times their multipliers)."""
    s, r, step = scratch_out, scratch_out.rows, scratch_out.step
    for m in range(first, last):
        for j in range(avatars.first_dof[s.members[m]], avatars.first_dof[s.members[m] + 1]):
            step[j] = 0.0
    for k in range(r.used[0]):
        push = r.multiplier[k]
        for side in range(2 if push != 0.0 else 0):
            avatar = r.owner[k, side]
            if avatar >= 0:
                for j in range(avatars.first_dof[avatar], avatars.first_dof[avatar + 1]):
                    step[j] += push * r.weighted[k, j]
    for m in range(first, last):
        low, high = avatars.first_dof[s.members[m]], avatars.first_dof[s.members[m] + 1]
        solve_down(avatars, low, high, s.objective.factor, step)
        for j in range(low, high):
            step[j] += s.objective.newton[j]


@kernel
def add_broken_bounds(rig: Rig, first: int, last: int, state: IkState, scratch_out: IkScratch) -> int:
    """Add rows for bounds and budgets that the step breaks; return their number."""
    skel, avatars = rig.skel, rig.avatars
    s, r, b, added = scratch_out, scratch_out.rows, state.budget, 0
    for m in range(first, last):
        avatar, more = s.members[m], 0
        for j in range(avatars.first_dof[avatar], avatars.first_dof[avatar + 1]):
            if r.used[0] == r.bound.shape[0] or more == BOUNDS_PER_ROUND:
                break
            is_below, is_above = s.step[j] < s.low[j] - NOTHING, s.step[j] > s.high[j] + NOTHING
            sign = 1.0 if is_below else -1.0
            if (is_below or is_above) and not has_bound(r, j, sign):
                add_bound(avatars, avatar, j, sign, s.low[j] if is_below else -s.high[j], r)
                more += 1
        added += more
        for link in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
            d, end = skel.first_dof[link], skel.first_dof[link + 1]
            if skel.kind[link] == FREE:
                added += add_budget(avatars, avatar, d, d + 3, b.move[link] - b.moved[link], b.slack[0], s)
                d += 3
            if end > d + 1:
                added += add_budget(avatars, avatar, d, end, b.turn[link] - b.turned[link], b.slack[1], s)
    return added


@kernel
def add_budget(avatars: Avatars, avatar: int, first: int, last: int, left: float, slack: float, scratch_out: IkScratch) -> int:
    """Add a cutting plane where degrees first .. last go farther together than the rest of their budget, along their
    direction."""
    s, r, square, left = scratch_out, scratch_out.rows, 0.0, max(left, 0.0)
    for j in range(first, last):
        square += s.step[j] * s.step[j]
    far, k = sqrt(square), r.used[0]
    if not (far > left + slack + NOTHING) or k == r.bound.shape[0]:
        return 0
    r.owner[k, 0], r.owner[k, 1] = avatar, -1
    clear_row(avatars, k, r)
    for j in range(first, last):
        r.jacobian[k, j] = -s.step[j] / far
    r.kind[k], r.pair[k, 0], r.pair[k, 1], r.bound[k], r.multiplier[k] = BUDGET, first, -1, -left, 0.0
    r.least[k], r.most[k] = 0.0, MOST_PRESSED
    r.used[0] = k + 1
    return 1


@kernel
def has_bound(rows: ConstraintRows, j: int, sign: float) -> bool:
    """Return True if one of the rows is the lower (sign 1) or upper (-1) bound of degree j."""
    for k in range(rows.used[0]):
        if rows.kind[k] == BOUND and rows.pair[k, 0] == j and rows.jacobian[k, j] == sign:
            return True
    return False


@kernel
def add_bound(avatars: Avatars, avatar: int, j: int, sign: float, bound: float, rows_out: ConstraintRows) -> None:
    """Append the condition sign x_j >= bound."""
    r, k = rows_out, rows_out.used[0]
    r.owner[k, 0], r.owner[k, 1] = avatar, -1
    clear_row(avatars, k, r)
    r.jacobian[k, j] = sign
    r.kind[k], r.pair[k, 0], r.pair[k, 1], r.bound[k], r.multiplier[k] = BOUND, j, -1, bound, 0.0
    r.least[k], r.most[k] = 0.0, MOST_PRESSED
    r.used[0] = k + 1
