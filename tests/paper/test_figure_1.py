"""Figure 1: a ball is snipped over a table with a finger, causing it to roll off. The hand of Figure 7 does it."""

import numpy as np

from scenarios.building.gallery import TABLE_HEIGHT
from scenarios.catalog.paper.hand_over_table import BALL_RADIUS
from tests.coupling.scenes import deepest
from tests.paper.scene_run import scene_run


def test_the_ball_rolls_over_the_table_and_off_it() -> None:
    scene, records = scene_run("hand_over_table")
    ball = scene.names.index("ball")
    height = np.array([record.shown.positions[ball, 2] for record in records])
    speed = np.array([record.shown.velocities[ball] for record in records])
    spin = np.array([record.shown.angular_velocities[ball] for record in records])
    moving = np.linalg.norm(speed, axis=1) > 1e-3
    on_table = height > TABLE_HEIGHT + BALL_RADIUS - 1e-3
    assert not moving[: int(0.9 * len(records))].any() and on_table[0] and not on_table[-1]
    # it leaves the table rolling: no slip at its lowest point, v = w x r
    last = int(np.flatnonzero(on_table)[-1])
    lowest = speed[last] + np.cross(spin[last], (0.0, 0.0, -BALL_RADIUS))
    assert np.linalg.norm(speed[last, :2]) > 0.5 and np.linalg.norm(lowest[:2]) < 1e-6


def test_nothing_overlaps_while_the_ball_is_pushed() -> None:
    scene, records = scene_run("hand_over_table")
    assert deepest(scene, records[int(0.9 * len(records)) :]) <= 1e-6
