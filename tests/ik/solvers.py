"""The solver's arrays for a small world, and postures of it, for the tests of `ik`."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from avatarsim.ik.kinematics import carry_avatar, place_avatar, take_step, tangent_error
from avatarsim.ik.make import make_solver
from avatarsim.ik.state import Avatars, IkScratch, IkState, Rig
from avatarsim.model.skeleton import FREE, SLIDE, Posture
from avatarsim.model.world import World, build, posture_of
from avatarsim.scene.scene import Scene
from tests.worlds.little_worlds import hand, random_sample, sliding_avatar

Array = NDArray[np.float64]

TREES = Scene("trees", (), (sliding_avatar(), hand(), sliding_avatar("n")))
"""Three trees with every kind of joint and shape; the second is a root alone."""


@dataclass(frozen=True)
class Solver:
    """A world with the solver's state of it."""

    world: World
    avatars: Avatars
    state: IkState
    working: IkScratch

    @property
    def count(self) -> int:
        """Return the number of avatars."""
        return len(self.avatars.first_link) - 1

    @property
    def rig(self) -> Rig:
        """Return the world as its avatars have it."""
        return Rig(self.world.geometry, self.world.skeleton, self.avatars)

    def take(self, posture: Posture) -> None:
        """Show the avatars at a posture."""
        for mine, other in zip(self.world.posture, posture, strict=True):
            mine[:] = other
        self.stand()

    def stand(self) -> None:
        """Poses and axes of the posture, at the trial too."""
        posture, poses, still = self.world.posture, self.world.poses, np.zeros(int(self.world.skeleton.first_dof[-1]))
        for there, axes in ((poses, self.state.axes), (self.working.trial, self.working.axes)):
            for avatar in range(self.count):
                carry_avatar(self.rig, avatar, posture, still, there, axes)
                place_avatar(self.rig, avatar, there)

    def after(self, step: Array) -> Posture:
        """Return the posture that a step (nd) leads to."""
        found = copied(self.world.posture)
        for avatar in range(self.count):
            take_step(self.rig, avatar, step, found)
        return found

    def follow(self, target: Posture) -> None:
        """Make a posture the tracker's, and note how far it is."""
        for mine in (self.state.tracker_before, self.working.target):
            for array, other in zip(mine, target, strict=True):
                array[:] = other
        self.state.tracking.is_located[:] = 0
        for avatar in range(self.count):
            tangent_error(self.rig, avatar, self.world.posture, target, self.working.objective.error)

    def solve_for_all(self) -> None:
        """Make all avatars one island, with budgets that hold nothing back."""
        self.working.members[:], self.working.is_active[:] = np.arange(self.count), 1
        self.state.budget.turn[:], self.state.budget.move[:] = 1e9, 1e9
        self.working.low[:], self.working.high[:] = -1e9, 1e9


def solver_of(scene: Scene) -> Solver:
    """Return the arrays of a scene at its first posture."""
    world = build(scene)
    made = make_solver(world.geometry, world.skeleton, world.posture, world.poses, 0, world.link_friction())
    found = Solver(world, *made)
    found.stand()
    return found


def copied(posture: Posture) -> Posture:
    """Return a posture of its own."""
    return Posture(*(array.copy() for array in posture))


def random_posture(found: Solver, seed: int) -> Posture:
    """Return a posture anywhere, its hinges so far within their limits that small steps both ways are taken whole."""
    skel = found.world.skeleton
    posture = posture_of(skel, found.world.hinges, random_sample(found.world.scene.avatars, seed))
    posture.angle[:] = np.clip(posture.angle, skel.limits[:, 0] + 0.2, skel.limits[:, 1] - 0.2)
    return posture


def apart(seed: int, by: float, scene: Scene = TREES) -> Solver:
    """Return a solver at a random posture whose target is a random step of spread `by` away."""
    found = solver_of(scene)
    found.take(random_posture(found, seed))
    nd = int(found.world.skeleton.first_dof[-1])
    found.follow(found.after(np.random.default_rng(seed + 50).normal(0.0, by, nd)))
    return found


def metric_of(found: Solver) -> Array:
    """Return M (nd, nd) as its factor has it."""
    factor, path, depth = found.working.objective.factor, found.avatars.path, found.avatars.depth
    lower = np.zeros((len(depth), len(depth)))
    for j, deep in enumerate(depth):
        lower[j, path[j, : deep + 1]] = factor[j, : deep + 1]
    return lower.T @ lower


def point_rates(found: Solver, link: int, arm: Array) -> Array:
    """Return the motion of a point (3) at `arm` from a link's origin with every degree of freedom (3, nd), written densely."""
    skel, poses, axes = found.world.skeleton, found.world.poses, found.state.axes
    rates = np.zeros((3, len(axes)))
    point = poses.position[skel.first + link] + arm
    for j, m in enumerate(found.avatars.joint_of):
        if skel.related[link, m]:
            shifts = skel.kind[m] == SLIDE or (skel.kind[m] == FREE and j < skel.first_dof[m] + 3)
            rates[:, j] = axes[j] if shifts else np.cross(axes[j], point - poses.position[skel.first + m])
    return rates
