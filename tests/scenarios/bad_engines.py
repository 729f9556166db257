"""Deliberately bad engines. A scene that any of them passes cannot tell good from bad.

They join the harness as a stranger's engine would: through the entry-point group, from a folder on the path (`joined`).
"""

import os
import signal
import sys
import time
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from avatarsim.engine import FrameRecord, Settings, Snapshot
from avatarsim.scene.body import Role
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, link_poses
from avatarsim.spatial import rotation
from reference.judge import Judge

Array = NDArray[np.float64]
DEPTH = 2e-3
"""What the third of them leaves [m]."""
STEPS = 8
"""Parts of a frame in which it looks; a body that passes through another within one of them is not seen."""

DISTRIBUTION, MODULE = "bad_engines_for_tests", "bad_engines_of_a_stranger"
NAMES = {
    "frozen": "Frozen", "tunnels": "Tunnels", "two_millimetres": "TwoMillimetres", "not_a_number": "NotANumber",
    "raises": "Raises", "dies": "Dies", "talks": "Talks", "speechless": "Speechless",
    "dawdles": "Dawdles",
}


def joined(folder: Path) -> Path:
    """Lay a distribution with these engines and its entry points into `folder`, as pip would; returns the folder."""
    (folder / f"{MODULE}.py").write_text(Path(__file__).read_text())
    (folder / "needs_absent_package.py").write_text("import a_package_that_nobody_has\n")
    info = folder / f"{DISTRIBUTION}-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {DISTRIBUTION}\nVersion: 1.0\n")
    lines = [f"{name} = {MODULE}:{kind}" for name, kind in NAMES.items()]
    lines += ["absent = needs_absent_package:Engine", "no_engine = pathlib:PurePath"]
    (info / "entry_points.txt").write_text("\n".join(["[avatarsim.engines]", *lines]) + "\n")
    return folder


class Frozen:
    """Shows its first state for ever. Nothing overlaps, nothing is wrong, nothing happens."""

    version = "1.0"
    presets: tuple[str, ...] = ("default", "other")

    @property
    def name(self) -> str:
        return type(self).__name__

    def cannot_say(self, scene: Scene) -> Mapping[str, str]:
        return {}

    def settings_as_run(self) -> Mapping[str, object]:
        return {"badness": (self.name, "a test needs it"), **self.settings.options}

    def load(self, scene: Scene, settings: Settings, dt: float) -> FrameRecord:
        self.scene, self.settings, self.time = scene, settings, 0.0
        positions, orientations = link_poses(scene.avatars, scene.first_sample)
        self.bodies = len(scene.bodies)
        self.positions = np.array([*(body.position for body in scene.bodies), *positions], dtype=np.float64)
        self.orientations = np.array([*(body.orientation for body in scene.bodies), *orientations], dtype=np.float64)
        self.velocities = np.zeros_like(self.positions)
        self.moving = [k for k, role in enumerate(scene.roles) if role is Role.SIMULATED]
        for k in self.moving:
            self.velocities[k] = scene.bodies[k].velocity
        self.angles = scene.first_sample.angles
        return self.shown()

    def advance(self, sample: TrackerSample, dt: float) -> FrameRecord:
        self.time += dt
        self.move(sample, dt)
        return self.shown()

    def move(self, sample: TrackerSample, dt: float) -> None:
        """What is bad about it."""

    def shown(self) -> FrameRecord:
        still = np.zeros_like(self.positions)
        snapshot = Snapshot(self.time, self.positions.copy(), self.orientations.copy(), self.velocities.copy(), still)
        return FrameRecord(snapshot, self.angles.copy())

    def close(self) -> None:
        """Nothing is held."""


class Tunnels(Frozen):
    """The avatar goes wherever the tracker goes, bodies fall through everything."""

    def move(self, sample: TrackerSample, dt: float) -> None:
        positions, orientations = link_poses(self.scene.avatars, sample)
        self.positions[self.bodies :], self.orientations[self.bodies :] = positions, orientations
        self.angles = sample.angles
        self.velocities[self.moving] += np.array(self.scene.gravity) * dt
        self.positions[self.moving] += self.velocities[self.moving] * dt


