"""Commands `avatarsim clean` and `avatarsim audit`: from their options to table, files and exit code."""

import argparse
import os
import sys
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from avatarsim.cleaning import Options
from avatarsim.cleaning.stream import FASTEST, SLOWEST
from avatarsim.cli.option_words import in_words
from avatarsim.cli.reading import reading_of
from avatarsim.clips import batch as batches
from avatarsim.clips import certificate
from avatarsim.clips.batch import Batch
from avatarsim.clips.certificate import Trouble
from avatarsim.clips.found import Found, found
from avatarsim.clips.inputs import files_of, given
from avatarsim.clips.page.layout import length, limit_excess
from avatarsim.clips.task import OVERLAPS, UNREADABLE, Outcome, Task
from avatarsim.clips.whole_files import alone_in, require_ours, write_whole
from avatarsim.clips.wishes import FLOOR, Wishes
from avatarsim.console import Progress, printable
from avatarsim.errors import InvalidFile, InvalidInput
from avatarsim.running.stopping import stoppable
from avatarsim.scene.checks import FARTHEST, within

if TYPE_CHECKING:
    from avatarsim.running.processes import Workers

CLEAN, LEFT, UNDONE = 0, 1, 3
"""Exit codes: no overlap; overlap found or left; something could not be read or done."""
STOPPED = 130
"""Exit code of a program that the user stopped."""

WORKERS = 1024
"""Most processes of one command: each takes some 0.2 GB of memory."""
AUDIT = "audit.json"
"""File of an audit's measures."""
NAMED = 5
"""Most names in a sentence; the rest are counted."""
SENTENCES = 24
"""Most different sentences on clips that are printed; the certificate has all. More would bury the table of a thousand clips."""
WIDEST = 40
"""Most characters of a clip's name in the table; of longer names the end."""
HEAD = {
    "clean": f"{'clip':{WIDEST}} frames  overlap before       after           ways before/after    moved p95 / most  ",
    "audit": f"{'clip':{WIDEST}} frames  overlap              ways not certified  outside limits  ",
}


def run(asked: argparse.Namespace) -> int:
    """Return the exit code. Raises InvalidInput for options that do not fit, MissingPackage for an option's missing package."""
    wishes = wishes_of(asked)
    clips = found(asked.motions, asked.out)
    if not clips.clips and not clips.unreadable:
        named = ", ".join(str(path) for path in asked.motions)
        raise InvalidInput("motions", named, "files, or folders with clips: .bvh .amc .npz .csv .txt")
    with ExitStack() as held:
        held.enter_context(stoppable())
        if asked.command == "clean":
            held.enter_context(alone_in(asked.out))
            batches.require_place(asked.out, asked.force)
        elif asked.out is not None:
            require_ours(asked.out / AUDIT, certificate.MARK, False)
        _say_left(clips)
        batch = Batch(
            troubles=[(place, UNREADABLE, why) for place, _, why in clips.unreadable],
            clips=frozenset(clip.place for clip in clips.clips),
            earlier=_earlier(asked.out, clips) if asked.command == "clean" else (),
        )
        try:
            return _done(asked, wishes, clips, batch)
        except KeyboardInterrupt:
            again = "; what was finished is kept, and the same command goes on from there" if asked.command == "clean" else ""
            say(f"stopped{again}")
            return STOPPED


