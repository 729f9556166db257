"""A rigid hand over a table: it stops where it touches, and pushes a ball off.

Shows: bodies, a driven body without joints, one frame after the other, and the contacts of a frame.
Run: python examples/rigid_hand.py
"""

import numpy as np

import avatarsim as av

DT = 1.0 / 60.0
"""[s] time of a frame."""


def world() -> av.Scene:
    """Return a hand of two pieces above a wooden table, on which a metal ball lies."""
    hand = (av.Piece(av.Box((0.09, 0.1, 0.03))), av.capsule_between((0.03, 0.04, 0.0), (0.09, 0.04, 0.0), 0.012))
    ball = (av.Piece(av.Sphere(0.05)),)
    table = av.fixed("table", (av.Piece(av.Box((1.0, 1.0, 0.04))),), "wood", position=(0.0, 0.0, -0.02))
    loose = av.simulated("ball", ball, "metal", av.solid(ball, 0.4), position=(0.2, 0.0, 0.05))
    return av.Scene("hand", (table, loose), (av.rigid_avatar("hand", hand, av.solid(hand, 0.5)),), start=tracked(0))


def tracked(frame: int) -> av.TrackerSample:
    """Return where the user's hand is: down into the table within a second, then along it towards the ball."""
    down, along = min(frame, 60) / 60.0, max(frame - 60, 0) / 60.0
    place = np.array([[-0.2 + 0.3 * along, 0.0, 0.3 - 0.35 * down]])
    return av.TrackerSample(frame * DT, place, np.array([[1.0, 0.0, 0.0, 0.0]]), np.zeros(0))


def main(frames: int = 180) -> av.FrameRecord:
    """Play the scene, and print where the user's hand was, where it was shown, and the bodies that touched."""
    scene = world()
    with av.AvatarsimEngine() as engine:
        record = engine.load(scene, av.Settings(), DT)
        for frame in range(1, frames + 1):
            record = engine.advance(tracked(frame), DT)
            if frame % 30 == 0:
                touching = {f"{contact.a}-{contact.b}" for contact in engine.contacts()}
                user, shown = tracked(frame).positions[0, 2], record.shown.positions[2, 2]
                print(f"{record.shown.time:4.1f} s  user {user:+.3f} m  shown {shown:+.4f} m  {', '.join(sorted(touching))}")
    speed = float(np.linalg.norm(record.shown.velocities[1]))
    print(f"the ball is at x = {record.shown.positions[1, 0]:.3f} m and rolls at {speed:.2f} m/s")
    return record


if __name__ == "__main__":
    main()
