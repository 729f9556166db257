"""Two hands take a mug from both sides and lift it: what holds it is friction, and the springs that tie hands to their users.

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


def mug() -> av.Body:
    """A mug of 0.3 kg: a prism of 24 sides with a handle."""
    turns = 2.0 * math.pi * np.arange(24) / 24.0
    rim = np.stack([RADIUS * np.cos(turns), RADIUS * np.sin(turns)], axis=-1)
    cup = np.vstack([np.column_stack([rim, np.full(24, z)]) for z in (0.0, HEIGHT)])
    pieces = (av.Piece(av.ConvexHull(cup)), av.Piece(av.Box((0.03, 0.012, 0.06)), (RADIUS + 0.015, 0.0, 0.5 * HEIGHT)))
    return av.simulated("mug", pieces, "clay", av.solid(pieces, 0.3))


def world(bodies: tuple[av.Body, ...], start: av.TrackerSample) -> av.Scene:
    """Two flat hands above a table, and whatever stands on it."""
    palm = (av.Piece(av.Box((0.1, 0.03, 0.09))),)
    hands = tuple(av.rigid_avatar(name, palm, av.solid(palm, 0.5)) for name in ("left", "right"))
    law = {("human", "clay"): av.ContactLaw(0.0, 0.8), ("human", "wood"): av.ContactLaw(0.0, 0.5)}
    rest = {(a, b): av.ContactLaw(0.1, 0.5) for a, b in (("clay", "wood"), ("clay", "clay"), ("human", "human"))}
    table = av.fixed("table", (av.Piece(av.Box((1.0, 1.0, 0.04))),), "wood", (0.0, 0.0, -0.02))
    return av.Scene("mug", (table, *bodies), hands, av.PairTable({**law, **rest}), start=start)


def tracked(frame: int) -> av.TrackerSample:
    """Together within half a second, 2 cm into the mug on each side, then up by 0.2 m within a second."""
    time = frame * DT
    apart = max(0.15 - 0.25 * time, RADIUS + 0.015 - 0.02)
    height = 0.05 + 0.2 * min(max(time - 0.8, 0.0), 1.0)
    places = np.array([[0.0, apart, height], [0.0, -apart, height]])
    return av.TrackerSample(time, places, np.tile([1.0, 0.0, 0.0, 0.0], (2, 1)), np.zeros(0))


def main(frames: int = 150) -> av.FrameRecord:
    """Lift the mug, print what it stands on or is held by, then take it out of the world and put another one there."""
    with av.AvatarsimEngine() as engine:
        record = engine.load(world((mug(),), tracked(0)), av.Settings(), DT)
        for frame in range(1, frames + 1):
            record = engine.advance(tracked(frame), DT)
            if frame % 30 == 0:
                touching = sorted({c.a if c.b == "mug" else c.b for c in engine.contacts() if "mug" in (c.a, c.b)})
                print(f"{record.shown.time:4.1f} s  the mug is at {record.shown.positions[1, 2]:.3f} m, on {', '.join(touching)}")
        lifted = record.shown.positions[1, 2]
        record = engine.change(world((), tracked(0)))
        print(f"lifted by {lifted:.3f} m, and taken away: {len(record.shown.positions)} bodies are left")
    return record


if __name__ == "__main__":
    main()
