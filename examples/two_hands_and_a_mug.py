"""One hand pushes a mug over a table, the other one stops it; then the mug is taken away, and a bowl comes instead.

Shows: several avatars in one sample, materials of one's own, a loose body of several pieces, and bodies that come and go.
Run: python examples/two_hands_and_a_mug.py
"""

import math

import numpy as np

import avatarsim as av

DT = 1.0 / 60.0
"""[s] time of a frame."""
RADIUS, HEIGHT = 0.04, 0.1
"""[m] of the mug."""


def prism(radius: float, height: float) -> av.Piece:
    """Return an upright prism of 24 sides with its base on z = 0."""
    turns = 2.0 * math.pi * np.arange(24) / 24.0
    rim = np.stack([radius * np.cos(turns), radius * np.sin(turns)], axis=-1)
    return av.Piece(av.ConvexHull(np.vstack([np.column_stack([rim, np.full(24, z)]) for z in (0.0, height)])))


def thing(name: str, pieces: tuple[av.Piece, ...], weight: float, x: float) -> av.Body:
    """Return a loose body of clay on the table."""
    return av.simulated(name, pieces, "clay", av.solid(pieces, weight), position=(x, 0.0, 1e-4))


def world(*bodies: av.Body) -> av.Scene:
    """Return a hand on each side above a table, and the bodies on it."""
    palm = (av.Piece(av.Box((0.1, 0.02, 0.09))),)
    hands = tuple(av.rigid_avatar(name, palm, av.solid(palm, 0.5)) for name in ("left", "right"))
    pairs = ("clay", "wood"), ("clay", "human"), ("human", "wood"), ("clay", "clay"), ("human", "human")
    laws = av.PairTable({pair: av.ContactLaw(restitution=0.1, friction=0.4) for pair in pairs})
    table = av.fixed("table", (av.Piece(av.Box((1.0, 1.0, 0.04))),), "wood", (0.0, 0.0, -0.02))
    return av.Scene("mug", (table, *bodies), hands, laws, start=tracked(0))


def tracked(frame: int) -> av.TrackerSample:
    """The left hand moves at 0.2 m/s from y = 0.2 m until the mug is at the right one, which waits, and 5 mm farther."""
    places = np.array([[0.0, max(0.2 - 0.2 * frame * DT, -0.055), 0.06], [0.0, -0.15, 0.06]])
    return av.TrackerSample(frame * DT, places, np.tile([1.0, 0.0, 0.0, 0.0], (2, 1)), np.zeros(0))


def main(frames: int = 150) -> av.FrameRecord:
    """Push the mug, and print where it is, the bodies in contact, and where the pushing hand is; then change it for a bowl."""
    handle = av.Piece(av.Box((0.03, 0.012, 0.06)), (RADIUS + 0.015, 0.0, 0.5 * HEIGHT))
    mug = thing("mug", (prism(RADIUS, HEIGHT), handle), 0.3, 0.0)
    with av.AvatarsimEngine() as engine:
        record = engine.load(world(mug), av.Settings(), DT)
        for frame in range(1, frames + 1):
            record = engine.advance(tracked(frame), DT)
            if frame % 30 == 0:
                touching = sorted({c.a if c.b == "mug" else c.b for c in engine.contacts() if "mug" in (c.a, c.b)})
                y, hand = record.shown.positions[1, 1], record.shown.positions[2, 1]
                print(f"{record.shown.time:4.1f} s  mug at {y:+.3f} m, hand at {hand:+.3f} m, mug touches {', '.join(touching)}")
        record = engine.change(world(thing("bowl", (prism(0.08, 0.05),), 0.4, 0.3)))
        print(f"after the change a bowl is at x = {record.shown.positions[1, 0]:.1f} m, and the hands are where they were")
    return record


if __name__ == "__main__":
    main()
