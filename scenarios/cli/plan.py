"""Plan of a command: the scenes that it takes, and a job for each scene, seed, engine and preset."""

import argparse
import sys
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from importlib import import_module
from typing import TypeVar

from avatarsim.errors import InvalidInput, UnknownName
from runfiles.engines import about
from scenarios import catalog, drawn_crowds, own_scenes, unseen
from scenarios.catalog.paper import TABLE_2
from scenarios.engines import known, variants_of
from scenarios.job import CATALOGUE, Job, Outcome
from scenarios.run.gate import bounds_of
from scenarios.run.harness import Offer, offers
from scenarios.run.own_settings import OwnSettings, check_settings, read
from scenarios.scenario import Scenario
from scenarios.unseen import seeds

Scene = TypeVar("Scene")
Presets = Mapping[str, Sequence[tuple[str, OwnSettings | None]]]

LARGEST_SEED = 2**31 - 1
"""Some engines take a seed as a number of 32 bits."""
PILES = ("stack_ten", "stack_struck", "balls_216")
"""Scenes of many contacts that `bench` times in addition to the everyday ones."""
MIXED = ("list", "run", "compare")
"""Commands that take unseen scenes and a few drawn crowds."""
NAMED = ("check", "bench")
"""Commands that take them only by a pattern that names them: their figures have a baseline, and these motions change."""


@dataclass(frozen=True)
class Plan:
    """Jobs of a command, outcomes of engines that do not open, and the engines and presets that are gated."""

    scenarios: dict[str, Scenario]
    jobs: list[Job]
    ready: list[Outcome]
    gated: frozenset[tuple[str, str]]
    own: tuple[OwnSettings, ...] = ()


def patterns_of(text: str) -> list[str]:
    """Return patterns that are separated by commas and blanks."""
    return [pattern.strip() for pattern in text.split(",")]


def unmatched(names: Collection[str], text: str) -> list[str]:
    """Return the patterns that match none of the names."""
    return [pattern for pattern in patterns_of(text) if not any(fnmatchcase(name, pattern) for name in names)]


def filtered(scenes: Mapping[str, Scene], text: str) -> dict[str, Scene]:
    """Return the scenes that a pattern matches; none if one pattern matches nothing, since it may be a misspelt name."""
    if unmatched(scenes, text):
        return {}
    return {name: scene for name, scene in scenes.items() if any(fnmatchcase(name, one) for one in patterns_of(text))}


def scenarios(command: str, patterns: str | None = None) -> dict[str, Scenario]:
    """Return all scenes that a command offers, the unseen ones last; `patterns` is the text of its filter."""
    known = catalog.scenarios()
    if own_scenes.scenarios():
        return known
    for room in (unseen, drawn_crowds):
        named = any(pattern.startswith(room.PREFIX) for pattern in patterns_of(patterns or ""))
        if command in MIXED or (command in NAMED and named):
            known = {**known, **room.scenarios()}
    return known


def catalogue_of(name: str) -> str:
    """Return the module whose `get` gives a scene."""
    return next((room.NAME for room in (unseen, drawn_crowds) if name.startswith(room.PREFIX)), CATALOGUE)


def get(name: str) -> Scenario:
    """Return a scene of any kind, also a drawn crowd of any seed. Raises UnknownName."""
    known_names = scenarios("list")
    if name not in known_names and not name.startswith(drawn_crowds.PREFIX):
        raise UnknownName("scenario", name, known_names)
    scenario: Scenario = import_module(catalogue_of(name)).get(name)
    return scenario


def seed_of(name: str, seed: int) -> int:
    """Return the seed of a job: of an unseen scene, OWN means the commit's own."""
    return seeds.draw().seed if seed == seeds.OWN and name in unseen.scenarios() else seed


def origin(jobs: Iterable[Job]) -> dict[str, object]:
    """Return the provenance of the commit's own seed, empty where no job has it."""
    is_drawn = any(job.catalogue == unseen.NAME and job.seed == seeds.draw().seed for job in jobs)
    return {"unseen": seeds.draw().text} if is_drawn else {}


