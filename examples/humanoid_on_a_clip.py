"""A humanoid walks into a wall: its user goes on through it, the body that is shown stops, and then finds a way around.

Shows: ball joints with swing and twist limits, a clip as one tracker sample per frame, and the record of waiting.
Run: python examples/humanoid_on_a_clip.py
"""

import math

import numpy as np

import avatarsim as av

DT = 1.0 / 60.0
"""[s] time of a frame."""
DOWN = (0.0, 0.0, -1.0)
"""Direction of hanging limbs."""
# name, parent, joint's centre in the parent [m], length [m], radius [m], weight [kg]; limbs hang down, the trunk is upright
LIMBS = (
    ("upper arm", "trunk", (0.0, 0.21, 0.42), 0.28, 0.045, 2.0), ("forearm", "upper arm", (0.0, 0.0, -0.3), 0.24, 0.035, 1.5),
    ("thigh", "pelvis", (0.0, 0.1, -0.08), 0.38, 0.07, 8.0), ("shin", "thigh", (0.0, 0.0, -0.42), 0.38, 0.05, 4.0),
)


def humanoid() -> av.Avatar:
    """Return a body of eleven links: pelvis, trunk, head, and two arms and two legs of two links each."""
    cone = av.SwingTwist(DOWN, DOWN, swing=2.0, twist=(-1.0, 1.0))
    upright = av.SwingTwist((0.0, 0.0, 1.0), (0.0, 0.0, 1.0), swing=0.6, twist=(-0.7, 0.7))
    pelvis, trunk, head = ((av.Piece(shape, (0.0, 0.0, z)),) for shape, z in (
        (av.Box((0.16, 0.28, 0.16)), 0.0), (av.Box((0.18, 0.3, 0.4)), 0.22), (av.Sphere(0.11), 0.12),
    ))
    links = [
        av.Link("pelvis", None, av.Free(), pelvis, av.solid(pelvis, 12.0)),
        av.Link("trunk", "pelvis", av.Ball(upright), trunk, av.solid(trunk, 28.0), anchor=(0.0, 0.0, 0.1)),
        av.Link("head", "trunk", av.Ball(upright), head, av.solid(head, 5.0), anchor=(0.0, 0.0, 0.45)),
    ]
    for side, sign in (("left", 1.0), ("right", -1.0)):
        for name, parent, (x, y, z), length, radius, weight in LIMBS:
            pieces = (av.Piece(av.Capsule(radius, length), (0.0, 0.0, -0.5 * length)),)
            bends = av.Hinges((av.Hinge((0.0, -1.0 if name == "forearm" else 1.0, 0.0), 0.0, 2.4),))
            joint = bends if name in ("forearm", "shin") else av.Ball(cone)
            above = parent if parent in ("pelvis", "trunk") else f"{side} {parent}"
            links.append(av.Link(f"{side} {name}", above, joint, pieces, av.solid(pieces, weight), anchor=(x, sign * y, z)))
    return av.Avatar("walker", tuple(links))


def clip(avatar: av.Avatar, frame: int) -> av.TrackerSample:
    """Return a walk along x at 1 m/s: thighs and arms swing against each other, knees and elbows bend a little."""
    time = frame * DT
    swing = 0.45 * math.sin(2.0 * math.pi * 0.9 * time)
    sample = av.rest((avatar,), time)
    sample.positions[0] = (time, 0.0, 1.0)
    for place, link in enumerate(avatar.links):
        if link.name.endswith(("thigh", "upper arm")):
            turn = swing if link.name in ("left thigh", "right upper arm") else -swing
            sample.rotations[place] = (math.cos(0.5 * turn), 0.0, -math.sin(0.5 * turn), 0.0)
    sample.angles[:] = 0.3 - 0.2 * np.cos(2.0 * math.pi * 1.8 * time)
    return sample


def room(avatar: av.Avatar, start: av.TrackerSample) -> av.Scene:
    """Return the body before a wall across its way at x = 1.5 m."""
    wall = av.fixed("wall", (av.Piece(av.Box((0.1, 3.0, 2.5))),), "wood", (1.5, 0.0, 1.25))
    return av.Scene("walk", (wall,), (avatar,), start=start)


def main(frames: int = 180) -> av.FrameRecord:
    """Play the clip, and print how far the user is and how far the body is shown."""
    avatar = humanoid()
    with av.AvatarsimEngine() as engine:
        record = engine.load(room(avatar, clip(avatar, 0)), av.Settings(), DT)
        for frame in range(1, frames + 1):
            record = engine.advance(clip(avatar, frame), DT)
            if frame % 30 == 0:
                touching = sorted({contact.b.partition("/")[2] for contact in engine.contacts() if contact.a == "wall"})
                shown, state = record.shown.positions[1, 0], ", ".join((*touching, *record.statuses)) or "free"
                print(f"{record.shown.time:4.1f} s  user at x = {frame * DT:.2f} m  shown at {shown:.2f} m  {state}")
    return record


if __name__ == "__main__":
    main()
