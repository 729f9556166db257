"""`python -m scenarios compare`: both passes over every scene in every engine, the short studies, the report, the table."""

import argparse
import sys
from collections.abc import Iterable, Sequence
from dataclasses import asdict, replace

from avatarsim.cli.option_words import in_words
from avatarsim.cli.reading import reading_of
from avatarsim.errors import InvalidInput
from avatarsim.scene.checks import positive
from runfiles.naming import GATED
from scenarios import own_scenes
from scenarios.cli.commands import carry_out
from scenarios.cli.plan import plan
from scenarios.engines import engines_to_run
from scenarios.job import Job
from scenarios.run.harness import Run
from scenarios.studies import contact_law, effects, hard_cases, judge_trust, settings
from scenarios.studies.study import Request, Study, in_turn

STUDIES: tuple[Study, ...] = (settings.STUDY, effects.STUDY, hard_cases.STUDY, contact_law.STUDY, judge_trust.STUDY)
"""Studies of a comparison, in their order."""
OWN_STUDIES: tuple[Study, ...] = (settings.STUDY, effects.STUDY, judge_trust.STUDY)
"""Studies in scenes that a user brings; hard cases and the contact law are in scenes of the catalogue."""


def compare(options: argparse.Namespace, words: Sequence[str]) -> int:
    """Carry out a comparison, with its studies unless it is cut short by `--frames`, which proves nothing about a scene."""
    own = bool(getattr(options, "scene", None))
    if own:
        take_own_scenes(options)
    else:
        reading = reading_of(options)
        given = {option: getattr(options, option) for option in ("avatar", "room", "motion", "scene_scale")}
        given |= {name: value for name, value in asdict(reading).items() if value != getattr(own_scenes.AS_FOUND, name)}
        for option, value in given.items():
            if value is not None:
                raise InvalidInput(f"--{option.replace('_', '-')}", str(value), "with --scene FILE, the scene that it belongs to")
    made = plan(options, engines_to_run(options.engine), False)

    def study(ran: Run) -> list[str]:
        return [] if options.frames is not None else in_turn(OWN_STUDIES if own else STUDIES, request_of(options, ran))

    return carry_out(options, words, replace(made, gated=frozenset({GATED})), timed=True, report=True, also=study)


def take_own_scenes(options: argparse.Namespace) -> None:
    """Put the user's scenes in the place of the catalogue. Raises InvalidInput for options that do not go with them."""
    for option in ("filter", "scheduler"):
        if (value := getattr(options, option, None)) is not None:
            raise InvalidInput(f"--{option} with --scene", str(value), "none: own scenes run whole, and on this machine")
    scale = 1.0 if options.scene_scale is None else positive("--scene-scale", options.scene_scale, InvalidInput)
    options.own_scene = True
    reading = reading_of(options)
    notes = own_scenes.take_files(
        options.scene, options.avatar, options.room, options.motion, options.seconds, scene_scale=scale, reading=reading
    )
    for note in notes:
        print(in_words(note, "clean"), file=sys.stderr)
    options.scene = None


def presets_of(jobs: Iterable[Job]) -> dict[str, tuple[str, ...]]:
    """Return the presets of each engine among jobs, without rows of the user's own."""
    by_engine: dict[str, dict[str, None]] = {}
    for job in jobs:
        if not job.base:
            by_engine.setdefault(job.engine, {})[job.preset] = None
    return {engine: tuple(presets) for engine, presets in by_engine.items()}


def request_of(options: argparse.Namespace, ran: Run) -> Request:
    """Return the request to the studies of a run: its scenes, engines and presets that have a recording."""
    presets = presets_of(outcome.job for outcome in ran.outcomes.values() if outcome.state == "measured")
    return Request(ran.folder, ran.scenarios, presets, options.jobs, options.seed[0], options.full, ran.outcomes, ran.clocked)
