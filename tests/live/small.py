"""A small driven world: an arm of two links with a free root over a table, a loose ball on it, and a target that pushes down."""

import math

import numpy as np

from avatarsim.engine import Settings
from avatarsim.live.messages import Plan
from avatarsim.live.recording import ENGINE
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import fixed, simulated, solid
from avatarsim.scene.joint import Free, Hinge, Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample

RATE = 60.0
HIGH = 0.3
"""Height of the palm at first [m]."""


def arm() -> Avatar:
    """Return a palm, and a finger on a hinge."""
    palm = (Piece(Box((0.1, 0.08, 0.03))),)
    finger = (Piece(Capsule(0.01, 0.06), (0.03, 0.0, 0.0), (math.sqrt(0.5), 0.0, math.sqrt(0.5), 0.0)),)
    bend = Hinges((Hinge((0.0, 1.0, 0.0), -0.3, 1.4),))
    return Avatar("arm", (
        Link("palm", None, Free(), palm, solid(palm, 0.4)),
        Link("finger", "palm", bend, finger, solid(finger, 0.05), anchor=(0.06, 0.0, 0.0)),
    ))


def scene() -> Scene:
    """Return the scene with the arm over the table."""
    table, ball = (Piece(Box((1.0, 1.0, 0.1))),), (Piece(Sphere(0.04)),)
    start = TrackerSample(0.0, np.array([[0.0, 0.0, HIGH], [0.0, 0.0, 0.0]]), np.tile([1.0, 0.0, 0.0, 0.0], (2, 1)), np.zeros(1))
    loose = simulated("ball", ball, "wood", solid(ball, 0.16), (0.2, 0.0, 0.0401))
    bodies = (fixed("table", table, "wood", (0.0, 0.0, -0.05)), loose)
    return Scene("small", bodies, (arm(),), start=start)


def pushed(frame: int) -> TrackerSample:
    """Return the user's posture: down into the table and about, and the finger to and fro beyond its limits."""
    t = frame / RATE
    at = (0.15 * math.sin(2.0 * t), 0.1 * math.sin(3.0 * t), HIGH - 0.35 * (1.0 - math.cos(2.5 * t)))
    positions = np.array([at, (0.0, 0.0, 0.0)])
    return TrackerSample(t, positions, np.tile([1.0, 0.0, 0.0, 0.0], (2, 1)), np.array([1.6 * math.sin(4.0 * t)]))


def plan(logs: str = "", preset: str = "default") -> Plan:
    """Return a plan for AvatarsimEngine on this scene."""
    return Plan(ENGINE, scene(), Settings(preset=preset), RATE, logs)
