"""The raw tracker motion, without any contact handling: the size of the problem that the engines solve."""

from collections.abc import Mapping

import numpy as np

from avatarsim.engine import FrameRecord, Settings, Snapshot
from avatarsim.errors import InvalidInput, UnknownName
from avatarsim.scene.body import Role
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, checked
from avatarsim.spatial import rotation
from reference.targets import Targets


class RawTracker:
    """Shows every link exactly where the tracker has it. Bodies stay at their first poses."""

    name = "tracker"
    version = "1"
    presets = ("default",)

    def unsupported(self, scene: Scene) -> Mapping[str, str]:
        """Return the features left out: all but kinematics."""
        features = {}
        if scene.avatars:
            features["contact"] = "links go where the tracker has them, through everything"
        if any(role is Role.SIMULATED for role in scene.roles):
            features["dynamics"] = "simulated bodies stay where they are at the start"
        return features

    def settings_as_run(self) -> Mapping[str, object]:
        """Return no settings: nothing can be set."""
        return {}

    def load(self, scene: Scene, settings: Settings, dt: float) -> FrameRecord:
        """Return the first posture."""
        if settings.preset not in self.presets:
            raise UnknownName(f"preset of {self.name}", settings.preset, self.presets)
        for name in settings.options:
            raise InvalidInput(f"option of {self.name}", name, "none: there is nothing to set")
        self._scene, self._settings, self._elapsed = scene, settings, 0.0
        self._positions = np.array([body.position for body in scene.bodies], dtype=np.float64).reshape(-1, 3)
        self._orientations = np.array([body.orientation for body in scene.bodies], dtype=np.float64).reshape(-1, 4)
        self._arms = np.array([link.mass.centre for link in scene.links], dtype=np.float64).reshape(-1, 3)
        # the very kernel that leads the other engines; without limits it changes nothing of a sample
        self._targets = Targets(scene, clamp=False)
        self._last: Snapshot | None = None
        self._centres = self._positions
        return self._record(scene.first_sample, dt)

    def advance(self, sample: TrackerSample, dt: float) -> FrameRecord:
        """Return the tracker's posture; velocities are those that led there from the last frame."""
        self._elapsed += dt
        return self._record(checked(sample, self._scene.avatars), dt)

    def close(self) -> None:
        """Do nothing: there is nothing to release."""

    def _record(self, sample: TrackerSample, dt: float) -> FrameRecord:
        if not (np.isfinite(dt) and dt > 0.0):
            raise InvalidInput("frame time [s]", dt, "finite and above 0")
        at, turned = self._targets.posture(self._targets.within_limits(sample))
        positions, orientations = np.vstack([self._positions, at]), np.vstack([self._orientations, turned])
        centres = positions.copy()
        centres[len(self._scene.bodies) :] += rotation.rotate(turned, self._arms)
        velocity, spin = np.zeros_like(positions), np.zeros_like(positions)
        if self._last is not None:
            velocity = (centres - self._centres) / dt
            turn = rotation.multiply(orientations, rotation.conjugate(self._last.orientations))
            spin = rotation.to_rotation_vector(turn) / dt
        self._centres = centres
        self._last = Snapshot(self._elapsed, positions, orientations, velocity, spin)
        inside = (self._last,) if self._settings.record_inside and self._elapsed > 0.0 else ()
        return FrameRecord(self._last, np.array(sample.angles, dtype=np.float64), inside=inside)
