"""An operator drives an arm into a table, and the Shield stops it above, within its limits of speed and acceleration.

Shows: a robot from a file of one's own, goals of its tool, and `av.Shield`, with the time that a call takes.
Run: python examples/shield_for_an_arm.py (needs the extra `assets`)
"""

import statistics
import tempfile
import time
from pathlib import Path

import numpy as np

import avatarsim as av

ARM = """<mujoco><worldbody>
  <geom name="table" type="box" pos=".6 0 -.02" size=".5 .5 .02"/>
  <body name="base" pos="0 0 .1">
    <joint name="turn" axis="0 0 1" range="-170 170"/> <geom type="capsule" fromto="0 0 0 0 0 .2" size=".05"/>
    <body name="upper" pos="0 0 .25">
      <joint name="shoulder" axis="0 1 0" range="-30 120"/> <geom type="capsule" fromto=".08 0 0 .4 0 0" size=".04"/>
      <body name="lower" pos=".45 0 0">
        <joint name="elbow" axis="0 1 0" range="-20 150"/> <geom type="capsule" fromto=".06 0 0 .3 0 0" size=".035"/>
        <body name="tool" pos=".4 0 0">
          <joint name="wrist" axis="0 1 0" range="-110 110"/> <geom type="sphere" size=".03"/>
        </body></body></body></body>
</worldbody></mujoco>"""
"""Four hinges over a table; any MJCF or URDF file does, with its meshes."""
RATE, SPEED, ACCELERATION = 250.0, 2.0, 10.0
"""Calls a second; [rad/s] and [rad/s^2] limits of each joint."""


def main(seconds: float = 3.0) -> list[np.ndarray]:
    """Lead the tool down through the table and along it; print its lowest height, the speed of joints, the time of a call."""
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "arm.xml").write_text(ARM, encoding="utf-8")
        model = av.load_avatar(str(Path(folder, "arm.xml")))
    shield = av.Shield(model, rate=RATE, speed_limits=SPEED, acceleration_limits=ACCELERATION)
    wanted = model.at({"shoulder": -0.4, "elbow": 1.2})
    rows, times, lowest = [shield(wanted)], [], 0.0
    for k in range(int(seconds * RATE)):
        passed = k / RATE  # [s]; in the first 0.5 m down, to 0.2 m below the top of the table, in the next 0.3 m aside
        goal = (0.6, 0.3 * min(max(0.0, passed - 1.0), 1.0), 0.3 - 0.5 * min(passed, 1.0))
        wanted = model.reach({"tool": goal}, start=wanted)
        lowest = min(lowest, float(model.pose(wanted)["tool"][0][2]))
        begun = time.perf_counter()
        rows.append(shield(wanted))
        times.append(time.perf_counter() - begun)
    q = np.array(rows)
    speed, change = np.diff(q, axis=0) * RATE, np.diff(q, n=2, axis=0) * RATE**2
    shown = min(float(model.pose(row)["tool"][0][2]) for row in q)
    print(f"the operator's tool was led down to {1e3 * lowest:.0f} mm, the robot's stayed at {1e3 * shown:.0f} mm and above")
    print(f"joints kept to {np.abs(speed).max():.2f} rad/s, and to {np.abs(change).max():.2f} rad/s^2")
    print(f"a call took {1e6 * statistics.median(times):.0f} us (median)")
    return rows


if __name__ == "__main__":
    main()
