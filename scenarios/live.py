"""`python -m scenarios.live`: built-in stages and scenes of the catalogue driven in the browser, other engines beside ours.

The page, the loops and the ports are those of `avatarsim live`; what is added is what alone the harness knows: its
scenes, its engines, and the independent judge, which measures them. A scene's own motion is a clip to play and to take over from.
"""

import argparse
import sys
from collections.abc import Mapping, Sequence

import numpy as np

from avatarsim.cli.arguments import live_options
from avatarsim.cli.live import drive, require_page
from avatarsim.console import ended
from avatarsim.engine import Settings
from avatarsim.errors import AvatarsimError, InvalidInput, UnknownName
from avatarsim.live.messages import Array, Plan
from avatarsim.live.stages import NAMES, Stage, stage, staged
from avatarsim.live.view.depth import Depth
from avatarsim.scene.motion import Motion
from avatarsim.scene.scene import Scene
from reference.judging.judge import Judge
from runfiles.engines import about, engines
from runfiles.naming import GATED
from scenarios.catalog import get
from scenarios.engines import known
from scenarios.run.gate import USAGE
from scenarios.scenario import RENDERED, Scenario

SCENE = "gallery"
"""The scene that is shown where none is asked for, as built in."""


def parser() -> argparse.ArgumentParser:
    """All options."""
    others = " ".join(f"{one.name}/{one.presets[0]}" for one in engines().values() if not one.baseline and one.name != GATED[0])
    top = argparse.ArgumentParser(
        prog="python -m scenarios.live", description="Scenes of the catalogue driven in the browser, other engines beside ours.",
        epilog=f"examples: python -m scenarios.live; python -m scenarios.live --scene hand --engine {others}",
    )
    live_options(top)
    scene = f"{', '.join(NAMES)} as in `avatarsim live`, or a scene of the catalogue"
    top.add_argument("--scene", default=SCENE, metavar="NAME", help=scene)
    beside = "engines beside ours, led by the same targets"
    top.add_argument("--engine", nargs="+", default=[], metavar="ENGINE/PRESET", help=beside)
    return top


def main(arguments: Sequence[str] | None = None) -> int:
    """The exit code: 0 ended by the user, 1 the engine's process ended by itself, 2 wrong usage."""
    asked = parser().parse_args(arguments)
    try:
        require_page()
        if asked.motion:
            raise InvalidInput("--motion", str(asked.motion[0]), "an option of `avatarsim live --avatar FILE`")
        found, clips = staged_of(asked.scene)
        rivals = [plan_of(words, found.scene, asked.rate) for words in asked.engine]
        return drive(asked, found, clips, rivals, judged(found.scene))
    except AvatarsimError as error:
        print(f"scenarios.live: {error}", file=sys.stderr)
        return USAGE


def staged_of(name: str) -> tuple[Stage, Mapping[str, Motion]]:
    """A built-in stage, or a scene of the catalogue with its motion as a clip. Raises UnknownName for neither, InvalidInput for
    one without an avatar."""
    if name in NAMES:
        return stage(name), {}
    scenario = get(name)
    scene = scenario.build()
    if not scene.avatars:
        raise InvalidInput("--scene", name, "a scene with an avatar")
    return staged(scene, scenario.title), {f"{scene.name}, seed 0": clip(scenario, scene)}


def plan_of(words: str, scene: Scene, rate: float) -> Plan:
    """Return the loop of another engine, named as ENGINE/PRESET. Raises UnknownName for what there is not."""
    name, _, preset = words.partition("/")
    paths = known()
    if name not in paths:
        raise UnknownName("engine", name, paths)
    preset = preset or about(name).presets[0]
    return Plan(paths[name], scene, Settings(preset=preset), rate, name=f"{name}/{preset}")


def clip(scenario: Scenario, scene: Scene) -> Motion:
    """The scenario's own motion, as one that can be played."""
    motion = scenario.motion(scene, 0)
    samples = [scene.first_sample, *(motion(frame) for frame in range(scenario.frames))]
    return Motion(
        RENDERED * np.arange(len(samples), dtype=np.float64), np.array([one.positions for one in samples]),
        np.array([one.rotations for one in samples]), np.array([one.angles for one in samples], dtype=np.float64),
    )


def judged(scene: Scene) -> Depth:
    """Penetration by the independent judge, of all pairs that may not overlap."""
    judge = Judge(scene)

    def depth(scene: Scene, positions: Array, orientations: Array, angles: Array) -> float:
        return judge.overlaps(positions, orientations).deepest

    return depth


if __name__ == "__main__":
    sys.exit(ended(main))