def _done(asked: argparse.Namespace, wishes: Wishes, clips: Found, batch: Batch) -> int:
    """Process all clips, write the files of the whole folder, and return the exit code."""
    for _, path, why in clips.unreadable:
        say(f"{path}: {why}")
    try:
        models = given(wishes, files_of(wishes))
    except InvalidFile as error:
        say(str(error))
        return UNDONE
    for model in models:
        for note in model.notes if model else ():
            say(note)
    is_clean = asked.command == "clean"
    tasks = batches.tasks_of(clips.clips, wishes, asked.out if is_clean else None, is_clean and asked.force)
    workers = _workers(asked, len(tasks), asked.out if asked.out is not None else asked.motions[0].parent)
    if is_clean:
        # the list of requested clips, in case this process is killed
        batches.leave(asked.out, batch)
    try:
        _work(asked.command, tasks, workers, batch)
    finally:
        # also of clips that were done before the user stopped it
        if is_clean:
            whole = batches.leave(asked.out, batch)
    if not is_clean and asked.out is not None:
        write_whole(asked.out / AUDIT, certificate.text(certificate.summary("audit", batch.entries, batch.troubles)))
    if is_clean:
        print(f"{asked.out / batches.INDEX}")
        _say_earlier(whole, clips)
    return exit_code(batch)


def _work(command: str, tasks: Sequence[Task], workers: "Workers", batch: Batch) -> None:
    told = set[str]()
    print(HEAD[command], flush=True)
    with Progress("cleaning" if command == "clean" else "auditing", sys.stderr) as bar:

        def ended(one: Outcome) -> None:
            bar.erase()
            if one.trouble is not None:
                say(f"{one.place}: {one.trouble[1]}")
            else:
                print(row(command, one), flush=True)
            avatar, pairs = tasks[0].wishes.avatar, excluded(one.entry or {})
            of_avatar = [(pairs, f"{avatar.name if avatar else one.place}: {pairs}")] if pairs else []
            for known, note in [*of_avatar, *((note, note) for note in one.notes)]:
                if known not in told:
                    told.add(known)
                    if len(told) <= SENTENCES:
                        say(note)
            step(0.0)

        def step(share: float) -> None:
            done = len(batch.outcomes)
            if done < len(tasks):
                bar.step((done + share) / len(tasks), f"{done} of {len(tasks)} clips")

        batches.run(tasks, workers, batch, ended, step)


def _workers(asked: argparse.Namespace, clips: int, folder: Path) -> "Workers":
    count = asked.workers
    if count is None:
        # without the package for parallel tasks one after the other, and a single clip here, with its progress
        count = min(clips, len(os.sched_getaffinity(0))) if clips > 1 and find_spec("pebble") is not None else 0
    return batches.workers_of(count, asked.scheduler, folder)


def exit_code(batch: Batch) -> int:
    """Return the exit code for the results of all clips."""
    if any(kind != OVERLAPS for _, kind, _ in batch.troubles):
        return UNDONE
    return LEFT if batch.troubles or not all(one["is_clean"] for one in batch.entries) else CLEAN


def wishes_of(asked: argparse.Namespace) -> Wishes:
    """Return the options for a clip. Raises InvalidInput for numbers out of range."""
    reading = reading_of(asked)
    if asked.rate is not None:
        within("--rate [1/s]", asked.rate, SLOWEST, FASTEST, InvalidInput)
    if asked.workers is not None and not 0 <= asked.workers <= WORKERS:
        raise InvalidInput("--workers", asked.workers, f"0 to {WORKERS}")
    height = getattr(asked, "ground", None)
    if height is not None:
        within("--ground [m]", height, -FARTHEST, FARTHEST, InvalidInput)
    given_ = {name: getattr(asked, name) for name in ("margin", "blend") if getattr(asked, name, None) is not None}
    room = asked.room if asked.room is None or str(asked.room) == FLOOR else asked.room.absolute()
    cleaning = Options(**given_, loose=asked.loose, opinion=not asked.no_opinion, ground=height is None)
    return Wishes(
        avatar=None if asked.avatar is None else asked.avatar.absolute(), room=room, rate=asked.rate, reading=reading,
        ground=height, cleaning=cleaning, page=not getattr(asked, "no_page", True),
    )


