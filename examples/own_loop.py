"""A loop of one's own, with a window in the browser: a hand reaches into a tower, and the tower falls.

Shows: `av.show` on a loop that keeps real time, the user's own posture as a ghost, and a slider of one's own in the window.
Run: python examples/own_loop.py (needs the extra `view`); the page is at http://127.0.0.1:8080
"""

import math
import time

import numpy as np

import avatarsim as av

DT = 1.0 / 60.0
"""[s] time of a frame."""
EDGE = 0.06
"""[m] of a brick."""


def tracked(frame: int, reach: float) -> av.TrackerSample:
    """Return where the user's hand is; a program with a tracker returns its last sample. `reach` [m] is how far it goes."""
    x = -0.3 + reach * 0.5 * (1.0 - math.cos(0.5 * math.pi * frame * DT))
    return av.TrackerSample(frame * DT, np.array([[x, 0.0, 0.2]]), av.from_xyzw([[0.0, 0.0, 0.0, 1.0]]), np.zeros(0))


def world() -> av.Scene:
    """Return five bricks on a table, and a fist."""
    brick, fist = (av.Piece(av.Box((EDGE, EDGE, EDGE))),), (av.Piece(av.Sphere(0.04)),)
    table = av.fixed("table", (av.Piece(av.Box((1.0, 1.0, 0.04)), (0.0, 0.0, -0.02)),), "wood")
    tower = [
        av.simulated(f"brick{k}", brick, "wood", av.solid(brick, 0.1), position=(0.0, 0.0, (k + 0.5) * EDGE)) for k in range(5)
    ]
    return av.Scene("tower", (table, *tower), (av.rigid_avatar("hand", fist, av.solid(fist, 0.5)),), start=tracked(0, 0.0))


def main(frames: int = 1200, port: int = 8080, opens_browser: bool = True) -> av.FrameRecord:
    """Advance in real time, and show each frame."""
    with av.AvatarsimEngine() as engine:
        record = engine.load(world(), av.Settings(), DT)
        with av.show(engine, port=port, opens_browser=opens_browser) as window:
            reach = window.server.gui.add_slider("reach [m]", min=0.0, max=0.6, step=0.01, initial_value=0.5)
            due = time.monotonic()
            for frame in range(1, frames + 1):
                sample = tracked(frame, reach.value)
                record = engine.advance(sample, DT)
                window.sync(record, sample)
                due += DT
                time.sleep(max(0.0, due - time.monotonic()))
    fallen = sum(place[2] < 0.5 * EDGE + 0.01 for place in record.shown.positions[1:6])
    print(f"after {record.shown.time:.1f} s {fallen} of 5 bricks lie on the table")
    return record


if __name__ == "__main__":
    main()
