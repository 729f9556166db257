"""Variants: presets that run only in scenes that meet a condition. `reference/*/about.toml` names them."""

from collections.abc import Callable, Iterator, Mapping, Sequence

from avatarsim.errors import InvalidFile
from avatarsim.scene.joint import Ball
from runfiles.engines import Variant, about, engines
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


def limits_balls(scenario: Scenario) -> bool:
    """Whether a ball joint of an avatar has limits."""
    links = scenario.as_run(False).build().links
    return any(isinstance(link.joint, Ball) and link.joint.limits is not None for link in links)


CONDITIONS: Mapping[str, Callable[[Scenario], bool]] = {
    "rests": something_rests, "bodies may sleep": may_sleep, "follows recorded motion": body_follows,
    "ball joints have limits": limits_balls,
}
"""Conditions that `scenes` of a variant can name."""

VARIANTS: Mapping[str, Mapping[str, Variant]] = {one.name: one.variants for one in engines().values()}
"""Built-in engine -> its variants."""


def takes_part(engine: str, preset: str, scenario: Scenario) -> bool:
    """Return whether a preset runs in a scenario: a variant does where its condition is met, others always do. Raises InvalidFile
    for a condition that is not known."""
    one = about(engine)
    if preset not in one.variants:
        return True
    condition = one.variants[preset].scenes
    if condition not in CONDITIONS:
        raise InvalidFile(f"variants.{preset}.scenes in {one.path}", condition, f"one of {', '.join(CONDITIONS)}")
    return CONDITIONS[condition](scenario)


def variants_of(engine: str, scenario: Scenario, asked: Sequence[str]) -> Iterator[str]:
    """Yield the variants of `engine` that take part in `scenario`: those `asked` for by name, all where nothing is asked for."""
    for name in about(engine).variants:
        if (not asked or name in asked) and takes_part(engine, name, scenario):
            yield name
