"""Scenes of any size: a comb of many limbs over a floor, avatars before a wall, a gallery of objects, piles of bricks.

A module of scenarios by name, as the catalogue is: `links_31_contact`, `avatars_10_apart`, `objects_2000_idle`.
"""

from dataclasses import replace
from functools import cache, partial

import numpy as np

from avatarsim.errors import UnknownName
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import solid
from avatarsim.scene.joint import Free, Hinge, Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Piece
from avatarsim.scene.tracker import TrackerSample, rest
from scenarios.building.avatars.humanoid import humanoid
from scenarios.building.avatars.standing import standing
from scenarios.building.stage import floor, wall_ahead
from scenarios.growth.gallery import FRAMES as GALLERY_FRAMES
from scenarios.growth.gallery import MODES as GALLERY_MODES
from scenarios.growth.gallery import gallery, walk
from scenarios.growth.piles import FRAMES as PILE_FRAMES
from scenarios.growth.piles import MODES as PILE_MODES
from scenarios.growth.piles import pile
from scenarios.motion.keyframes import posed
from scenarios.motion.untracked import untracked
from scenarios.scenario import RENDERED, Motion, Scenario

LINKS = (16, 31, 61, 100, 199)
"""Links of the comb: a back, and limbs of three links."""
AVATARS = (1, 3, 10, 30, 100)
"""Avatars in the row, of 15 links each."""
OBJECTS = (20, 200, 2000)
"""Objects in the gallery."""
CONTACTS = (1, 10, 100, 1000)
"""Contact points at one instant, at least."""
SIZES = {"links": LINKS, "avatars": AVATARS, "objects": OBJECTS, "contacts": CONTACTS}
"""What grows, and how far."""
MODES = {"links": ("apart", "contact"), "avatars": ("apart", "contact"), "objects": GALLERY_MODES, "contacts": PILE_MODES}
"""Nothing touches; or most of the time limbs (arms) are in the floor (the wall). Objects: `gallery`; contacts: `piles`."""
FRAMES = 90
"""One and a half seconds: three times into contact and out again."""
JOINTED, APART = 3, 0.09
"""Links of a limb; distance [m] from one limb to the next."""
THICK, LONG = 0.025, 0.1
"""Radius of a limb's links [m] and the length of their straight part."""
DEEP = 0.05
"""How far the user goes into floor or wall [m]."""
FACE = 0.45
"""Where the wall begins before the avatars [m]: a stretched hand reaches well into it."""
ROOM = 1.6
"""Distance between two avatars in the row [m]."""
SWINGS = 3
"""How often the user goes there and back."""
HELD = 1.6
"""The way would end so many times as far as it does: above 1 the user stays at its end, so that most frames are in contact."""


