"""From many starts, by sequential quadratic programs with a trust region, to the nearest posture that is allowed."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.joint import Ball
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import reach
from tests.nearest_free.ball_limits import BallLimits
from tests.nearest_free.closeness import Closeness
from tests.nearest_free.gaps import Gaps
from tests.nearest_free.least_squares import giving_way, least_squares
from tests.nearest_free.tree import Placed, Posture, Tree

Array = NDArray[np.float64]

TOUCHING = 1e-6
"""Target gap [m]: above the error of a distance, and negligible next to any visible offset."""
PRICE = 20.0
"""Cost of a metre (radian) of overlap in metres squared of closeness while it lasts. Too low, and overlap is kept."""
STEP, SHORTEST, LONGEST = 0.2, 2e-6, 0.5
"""Trust region: first, least and greatest change of a degree of freedom in one step [m or rad]."""
MOST_STEPS = 80
"""Steps from one start; nearly all end earlier by a trust region that has shrunk to nothing."""
GOOD, POOR = 0.75, 0.1
"""Share of the promised gain above which the trust region grows, below which the step is taken back."""
ENOUGH = 1e-7
"""Breach [m or rad] with which a posture still counts as allowed; the judge allows ten times as much."""


@dataclass(frozen=True, eq=False)
class Found:
    """An end of the search: the posture, its figures (offset [m], angle [rad]), its score [m^2], and its largest breach."""

    posture: Posture
    offset: float
    angle: float
    score: float
    breach: float

    @property
    def allowed(self) -> bool:
        """Return whether it may be shown."""
        return self.breach <= ENOUGH


class Problem:
    """One frame: where the bodies are, where the user is, where link origins may be (low and high (L, 3) [m]).

    `arm` [m] is the weight of a radian; by default how far an average link reaches from its joint.
    """

    def __init__(
        self, scene: Scene, tree: Tree, positions: Array, orientations: Array, goal: Posture, low: Array, high: Array,
        arm: float | None = None,
    ) -> None:
        self.tree, self.low, self.high = tree, low, high
        self.gaps = Gaps(scene, tree, positions, orientations)
        reaches = [max(reach(piece) for piece in link.pieces) for link in scene.links if link.pieces]
        self.arm = float(np.mean(reaches)) if arm is None else arm
        self.closeness = Closeness(tree, tree.placed(goal), self.arm)
        joints = [(k, link.joint) for k, link in enumerate(tree.links)]
        self.balls = [(k, BallLimits(joint, tree.zero[k])) for k, joint in joints if isinstance(joint, Ball)]
        self.walls = [(k, c) for k in range(len(tree.links)) for c in range(3)]

    def breaches(self, placed: Placed) -> Array:
        """By how much each constraint is broken [m or rad]; 0 and less where it holds."""
        found = [TOUCHING - self.gaps.values(placed)]
        found += [-ball.margins(placed.relative[k]) for k, ball in self.balls]
        return np.concatenate([*found, (self.low - placed.positions).ravel(), (placed.positions - self.high).ravel()])

    def merit(self, placed: Placed) -> float:
        """Return closeness, and the price of violated constraints."""
        return self.closeness.score(placed) + PRICE * float(np.maximum(self.breaches(placed), 0.0).sum())

    def rows(self, placed: Placed) -> tuple[Array, Array]:
        """Return constraints to first order: rows (m, n) and the values that they must reach (m,)."""
        tree = self.tree
        gaps, rows = self.gaps.rows(placed)
        all_rows, least = [rows], [TOUCHING - gaps]
        for k, ball in self.balls:
            here, slopes = ball.rows(placed.relative[k])
            wide = np.zeros((len(here), tree.n))
            wide[:, tree.first[k] : tree.first[k + 1]] = slopes
            all_rows.append(wide)
            # a hair inside, so that rounding of a quaternion does not count as outside
            least.append(0.1 * ENOUGH - here)
        for k, c in self.walls:
            for limit, sign in ((self.low[k, c], 1.0), (self.high[k, c], -1.0)):
                if np.isfinite(limit) and sign * (placed.positions[k, c] - limit) < LONGEST:
                    all_rows.append(sign * tree.point_rates(placed, k, placed.positions[k])[c : c + 1])
                    least.append(np.array([sign * (limit - placed.positions[k, c])]))
        return np.vstack(all_rows), np.concatenate(least)

    def bounds(self, posture: Posture, trust: float) -> tuple[Array, Array]:
        """Return rows (2n, n) and the values that they must reach (2n,): the trust region, narrowed by the hinges' limits."""
        tree = self.tree
        low, high = np.full(tree.n, -trust), np.full(tree.n, trust)
        low[tree.hinge_dofs] = np.maximum(low[tree.hinge_dofs], tree.limits[:, 0] - posture.angles)
        high[tree.hinge_dofs] = np.minimum(high[tree.hinge_dofs], tree.limits[:, 1] - posture.angles)
        return np.vstack([np.eye(tree.n), -np.eye(tree.n)]), np.concatenate([low, -high])

    def found(self, posture: Posture) -> Found:
        """Return `posture` with its figures."""
        placed = self.tree.placed(posture)
        return Found(posture, *self.closeness.figures(placed), self.closeness.score(placed), float(self.breaches(placed).max()))


