"""Starts drawn inside things, and the free postures that they begin at: `python -m tests.nearest_free.drawn_starts`.

Columns: found, distance of the link origins (root mean square) [mm] and that of the nearest posture of `search.nearest`, whose
searches begin at the start, at the found posture and around both; processor time of the search for a free posture [ms].
"""

import argparse
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from avatarsim.free_start import Postures
from avatarsim.model.world import build, posture_of, shown_sample
from avatarsim.pose_queries import deepest_overlaps
from avatarsim.scene.body import Role
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from avatarsim.tolerances import POSTURE_GAP
from scenarios import catalog
from tests.nearest_free import tree as trees
from tests.nearest_free.search import Problem, descend, scattered

SCENES = (
    "arm_in_corner", "arms_through_chest", "avatar_into_wall", "hand_grasp", "hand_in_bowl", "hand_in_corner", "hand_over_table",
    "limit_torture_hinges", "mocap_walk", "mocap_punch_wall", "walk_through_obstacles", "two_arms", "start_inside",
    "singular_chain", "thin_wall_hand", "coincident_centres", "driven_10cm_wall", "pinch_light", "ball_off_table", "arms_lift",
)
AWAY, TURNED = (0.3, 0.3, 0.15), 0.25
"""Largest moves of roots from where a user of the scene has them [m], and the standard deviation of turns of joints [rad]."""

DEEP = 1e-3
"""[m] least depth of a start that counts as inside something."""


@dataclass(frozen=True, eq=False)
class Drawn:
    """A start that overlaps, in a scene whose bodies do not move."""

    scene: Scene
    sample: TrackerSample
    depth: float


def standing(scene: Scene) -> Scene:
    """Return the scene without loose bodies."""
    bodies = tuple(body for body in scene.bodies if body.role is Role.FIXED)
    return Scene(scene.name, bodies, scene.avatars, scene.materials, start=scene.start)


def drawn(name: str, count: int, seed: int) -> Iterator[Drawn]:
    """So many starts inside things of a scene of the catalogue."""
    scenario, random = catalog.get(name), np.random.default_rng((seed, *name.encode()))
    scene = standing(scenario.build())
    motion, tree, found = scenario.motion(scenario.build(), 0), trees.Tree(scene), 0
    for _ in range(200 * count):
        if found == count:
            return
        user = trees.posture_of(motion(int(random.integers(scenario.frames))))
        posture = scattered(tree, user, TURNED, random)
        posture = replace(posture, roots=posture.roots + random.uniform(-1.0, 1.0, posture.roots.shape) * np.array(AWAY))
        sample = TrackerSample(0.0, posture.roots, rotation.from_matrix(posture.turns), posture.angles)
        world = build(replace(scene, start=sample))
        depth = max((one.depth for one in deepest_overlaps(world)), default=0.0)
        if depth >= DEEP:
            found += 1
            yield Drawn(scene, sample, depth)


def nearest_of(one: Drawn, ends: list[trees.Posture], others: int, seed: int) -> float:
    """Return the distance [m] of the nearest posture of the brute-force search; infinite where it finds none."""
    scene, random = one.scene, np.random.default_rng(seed)
    tree, free = trees.Tree(scene), np.full((len(scene.links), 3), np.inf)
    positions = np.array([body.position for body in scene.bodies]).reshape(-1, 3)
    turns = np.array([body.orientation for body in scene.bodies]).reshape(-1, 4)
    user = trees.posture_of(one.sample)
    problem = Problem(scene, tree, positions, turns, user, -free, free)
    starts = [user, *ends, *(scattered(tree, end, 0.2, random) for end in [user, *ends] for _ in range(others))]
    return min((found.offset for found in (descend(problem, start) for start in starts) if found.allowed), default=np.inf)


def offset(one: Drawn, other: trees.Posture) -> float:
    """Return the root mean square distance [m] of the link origins from the start's."""
    tree = trees.Tree(one.scene)
    ways = tree.placed(other).positions - tree.placed(tree.clipped(trees.posture_of(one.sample))).positions
    return float(np.sqrt(np.mean((ways**2).sum(axis=1))))


def main() -> None:
    """Draw, search, and print a row per scene and a line of all."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--count", type=int, default=25)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--others", type=int, default=0, help="scattered starts of the dumb search; -1: none at all")
    parser.add_argument("scenes", nargs="*", default=SCENES)
    asked = parser.parse_args()
    rows = []
    for name in asked.scenes or SCENES:
        own = list[tuple[float, ...]]()
        for number, one in enumerate(drawn(name, asked.count, asked.seed)):
            world = build(replace(one.scene, start=one.sample))
            target = posture_of(world.skeleton, world.hinges, one.sample)
            if not own:
                # kernels are read from disk
                Postures(world).nearest(target, POSTURE_GAP)
            begun = time.process_time()
            is_found = Postures(world).nearest(target, POSTURE_GAP)
            spent = time.process_time() - begun
            is_free = is_found and not deepest_overlaps(world)
            end = trees.posture_of(shown_sample(world, 0.0))
            far = offset(one, end) if is_free else np.inf
            best = np.nan if asked.others < 0 else min(far, nearest_of(one, [end] if is_free else [], asked.others, number))
            own.append((is_free, far, best, spent))
        show(name, np.array(own, dtype=float).reshape(-1, 4))
        rows += own
    show("all", np.array(rows, dtype=float).reshape(-1, 4))


def show(name: str, rows: np.ndarray) -> None:
    """Print the figures of some starts."""
    if not len(rows):
        print(f"{name:24} none drawn")
        return
    found = rows[rows[:, 0] > 0.0]
    ratio = found[:, 1] / np.maximum(found[:, 2], 1e-3)
    print(
        f"{name:24} {len(found):4} of {len(rows):4} found, offset median {1e3 * np.median(found[:, 1]):6.1f} mm, "
        f"ratio p50 {np.median(ratio):5.2f} p95 {np.quantile(ratio, 0.95):5.2f} max {ratio.max():6.2f} "
        f"over 2: {(ratio > 2.0).sum():3}, "
        f"time p50 {1e3 * np.median(rows[:, 3]):5.1f} max {1e3 * rows[:, 3].max():5.1f} ms", flush=True,
    )


if __name__ == "__main__":
    main()