def row(command: str, one: Outcome) -> str:
    """Return one line of the table."""
    entry: dict[str, Any] = dict(one.entry or {})
    overlap, chords, limits = entry["overlap"], entry["between_frames"], entry["limits"]
    name = printable(one.place)
    over = len(name) + 3 - WIDEST
    name = name if over <= 3 else f"...{name[over:]}"
    last = verdict(entry) + (", done before" if one.kept else "")
    begin = f"{name:{WIDEST}} {entry['frames']:6}  {_deepest(overlap['before']):20} "
    if command == "audit":
        line = f"{begin} {chords['not_certified_before']:18}  {limit_excess(limits, 'before'):>14}  {last}"
        return f"{line}{_where(overlap['before'], entry['frames'])}"
    ways = f"{chords['not_certified_before']} / {chords['not_certified_after']}"
    p95, most = (max((link[name] for link in entry["moved"]["links"]), default=0.0) for name in ("p95_m", "most_m"))
    moved = f"{length(p95)} / {length(most)}"
    return f"{begin}{_deepest(overlap['after']):15} {ways:>18}  {moved:>18}  {last}"


def verdict(entry: Mapping[str, Any]) -> str:
    """Return the worst finding on a clip as written, or on an audited clip as recorded."""
    when = "before" if entry["overlap"]["after"] is None else "after"
    if entry["is_clean"]:
        return "clean"
    if entry["overlap"][when]["frames"]:
        return "OVERLAPS"
    return "NOT CERTIFIED" if entry["between_frames"][f"not_certified_{when}"] else "BEYOND LIMITS"


def _where(overlap: Mapping[str, Any], frames: int) -> str:
    """Return a line on the pair and the frame of the deepest overlap; empty without any."""
    if overlap["pair"] is None:
        return ""
    a, b = map(printable, overlap["pair"])
    return f"\n    deepest: {a} and {b}, in frame {overlap['frame']} of 0 to {frames - 1}"


MEANS = {
    "excluded": "from contact by the file, and no proof looks there",
    "at_rest": "at home and may be no deeper",
}
"""Meaning of these lists of pairs of a certificate."""


def excluded(entry: Mapping[str, Any]) -> str:
    """Return a sentence on pairs that are excluded from contact or overlap at home; "" without any.
    It is equal for all clips of an avatar."""
    told = []
    for kind, one_is, are in (
        ("excluded", "is excluded", "are excluded"), ("at_rest", "overlaps", "overlap"),
    ):
        # links without the name of their avatar, which of a recorded skeleton is that of its clip
        names = [" and ".join(one[side].partition("/")[2] or one[side] for side in "ab") for one in entry.get(kind, ())]
        if names:
            count = f"1 pair {one_is}" if len(names) == 1 else f"{len(names)} pairs {are}"
            told.append(f"{count} {MEANS[kind]}: {_some(names)}")
    return "; ".join(told)


def _deepest(one: dict[str, Any]) -> str:
    return f"{one['frames']} frames, {length(one['deepest_m'])}"


def say(sentence: str) -> None:
    """Print one line on the error stream, with options as on the command line."""
    print(f"avatarsim: {in_words(printable(sentence), 'clean')}", file=sys.stderr, flush=True)


def _say_left(clips: Found) -> None:
    """Name the files and folders that are skipped since they are no motions."""
    if clips.left:
        say(f"left alone, no motions: {_some([path.name for path in clips.left])}")


def _some(names: Sequence[str]) -> str:
    """Return the first few names, and how many more there are."""
    return ", ".join([*names[:NAMED], *([f"{len(names) - NAMED} more"] if len(names) > NAMED else [])])


def _earlier(out: Path, clips: Found) -> tuple[Trouble, ...]:
    """Return the undone clips of earlier commands into the folder."""
    try:
        return batches.left_undone(out, clips.places)
    except InvalidFile as error:
        say(f"what earlier commands left undone in {out} is not known: {error}")
        return ()


def _say_earlier(whole: Mapping[str, Any], clips: Found) -> None:
    """Name the undone clips of earlier commands into this folder."""
    names = [str(one["name"]) for one in whole["not_done"] if one["name"] not in clips.places]
    if names:
        say(f"not done, of earlier commands into this folder: {_some(names)}; {batches.WHOLE} says why")
