"""Invariance of verdicts: a recording that is moved, rotated, or has another order of bodies gets equal verdicts.

This needs no reference result, so real runs can be used: of the engine, and of the raw tracker, which has deep overlaps.
"""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from avatarsim.engine import Settings
from avatarsim.scene.scene import Scene
from avatarsim.spatial import rotation
from runfiles.record import Recording
from scenarios import catalog
from scenarios.building.expected import Course, OfTime, Stop
from scenarios.engines import opened
from scenarios.job import Job
from scenarios.measure.everything import measured
from scenarios.measure.known import Known
from scenarios.measure.value import Missing
from scenarios.run.accuracy import gathered
from scenarios.scenario import Region, Scenario
from scenarios.studies.hard_cases.elsewhere import Elsewhere

RUNS = [
    ("avatarsim", "squeeze", 60), ("tracker", "squeeze", 60), ("tracker", "arms_through_chest", 30),
    ("tracker", "limit_torture_hinges", 12), ("tracker", "reach_cone_edges", 20), ("avatarsim", "bounce_ladder", 45),
    ("avatarsim", "stop_distance", 60), ("avatarsim", "oblique_bounce", 30), ("avatarsim", "stack_ten", 45),
    ("avatarsim", "dzhanibekov", 100), ("avatarsim", "two_spheres", 20), ("avatarsim", "falling_rod", 75),
    ("tracker", "hand_in_bowl", 60), ("tracker", "deep_overlap", 3), ("tracker", "coincident_start", 2),
]
QUARTER = tuple(rotation.from_axis_angle((0.0, 0.0, 1.0), 0.5 * np.pi).tolist())
ASKEW = tuple(rotation.from_axis_angle((0.48, -0.6, 0.64), 2.0).tolist())
WORDS = ("frame_time", "_per_frame")


@cache
def run(engine: str, name: str, frames: int) -> tuple[Scenario, Scene, Recording]:
    """Return a run as recorded by the harness."""
    scenario = replace(catalog.get(name).as_run(False), frames=frames)
    scene = scenario.build()
    motion, running = scenario.motion(scene, 0), opened(engine)
    samples = [motion(k) for k in range(frames)]
    shown = [running.load(scene, Settings(record_inside=True), scenario.dt)]
    shown += [running.advance(sample, scenario.dt) for sample in samples]
    return scenario, scene, gathered(Job(name, engine, "default"), scenario, scene, [scene.first_sample, *samples], shown, {})


def sent(recording: Recording, there: Elsewhere) -> Recording:
    """Return a recording moved to the place: the inverse of moving it back."""
    return replace(
        recording, positions=there.place(recording.positions), orientations=there.turned(recording.orientations),
        velocities=there.along(recording.velocities), raw_positions=there.place(recording.raw_positions),
        angular_velocities=rotation.rotate(np.array(there.turn), recording.angular_velocities),
        raw_orientations=there.turned(recording.raw_orientations), inside_positions=there.place(recording.inside_positions),
        inside_orientations=there.turned(recording.inside_orientations),
        inside_velocities=there.along(recording.inside_velocities),
        inside_angular_velocities=rotation.rotate(np.array(there.turn), recording.inside_angular_velocities),
    )


def quarter(region: Region, there: Elsewhere) -> Region:
    """Return a region after a quarter turn about z and a translation: x becomes y, y becomes minus x."""
    (x, y, z), (xx, yy, zz), (ox, oy, oz) = region.low, region.high, there.origin
    return replace(region, low=(ox - yy, oy + x, oz + z), high=(ox - y, oy + xx, oz + zz))


def asked(scenario: Scenario, there: Elsewhere, regions: tuple[Region, ...]) -> Scenario:
    """Return the scenario with its closed forms at the new place."""

    def place(form: OfTime | None) -> OfTime | None:
        return None if form is None else lambda time: there.place(form(time)).tolist()

    def along(form: OfTime | None) -> OfTime | None:
        return None if form is None else lambda time: there.along(form(time)).tolist()

    expects: dict[str, object] = dict(scenario.expects)
    courses, stops = expects.get("courses", ()), expects.get("stops", ())
    assert isinstance(courses, tuple) and isinstance(stops, tuple)
    if courses:
        expects["courses"] = tuple(
            replace(c, position=place(c.position), velocity=along(c.velocity), spin=along(c.spin))
            for c in courses if isinstance(c, Course)
        )
    if stops:
        expects["stops"] = tuple(
            replace(s, direction=tuple(there.along(s.direction).tolist())) for s in stops if isinstance(s, Stop)
        )
    return replace(scenario, expects=expects, regions=regions)


def same(found: Mapping[str, object], wanted: Mapping[str, object], tolerance: float) -> None:
    """Assert that every figure and every missing one agree, except times and counts of work."""
    assert set(found) == set(wanted) and wanted
    for metric, value in wanted.items():
        if isinstance(value, Missing):
            assert found[metric] == value
        elif not any(word in metric for word in WORDS):
            assert found[metric] == pytest.approx(value, rel=1e-5, abs=tolerance, nan_ok=True), metric


@pytest.mark.parametrize("there", [Elsewhere(1.0, QUARTER, (3.0, -2.0, 0.5)), Elsewhere(1.0, ASKEW, (0.7, 0.2, -0.4))])
@pytest.mark.parametrize(("engine", "name", "frames"), RUNS)
def test_moved_and_turned(engine: str, name: str, frames: int, there: Elsewhere) -> None:
    scenario, scene, recording = run(engine, name, frames)
    # a region is a box along the axes, and stays one only after quarter turns
    regions = tuple(quarter(region, there) for region in scenario.regions) if there.turn == QUARTER else ()
    plain = scenario if there.turn == QUARTER else replace(scenario, regions=())
    wanted = measured(recording, Known(plain, scene))
    found = measured(sent(recording, there), Known(asked(scenario, there, regions), there.scene(scene)))
    same(found.values, wanted.values, 1e-8)
    np.testing.assert_allclose(found.overlap, wanted.overlap, atol=1e-8)


@pytest.mark.parametrize(("engine", "name", "frames"), RUNS)
def test_bodies_in_another_order(engine: str, name: str, frames: int) -> None:
    """The order is reversed, so that A of each pair of bodies becomes B."""
    scenario, scene, recording = run(engine, name, frames)
    bodies, links = len(scene.bodies), len(scene.links)
    order = [*range(bodies - 1, -1, -1), *range(bodies, bodies + links)]
    fields = ("positions", "orientations", "velocities", "angular_velocities")
    arrays = {field: getattr(recording, field)[:, order] for field in (*fields, *(f"inside_{field}" for field in fields))}
    turned = replace(recording, meta={**recording.meta, "names": [scene.names[k] for k in order]}, **arrays)
    found = measured(turned, Known(scenario, replace(scene, bodies=scene.bodies[::-1])))
    same(found.values, measured(recording, Known(scenario, scene)).values, 1e-9)


def test_a_verdict_that_should_change_does() -> None:
    """Otherwise the checks above would prove nothing: gravity that is not rotated with the world no longer explains a fall."""
    scenario, scene, recording = run("avatarsim", "bounce_ladder", 45)
    there = Elsewhere(1.0, ASKEW)
    wrong = replace(there.scene(scene), gravity=scene.gravity)
    found = measured(sent(recording, there), Known(replace(scenario, regions=()), wrong)).values["energy_added_max"]
    assert isinstance(found, float) and found > 0.1
