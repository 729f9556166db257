"""Typical commands, each run in a fresh process, and the kernels that each of them compiles: `python -m tests.late_commands DIR`.

Prints a JSON object per command: its name, its exit code, the kernels that it added to the cache, and its output. See
test_compile_ahead.
"""

import json
import os
import sys
import traceback
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from avatarsim.cleaning import Shield
from avatarsim.cli import main as avatarsim
from avatarsim.compile_ahead import part_scene
from avatarsim.engine import Settings
from avatarsim.jit.places import SUFFIX, current
from avatarsim.many_worlds import advance_many
from avatarsim.scene.tracker import rest
from avatarsim.simulator import AvatarsimEngine
from scenarios.__main__ import main as scenarios
from tests.cleaning.rooms import FLOOR, RATE, lowered, model, swinging, wall
from tests.cli.test_live import recording
from tests.clips.made import bvh
from tests.late_kernels import CASES

CUT_SHORT = ("--frames", "20", "--jobs", "1")
"""Options of the harness: kernels come with the first frames."""


def kept() -> set[str]:
    """Return files of compiled kernels."""
    return {f"{path.parent.parent.name}/{path.name}" for base in current().read for path in base.rglob(f"*{SUFFIX}")}


def frames() -> int:
    """Run scenes of all kinds, and every call between frames."""
    for case in CASES.values():
        engine = AvatarsimEngine()
        engine.load(case.scene, case.settings, case.dt)
        advance_many([engine], case.samples[:1], case.dt, threads=1)
        for sample in case.samples[1:]:
            engine.advance(sample, case.dt)
        engine.restore(engine.snapshot())
        engine.contacts(0.1)
        engine.reset()
        engine.change(case.scene)
        engine.load(replace(case.scene, narrow=("overlap_removal",)), Settings(), case.dt).state_hash()
        engine.advance(case.samples[0], case.dt)
    return 0


def touching() -> int:
    """Run a scene that begins with a contact, and an avatar that is put elsewhere."""
    scene, posed = part_scene("motion")[0], part_scene("posture")[0]
    bodies = tuple(replace(body, position=(0.0, 0.0, 0.05)) if body.name == "ball" else body for body in scene.bodies)
    with AvatarsimEngine() as engine:
        engine.load(replace(scene, bodies=bodies), Settings(), 1.0 / 60.0)
        engine.advance(rest(()), 1.0 / 60.0)
        engine.load(posed, Settings(), 1.0 / 60.0)
        engine.put(posed.first_sample)
    return 0


def shield() -> int:
    """Filter a stream of postures between a wall and a floor."""
    motion = lowered(swinging(30, 0.4, along=1.0), np.linspace(0.2, -0.2, 30))
    cleaned = Shield(model(), (FLOOR, wall(0.8)), RATE)
    for row in cleaned.coordinates.rows(motion):
        cleaned(row)
    return 0


def commands(folder: Path) -> dict[str, Callable[[], int]]:
    """Return the first commands of a user, by name; files are written into `folder`."""
    for seed in range(2):
        bvh(folder / "clips" / f"{seed}.bvh", frames=40, seed=seed)
    clips, out = str(folder / "clips"), str(folder / "run")
    page = ["--no-browser", "--port", "0", "--seconds", "1"]
    floor = ["--room", "floor", "--workers", "0"]
    return {
        "frames": frames, "touching": touching, "shield": shield,
        "clean": lambda: avatarsim(["clean", clips, *floor, "-o", str(folder / "cleaned")]),
        "audit": lambda: avatarsim(["audit", clips, *floor]),
        "live": lambda: avatarsim(["live", "--scene", "gallery", *page]),
        "live as printed": lambda: avatarsim(["live", "--method", "paper", *page]),
        "replay": lambda: avatarsim(["replay", str(recording(folder))]),
        "compare": lambda: scenarios(["compare", "--filter", "ball_drop,mocap_punch_wall", *CUT_SHORT, "--out", out]),
        "check": lambda: scenarios(["check", "--filter", "hand_over_table,mocap_getup_floor", *CUT_SHORT, "--out", out]),
    }


def in_a_child(command: Callable[[], int], printed: Path) -> int:
    """Return the exit code of a command in a child of this process, which has imported everything and loaded no kernel."""
    child = os.fork()
    if child:
        return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    code = 70
    try:
        stream = os.open(printed, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(stream, 1)
        os.dup2(stream, 2)
        code = command()
    except BaseException:
        traceback.print_exc()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)


def main() -> None:
    """Run all commands, one after the other."""
    folder = Path(sys.argv[1])
    for name, command in commands(folder).items():
        before, printed = kept(), folder / "printed"
        code = in_a_child(command, printed)
        said = printed.read_text(encoding="utf-8", errors="replace")
        print(json.dumps({"name": name, "code": code, "late": sorted(kept() - before), "printed": said}), flush=True)


if __name__ == "__main__":
    main()
