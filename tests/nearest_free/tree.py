"""All avatars of a scene as one tree of joints: where links are, and how each joint rate moves them."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.joint import Ball, Free, Hinges, Rigid
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Posture:
    """Roots (L, 3) [m] of free links, turns (L, 3, 3) of free and ball links, angles (H,) [rad] of hinges."""

    roots: Array
    turns: Array
    angles: Array


def posture_of(sample: TrackerSample) -> Posture:
    """Return a tracker's posture with matrices for its quaternions."""
    turns = rotation.to_matrix(rotation.normalised(sample.rotations))
    return Posture(np.array(sample.positions, dtype=np.float64), turns, np.array(sample.angles, dtype=np.float64))


@dataclass(frozen=True, eq=False)
class Placed:
    """Links in the world, n degrees of freedom: positions (L, 3), turns (L, 3, 3), against the parent (L, 3, 3); for each degree
    its world axis (n, 3) and centre (n, 3)."""

    positions: Array
    turns: Array
    relative: Array
    axes: Array
    centres: Array


def cross(a: Array, b: Array) -> Array:
    """Return the vector product of a and b (..., 3). numpy's own takes most of a search's time for looking at its arguments."""
    x, y, z = a[..., 0], a[..., 1], a[..., 2]
    u, v, w = b[..., 0], b[..., 1], b[..., 2]
    return np.stack((y * w - z * v, z * u - x * w, x * v - y * u), axis=-1)


def skew(v: Array) -> Array:
    """Return the matrix (3, 3) of the cross product with v (3,)."""
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


def turn_by(vector: Array) -> Array:
    """Return the rotation matrix (3, 3) of a rotation vector (3,) [rad]."""
    angle = float(np.linalg.norm(vector))
    k = skew(vector)
    # sin(a)/a and (1-cos(a))/a^2 by numpy's sinc, finite at zero
    return np.asarray(np.eye(3) + np.sinc(angle / np.pi) * k + 0.5 * np.sinc(0.5 * angle / np.pi) ** 2 * (k @ k))


def nearly_turned(m: Array) -> Array:
    """The rotation next to a matrix (3, 3) that is one but for rounding, so that products stay rotations however many follow."""
    return np.asarray(m @ (1.5 * np.eye(3) - 0.5 * (m.T @ m)))


