"""Variants run only in the scenes of their condition."""

import pytest

from runfiles.engines import about
from scenarios.__main__ import parser
from scenarios.cli.plan import plan, scenarios
from scenarios.engines import opened, variants_of
from scenarios.job import Job
from scenarios.run.accuracy import prepare

CASES: list[tuple[str, str, str, set[str]]] = [
    ("mujoco", "sleeping", "tuned", {"sleep"}),
    ("mujoco", "servos", "tuned", {"drive", "integrator", "contact", "contact_steps", "motor_force", "weld_time", "welds"}),
    ("mujoco", "hinges", "tuned", {"ball_joints"}),
    ("pybullet", "sleeping", "tuned", {"sleep"}),
    ("pybullet", "follows", "default", {"feed_forward", "ball_gain"}),
    ("rapier", "sleeping", "tuned", {"sleep"}),
    ("rapier", "multibody", "tuned", {"reduced_coordinates"}),
]
"""Engine, variant, the preset that it changes, and the changed settings."""


@pytest.mark.parametrize(("variants", "among", "not_among", "most"), [
    ([(engine, "sleeping") for engine in ("mujoco", "pybullet", "rapier")],
     {"stack_ten", "rest_ten_minutes", "heavy_on_light", "hand_over_table"},
     {"two_arms", "mocap_punch_wall", "mocap_run", "free_flight", "hand_in_corner"}, 20),
    ([("mujoco", "servos"), ("pybullet", "follows")], {"mocap_run", "mocap_punch_wall", "unseen_door"},
     {"hand_over_table", "ball_drop", "hand_in_corner", "stack_ten"}, 30),
    ([("rapier", "multibody")], {"hand_in_corner", "hand_grasp", "limit_torture_hinges"}, {"stack_ten", "two_arms"}, 20),
    ([("mujoco", "hinges")], {"unseen_door", "mocap_run", "two_arms"}, {"hand_over_table", "stack_ten"}, 45),
])
def test_scenes_of_a_variant(variants: list[tuple[str, str]], among: set[str], not_among: set[str], most: int) -> None:
    for engine, name in variants:
        found = {scene for scene, scenario in scenarios("compare").items() if name in variants_of(engine, scenario, ())}
        assert among <= found and not not_among & found and len(found) < most


@pytest.mark.parametrize(("engine", "name", "base", "changed"), CASES)
def test_every_variant_differs_from_its_base_in_its_settings(engine: str, name: str, base: str, changed: set[str]) -> None:
    made = opened(engine)
    assert base in made.presets
    # a body on a wall follows; a stack rests
    where = "stack_ten" if name == "sleeping" else "driven_10cm_wall"
    prepared = prepare(Job(where, engine, name))
    found = {}
    for preset in (base, name):
        made.load(prepared.scene, Job(where, engine, preset).settings(made), prepared.scenario.dt)
        found[preset] = {key: one[0] if isinstance(one, tuple) else one for key, one in made.settings_as_run().items()}
    made.close()
    differs = {key for key in found[name] if key in found[base] and found[base][key] != found[name][key]}
    assert {key for key in differs if " " not in key or key == "dt as run"} == changed | {"optimises"}


@pytest.mark.parametrize(("words", "runs"), [
    (("compare", "--filter", "mocap_run"), {("mocap_run", "servos"), ("mocap_run", "hinges")}),
    (("compare", "--filter", "stack_ten,zeno,two_arms"),
     {("stack_ten", "sleeping"), ("zeno", "sleeping"), ("two_arms", "hinges")}),
    (("compare", "--filter", "stack_ten", "--preset", "tuned"), set()),
    (("run", "stack_ten"), set()),
    (("run", "stack_ten", "--preset", "sleeping"), {("stack_ten", "sleeping")}),
    (("bench", "--filter", "stack_ten"), set()),
])
def test_variants_run_in_a_comparison_or_by_name(words: tuple[str, ...], runs: set[tuple[str, str]]) -> None:
    options = parser().parse_args([*words, "--engine", "mujoco", "--jobs", "0"])
    jobs = plan(options, options.engine, False).jobs
    assert {(job.scenario, job.preset) for job in jobs if job.preset in about("mujoco").variants} == runs
