"""Gait of two legs under a root that moves: stance and swing of a fixed period (Bruderlin and Calvert 1989), legs by `pull`.

A leg is solved as a triangle: the knee by the law of cosines, the hip by aiming, so that a straight leg is no singularity.
Stride length and speed are those of dynamic similarity (Alexander 1976): stride / leg = 2.3 Froude^0.3, speed^2 = Froude g leg.
"""

from math import atan2, exp, hypot, pi, sin, sqrt

import numpy as np

from avatarsim.live.drive.ease import minimum_jerk, shortened
from avatarsim.live.drive.limbs import Limb
from avatarsim.live.drive.pull import Goal, Pull, bend_about, exterior_angle, turn_about
from avatarsim.live.drive.tree import Array, Poses, Posture, Tree
from avatarsim.spatial.rotation import IDENTITY, conjugate, from_axis_angle, multiply, rotate

UP = (0.0, 0.0, 1.0)
"""Up in the world."""

GRAVITY = 9.81
"""[m/s^2] Gravity, by which the speed of a walk is scaled."""

FROUDE = 0.1
"""Froude number of the walk: a stroll. Walks end at 0.5; from 0.25 on, feet that stay flat, as here, do not reach."""

STANCE = 0.6
"""Share of a period for which a foot is on the ground."""

LIFT = 0.08
"""Height of a swinging foot, as a share of the leg: clears a door-sill."""

DEEPEST = 0.45
"""Depth of a crouch at the root, as a share of the leg. More: knees meet the chest."""

FOLLOW = 0.12
"""[s] Time constant with which strides follow the root's speed. Shorter: feet jerk when the root starts; longer: feet slide."""

HEEL = 0.2
"""Share of a toe's error, for lack of ankle range, by which its heel moves in a frame. More: heels tremble."""

HIGHEST_HEEL = 0.2
"""Largest displacement of a heel due to that, as a share of the leg: a toe out of reach stays so."""

FASTEST_WALK = 1.5
"""Largest speed of strides, in multiples of the walk's own; legs of a faster root slide. More: feet do not reach."""

AT_REST = 1e-3
"""[m/s] Speed below which strides have ended."""


