"""`python -m scenarios.live`: stages and scenes of the catalogue driven in the browser, with other engines next to avatarsim.

Page, loops and ports are those of `avatarsim live`; added are scenes, with their motions as clips, engines and the judge.
"""

import argparse
import sys
from collections.abc import Mapping, Sequence

from avatarsim.cli.arguments import live_options
from avatarsim.cli.live import drive
from avatarsim.console import ended
from avatarsim.engine import Settings
from avatarsim.errors import AvatarsimError, InvalidInput, UnknownName
from avatarsim.live.messages import Plan
from avatarsim.live.show import require_page
from avatarsim.live.stages import NAMES, Stage, stage
from avatarsim.live.view.depth import Depth
from avatarsim.scene.motion import Motion
from avatarsim.scene.scene import Scene
from reference.judging.judge import Judge
from runfiles.engines import about, engines
from runfiles.naming import GATED
from scenarios.catalog import get
from scenarios.engines import absent, known
from scenarios.own_scenes import motion_of
from scenarios.run.gate import USAGE
from scenarios.scenario import RENDERED

PRESETS = 2
"""Presets of each engine that a page offers: the tuned one and the engine's defaults."""


def parser() -> argparse.ArgumentParser:
    """Return the parser of all options."""
    others = " ".join(f"{one.name}/{one.presets[0]}" for one in engines().values() if not one.baseline and one.name != GATED[0])
    top = argparse.ArgumentParser(
        prog="python -m scenarios.live", description="Drive scenes of the catalogue in the browser, other engines beside.",
        epilog=f"examples: python -m scenarios.live; python -m scenarios.live --scene hand --engine {others}",
    )
    live_options(top)
    scene = f"{', '.join(NAMES)} as in `avatarsim live`, or a scene of the catalogue"
    top.add_argument("--scene", default="toys", metavar="NAME", help=scene)
    other = "engines beside avatarsim, led by the same targets"
    top.add_argument("--engine", nargs="+", default=[], metavar="ENGINE/PRESET", help=other)
    return top


def main(arguments: Sequence[str] | None = None) -> int:
    """Return the exit code: 0 ended by the user, 1 the engine's process ended by itself, 2 wrong usage."""
    options = parser().parse_args(arguments)
    try:
        require_page()
        if options.motion:
            raise InvalidInput("--motion", str(options.motion[0]), "an option of `avatarsim live --avatar FILE`")
        stage, clips = staged_of(options.scene)
        others = [plan_of(words, stage.scene, options.rate) for words in options.engine]
        offered = [plan for plan in installed(stage.scene, options.rate) if plan.name not in {one.name for one in others}]
        return drive(options, stage, clips, others, judged(stage.scene), [*others, *offered])
    except AvatarsimError as error:
        print(f"scenarios.live: {error}", file=sys.stderr)
        return USAGE


def staged_of(name: str) -> tuple[Stage, Mapping[str, Motion]]:
    """Return a built-in stage, or a scene of the catalogue with its motion as a clip. Raises UnknownName, and InvalidInput for a
    scene without an avatar."""
    if name in NAMES:
        return stage(name), {}
    scenario = get(name)
    scene = scenario.build()
    if not scene.avatars:
        raise InvalidInput("--scene", name, "a scene with an avatar")
    motion = scenario.motion(scene, 0)
    clip = motion_of([scene.first_sample, *(motion(frame) for frame in range(scenario.frames))], 1.0 / RENDERED)
    return Stage(scene), {f"{scene.name}, seed 0": clip}


def plan_of(words: str, scene: Scene, rate: float) -> Plan:
    """Return the loop of another engine, named as ENGINE/PRESET. Raises UnknownName."""
    name, _, preset = words.partition("/")
    if name not in known():
        raise UnknownName("engine", name, known())
    preset = preset or about(name).presets[0]
    return Plan(about(name).adapter, scene, Settings(preset=preset), rate, name=f"{name}/{preset}")


def installed(scene: Scene, rate: float) -> list[Plan]:
    """Return the loops of all other engines whose packages are installed, in their first presets."""
    missing = absent()
    shown = [one for one in engines().values() if not one.baseline and one.name != GATED[0] and one.name not in missing]
    return [plan_of(f"{one.name}/{preset}", scene, rate) for one in shown for preset in one.presets[:PRESETS]]


def judged(scene: Scene) -> Depth:
    """Return a function for the deepest overlap [m] of all pairs that may not overlap, by the independent judge."""
    judge = Judge(scene)
    return lambda scene, positions, orientations, angles: judge.overlaps(positions, orientations).deepest


if __name__ == "__main__":
    sys.exit(ended(main))
