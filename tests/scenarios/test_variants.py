"""Rows beside presets run in the scenes of their question, and nowhere else."""

import pytest

from avatarsim.errors import UnknownName
from runfiles.engines import about, engines
from scenarios import catalog
from scenarios.__main__ import main, parser
from scenarios.cli.plan import plan, scenarios
from scenarios.engines import opened, variants_of
from scenarios.job import Job
from scenarios.run.accuracy import prepare

CASES: list[tuple[str, str, str, set[str]]] = [
    ("mujoco", "sleeping", "tuned", {"sleep"}),
    ("mujoco", "servos", "tuned", {
        "drive", "integrator", "contact", "contact_steps", "motor_force",
        "weld_time", "welds",
    }),
    ("mujoco", "hinges", "tuned", {"ball_joints"}),
    ("pybullet", "sleeping", "tuned", {"sleep"}),
    ("pybullet", "follows", "default", {"feed_forward", "ball_gain"}),
]
"""Engine, variant, the preset that it changes, and the settings that differ."""


@pytest.mark.parametrize("engine", ["mujoco", "pybullet"])
def test_others_sleep_where_bodies_rest_and_in_everyday_scenes_with_loose_bodies(engine: str) -> None:
    taking_part = {name for name, scenario in catalog.scenarios().items() if "sleeping" in variants_of(engine, scenario, ())}
    assert {"stack_ten", "rest_ten_minutes", "heavy_on_light", "hand_over_table"} <= taking_part and len(taking_part) < 20
    assert not taking_part & {"two_arms", "mocap_punch_wall", "mocap_run", "free_flight", "hand_in_corner"}
    assert list(variants_of("pybullet", catalog.get("mocap_run"), ())) == ["follows"]


def test_a_variant_that_is_not_asked_for_does_not_run() -> None:
    stack = catalog.get("stack_ten")
    assert list(variants_of("mujoco", stack, ["tuned"])) == []
    assert list(variants_of("mujoco", stack, ["sleeping"])) == ["sleeping"]


@pytest.mark.parametrize(("engine", "name", "base", "changed"), CASES)
def test_every_variant_loads_and_says_what_differs_from_its_base(engine: str, name: str, base: str, changed: set[str]) -> None:
    made = opened(engine)
    # a body on a wall is what follows; a stack is what rests
    where = "stack_ten" if name == "sleeping" else "driven_10cm_wall"
    prepared = prepare(Job(where, engine, name))
    told = {}
    for preset in (base, name):
        made.load(prepared.scene, Job(where, engine, preset).settings(made), prepared.scenario.dt)
        told[preset] = {key: value[0] if isinstance(value, tuple) else value for key, value in made.settings_as_run().items()}
    made.close()
    differs = {key for key in told[name] if key in told[base] and told[base][key] != told[name][key]}
    assert {key for key in differs if " " not in key or key == "dt as run"} == changed | {"optimises"}


def test_every_variant_has_a_base_that_its_engine_has() -> None:
    every = {(engine, name) for engine, one in engines().items() for name in one.variants}
    assert {(engine, name) for engine, name, *_ in CASES} == every
    assert all(base in opened(engine).presets for engine, _, base, _ in CASES)


def test_bodies_of_many_links_follow_recorded_motion_in_rows_of_their_own_and_hands_do_not() -> None:
    for engine, name in (("mujoco", "servos"), ("pybullet", "follows")):
        taking_part = {scene for scene, scenario in scenarios("compare").items() if name in variants_of(engine, scenario, ())}
        assert {"mocap_run", "mocap_punch_wall", "unseen_door"} <= taking_part and len(taking_part) < 30
        assert not taking_part & {"hand_over_table", "ball_drop", "hand_in_corner", "stack_ten"}


def test_a_preset_that_no_engine_has_is_still_an_error() -> None:
    with pytest.raises(UnknownName):
        Job("stack_ten", "mujoco", "dreaming").settings(opened("mujoco"))
    assert main(["run", "stack_ten", "--engine", "mujoco", "--preset", "dreaming"]) == 2


@pytest.mark.parametrize(("words", "runs"), [
    (("compare", "--filter", "mocap_run"), {("mocap_run", "servos"), ("mocap_run", "hinges")}),
    (("compare", "--filter", "stack_ten,zeno,two_arms"),
     {("stack_ten", "sleeping"), ("zeno", "sleeping"), ("two_arms", "hinges")}),
    (("compare", "--filter", "stack_ten", "--preset", "tuned"), set()),
    (("run", "stack_ten"), set()),
    (("run", "stack_ten", "--preset", "sleeping"), {("stack_ten", "sleeping")}),
    (("bench", "--filter", "stack_ten"), set()),
])
def test_a_comparison_plans_the_row_and_a_single_run_does_not(words: tuple[str, ...], runs: set[tuple[str, str]]) -> None:
    asked = parser().parse_args([*words, "--engine", "mujoco", "--jobs", "0"])
    made = plan(asked, asked.engine, asked.command == "run")
    assert {(job.scenario, job.preset) for job in made.jobs if job.preset in about("mujoco").variants} == runs
