"""Rows beside presets run in the scenes of their question, and nowhere else."""

import pytest

from avatarsim.errors import UnknownName
from scenarios import catalog
from scenarios.__main__ import main, parser
from scenarios.commands import plan
from scenarios.engines import opened
from scenarios.job import Job
from scenarios.variants import VARIANTS, variants_of


def test_mujoco_sleeps_where_bodies_are_to_rest_only() -> None:
    taking_part = {name for name, scenario in catalog.scenarios().items() if list(variants_of("mujoco", scenario, ()))}
    assert {"stack_ten", "rest_ten_minutes", "heavy_on_light"} <= taking_part and len(taking_part) < 20
    assert not taking_part & {"two_arms", "mocap_run", "free_flight", "hand_in_corner"}
    assert list(variants_of("pybullet", catalog.get("stack_ten"), ())) == []


def test_a_variant_that_is_not_asked_for_does_not_run() -> None:
    stack = catalog.get("stack_ten")
    assert list(variants_of("mujoco", stack, ["tuned"])) == []
    assert list(variants_of("mujoco", stack, ["sleeping"])) == ["sleeping"]


@pytest.mark.parametrize(("engine", "name"), [(engine, name) for engine, names in VARIANTS.items() for name in names])
def test_every_variant_loads_and_says_what_differs_from_tuned(engine: str, name: str) -> None:
    made, job = opened(engine), Job("stack_ten", engine, name)
    scenario, scene, _ = job.asked()
    told = {}
    for preset in ("tuned", name):
        made.load(scene, Job("stack_ten", engine, preset).settings(made), scenario.dt)
        told[preset] = dict(made.settings_as_run())
    made.close()
    differs = {key for key in told[name] if key in told["tuned"] and told["tuned"][key] != told[name][key]}
    assert differs == {"sleep", "optimises"}


def test_a_preset_that_no_engine_has_is_still_an_error() -> None:
    with pytest.raises(UnknownName):
        Job("stack_ten", "mujoco", "dreaming").settings(opened("mujoco"))
    assert main(["run", "stack_ten", "--engine", "mujoco", "--preset", "dreaming"]) == 2


@pytest.mark.parametrize(("words", "runs"), [
    (("compare", "--filter", "stack_ten,zeno,two_arms"), {("stack_ten", "sleeping"), ("zeno", "sleeping")}),
    (("compare", "--filter", "stack_ten", "--preset", "tuned"), set()),
    (("run", "stack_ten"), set()),
    (("run", "stack_ten", "--preset", "sleeping"), {("stack_ten", "sleeping")}),
    (("bench", "--filter", "stack_ten"), set()),
])
def test_a_comparison_plans_the_row_and_a_single_run_does_not(words: tuple[str, ...], runs: set[tuple[str, str]]) -> None:
    asked = parser().parse_args([*words, "--engine", "mujoco", "--jobs", "0"])
    made = plan(asked, asked.engine, asked.command == "run")
    assert {(job.scenario, job.preset) for job in made.jobs if job.preset in VARIANTS["mujoco"]} == runs