def scenes(options: argparse.Namespace) -> dict[str, Scenario]:
    """Return the scene that is named, or those that the filter matches. Without a filter or `--full`, `bench` takes a few.

    Raises:
        UnknownName: for a scene or a bounded metric that there is not.
    """
    name = getattr(options, "scene", None)
    selected = {name: get(name)} if name else scenarios(options.command, options.filter)
    if options.filter is not None:
        selected = filtered(selected, options.filter)
    elif options.command == "bench" and not options.full:
        few = {key: scenario for key, scenario in selected.items() if scenario.everyday or key in (*TABLE_2, *PILES)}
        note = f"{len(few)} of {len(selected)} scenes: everyday ones, piles and Table 2"
        print(f"{note}; --full (make: FULL=1) or --filter '*' takes all", file=sys.stderr)
        selected = few
    for scenario in selected.values():
        bounds_of(scenario)
    return selected


def plan(
    options: argparse.Namespace, engines: Sequence[str], first_preset_only: bool, pairs: Sequence[tuple[str, int]] = (),
) -> Plan:
    """Plan every scene with every engine, preset and seed. Raises InvalidInput, and UnknownName for an engine or preset.

    Args:
        pairs: scenes by name, each with a seed of its own, in place of those that the options name.
    """
    for name in engines:
        if name not in known():
            raise UnknownName("engine", name, known())
    for option, least in (("frames", 1), ("jobs", 0)):
        if (value := getattr(options, option)) is not None and value < least:
            raise InvalidInput(f"--{option}", value, f"{least} at least")
    for seed in options.seed:
        if not 0 <= seed <= LARGEST_SEED:
            raise InvalidInput("--seed", seed, f"0 to {LARGEST_SEED}")
    engines = list(dict.fromkeys(engines))
    own = read(options.settings, known(), engines) if options.settings else ()
    selected = {name: get(name) for name, _ in pairs} or scenes(options)
    offered = offers(engines, options.jobs) if selected else {}
    presets = _presets(options, offered, own, first_preset_only)
    if own and selected:
        opens = [row for row in own if not offered[row.engine].trouble]
        check_settings(opens, next(iter(selected)), options.settings, options.jobs)
    jobs, ready = [], []
    for scene, seed in pairs or [(scene, seed) for scene in selected for seed in dict.fromkeys(options.seed)]:
        for name, offer in offered.items():
            common = {"scenario": scene, "engine": name, "seed": seed_of(scene, seed), "full": options.full,
                      "frames": options.frames, "catalogue": catalogue_of(scene)}
            if offer.trouble:
                # one row at least, since its presets may not be known
                absent = [Job(**common, preset=preset) for preset, _ in presets[name] or [("default", None)]]
                jobs += absent
                ready += [Outcome(job, "crashed" if offer.crashed else "not-measured", offer.trouble) for job in absent]
                continue
            more = variants_of(name, selected[scene], options.preset) if options.command == "compare" or options.preset else ()
            jobs += [Job(**common, preset=preset, base=row.base, options=row.options) if row else Job(**common, preset=preset)
                     for preset, row in (*presets[name], *((variant, None) for variant in more))]
    firsts = {name: offer.presets[0] if offer.presets else "default" for name, offer in offered.items()}
    return Plan(selected, jobs, ready, frozenset(firsts.items()), own)


def _presets(
    options: argparse.Namespace, offered: Mapping[str, Offer], own: Sequence[OwnSettings], first_only: bool,
) -> Presets:
    """Return the presets to run of each engine, and the user's rows with their settings."""
    presets: dict[str, list[tuple[str, OwnSettings | None]]] = {}
    for name, offer in offered.items():
        listed = [preset for preset in offer.presets if not options.preset or preset in options.preset]
        listed = listed[:1] if first_only and not options.preset else listed
        rows = [row for row in own if row.engine == name]
        for row in rows:
            if row.name in offer.presets:
                raise InvalidInput(f"name of a row in {options.settings}", row.name, f"none of {name}'s own presets")
            if offer.presets and row.base not in offer.presets:
                raise UnknownName(f"preset of [{name}.{row.name}] in {options.settings}", row.base, offer.presets)
        presets[name] = [(preset, None) for preset in listed] + [(row.name, row) for row in rows]
    variants = {variant for name in offered for variant in about(name).variants}
    opens = offered and not any(offer.trouble for offer in offered.values())
    if options.preset and opens and not any(presets.values()) and not variants & set(options.preset):
        known_presets = {preset for offer in offered.values() for preset in offer.presets}
        raise UnknownName("preset", ", ".join(options.preset), known_presets | variants)
    return presets
