"""Variants of other engines beside their presets, as a maintainer would ask for them, each only in scenes of its question."""

from collections.abc import Callable, Iterator, Mapping, Sequence

from scenarios.scenario import Scenario

RECORDED = ("mocap_", "unseen_")
"""How the names of scenes begin in which a body follows recorded motion."""


def something_rests(scenario: Scenario) -> bool:
    """Whether the scenario states bodies that are to rest."""
    return "rests" in scenario.expects


def may_sleep(scenario: Scenario) -> bool:
    """Whether the scenario states bodies that are to rest, or is an everyday scene in which something can fall asleep: ours does
    so by itself, so that there a reader compares times with what sleeps as well."""
    return something_rests(scenario) or (scenario.everyday and scenario.as_run(False).build().derived_effects.sleeping)


def body_follows(scenario: Scenario) -> bool:
    """Whether a body of many links follows a recorded motion: the clips, and what nothing was tuned for. All scenes with limbs
    would cost half a minute more and ask nothing else."""
    return scenario.name.startswith(RECORDED)


def in_a_room(scenario: Scenario) -> bool:
    """Whether a body follows a motion that nothing was tuned for: where joints meet their limits in unseen postures."""
    return scenario.name.startswith(RECORDED[1])


VARIANTS: Mapping[str, Mapping[str, Callable[[Scenario], bool]]] = {
    "mujoco": {"sleeping": may_sleep, "servos": body_follows, "hinges": in_a_room},
    "pybullet": {"sleeping": may_sleep, "follows": body_follows},
}
"""Engine -> variant -> whether it takes part in a scenario. The settings are the engine's own, under that name."""


def takes_part(engine: str, preset: str, scenario: Scenario) -> bool:
    """Whether a row is of this scenario: a preset always is, a variant where its question is."""
    condition = VARIANTS.get(engine, {}).get(preset)
    return condition is None or condition(scenario)


def variants_of(engine: str, scenario: Scenario, asked: Sequence[str]) -> Iterator[str]:
    """Variants of `engine` that take part in `scenario`: those `asked` for by name, all where nothing is asked for."""
    for name, takes_part in VARIANTS.get(engine, {}).items():
        if (not asked or name in asked) and takes_part(scenario):
            yield name
