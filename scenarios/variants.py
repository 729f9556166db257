"""Rows of other engines beside their presets, each only in the scenes of its question: what a maintainer of it would ask for."""

from collections.abc import Callable, Iterator, Mapping, Sequence

from scenarios.scenario import Scenario


def something_rests(scenario: Scenario) -> bool:
    """Whether the scenario states bodies that are to rest."""
    return "rests" in scenario.expects


VARIANTS: Mapping[str, Mapping[str, Callable[[Scenario], bool]]] = {"mujoco": {"sleeping": something_rests}}
"""Engine -> variant -> whether it takes part in a scenario. The settings are the engine's own, under that name."""


def variants_of(engine: str, scenario: Scenario, asked: Sequence[str]) -> Iterator[str]:
    """Variants of `engine` that take part in `scenario`: those `asked` for by name, all where nothing is asked for."""
    for name, takes_part in VARIANTS.get(engine, {}).items():
        if (not asked or name in asked) and takes_part(scenario):
            yield name