def comb(links: int) -> Avatar:
    """A free back along x and limbs of three links hanging from it, in two rows."""
    limbs = (links - 1) // JOINTED
    long = APART * ((limbs + 1) // 2)
    back = (Piece(Box((long, 0.2, 0.06))),)
    bar = (Piece(Capsule(THICK, LONG), (0.0, 0.0, -0.5 * LONG)),)
    hinge = Hinges((Hinge((1.0, 0.0, 0.0), -0.6, 0.6),))
    found = [Link("back", None, Free(), back, solid(back, 5.0))]
    for limb in range(limbs):
        at = -0.5 * long + APART * (limb // 2 + 0.5)
        parent, anchor = "back", (at, 0.16 if limb % 2 else -0.16, 0.0)
        for k in range(JOINTED):
            name = f"limb_{limb}_{k}"
            found.append(Link(name, parent, hinge, bar, solid(bar, 0.2), anchor=anchor))
            parent, anchor = name, (0.0, 0.0, -LONG - 2.0 * THICK - 0.005)
    # a limb bends beside the back and may rub along it at its root
    beside = tuple(("back", f"limb_{limb}_{k}") for limb in range(limbs) for k in (0, 1))
    tips = tuple(f"limb_{limb}_{JOINTED - 1}" for limb in range(limbs))
    return Avatar("comb", tuple(found), tips, beside, size_range=(0.01, 60.0))


def swing(frame: int) -> float:
    """Share of the way into contact, 0 to 1, held, and back, SWINGS times."""
    return float(min(1.0, HELD * (0.5 - 0.5 * np.cos(2.0 * np.pi * SWINGS * (frame + 1) / FRAMES))))


def comb_scene(links: int, mode: str) -> Scene:
    """The comb 2 cm above the floor, or half a metre higher."""
    avatar = comb(links)
    start = rest((avatar,))
    start.positions[0, 2] = JOINTED * (LONG + 2.0 * THICK + 0.005) + 0.02 + (0.5 if mode == "apart" else 0.0)
    return Scene(f"links_{links}_{mode}", (floor(),), (avatar,), start=start)


def comb_motion(scene: Scene, seed: int) -> Motion:
    """The back bobs; limbs swing sideways, each a little after the one before."""
    start = scene.first_sample
    phases = np.arange(len(start.angles)) * 0.7

    def sample(frame: int) -> TrackerSample:
        positions = start.positions.copy()
        positions[0, 2] -= (DEEP + 0.02) * swing(frame)
        angles = 0.15 * np.sin(2.0 * np.pi * (frame + 1) / FRAMES + phases) * swing(frame)
        return TrackerSample((frame + 1) * RENDERED, positions, start.rotations, angles)

    return sample


def row_scene(count: int, mode: str) -> Scene:
    """Avatars side by side before a wall, or far from it."""
    one = humanoid()
    people = tuple(replace(one, name=f"human_{k}") for k in range(count))
    postures = [standing(one, 0.0, ROOM * (k - 0.5 * (count - 1))) for k in range(count)]
    wall = wall_ahead(FACE + (2.0 if mode == "apart" else 0.0))
    # the floor and the wall of the stage are 20 m wide; a hundred avatars need more
    bodies = tuple(
        replace(body, pieces=(Piece(Box((size[0], max(size[1], ROOM * count + 4.0), size[2]))),))
        for body in (floor(), wall) if isinstance(body.pieces[0].shape, Box) for size in (body.pieces[0].shape.size,)
    )
    return Scene(f"avatars_{count}_{mode}", bodies, people, start=together(postures, 0.0))


def together(postures: list[TrackerSample], time: float) -> TrackerSample:
    """The postures of several avatars as one sample."""
    return TrackerSample(
        time, np.concatenate([p.positions for p in postures]), np.concatenate([p.rotations for p in postures]),
        np.concatenate([p.angles for p in postures]),
    )


def row_motion(scene: Scene, seed: int) -> Motion:
    """Each avatar stretches both arms forward, a little after the one beside it, and takes them back."""
    one, count = scene.avatars[0], len(scene.avatars)
    starts = [standing(one, 0.0, ROOM * (k - 0.5 * (count - 1))) for k in range(count)]

    def reaching(start: TrackerSample, share: float) -> TrackerSample:
        out, lift, bent = 15.0 - 10.0 * share, min(20.0 - 105.0 * share, 0.0), 10.0 + 60.0 * (1.0 - share) * share
        turned = {"left_shoulder": (out, lift, 0.0), "right_shoulder": (-out, lift, 0.0)}
        return posed(one, start, turned, {"left_elbow": (bent,), "right_elbow": (bent,)})

    def sample(frame: int) -> TrackerSample:
        shares = [swing(frame - 2 * (k % 5)) if frame >= 2 * (k % 5) else 0.0 for k in range(count)]
        return together([reaching(start, share) for start, share in zip(starts, shares, strict=True)], (frame + 1) * RENDERED)

    return sample


@cache
def get(name: str) -> Scenario:
    """The scenario called `name`: what grows, how many, in which mode. UnknownName for anything else."""
    known = [f"{what}_{size}_{mode}" for what, sizes in SIZES.items() for size in sizes for mode in MODES[what]]
    if name not in known:
        raise UnknownName("scene of growing size", name, known)
    what, size, mode = name.split("_")
    scene = {"links": comb_scene, "avatars": row_scene, "objects": gallery, "contacts": pile}[what]
    motion = {"links": comb_motion, "avatars": row_motion, "objects": walk, "contacts": untracked()}[what]
    frames = {"objects": GALLERY_FRAMES, "contacts": PILE_FRAMES}.get(what, FRAMES)
    return Scenario(
        name, f"{size} {what}, {mode}.", "Frame time.", partial(scene, int(size), mode), motion, frames,
    )
