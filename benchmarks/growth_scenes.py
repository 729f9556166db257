"""Scenes of any size: combs of many limbs over a floor, and objects on a floor below a hand.

A module of scenarios by name, as the catalogue is: `links_31_contact`, `avatars_10_apart`.
"""

from dataclasses import replace
from functools import cache, partial
from math import ceil, sqrt

import numpy as np

from avatarsim.errors import UnknownName
from avatarsim.scene.avatar import Avatar, Link, rigid_avatar
from avatarsim.scene.body import Body, fixed, simulated, solid
from avatarsim.scene.joint import Free, Hinge, Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample, rest
from scenarios.motion.rigid_hands import hands_at, led
from scenarios.scenario import RENDERED, Motion, Scenario

SIZES = {"links": (16, 31, 61, 100, 199), "avatars": (1, 3, 10, 30, 100), "objects": (20, 200, 2000)}
"""Links of one comb, combs of 16 links each, objects."""
MODES = {"links": ("apart", "contact"), "avatars": ("apart", "contact"), "objects": ("idle", "pushed")}
"""Nothing touches, or most of the time limbs are in the floor; a hand hangs still, or pushes one object along."""
FRAMES = {"links": 90, "avatars": 90, "objects": 300}
"""Three times into contact and out again; some engines put a body to sleep only after two seconds of rest."""
SWINGS, STAY = 3, 1.6
"""Times that the user goes into contact and back; above 1 the user stays at the end of the way, so that most frames touch."""
JOINTED, NEXT_LIMB, THICK, LONG = 3, 0.09, 0.025, 0.1
"""Of a comb: links of a limb; distance from one limb to the next, radius of a link and length of its straight part [m]."""
HIGH = JOINTED * (LONG + 2.0 * THICK + 0.005)
"""Length of a limb [m]."""
DEEP, ROOM = 0.05, 1.6
"""Depth to which the user goes into the floor, distance of two combs [m]."""
PITCH, SIDE, HAND, WAY, ABOVE = 0.3, 0.1, 0.06, 0.12, 1.0
"""Distance of adjacent objects, size of an object, radius of the hand, way that it pushes, its height when idle [m]."""


def ground(wide: float) -> Body:
    """Return a slab whose top is z = 0."""
    return fixed("floor", (Piece(Box((wide, wide, 0.2))),), "wood", (0.0, 0.0, -0.1))


def comb(links: int) -> Avatar:
    """Return a free back along x and limbs of three links hanging from it, in two rows."""
    limbs = (links - 1) // JOINTED
    long = NEXT_LIMB * ((limbs + 1) // 2)
    back = (Piece(Box((long, 0.2, 0.06))),)
    bar = (Piece(Capsule(THICK, LONG), (0.0, 0.0, -0.5 * LONG)),)
    hinge = Hinges((Hinge((1.0, 0.0, 0.0), -0.6, 0.6),))
    parts = [Link("back", None, Free(), back, solid(back, 5.0))]
    for limb in range(limbs):
        at = -0.5 * long + NEXT_LIMB * (limb // 2 + 0.5)
        parent, anchor = "back", (at, 0.16 if limb % 2 else -0.16, 0.0)
        for k in range(JOINTED):
            name = f"limb_{limb}_{k}"
            parts.append(Link(name, parent, hinge, bar, solid(bar, 0.2), anchor=anchor))
            parent, anchor = name, (0.0, 0.0, -LONG - 2.0 * THICK - 0.005)
    # a limb bends next to the back and may rub along it at its root
    rubbing_pairs = tuple(("back", f"limb_{limb}_{k}") for limb in range(limbs) for k in (0, 1))
    tips = tuple(f"limb_{limb}_{JOINTED - 1}" for limb in range(limbs))
    return Avatar("comb", tuple(parts), tips, rubbing_pairs, size_range=(0.01, 60.0))


def combs(count: int, links: int, mode: str, name: str) -> Scene:
    """Return combs side by side, 2 cm above the floor or half a metre higher."""
    one = comb(links)
    avatars = tuple(replace(one, name=f"comb_{k}") for k in range(count))
    start = rest(avatars)
    start.positions[::links, 1] = ROOM * (np.arange(count) - 0.5 * (count - 1))
    start.positions[::links, 2] = HIGH + 0.02 + (0.5 if mode == "apart" else 0.0)
    return Scene(name, (ground(20.0 + ROOM * count),), avatars, start=start)


def comb_motion(scene: Scene, seed: int) -> Motion:
    """The backs bob; limbs swing sideways, each a little after the one before."""
    start, frames, links = scene.first_sample, FRAMES["links"], len(scene.avatars[0].links)
    phases = np.arange(len(start.angles)) * 0.7

    def sample(frame: int) -> TrackerSample:
        turn = 2.0 * np.pi * (frame + 1) / frames
        share = min(1.0, STAY * (0.5 - 0.5 * np.cos(SWINGS * turn)))
        positions = start.positions.copy()
        positions[::links, 2] -= (DEEP + 0.02) * share
        return TrackerSample((frame + 1) * RENDERED, positions, start.rotations, 0.15 * share * np.sin(turn + phases))

    return sample


def gallery(count: int, mode: str, name: str) -> Scene:
    """Return boxes and balls on a square grid, at rest on the floor, and a hand high above or a centimetre from one of them."""
    side, palm = ceil(sqrt(count)), (Piece(Sphere(HAND)),)
    shapes = (Piece(Box((SIDE, SIDE, SIDE))),), (Piece(Sphere(0.5 * SIDE)),)
    objects = []
    for k in range(count):
        at = (PITCH * (k % side - side // 2), PITCH * (k // side - side // 2), 0.5 * SIDE)
        objects.append(simulated(f"object_{k}", shapes[k % 2], "wood", solid(shapes[k % 2], 1.0), at))
    begin = (0.0, 0.0, ABOVE) if mode == "idle" else (-0.5 * SIDE - HAND - 0.01, 0.0, HAND)
    hand = rigid_avatar("hand", palm, solid(palm, 0.5))
    return Scene(name, (ground(PITCH * (side + 4)), *objects), (hand,), start=hands_at([begin]))


def hand_motion(scene: Scene, seed: int) -> Motion:
    """An idle hand stays; a pushing one goes its way slowly."""
    x, y, z = scene.first_sample.positions[0].tolist()
    speed = 0.0 if scene.name.endswith("idle") else WAY / (FRAMES["objects"] * RENDERED)
    return led(lambda time: [(x + speed * time, y, z)])(scene, seed)


@cache
def get(name: str) -> Scenario:
    """Return the scenario called `name`: kind, size and mode. UnknownName for anything else."""
    known = [f"{kind}_{size}_{mode}" for kind, sizes in SIZES.items() for size in sizes for mode in MODES[kind]]
    if name not in known:
        raise UnknownName("scene of growing size", name, known)
    kind, size, mode = name.split("_")
    if kind == "objects":
        build, motion = partial(gallery, int(size), mode, name), hand_motion
    else:
        count, links = (1, int(size)) if kind == "links" else (int(size), SIZES["links"][0])
        build, motion = partial(combs, count, links, mode, name), comb_motion
    return Scenario(name, f"{size} {kind}, {mode}.", "Frame time.", build, motion, FRAMES[kind])
