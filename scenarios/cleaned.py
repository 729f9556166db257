"""`python -m scenarios.cleaned [--clips NAME ...] [--rooms floor gallery] [--margin M] [--blend S] [--save FOLDER]`.

Cleans the recorded human clips of pybullet_data, as they were recorded, on a floor and in the gallery, and prints one table:
overlap of the input and of what is written by our own measure, by the judge of the comparison in all frames and at ten equal
steps between them, limits, jerk where the input was free, how far the motion was moved, and clip-seconds per second of one core.

The table of docs/cleaning.md is this command's. Kernels should be compiled already (`python -m avatarsim`). Exit code 1 where
something is left that `clean` promises not to leave.
"""

import argparse
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets.models.model import Model
from avatarsim.cleaning import Cleaned, Options, clean
from avatarsim.cleaning.result import OVERLAP
from avatarsim.console import ended, path_option
from avatarsim.errors import AvatarsimError, UnknownName
from avatarsim.scene.body import Body, fixed
from avatarsim.scene.motion import Motion
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from avatarsim.scene.tracker import poses_of_links
from reference.judging.judge import Judge
from scenarios.building.avatars.humanoid import humanoid
from scenarios.building.gallery import gallery
from scenarios.catalog.recorded.mocap_clips import PLAYED, Played
from scenarios.motion.mocap import load_clip, placed
from scenarios.motion.track import track_of

Array = NDArray[np.float64]

ROOMS = ("floor", "gallery")
"""Where clips are cleaned."""
STEPS = 10
"""Equal steps between frames at which the judge looks as well."""
EXCESS = 1e-9
"""[rad] beyond a limit that rounding may leave."""
MOST_JERK = 1.5
"""Largest jerk where the input was free, in multiples of the input's there."""


@dataclass(frozen=True)
class Row:
    """One clip in one room: what was cleaned, and what the judge finds: deepest overlap [m] and frames with one, before and
    after, and between the frames that were written; `seconds` that cleaning took, without the second opinion."""

    clip: str
    room: str
    motion: Motion
    cleaned: Cleaned
    judged_before: Array
    judged_after: Array
    judged_between: Array
    seconds: float

    @property
    def jerk_ratio(self) -> float:
        """Jerk where the input was free, in multiples of the input's; nan without such frames."""
        before, after = self.cleaned.before.jerk_free, self.cleaned.after.jerk_free
        return after / before if before > 0.0 else 1.0 if after == before else float("nan")

    @property
    def rewritten(self) -> int:
        """Frames said to be unchanged that are not, to the bit."""
        same = ~self.cleaned.changed
        names, written = ("positions", "rotations", "angles"), self.cleaned.motion
        pairs = [(getattr(self.motion, name), getattr(written, name)) for name in names]
        differ = [np.any((one != other).reshape(len(one), -1), axis=1) for one, other in pairs]
        return int(np.sum(same & np.any(differ, axis=0)))

    @property
    def broken(self) -> tuple[str, ...]:
        """The promises that are broken."""
        after = self.cleaned.after
        said = {
            "overlap in a frame": after.overlapping + int(np.sum(~(self.judged_after <= OVERLAP))),
            "overlap between frames": int(np.sum(~(self.judged_between <= OVERLAP))), "a way not proved": after.unproven,
            "limits": int(not after.limit_excess <= EXCESS), "jerk": int(self.jerk_ratio > MOST_JERK),
            "a frame rewritten": self.rewritten,
        }
        return tuple(name for name, count in said.items() if count)


def floor_of(played: Played) -> tuple[Body, ...]:
    """A floor whose top is z = 0."""
    return (fixed("floor", (Piece(Box((40.0, 40.0, 0.2))),), "wood", (0.0, 0.0, -0.1)),)


def motion_of(played: Played) -> Motion:
    """The clip at its own rate, where it is put in the gallery."""
    clip = placed(load_clip(played.clip), played.x, played.y, float(np.radians(played.heading)))
    track = track_of(clip, humanoid())
    return Motion(clip.times, track.positions, track.rotations, track.angles)


def depths(judge: Judge, motion: Motion) -> Array:
    """(F,) deepest overlap [m] of each posture, by the judge."""
    scene = judge.scene
    links, turns = poses_of_links(scene.avatars, motion.positions, motion.rotations, motion.angles)
    at = np.array([body.position for body in scene.bodies]).reshape(-1, 3)
    turned = np.array([body.orientation for body in scene.bodies]).reshape(-1, 4)
    return judge.depths(
        np.concatenate([np.broadcast_to(at, (len(motion), *at.shape)), links], axis=1),
        np.concatenate([np.broadcast_to(turned, (len(motion), *turned.shape)), turns], axis=1),
    )


def between(motion: Motion) -> Motion:
    """The inner ones of STEPS equal steps from each frame to the next."""
    found = [motion.between(k, n / STEPS) for k in range(len(motion) - 1) for n in range(1, STEPS)]
    arrays = ([getattr(sample, name) for sample in found] for name in ("time", "positions", "rotations", "angles"))
    return Motion(*(np.array(array) for array in arrays))


