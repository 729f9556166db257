"""Prints the states of whole frames, scene by scene: compiled, or as plain Python under NUMBA_DISABLE_JIT=1."""

from avatarsim.engine import Settings
from avatarsim.simulator import AvatarsimEngine
from scenarios import catalog

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


def lines() -> list[str]:
    """Return a line per scene, the last of method `paper`."""
    return [*(hashes("default", name, frames) for name, frames in SCENES.items()), hashes("paper", "coach_release", 15)]


if __name__ == "__main__":
    print("\n".join(lines()))
