"""Deliberately bad engines. A scene that any of them passes cannot separate good from bad.

They are found by the harness like any external engine: through the entry-point group, from a folder on the path (`joined`).
"""

import os
import signal
import sys
import time
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from avatarsim.engine import FrameRecord, Settings, Snapshot
from avatarsim.scene.body import Role
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, link_poses, poses_of_links
from avatarsim.spatial import rotation
from reference.judging.judge import Judge

Array = NDArray[np.float64]
DEPTH = 2e-3
"""Overlap [m] that TwoMillimetres leaves."""
PARTS, ROUNDS = 16, 8
"""Number of parts and of rounds in which TwoMillimetres divides the part of a path that gets too deep: 100 m to a micrometre."""
STEPS = 8
"""Parts of a frame that it checks; a body that passes through another within one of them is not found."""

DISTRIBUTION, MODULE = "bad_engines_for_tests", "bad_engines_of_a_stranger"
NAMES = {
    "frozen": "Frozen", "tunnels": "Tunnels", "two_millimetres": "TwoMillimetres", "not_a_number": "NotANumber",
    "raises": "Raises", "dies": "Dies", "talks": "Talks", "speechless": "Speechless",
    "dawdles": "Dawdles", "unrecorded": "Unrecorded",
}


def joined(folder: Path) -> Path:
    """Install a distribution with these engines and its entry points in `folder`, as pip would; return the folder."""
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
    """An engine that always shows its first state: without overlap, without faults, without motion."""

    version = "1.0"
    presets: tuple[str, ...] = ("default", "other")

    @property
    def name(self) -> str:
        return type(self).__name__

    def unsupported(self, scene: Scene) -> Mapping[str, str]:
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
        """Change the state as the bad engine does."""

    def shown(self) -> FrameRecord:
        still = np.zeros_like(self.positions)
        snapshot = Snapshot(self.time, self.positions.copy(), self.orientations.copy(), self.velocities.copy(), still)
        return FrameRecord(snapshot, self.angles.copy())

    def close(self) -> None:
        """Do nothing: there is nothing to release."""


class Tunnels(Frozen):
    """An engine whose avatar follows the tracker everywhere, and whose bodies fall through everything."""

    def move(self, sample: TrackerSample, dt: float) -> None:
        positions, orientations = link_poses(self.scene.avatars, sample)
        self.positions[self.bodies :], self.orientations[self.bodies :] = positions, orientations
        self.angles = sample.angles
        self.velocities[self.moving] += np.array(self.scene.gravity) * dt
        self.positions[self.moving] += self.velocities[self.moving] * dt


class NotANumber(Tunnels):
    """An engine whose positions are NaN after three frames."""

    def move(self, sample: TrackerSample, dt: float) -> None:
        super().move(sample, dt)
        if self.time > 3.5 * dt:
            self.positions[:] = np.nan


