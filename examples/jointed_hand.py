"""A hand of hinged fingers closes on a bar: each finger stops where it touches, while its user makes a fist.

Shows: links and hinges with limits, and a posture as the angles of a tracker sample.
Run: python examples/jointed_hand.py
"""

import math

import numpy as np

import avatarsim as av

DT = 1.0 / 60.0
"""[s] time of a frame."""
BONES = (0.045, 0.03, 0.022)
"""[m] lengths of the bones of a finger, from the palm on."""
BEND = math.radians(80.0)
"""[rad] how far the user bends every joint."""


def finger(name: str, y: float, thickness: float) -> list[av.Link]:
    """Return three bones along x, each of which bends towards -z, about y."""
    links, parent, anchor = [], "palm", (0.05, y, 0.0)
    for number, length in enumerate(BONES):
        bone = (av.capsule_between((0.0, 0.0, 0.0), (length, 0.0, 0.0), thickness),)
        hinge = av.Hinge((0.0, 1.0, 0.0), lower=-0.2, upper=math.radians(100.0))
        link = av.Link(f"{name}{number}", parent, av.Hinges((hinge,)), bone, av.solid(bone, 0.02), anchor=anchor)
        links.append(link)
        parent, anchor = link.name, (length, 0.0, 0.0)
    return links


def hand() -> av.Avatar:
    """Return a palm with four fingers."""
    palm = (av.Piece(av.Box((0.09, 0.09, 0.025))),)
    links = [av.Link("palm", None, av.Free(), palm, av.solid(palm, 0.4))]
    for name, y in (("index", 0.034), ("middle", 0.011), ("ring", -0.011), ("little", -0.034)):
        links += finger(name, y, 0.009)
    # the first bones begin inside the palm, and neighbours all but touch
    return av.Avatar("hand", tuple(links), ignore=tuple(("palm", link.name) for link in links[1:] if link.name.endswith("0")))


def tracked(avatar: av.Avatar, time: float, share: float) -> av.TrackerSample:
    """Return the user's hand with every joint bent by a share of a fist."""
    sample = av.rest((avatar,), time)
    return av.TrackerSample(time, sample.positions, sample.rotations, np.full(avatar.hinge_count, share * BEND))


def main(frames: int = 60) -> av.FrameRecord:
    """Close the hand within a second, and print how far the user and the shown hand have bent each joint of a finger."""
    avatar = hand()
    bar = av.fixed("bar", (av.capsule_between((0.07, -0.15, -0.04), (0.07, 0.15, -0.04), 0.016),), "metal")
    scene = av.Scene("grasp", (bar,), (avatar,), start=tracked(avatar, 0.0, 0.0))
    with av.AvatarsimEngine() as engine:
        record = engine.load(scene, av.Settings(), DT)
        for frame in range(1, frames + 1):
            record = engine.advance(tracked(avatar, frame * DT, min(1.0, frame / 60.0)), DT)
        touching = sorted({contact.b for contact in engine.contacts() if contact.a == "bar"})
    print(f"the user bends every joint by {math.degrees(min(1.0, frames / 60.0) * BEND):.0f} degrees")
    for name, angles in zip(("index", "middle", "ring", "little"), record.angles.reshape(4, 3), strict=True):
        print(f"{name:>7} is shown at " + ", ".join(f"{math.degrees(angle):5.1f}" for angle in angles) + " degrees")
    print(f"{len(touching)} links touch the bar: {', '.join(touching)}")
    return record


if __name__ == "__main__":
    main()
