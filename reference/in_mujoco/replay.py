"""Play a tracked motion in MuJoCo and print depth and time, with MuJoCo and numpy only.

python replay_mujoco.py MODEL.xml.gz MODEL.steps.npz
"""

import gzip
import sys
import time
from pathlib import Path

import mujoco
import numpy as np


def main(model_file: Path, steps_file: Path) -> None:
    """Advance the model by all steps, each with the mocap poses and controls that the file has for it."""
    model = mujoco.MjModel.from_xml_string(gzip.decompress(model_file.read_bytes()).decode())
    data, steps, deepest, spent = mujoco.MjData(model), np.load(steps_file), 0.0, []
    mujoco.mj_resetDataKeyframe(model, data, 0)
    for positions, rotations, controls in zip(steps["mocap_pos"], steps["mocap_quat"], steps["ctrl"], strict=True):
        data.mocap_pos[:], data.mocap_quat[:], data.ctrl[:] = positions, rotations, controls
        begun = time.perf_counter()
        mujoco.mj_step(model, data)
        spent.append(time.perf_counter() - begun)
        # [m], of MuJoCo's own contacts, sub-steps included
        deepest = max([deepest, *(-data.contact.dist)])
    frames = np.reshape(spent, (-1, int(steps["steps_per_frame"]))).sum(axis=1)
    print(f"deepest {1e3 * deepest:.6g} mm; median frame {1e6 * np.median(frames):.4g} us; qpos ends at {data.qpos}")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
