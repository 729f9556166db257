"""The command `avatarsim replay`: runs a recording again and compares its states bit for bit."""

import argparse
import json
import sys
import time

from avatarsim.clips.atomic_files import write_atomically
from avatarsim.console import Progress
from avatarsim.engine import FrameRecord
from avatarsim.errors import AvatarsimError
from avatarsim.live.recording import Recorded, read, versions
from avatarsim.live.replaying import Replayed, replay
from avatarsim.live.show import recording_page

SAME, DIFFERS, UNREADABLE = 0, 1, 3
"""Exit codes."""


def run(args: argparse.Namespace) -> int:
    """Return the exit code."""
    try:
        recorded = read(args.recording)
        if args.page is not None:
            write_atomically(args.page, recording_page(args.recording))
        with Progress("replay", sys.stderr) as progress:
            def one(frame: int, record: FrameRecord) -> None:
                if progress.due:
                    progress.step(frame / max(1, recorded.frames), f"frame {frame} of {recorded.frames}")

            begun = time.monotonic()
            done = replay(recorded, one)
            seconds = time.monotonic() - begun
    except AvatarsimError as error:
        print(f"avatarsim: {error}", file=sys.stderr)
        return UNREADABLE
    others = {name: (was, versions().get(name, "")) for name, was in recorded.versions.items() if versions().get(name) != was}
    if args.json:
        print(json.dumps(_as_json(recorded, done, others, seconds), indent=2))
    else:
        _print_result(recorded, done, others, seconds)
    return SAME if done.difference is None else DIFFERS


def _as_json(recorded: Recorded, done: Replayed, others: dict[str, tuple[str, str]], seconds: float) -> dict[str, object]:
    """Return the result as JSON."""
    difference = done.difference
    return {
        "scene": recorded.plan.scene.name, "preset": recorded.plan.settings.preset, "rate_hz": recorded.plan.rate,
        "frames": done.frames, "commands": len(recorded.rows) - recorded.frames, "seconds": seconds,
        "is_torn": recorded.is_torn, "is_same": difference is None,
        "first_difference": None if difference is None else {
            "frame": difference.frame, "recorded": difference.recorded, "replayed": difference.replayed
        },
        "other_versions": {name: {"recorded": a, "here": b} for name, (a, b) in others.items()},
    }


def _print_result(recorded: Recorded, done: Replayed, others: dict[str, tuple[str, str]], seconds: float) -> None:
    plan = recorded.plan
    # texts of an untrusted file may contain terminal control codes
    name, method = (text if text.isprintable() else repr(text) for text in (plan.scene.name, plan.settings.preset))
    print(
        f"{name}, method {method}, {done.frames} frames at {plan.rate:g} Hz, {len(recorded.rows) - recorded.frames} commands; "
        f"in {seconds:.1f} s, {done.frames / max(seconds, 1e-9):.0f} frames a second"
    )
    if recorded.is_torn:
        print("its end is torn: the program that wrote it was stopped; all whole frames were run")
    if done.difference is None:
        print("every state is the same to the bit")
        return
    where = "the state before the first frame" if done.difference.frame == 0 else f"frame {done.difference.frame}"
    print(f"{where} is another: {done.difference.replayed}, recorded was {done.difference.recorded}")
    if others:
        listed = ", ".join(f"{name} {a} (here {b})" for name, (a, b) in others.items())
        print(f"it was recorded with {listed}; other versions or processors may give other last bits")
