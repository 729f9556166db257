"""Prints the states of whole frames, scene by scene: compiled, or as plain Python under NUMBA_DISABLE_JIT=1."""

import hashlib

import numpy as np

import avatarsim as av
from avatarsim.engine import Settings
from avatarsim.simulator import AvatarsimEngine
from scenarios import catalog
from tests.cleaning.rooms import FLOOR, RATE, lowered, model, swinging

SCENES = {
    "arm_in_corner": 24, "arms_through_chest": 20, "carried_mug": 4, "closing_door": 16, "coins": 5, "coupling_sweep": 24,
    "dominoes": 3, "door_and_boxes": 8, "elastic_20s": 40, "hand_grasp": 8, "hand_in_corner": 8, "heap_50": 4,
    "incline_tips": 12, "lift": 12, "limit_torture": 8, "log_roll": 16, "mocap_getup_floor": 16, "mocap_walk_wall": 24,
    "mug_in_fingers": 8, "painleve": 8, "parallel_link": 16, "press_coin": 8, "slide_to_roll": 16, "start_inside": 3,
    "superball": 24, "tray": 10, "tunnelling": 10, "turntable": 6, "walk_through_obstacles": 32, "worn_floor": 6, "zeno": 24,
}
"""Scene -> frames, about a quarter of a second each as plain Python; together they run most of the kernels' lines."""


def hashes(preset: str, name: str, frames: int) -> str:
    """Return the hashes of the states of a scene's first frames."""
    scenario = catalog.get(name).as_run(False)
    scene = scenario.build()
    motion, engine = scenario.motion(scene, 0), AvatarsimEngine()
    states = [engine.load(scene, Settings(preset), scenario.dt)]
    states += [engine.advance(motion(k), scenario.dt) for k in range(frames)]
    return " ".join([preset, name, *(state.state_hash() for state in states)])


def cleaned() -> str:
    """Return the hash of a walk into the floor and out again, as a stream with limits of its rates and as a whole."""
    walk = lowered(swinging(24, 0.0), 0.5 - 0.25 * np.exp(-(((np.arange(24) - 12) / 4.0) ** 2)))
    shield = av.Shield(model(), (FLOOR,), RATE, speed_limits=1.0, acceleration_limits=10.0)
    streamed = np.array([shield(row) for row in shield.coordinates.rows(walk)])
    whole = av.clean(walk, model(), (FLOOR,)).motion
    return hashlib.blake2b(streamed.tobytes() + whole.positions.tobytes() + whole.angles.tobytes(), digest_size=8).hexdigest()


def lines() -> list[str]:
    """Return a line per scene, one of method `paper` and one of cleaning."""
    scenes = [hashes("default", name, frames) for name, frames in SCENES.items()]
    return [*scenes, hashes("paper", "coach_release", 15), cleaned()]


if __name__ == "__main__":
    print("\n".join(lines()))