class NotANumber(Tunnels):
    """Loses its numbers after three frames."""

    def move(self, sample: TrackerSample, dt: float) -> None:
        super().move(sample, dt)
        if self.time > 3.5 * dt:
            self.positions[:] = np.nan


class TwoMillimetres(Frozen):
    """It stops 2 mm inside, by halving the way until the judge finds just that."""

    def load(self, scene: Scene, settings: Settings, dt: float) -> FrameRecord:
        self.judge = Judge(scene)
        self.sample, self.stuck = scene.first_sample, False
        return super().load(scene, settings, dt)

    def depth(self, positions: Array, orientations: Array) -> float:
        return self.judge.overlaps(positions, orientations).deepest

    def posture(self, sample: TrackerSample) -> tuple[Array, Array]:
        links, turns = link_poses(self.scene.avatars, sample)
        return np.concatenate([self.positions[: self.bodies], links]), np.concatenate([self.orientations[: self.bodies], turns])

    def move(self, sample: TrackerSample, dt: float) -> None:
        if self.scene.avatars:
            self.follow(sample)
        elif not self.stuck:
            self.fly(dt)

    def follow(self, sample: TrackerSample) -> None:
        """From the posture shown towards the tracker's as far as DEPTH allows."""
        low, high = 0.0, 1.0
        if self.depth(*self.posture(sample)) > DEPTH:
            for _ in range(30):
                middle = 0.5 * (low + high)
                free = self.depth(*self.posture(blend(self.sample, sample, middle))) <= DEPTH
                low, high = (middle, high) if free else (low, middle)
        else:
            low = 1.0
        self.sample = blend(self.sample, sample, low)
        self.positions, self.orientations = self.posture(self.sample)
        self.angles = self.sample.angles

    def fly(self, dt: float) -> None:
        """All bodies fly freely; at the first overlap of DEPTH the whole world stops, just that deep."""
        for _ in range(STEPS):
            h = dt / STEPS
            self.velocities[self.moving] += np.array(self.scene.gravity) * h
            way = np.zeros_like(self.positions)
            way[self.moving] = self.velocities[self.moving] * h
            if self.depth(self.positions + way, self.orientations) > DEPTH:
                low, high = 0.0, 1.0
                for _ in range(40):
                    middle = 0.5 * (low + high)
                    free = self.depth(self.positions + middle * way, self.orientations) <= DEPTH
                    low, high = (middle, high) if free else (low, middle)
                self.positions += low * way
                self.stuck = True
                return
            self.positions += way


def blend(a: TrackerSample, b: TrackerSample, fraction: float) -> TrackerSample:
    """The posture `fraction` of the way from a to b."""
    rotations = rotation.slerp(a.rotations, b.rotations, np.array(fraction))
    positions = a.positions + fraction * (b.positions - a.positions)
    return TrackerSample(b.time, positions, rotations, a.angles + fraction * (b.angles - a.angles))


class Raises(Tunnels):
    """Gives up in its fourth frame."""

    def move(self, sample: TrackerSample, dt: float) -> None:
        super().move(sample, dt)
        if self.time > 3.5 * dt:
            raise RuntimeError("the solver has lost its way")


class Dies(Tunnels):
    """Takes its process along in the fourth frame, as a fault in compiled code would."""

    def move(self, sample: TrackerSample, dt: float) -> None:
        super().move(sample, dt)
        if self.time > 3.5 * dt:
            os.kill(os.getpid(), signal.SIGKILL)


class Dawdles(Tunnels):
    """Takes a second for each frame."""

    def move(self, sample: TrackerSample, dt: float) -> None:
        super().move(sample, dt)
        time.sleep(1.0)


class Talks(Tunnels):
    """Greets on the standard output, as some engines do from C."""

    def load(self, scene: Scene, settings: Settings, dt: float) -> FrameRecord:
        print("WELCOME TO MY ENGINE", file=sys.stdout, flush=True)
        os.write(1, b"WELCOME FROM C\n")
        return super().load(scene, settings, dt)


class Speechless(Frozen):
    """Has no words for any scene."""

    def cannot_say(self, scene: Scene) -> Mapping[str, str]:
        return {"scene": "it knows spheres only"}
