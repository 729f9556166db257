"""An engine to copy, for the comparison: avatars go where their user is, within limits, and loose bodies fly without contact.

Shows: the protocol of an engine, its refusals, forward kinematics, and the checks of avatarsim.testing.
Run: python examples/engine_of_your_own.py
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

import avatarsim as av
from avatarsim.engine import require_shapes
from avatarsim.errors import UnknownName
from avatarsim.scene.body import Role
from avatarsim.scene.joint import axes_of
from avatarsim.scene.tracker import checked
from avatarsim.spatial import rotation
from avatarsim.testing import check_engine


class MyEngine:
    """Without contact. Put your simulator's world into `load`, and its steps into `advance`."""

    name, version, presets = "mine", "1", ("default",)

    def unsupported(self, scene: av.Scene) -> Mapping[str, str]:
        """Return features that this engine lacks, with the consequence."""
        return {"contact": "everything passes through everything"}

    def settings_as_run(self) -> Mapping[str, object]:
        """Return settings in force."""
        return {}

    def load(self, scene: av.Scene, settings: av.Settings, dt: float) -> av.FrameRecord:
        """Build the world and return the first state."""
        if settings.preset not in self.presets:
            raise UnknownName("preset of mine", settings.preset, self.presets)
        for name in settings.options:
            raise UnknownName("option of mine", name, ())
        require_shapes(scene, (av.Sphere, av.Box, av.Capsule, av.Ellipsoid))  # a hull is refused
        self.scene, self.time = scene, 0.0
        self.loose = np.array([body.role is Role.SIMULATED for body in scene.bodies], dtype=bool)
        masses = [body.mass.centre if body.mass else (0.0, 0.0, 0.0) for body in scene.bodies]
        self.centre = np.array(masses).reshape(-1, 3)
        self.turn = np.array([body.orientation for body in scene.bodies]).reshape(-1, 4)
        self.place = np.array([body.position for body in scene.bodies]).reshape(-1, 3) + rotation.rotate(self.turn, self.centre)
        self.speed = np.array([body.velocity for body in scene.bodies]).reshape(-1, 3)
        self.spin = np.array([body.angular_velocity for body in scene.bodies]).reshape(-1, 3)
        axes = [axis for link in scene.links for axis in axes_of(link.joint)]
        self.limits = np.array([axis.lower for axis in axes]), np.array([axis.upper for axis in axes])
        self.links: np.ndarray | None = None
        return self.record(scene.first_sample, dt)

    def advance(self, sample: av.TrackerSample, dt: float) -> av.FrameRecord:
        """Pass a frame; dt is checked, as samples are."""
        if not 0.0 < dt < np.inf:
            raise av.InvalidInput("frame time [s]", dt, "finite and above 0")
        sample = checked(sample, self.scene.avatars)
        self.time += dt
        self.speed[self.loose] += np.array(self.scene.gravity) * dt
        self.place[self.loose] += self.speed[self.loose] * dt
        turn = rotation.from_rotation_vector(self.spin * dt)
        self.turn[self.loose] = rotation.normalised(rotation.multiply(turn, self.turn))[self.loose]
        return self.record(sample, dt)

    def record(self, sample: av.TrackerSample, dt: float) -> av.FrameRecord:
        """Return bodies first, then links; velocities of centres of mass, in world axes. Link velocities are left out here."""
        angles = np.clip(sample.angles, *self.limits)
        places, turns = av.link_poses(self.scene.avatars, replace(sample, angles=angles))
        still = np.zeros_like(places)
        shown = av.Snapshot(
            self.time, np.vstack([self.place - rotation.rotate(self.turn, self.centre), places]), np.vstack([self.turn, turns]),
            np.vstack([self.speed, still]), np.vstack([self.spin, still]),
        )
        return av.FrameRecord(shown, angles)

    def close(self) -> None:
        """Free everything."""


def main() -> int:
    """Check the engine; the number of findings."""
    findings = check_engine(MyEngine, raises=False)
    print("\n".join(map(str, findings)) or "no findings")
    return len(findings)


if __name__ == "__main__":
    main()
