"""Energy of simulated bodies: the unexplained part of a frame's gain, and the lift by removal of overlap."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.body import Role
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import reach
from avatarsim.spatial import rotation
from runfiles.record import EVENTS, Recording
from scenarios.measure.timeline import timeline
from scenarios.measure.value import Missing, Values, measure

Array = NDArray[np.float64]

REACH = 0.05
"""Distance [m] between bounding balls within which a driven link may do work on a simulated body. Such frames explain any gain,
so they are left out; wider would leave out more, narrower would blame an engine whose margin acts at a distance."""


def kinetic(mass: Array, inertia: Array, orientations: Array, velocities: Array, spins: Array) -> Array:
    """Return (T, b) kinetic energy [J] of b bodies of `mass` (b,) and body-frame `inertia` (b, 3, 3)."""
    turning = inertia[:, 0, 0] * np.einsum("tbi,tbi->tb", spins, spins)
    # whose inertia is the same about every axis needs no axes of its own
    k = np.flatnonzero((inertia != inertia[:, :1, :1] * np.eye(3)).any(axis=(1, 2)))
    if len(k):
        own = rotation.rotate(rotation.conjugate(orientations[:, k]), spins[:, k])
        turning[:, k] = np.einsum("tbi,bij,tbj->tb", own, inertia[k], own)
    return np.asarray(0.5 * (mass * np.einsum("tbi,tbi->tb", velocities, velocities) + turning))


def lifts(time: Array, height: Array, speed: Array) -> Array:
    """Return (T-1, b) rise [m] between states that no velocity explains: more than the faster of the two speeds would give."""
    explained = np.maximum(speed[:-1], speed[1:]) * np.diff(time)[:, None]
    return np.asarray(np.maximum(np.diff(height, axis=0) - explained, 0.0))


def undriven(recording: Recording, scene: Scene, bodies: list[int]) -> NDArray[np.bool_]:
    """Return (F,) True for frames in which no link comes within REACH of a simulated body at either end."""
    links = recording.positions[:, recording.links]
    if links.shape[1] == 0:
        return np.ones(recording.frames, dtype=bool)
    own = np.array([max(map(reach, scene.bodies[k].pieces)) for k in bodies])
    theirs = np.array([max(map(reach, link.pieces), default=0.0) for link in scene.links])
    apart = np.linalg.norm(links[:, :, None] - recording.positions[:, None, bodies], axis=-1)
    away = (apart > own[None, None] + theirs[None, :, None] + REACH).all(axis=(1, 2))
    return np.asarray(away[:-1] & away[1:])


def struck(recording: Recording, scene: Scene, moving: Array) -> Array:
    """Return (I,) kinetic energy [J] gained by simulated bodies and driven links together at each impact recorded inside a frame,
    from that of the simulated bodies `moving` (S,) [J] in all snapshots.

    A link counts with its coupled mass, which is the mass that the body feels. At an instant gravity and users do no work,
    so this covers the part that `undriven` must leave out: a link that an impact leaves faster than the body could make it."""
    before = np.flatnonzero(recording.inside_event[:-1] == EVENTS.index("approach"))
    before = before[recording.inside_event[before + 1] == EVENTS.index("impact")]
    owned = [(avatar.coupled_mass, link.mass.mass) for avatar in scene.avatars for link in avatar.links]
    coupled = np.array([own if stated is None else stated for stated, own in owned])
    links = recording.inside_velocities[:, recording.links]
    moving = moving + 0.5 * np.sum(coupled * np.sum(links**2, axis=-1), axis=1)
    return np.asarray(moving[before + 1] - moving[before])


@measure
def energy(recording: Recording, scene: Scene) -> Values:
    """Return energy_added_max and lift_energy_max [J], lift_height_max [m]: per frame the kinetic energy gained by all simulated
    bodies beyond gravity's work (over the way without lift), per impact their and the links' gain, the potential energy of that
    lift, and its height, of the body that is lifted most. Empty without simulated bodies."""
    bodies = [k for k, body in enumerate(scene.bodies) if body.role is Role.SIMULATED]
    masses = [body.mass for body in scene.bodies if body.mass is not None and body.role is Role.SIMULATED]
    if not bodies or recording.frames == 0:
        return {}
    line = timeline(recording, bodies)
    mass, inertia = np.array([m.mass for m in masses]), np.array([m.inertia for m in masses])
    gravity = np.array(scene.gravity)
    strength = float(np.linalg.norm(gravity))
    up = -gravity / strength if strength > 0.0 else np.array([0.0, 0.0, 1.0])
    height = (line.positions + rotation.rotate(line.orientations, np.array([m.centre for m in masses]))) @ up
    lift = lifts(line.time, height, line.velocities @ up)
    work = -strength * mass * (np.diff(height, axis=0) - lift)
    moving = kinetic(mass, inertia, line.orientations, line.velocities, line.angular_velocities).sum(axis=1)
    shown = np.flatnonzero(np.diff(line.frame, append=recording.frames + 1) > 0)
    gained = np.diff(moving[shown])
    explained, lifted = np.zeros(recording.frames + 1), np.zeros(recording.frames + 1)
    np.add.at(explained, line.frame[1:], work.sum(axis=1))
    np.add.at(lifted, line.frame[1:], (strength * mass * lift).sum(axis=1))
    heights = np.zeros((recording.frames + 1, len(bodies)))
    np.add.at(heights, line.frame[1:], lift)
    chosen = undriven(recording, scene, bodies)
    none = Missing("a driven link is within reach of a simulated body in every frame", "scene")
    added = np.concatenate([(gained - explained[1:])[chosen], struck(recording, scene, moving[line.inside])])
    return {
        "energy_added_max": max(0.0, _largest(added)) if added.size else none,
        "lift_energy_max": _largest(lifted[1:]),
        # where nothing falls no way is up
        "lift_height_max": _largest(heights[1:]) if strength > 0.0 else 0.0,
    }


def _largest(values: Array) -> float:
    return float(np.max(values))