class Gait:
    """Legs of an avatar, and the phase of their stride."""

    def __init__(self, tree: Tree, legs: tuple[Limb, ...], start: Posture, lever: float) -> None:
        self._tree, self._legs = tree, legs
        self._own = {k for leg in legs for k in leg.links}
        self._bent = [_knee_and_ankle(tree, leg) for leg in legs]
        self.leg = sum(hypot(*tree.nodes[k].anchor) for k in self._bent[0])
        # the knee sets the length of the leg, joints above it aim, and joints below it turn the foot
        every = frozenset(range(len(tree.nodes)))
        self._aim, self._turn = [], []
        for leg, (knee, ankle) in zip(legs, self._bent, strict=True):
            above = frozenset(leg.links[: leg.links.index(knee)])
            self._aim.append(Pull(tree, (ankle,), lever, every - above))
            self._turn.append(Pull(tree, (leg.tip,), lever, every - frozenset(leg.links) | above | {knee}))
        self._tips = [leg.tip for leg in legs]
        back, (places, turns), root = conjugate(self.forward(start)), tree.poses(start), start.roots[0]
        self._home = rotate(back, places[self._tips] - root)
        self._heel = rotate(back, places[[ankle for _, ankle in self._bent]] - places[self._tips])
        self._heels = np.zeros((len(legs), 3))
        self._turned = multiply(back, turns[self._tips])
        self._floor = float(places[self._tips, 2].min())
        self._stand = float(root[2]) - self._floor
        self.speed = sqrt(FROUDE * GRAVITY * self.leg)
        self.period = 2.3 * FROUDE**0.3 * self.leg / self.speed
        self._phase = self._drop = self._spin = 0.0
        self._way: tuple[float, float] = (0.0, 0.0)
        self.is_on = False

    def is_leg(self, link: int) -> bool:
        """Return True if a link is part of a leg."""
        return link in self._own

    @property
    def is_stepping(self) -> bool:
        """Return True if a stride has not yet ended."""
        return self.is_on and max(hypot(*self._way), abs(self._spin) * self.leg) > AT_REST

    def begin(self, posture: Posture, finds_floor: bool) -> None:
        """Start with the legs as they are; `finds_floor`: set the ground to the height of the lower foot."""
        if self.is_on:
            return
        self.is_on, self._phase, self._drop, self._way, self._spin = True, 0.0, 0.0, (0.0, 0.0), 0.0
        self._heels[:] = 0.0
        if finds_floor:
            self._floor = float(self._tree.poses(posture)[0][self._tips, 2].min())

    def end(self) -> None:
        """Release the legs to another source."""
        self.is_on = False

    def heights(self) -> tuple[float, float]:
        """Return the lowest and highest place [m] of the root on this ground."""
        return self._floor + self._stand - DEEPEST * self.leg, self._floor + self._stand

    def height(self, posture: Posture) -> float:
        """Return the height of the root without the dip of a stride [m]."""
        return float(posture.roots[0, 2]) + self._drop

    def forward(self, posture: Posture) -> Array:
        """Return the turn about the vertical from x to the facing direction of the body."""
        places, _ = self._tree.poses(posture)
        x, y, _ = places[self._legs[0].links[0]] - places[self._legs[1].links[0]]
        # left is a quarter turn from forward
        return from_axis_angle(UP, atan2(-x, y))

    def advance(self, posture: Posture, velocity: tuple[float, float], spin: float, dt: float, most: float) -> None:
        """Move the legs under a root that is at its new place and moves at `velocity` (x, y) [m/s] and `spin` [rad/s]; no joint
        turns by more than `most` [rad]."""
        follow = 1.0 - exp(-dt / FOLLOW)
        vx, vy = self._way
        share = min(1.0, FASTEST_WALK * self.speed / max(hypot(*velocity), 1e-9))
        self._way = vx + follow * (share * velocity[0] - vx), vy + follow * (share * velocity[1] - vy)
        self._spin += follow * (spin - self._spin)
        self._phase = (self._phase + dt / self.period) % 1.0 if self.is_stepping else 0.0
        x, y, z = posture.roots[0].tolist()
        height, reach = z + self._drop, 0.5 * hypot(*self._way) * self.period * STANCE
        self._drop = self.leg - sqrt(max(self.leg**2 - reach**2, (0.5 * self.leg) ** 2))
        # a root above standing height raises the ground with it, one below the deepest crouch lowers it
        ground = min(max(self._floor, height - self._stand), height - self._stand + DEEPEST * self.leg)
        posture.roots[0] = (x, y, height - self._drop)
        facing = self.forward(posture)
        for number, tip in enumerate(self._tips):
            place = self._foot(number, np.array((x, y, ground + self._stand)), facing)
            self._turn[number].solve(posture, [Goal(tip, None, multiply(facing, self._turned[number]))], most)
            poses = self._tree.poses(posture)
            heel = self._heels[number] + HEEL * (place - poses[0][tip])
            heel[2] = max(0.0, heel[2])
            self._heels[number] = shortened(heel, HIGHEST_HEEL * self.leg)
            self._stand_on(number, posture, poses, place + self._heels[number], facing, most)

    def _foot(self, number: int, root: Array, facing: Array) -> Array:
        """Return the target place of a foot [m], under a root at standing height."""
        home = rotate(facing, self._home[number])
        ux, uy = self._way[0] - self._spin * home[1], self._way[1] + self._spin * home[0]
        share = (self._phase + 0.25 + 0.5 * number) % 1.0
        along, lift = 0.5 - share / STANCE, 0.0
        if share >= STANCE:
            swung = (share - STANCE) / (1.0 - STANCE)
            along = minimum_jerk(swung) - 0.5
            lift = LIFT * self.leg * sin(pi * swung) ** 2 * min(1.0, hypot(ux, uy) / (0.5 * self.speed))
        stride = self.period * STANCE * along
        return root + home + (ux * stride, uy * stride, lift)

    def _stand_on(self, number: int, posture: Posture, poses: Poses, toe: Array, facing: Array, most: float) -> None:
        """Move the ankle of a leg by knee and hip to where a level foot with its tip at `toe` [m] has it."""
        (knee, ankle), leg = self._bent[number], self._legs[number]
        goal = toe + rotate(facing, self._heel[number])
        hip, middle, low = poses[0][[leg.links[0], knee, ankle]]
        thigh, shank, left = middle - hip, low - middle, rotate(facing, (0.0, 1.0, 0.0))
        a, b, d = hypot(*thigh), hypot(*shank), hypot(*(goal - hip))
        bent = bend_about(left, thigh, shank)
        wanted = exterior_angle(a, b, d)
        turn_about(self._tree, posture, knee, left, min(max(wanted - bent, -most), most), poses)
        self._aim[number].solve(posture, [Goal(ankle, goal)], most)


def _knee_and_ankle(tree: Tree, leg: Limb) -> tuple[int, int]:
    """Return the links at the lower ends of the two longest bones."""
    longest = sorted(leg.links[1:], key=lambda k: -hypot(*tree.nodes[k].anchor))[:2]
    knee, ankle = sorted(longest)
    return knee, ankle


def yaw_of_x(turn: Array) -> Array:
    """Return the turn about the vertical to the direction of a frame's x axis; identity if that is upright."""
    x, y, _ = rotate(turn, (1.0, 0.0, 0.0))
    return from_axis_angle(UP, atan2(y, x)) if hypot(x, y) > 0.1 else np.array(IDENTITY)