def step(problem: Problem, posture: Posture, placed: Placed, trust: float, rates: Array, error: Array) -> Array | None:
    """Return the best step (n,) within the trust region; breaches that it cannot mend it makes as small as it can."""
    rows, least = problem.rows(placed)
    box, reached = problem.bounds(posture, trust)
    found = least_squares(rates, error, np.vstack([box, rows]), np.concatenate([reached, least]))
    if found is None:
        found = giving_way(rates, error, np.vstack([box, rows]), np.concatenate([reached, least]), len(box))
    return found


def descend(problem: Problem, start: Posture) -> Found:
    """Return steps downhill from `start` until none is left that helps."""
    tree, trust = problem.tree, STEP
    posture = tree.clipped(start)
    placed = tree.placed(posture)
    merit = problem.merit(placed)
    for _ in range(MOST_STEPS):
        rates, error = problem.closeness.linearised(placed)
        way = step(problem, posture, placed, trust, rates, error)
        if way is None:
            break
        next_posture = tree.moved(posture, way)
        next_placed = tree.placed(next_posture)
        next_merit = problem.merit(next_placed)
        breach = float(np.maximum(problem.breaches(placed), 0.0).sum())
        promised = float(error @ error - ((rates @ way + error) ** 2).sum()) + PRICE * breach
        gained = merit - next_merit
        longest = float(np.abs(way).max(initial=0.0))
        if gained > max(POOR * promised, 0.0):
            posture, placed, merit = next_posture, next_placed, next_merit
            if gained > GOOD * promised and longest > 0.9 * trust:
                trust = min(2.0 * trust, LONGEST)
        else:
            trust = 0.3 * min(trust, longest)
        if trust < SHORTEST or longest < SHORTEST:
            break
    return mended(problem, posture)


def mended(problem: Problem, posture: Posture) -> Found:
    """Take the shortest steps back into the free region, for the micrometres that a finite price leaves."""
    tree = problem.tree
    found = problem.found(posture)
    for _ in range(6):
        if found.allowed or found.breach > 0.01:
            break
        way = step(problem, posture, tree.placed(posture), 0.02, np.eye(tree.n), np.zeros(tree.n))
        if way is None:
            break
        posture = tree.moved(posture, way)
        found = problem.found(posture)
    return found


def nearest(problem: Problem, starts: Sequence[Posture]) -> Found | None:
    """Return the best allowed end of all starts; None when no start led to one."""
    ends = [found for found in (descend(problem, start) for start in starts) if found.allowed]
    return min(ends, key=lambda found: found.score, default=None)


def scattered(tree: Tree, posture: Posture, spread: float, random: np.random.Generator) -> Posture:
    """Return `posture` with every degree of freedom moved by a normal deviate of `spread` [rad; half as much in m]."""
    way = random.normal(0.0, spread, tree.n)
    way[tree.shifts] *= 0.5
    return tree.moved(posture, way)
