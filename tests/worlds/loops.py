"""The lower loop of method `paper` over a small world, for tests: targets in, frames passed, counts summed."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from avatarsim.model.joint_limits import cone_excess, has_cone
from avatarsim.model.skeleton import HINGES, Posture
from avatarsim.paper.algorithm_1 import follow_as_printed
from avatarsim.paper.state import make_paper_memory
from avatarsim.scene.avatar import Avatar
from avatarsim.scene.body import Body
from avatarsim.scene.tracker import rest
from avatarsim.settings import AttractionSettings, CouplingSettings, PaperSettings
from avatarsim.spatial.tangent import columns
from tests.worlds.arms import world_of

DT = 1.0 / 60.0
Place = tuple[float, float, float]


class Loop:
    """A world, its memory, and frames of 1/60 s."""

    def __init__(
        self, avatars: tuple[Avatar, ...], bodies: tuple[Body, ...] = (), *, roots: Sequence[Place] = (),
        angles: Sequence[float] = (), seed: int = 0, settings: dict[str, Any] | None = None,
    ) -> None:
        start = rest(avatars)
        positions, given = start.positions.copy(), start.angles.copy()
        positions[: len(roots)] = np.array(roots).reshape(-1, 3)
        given[: len(angles)] = angles
        self.world = world_of(avatars, bodies, replace(start, positions=positions, angles=given))
        self.memory = make_paper_memory(self.world, seed)
        self.settings = PaperSettings()._replace(**(settings or {}))
        self.total = np.zeros_like(self.memory.counts)

    def target(self, roots: Sequence[Place] = (), angles: Sequence[float] = ()) -> Posture:
        """Return the present posture with other root places and hinge angles."""
        target = Posture(*(array.copy() for array in self.world.posture))
        if len(roots):
            target.root[: len(roots)] = np.array(roots)
        if len(angles):
            target.angle[self.world.hinges[: len(angles)]] = angles
        return target

    def frame(
        self, target: Posture | None = None, *, roots: Sequence[Place] = (), angles: Sequence[float] = (), frames: int = 1
    ) -> None:
        """Pass frames towards one target."""
        target = self.target(roots, angles) if target is None else target
        for _ in range(frames):
            follow_as_printed(
                self.world.geometry, self.world.skeleton, target, DT, self.settings, CouplingSettings(), AttractionSettings(),
                self.world.posture, self.world.poses, self.memory,
            )
            self.total += self.memory.counts

    def count(self, which: int) -> int:
        """Sum of one count over all frames."""
        return int(self.total[which])

    def excess(self) -> float:
        """Return how far the posture is beyond any limit [rad]; 0 or below: nowhere."""
        skel, posture = self.world.skeleton, self.world.posture
        worst = -np.inf
        for link in range(len(skel.kind)):
            if skel.kind[link] == HINGES:
                span = slice(skel.first_dof[link], skel.first_dof[link + 1])
                worst = max(worst, float((skel.limits[span, 0] - posture.angle[span]).max()))
                worst = max(worst, float((posture.angle[span] - skel.limits[span, 1]).max()))
            elif has_cone(skel.balls, link):
                worst = max(worst, cone_excess(skel.balls, link, columns(posture.turn, link)))
        return worst
