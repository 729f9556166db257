"""Truncation: which scenes a quick comparison ends before their full length, after which share of it, and what it cannot show."""

from collections.abc import Mapping
from dataclasses import dataclass

from reports.reading.load import Results
from reports.words.wording import count, limit

FULL = "make compare FULL=1"
"""Runs every scene at its full length."""
BULLET_SLEEPS = 2.0
"""Rest [s] after which Bullet puts an island of bodies to sleep (its deactivation time, as it comes)."""


@dataclass(frozen=True)
class Cut:
    """One scene that ended early: `ran` of `full` seconds."""

    ran: float
    full: float

    @property
    def said(self) -> str:
        """"ran 1 s of 600 s"."""
        return f"ran {_seconds(self.ran)} of {_seconds(self.full)}"

    @property
    def within(self) -> str:
        """"in 4 s of 20 s", beside a figure of the scene."""
        return self.said.replace("ran", "in", 1)


def cuts(results: Results) -> Mapping[str, Cut]:
    """Every scene that ran fewer frames than its full length has, in the order of the file, so far as that has lengths."""
    found = {}
    for scene in results.scenes():
        ran, full = max((row.frames for row in results.of(scene)), default=0), results.lengths.get(scene, 0)
        dt = results.frame_times.get(scene, 0.0)
        if 0 < ran < full and dt > 0.0:
            found[scene] = Cut(ran * dt, full * dt)
    return found


def sentence(results: Results) -> str:
    """How many scenes were cut short and which most, with the command that runs all at full length; "" where none was."""
    found = cuts(results)
    if not found:
        return ""
    most = min(found, key=lambda scene: found[scene].ran / found[scene].full)
    return (f"Quick comparison: {len(found)} of {count(len(results.scenes()), 'scene')} are cut short, {most} most "
            f"({found[most].said}); each card says how long its scene ran. Full lengths: {FULL}.")


def scene_sentence(results: Results, scene: str) -> str:
    """The same of one scene, and what follows for sleeping where it has a row whose engine sleeps; "" for one that ran whole."""
    found = cuts(results).get(scene)
    if found is None:
        return ""
    rows = {row.run for row in results.of(scene)}
    sleeping = ""
    if "mujoco/sleeping" in rows:
        shown = "so a median here is mostly of frames before that" if found.ran < 2.0 * BULLET_SLEEPS else (
            "so it sleeps in the median frame at the earliest where a scene lasts longer than twice that")
        sleeping = (" What rests falls asleep in ours and in mujoco/sleeping within a few frames; pybullet/sleeping "
                    f"waits for {limit(BULLET_SLEEPS * 1e6, 'us')} of rest, {shown}.")
    return f"Cut short: this scene {found.said}. Full length: {FULL}.{sleeping}"


def _seconds(time: float) -> str:
    return limit(time * 1e6, "us")
