"""`python -m scenarios compare`: both passes over every scene in every engine, the short studies, the report, the table."""

import argparse
import sys
from collections.abc import Sequence

from avatarsim.errors import InvalidInput
from avatarsim.scene.checks import positive
from runfiles.naming import GATED
from scenarios import own_scenes
from scenarios.cli.commands import Plan, carried_out, plan
from scenarios.engines import known
from scenarios.run.harness import Run
from scenarios.studies import contact_law, effects, hard_cases, judge_trust, settings
from scenarios.studies.study import Request, Study, in_turn

STUDIES: tuple[Study, ...] = (settings.STUDY, effects.STUDY, hard_cases.STUDY, contact_law.STUDY, judge_trust.STUDY)
"""The studies of a comparison, in the order in which they run."""
OWN_STUDIES: tuple[Study, ...] = (settings.STUDY, effects.STUDY, judge_trust.STUDY)
"""Those of a comparison in scenes that a user brings; hard cases and the contact law are in scenes of the catalogue."""

SCALES = {"scene": "scene_scale", "avatar": "avatar_scale", "room": "room_scale"}
"""Files of a scene of one's own, and the option that says how many metres a unit of length has in each."""


def compare(asked: argparse.Namespace, words: Sequence[str]) -> int:
    """Both passes over everything, the studies, the report, the table, the exit code.

    A run that is cut short by `--frames` proves nothing about a scene, and is not studied."""
    asked.own = None
    if getattr(asked, "scene", None):
        take(asked)
    else:
        alone(asked)
    made = plan(asked, asked.engine or list(known()), False)

    def studied(ran: Run) -> list[str]:
        studies = OWN_STUDIES if asked.own else STUDIES
        return [] if asked.frames is not None else in_turn(studies, request_of(asked, ran))

    gated = Plan(made.scenarios, made.jobs, made.ready, frozenset({GATED}))
    return carried_out(asked, words, gated, timed=True, report=True, also=studied)


def alone(asked: argparse.Namespace) -> None:
    """Refuse what says something of a scene of one's own where none is named: the catalogue would run without it."""
    for option in ("avatar", "room", "motion", *SCALES.values()):
        if getattr(asked, option, None) is not None:
            raise InvalidInput(_word(option), str(getattr(asked, option)), "with --scene FILE, the scene that it belongs to")


def take(asked: argparse.Namespace) -> None:
    """Take the user's own scenes. Raises InvalidInput with options that need the catalogue, and for files as `own_scenes.ask`."""
    for option in ("filter", "scheduler"):
        if getattr(asked, option, None) is not None:
            valid = "none: own scenes run whole, and on this machine"
            raise InvalidInput(f"--{option} with --scene", str(getattr(asked, option)), valid)
    for said in own_scenes.ask(asked.scene, asked.avatar, asked.room, asked.motion, asked.seconds, **scales(asked)):
        print(said, file=sys.stderr)
    asked.own, asked.scene = asked.scene, None


def scales(asked: argparse.Namespace) -> dict[str, float]:
    """The scales that are asked for. Raises InvalidInput for one out of range, and for one of a file that is not named."""
    found: dict[str, float] = {}
    for file, option in SCALES.items():
        value = getattr(asked, option)
        if value is None:
            continue
        found[option] = positive(_word(option), value, InvalidInput)
        if getattr(asked, file) is None:
            raise InvalidInput(_word(option), value, f"an option beside --{file}")
    return found


def _word(option: str) -> str:
    return f"--{option.replace('_', '-')}"


def request_of(asked: argparse.Namespace, ran: Run) -> Request:
    """Return what the studies of this run are about: its scenes, and the engines and presets that brought a recording."""
    presets: dict[str, tuple[str, ...]] = {}
    for outcome in ran.outcomes.values():
        job = outcome.job
        if outcome.state == "measured" and not job.base and job.preset not in presets.get(job.engine, ()):
            presets[job.engine] = (*presets.get(job.engine, ()), job.preset)
    return Request(ran.folder, ran.scenarios, presets, asked.jobs, asked.seed[0], asked.full, ran.outcomes, ran.clocked)