class TwoMillimetres(Frozen):
    """An engine that stops 2 mm inside: it shortens the motion until the judge finds just that depth."""

    def load(self, scene: Scene, settings: Settings, dt: float) -> FrameRecord:
        self.judge = Judge(scene)
        self.sample, self.stuck = scene.first_sample, False
        return super().load(scene, settings, dt)

    def furthest(self, states: Callable[[Array], tuple[Array, Array]], parts: int) -> float:
        """Return the share of a path up to which nothing is deeper than DEPTH: `states` gives poses (S, n, .) at shares (S,).
        It checks the ends of the parts, and divides the first part that gets too deep again and again."""
        low, high = 0.0, 1.0
        for _ in range(ROUNDS):
            shares = np.linspace(low, high, parts + 1)
            beyond = self.judge.depths(*states(shares[1:])) > DEPTH
            if not beyond.any():
                # the whole path; later, the end of a part, due to rounding
                return float(high)
            first, parts = int(np.argmax(beyond)), PARTS
            low, high = shares[first], shares[first + 1]
        return float(low)

    def move(self, sample: TrackerSample, dt: float) -> None:
        if any(not avatar.moves for avatar in self.scene.avatars):
            self.follow(sample)
        elif not self.stuck:
            self.fly(dt)

    def follow(self, sample: TrackerSample) -> None:
        """Move from the shown posture towards the tracker's as far as DEPTH allows."""
        start = self.sample

        def postures(shares: Array) -> tuple[Array, Array]:
            links, turns = poses_of_links(self.scene.avatars, *blended(start, sample, shares))
            bodies = np.broadcast_to(self.positions[: self.bodies], (len(shares), self.bodies, 3))
            frames = np.broadcast_to(self.orientations[: self.bodies], (len(shares), self.bodies, 4))
            return np.concatenate([bodies, links], axis=1), np.concatenate([frames, turns], axis=1)

        share = np.array([self.furthest(postures, 1)])
        positions, orientations = postures(share)
        self.positions, self.orientations = positions[0], orientations[0]
        self.sample = TrackerSample(sample.time, *(part[0] for part in blended(start, sample, share)))
        self.angles = self.sample.angles

    def fly(self, dt: float) -> None:
        """Move all bodies freely; at the first overlap of DEPTH stop the whole world at that depth."""
        begin, gained = self.positions, np.array(self.scene.gravity) * dt
        way, bend = np.zeros_like(begin), np.zeros_like(begin)
        way[self.moving], bend[self.moving] = self.velocities[self.moving] * dt, 0.5 * gained * dt

        def along(shares: Array) -> tuple[Array, Array]:
            part = shares[:, None, None]
            turns = np.broadcast_to(self.orientations, (len(shares), *self.orientations.shape))
            return begin + part * way + part * part * bend, turns

        share = self.furthest(along, STEPS)
        self.positions = along(np.array([share]))[0][0]
        self.velocities[self.moving] += share * gained
        self.stuck = share < 1.0


def blended(a: TrackerSample, b: TrackerSample, shares: Array) -> tuple[Array, Array, Array]:
    """Return positions (S, L, 3), rotations (S, L, 4) and angles (S, H) at `shares` (S,) of the path from a to b."""
    part = shares[:, None]
    return (
        a.positions + part[..., None] * (b.positions - a.positions), rotation.slerp(a.rotations, b.rotations, part),
        a.angles + part * (b.angles - a.angles),
    )


class Raises(Tunnels):
    """An engine that raises in its fourth frame."""

    def move(self, sample: TrackerSample, dt: float) -> None:
        super().move(sample, dt)
        if self.time > 3.5 * dt:
            raise RuntimeError("the solver has lost its way")


class Dies(Tunnels):
    """An engine that kills its process in the fourth frame, as a fault in compiled code would."""

    def move(self, sample: TrackerSample, dt: float) -> None:
        super().move(sample, dt)
        if self.time > 3.5 * dt:
            os.kill(os.getpid(), signal.SIGKILL)


class Unrecorded(Tunnels):
    """Returns positions in place of a record."""

    def advance(self, sample: TrackerSample, dt: float) -> FrameRecord:
        return super().advance(sample, dt).shown.positions  # type: ignore[return-value]


class Dawdles(Tunnels):
    """An engine that takes a second for each frame."""

    def move(self, sample: TrackerSample, dt: float) -> None:
        super().move(sample, dt)
        time.sleep(1.0)


class Talks(Tunnels):
    """An engine that prints to the standard output, as some engines do from C."""

    def load(self, scene: Scene, settings: Settings, dt: float) -> FrameRecord:
        print("WELCOME TO MY ENGINE", file=sys.stdout, flush=True)
        os.write(1, b"WELCOME FROM C\n")
        return super().load(scene, settings, dt)


class Speechless(Frozen):
    """An engine that supports no scene."""

    def unsupported(self, scene: Scene) -> Mapping[str, str]:
        return {"scene": "it knows spheres only"}