def row_of(played: Played, room: str, options: Options) -> Row:
    """Clean one clip in one room, and ask the judge."""
    motion, human = motion_of(played), humanoid()
    bodies = floor_of(played) if room == "floor" else gallery()
    begun = time.process_time()
    cleaned = clean(motion, Model(human, None, (), ()), bodies, options)
    seconds = time.process_time() - begun
    judge = Judge(Scene("cleaned", bodies, (human,)))
    before, after, inside = (depths(judge, one) for one in (motion, cleaned.motion, between(cleaned.motion)))
    return Row(played.clip, room, motion, cleaned, before, after, inside, seconds)


HEADS = (
    "clip", "room", "s", "frames", "overlap", "mm", "unproved", "rad", "after: overlap", "unproved", "rad", "jerk free", "held",
    "free changed", "moved mm", "s/s",
)
"""Heads of the table. Of the input: frames that overlap, the deepest, ways that are not proved, largest excess beyond limits.
After: frames + places between frames that overlap, and the same; jerk where the input was free and elsewhere, in multiples of the
input's; of the free frames of the input those that changed; 95th percentile of the link that was moved most; clip-seconds per
second of one core."""


def cells(row: Row) -> tuple[str, ...]:
    """A row of the table."""
    before, after, moved = row.cleaned.before, row.cleaned.after, row.cleaned.moved
    duration = float(row.motion.times[-1] - row.motion.times[0])
    held = after.jerk_held / before.jerk_held if before.jerk_held > 0.0 else float("nan")
    left = int(np.sum(~(row.judged_after <= OVERLAP))), int(np.sum(~(row.judged_between <= OVERLAP)))
    free = ~row.cleaned.held
    return (
        row.clip, row.room, f"{duration:.1f}", f"{before.frames}", f"{int(np.sum(~(row.judged_before <= OVERLAP)))}",
        f"{1e3 * row.judged_before.max():.1f}", f"{before.unproven}", f"{before.limit_excess:.2f}", f"{left[0]} + {left[1]}",
        f"{after.unproven}", f"{after.limit_excess:.0g}", told(row.jerk_ratio), told(held),
        f"{int(np.sum(free & row.cleaned.changed))} of {int(free.sum())}", f"{1e3 * moved.link_p95.max():.0f}",
        f"{duration / row.seconds:.0f}",
    )


def told(ratio: float) -> str:
    """A ratio, or a dash for none."""
    return f"{ratio:.2f}" if ratio == ratio else "-"


def table(rows: Sequence[Row]) -> str:
    """All rows, in Markdown."""
    lines = [HEADS, *(cells(row) for row in rows)]
    widths = [max(len(line[k]) for line in lines) for k in range(len(HEADS))]
    text = ["| " + " | ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)) + " |" for line in lines]
    return "\n".join([text[0], "|" + "|".join("-" * (width + 2) for width in widths) + "|", *text[1:]])


def all_rows(wanted: Sequence[tuple[Played, str]], options: Options) -> list[Row]:
    """A row of each clip in each room, told as they come."""
    # the first call loads kernels
    row_of(*wanted[0], options)
    rows = []
    for played, room in wanted:
        rows.append(row_of(played, room, options))
        print(" ".join(cells(rows[-1])), file=sys.stderr, flush=True)
    return rows


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table; 1 where a promise is broken."""
    names = [played.clip for played in PLAYED]
    parser = argparse.ArgumentParser(prog="python -m scenarios.cleaned", description=str(__doc__).splitlines()[2])
    parser.add_argument("--clips", nargs="+", default=names, metavar="NAME", help="these clips only")
    parser.add_argument("--rooms", nargs="+", default=list(ROOMS), choices=ROOMS, help="these rooms only")
    parser.add_argument("--margin", type=float, default=Options().margin, help="gap that is kept [m]")
    parser.add_argument("--blend", type=float, default=Options().blend, help="how long limbs give way before contact [s]")
    parser.add_argument("--save", type=path_option, metavar="FILE", help="write the table there as well")
    asked = parser.parse_args(arguments)
    chosen = {played.clip: played for played in PLAYED}
    for name in asked.clips:
        if name not in chosen:
            parser.error(str(UnknownName("clip", name, names)))
    options = Options(margin=asked.margin, blend=asked.blend, opinion=False)
    try:
        rows = all_rows([(chosen[name], room) for room in asked.rooms for name in asked.clips], options)
    except AvatarsimError as error:
        print(f"{type(error).__name__}: {error}", file=sys.stderr)
        return 2
    print(table(rows))
    duration = sum(float(row.motion.times[-1]) for row in rows)
    print(f"\n{duration:.1f} s of clips in {sum(row.seconds for row in rows):.1f} s of one core")
    broken = [f"{row.clip} in {row.room}: {', '.join(row.broken)}" for row in rows if row.broken]
    for said in broken:
        print(f"broken: {said}")
    if asked.save is not None:
        Path(asked.save).write_text(table(rows) + "\n", encoding="utf-8")
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(ended(main))