class Tree:
    """Kinematics of the links of `scene`. Degrees of freedom, link by link: a free root has three shifts along the world's axes
    and three turns about its own, a ball three turns about its own axes, hinges one each."""

    def __init__(self, scene: Scene) -> None:
        self.links = scene.links
        self.parent: list[int] = []
        self.first: list[int] = [0]
        self.first_hinge: list[int] = [0]
        for avatar in scene.avatars:
            base = len(self.parent)
            at = {link.name: base + k for k, link in enumerate(avatar.links)}
            for link in avatar.links:
                joint = link.joint
                hinges = len(joint.hinges) if isinstance(joint, Hinges) else 0
                self.parent.append(-1 if link.parent is None else at[link.parent])
                self.first.append(self.first[-1] + (6 if isinstance(joint, Free) else 3 if isinstance(joint, Ball) else hinges))
                self.first_hinge.append(self.first_hinge[-1] + hinges)
        self.n = self.first[-1]
        self.zero = rotation.to_matrix(np.array([link.orientation for link in self.links]))
        self.anchors = np.array([link.anchor for link in self.links], dtype=np.float64)
        self.shifts = np.zeros(self.n, dtype=bool)
        self.hinge_dofs = np.zeros(self.first_hinge[-1], dtype=np.int64)
        self.limits = np.zeros((self.first_hinge[-1], 2))
        # (L, n): whether a degree of freedom moves a link
        self.moves = np.zeros((len(self.links), self.n), dtype=bool)
        for k, link in enumerate(self.links):
            if self.parent[k] >= 0:
                self.moves[k] = self.moves[self.parent[k]]
            self.moves[k, self.first[k] : self.first[k + 1]] = True
            if isinstance(link.joint, Free):
                self.shifts[self.first[k] : self.first[k] + 3] = True
            if isinstance(link.joint, Hinges):
                for h, hinge in enumerate(link.joint.hinges):
                    self.hinge_dofs[self.first_hinge[k] + h] = self.first[k] + h
                    self.limits[self.first_hinge[k] + h] = hinge.lower, hinge.upper
        self.jointed = [k for k, link in enumerate(self.links) if not isinstance(link.joint, Rigid)]

    def placed(self, posture: Posture) -> Placed:
        """Return forward kinematics."""
        count = len(self.links)
        positions, turns, relative = np.zeros((count, 3)), np.zeros((count, 3, 3)), np.zeros((count, 3, 3))
        axes, centres = np.zeros((self.n, 3)), np.zeros((self.n, 3))
        for k, link in enumerate(self.links):
            d, joint, up = self.first[k], link.joint, self.parent[k]
            base, frame = (np.zeros(3), np.eye(3)) if up < 0 else (positions[up], turns[up])
            if isinstance(joint, Free):
                positions[k], relative[k] = posture.roots[k], posture.turns[k]
                axes[d : d + 3] = np.eye(3)
                d += 3
            else:
                positions[k] = base + frame @ self.anchors[k]
                relative[k] = self.zero[k]
                if isinstance(joint, Ball):
                    relative[k] = self.zero[k] @ posture.turns[k]
            if isinstance(joint, Hinges):
                for h, hinge in enumerate(joint.hinges):
                    axis = np.array(hinge.axis)
                    axes[d + h] = frame @ relative[k] @ axis
                    relative[k] = relative[k] @ turn_by(axis * posture.angles[self.first_hinge[k] + h])
            turns[k] = frame @ relative[k]
            if isinstance(joint, (Free, Ball)):
                axes[d : d + 3] = turns[k].T
            centres[self.first[k] : self.first[k + 1]] = positions[k]
        return Placed(positions, turns, relative, axes, centres)

    def point_rates(self, placed: Placed, link: int, point: Array) -> Array:
        """Return (3, n) velocity of a world `point` (3,) fixed to `link`, per unit rate of each degree of freedom."""
        rates = np.where(self.shifts[:, None], placed.axes, cross(placed.axes, point - placed.centres))
        return np.asarray((rates * self.moves[link][:, None]).T)

    def moved(self, posture: Posture, x: Array) -> Posture:
        """Return `posture` after a step x (n,); hinges end inside their limits."""
        roots, turns, angles = posture.roots.copy(), posture.turns.copy(), posture.angles.copy()
        for k, link in enumerate(self.links):
            d = self.first[k]
            if isinstance(link.joint, Free):
                roots[k] += x[d : d + 3]
                d += 3
            if isinstance(link.joint, (Free, Ball)):
                turns[k] = nearly_turned(turns[k] @ turn_by(x[d : d + 3]))
        angles += x[self.hinge_dofs]
        return self.clipped(Posture(roots, turns, angles))

    def clipped(self, posture: Posture) -> Posture:
        """Return `posture` with every hinge inside its limits."""
        return replace(posture, angles=np.clip(posture.angles, self.limits[:, 0], self.limits[:, 1]))

    def from_poses(self, positions: Array, orientations: Array, angles: Array) -> Posture:
        """Return the posture that links at positions (L, 3), orientations (L, 4) show, with the given `angles` (H,) of hinges."""
        world = rotation.to_matrix(rotation.normalised(orientations))
        turns = np.tile(np.eye(3), (len(self.links), 1, 1))
        for k, link in enumerate(self.links):
            if isinstance(link.joint, Free):
                turns[k] = world[k]
            elif isinstance(link.joint, Ball):
                frame = np.eye(3) if self.parent[k] < 0 else world[self.parent[k]]
                turns[k] = (frame @ self.zero[k]).T @ world[k]
        return Posture(np.array(positions, dtype=np.float64), turns, np.array(angles, dtype=np.float64))
