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
from avatarsim.clips.atomic_files import alone_in, require_replaceable, write_atomically
from avatarsim.clips.batch import Batch
from avatarsim.clips.certificate import Trouble
from avatarsim.clips.clip_files import ClipFiles, find_clips
from avatarsim.clips.inputs import files_of, load_models
from avatarsim.clips.options import FLOOR, ClipOptions
from avatarsim.clips.page.layout import length, limit_excess
from avatarsim.clips.task import OVERLAPS, UNREADABLE, Outcome, Task
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


def run(args: argparse.Namespace) -> int:
    """Return the exit code. Raises InvalidInput for options that do not fit, MissingPackage for an option's missing package."""
    options = clip_options(args)
    clips = find_clips(args.motions, args.out)
    if not clips.clips and not clips.unreadable:
        named = ", ".join(str(path) for path in args.motions)
        raise InvalidInput("motions", named, "files, or folders with clips: .bvh .amc .npz .csv .txt")
    with ExitStack() as stack:
        stack.enter_context(stoppable())
        if args.command == "clean":
            stack.enter_context(alone_in(args.out))
            batches.require_place(args.out, args.force)
        elif args.out is not None:
            require_replaceable(args.out / AUDIT, certificate.MARK, False)
        _report_skipped(clips)
        batch = Batch(
            troubles=[(place, UNREADABLE, why) for place, _, why in clips.unreadable],
            clips=frozenset(clip.place for clip in clips.clips),
            earlier=_earlier(args.out, clips) if args.command == "clean" else (),
        )
        try:
            return _done(args, options, clips, batch)
        except KeyboardInterrupt:
            again = "; finished clips are kept, and the same command resumes" if args.command == "clean" else ""
            report(f"stopped{again}")
            return STOPPED


def _done(args: argparse.Namespace, options: ClipOptions, clips: ClipFiles, batch: Batch) -> int:
    """Process all clips, write the files of the whole folder, and return the exit code."""
    for _, path, why in clips.unreadable:
        report(f"{path}: {why}")
    try:
        models = load_models(options, files_of(options))
    except InvalidFile as error:
        report(str(error))
        return UNDONE
    for model in models:
        for note in model.notes if model else ():
            report(note)
    is_clean = args.command == "clean"
    tasks = batches.tasks_of(clips.clips, options, args.out if is_clean else None, is_clean and args.force)
    workers = _workers(args, len(tasks), args.out if args.out is not None else args.motions[0].parent)
    if is_clean:
        # the list of requested clips, in case this process is killed
        batches.leave(args.out, batch)
    try:
        _work(args.command, tasks, workers, batch)
    finally:
        # also of clips that were done before the user stopped it
        if is_clean:
            summary = batches.leave(args.out, batch)
    if not is_clean and args.out is not None:
        write_atomically(args.out / AUDIT, certificate.text(certificate.summary("audit", batch.entries, batch.troubles)))
    if is_clean:
        print(f"{args.out / batches.INDEX}")
        _report_earlier(summary, clips)
    return exit_code(batch)


def _work(command: str, tasks: Sequence[Task], workers: "Workers", batch: Batch) -> None:
    printed = set[str]()
    print(HEAD[command], flush=True)
    with Progress("cleaning" if command == "clean" else "auditing", sys.stderr) as bar:

        def ended(one: Outcome) -> None:
            bar.erase()
            if one.trouble is not None:
                report(f"{one.place}: {one.trouble[1]}")
            else:
                print(row(command, one), flush=True)
            avatar, pairs = tasks[0].options.avatar, excluded(one.entry or {})
            of_avatar = [(pairs, f"{avatar.name if avatar else one.place}: {pairs}")] if pairs else []
            for known, note in [*of_avatar, *((note, note) for note in one.notes)]:
                if known not in printed:
                    printed.add(known)
                    if len(printed) <= SENTENCES:
                        report(note)
            step(0.0)

        def step(share: float) -> None:
            done = len(batch.outcomes)
            if done < len(tasks):
                bar.step((done + share) / len(tasks), f"{done} of {len(tasks)} clips")

        batches.run(tasks, workers, batch, ended, step)


def _workers(args: argparse.Namespace, clips: int, folder: Path) -> "Workers":
    count = args.workers
    if count is None:
        # without the package for parallel tasks one after the other, and a single clip here, with its progress
        count = min(clips, len(os.sched_getaffinity(0))) if clips > 1 and find_spec("pebble") is not None else 0
    return batches.workers_of(count, args.scheduler, folder)


def exit_code(batch: Batch) -> int:
    """Return the exit code for the results of all clips."""
    if any(kind != OVERLAPS for _, kind, _ in batch.troubles):
        return UNDONE
    return LEFT if batch.troubles or not all(one["is_clean"] for one in batch.entries) else CLEAN


def clip_options(args: argparse.Namespace) -> ClipOptions:
    """Return the options for a clip. Raises InvalidInput for numbers out of range."""
    reading = reading_of(args)
    if args.rate is not None:
        within("--rate [1/s]", args.rate, SLOWEST, FASTEST, InvalidInput)
    if args.workers is not None and not 0 <= args.workers <= WORKERS:
        raise InvalidInput("--workers", args.workers, f"0 to {WORKERS}")
    height = getattr(args, "ground", None)
    if height is not None:
        within("--ground [m]", height, -FARTHEST, FARTHEST, InvalidInput)
    stated = {name: getattr(args, name) for name in ("margin", "blend") if getattr(args, name, None) is not None}
    room = args.room if args.room is None or str(args.room) == FLOOR else args.room.absolute()
    cleaning = Options(**stated, loose=args.loose, opinion=not args.no_opinion, ground=height is None)
    return ClipOptions(
        avatar=None if args.avatar is None else args.avatar.absolute(), room=room, rate=args.rate, reading=reading,
        ground=height, cleaning=cleaning, page=not getattr(args, "no_page", True),
    )


def row(command: str, one: Outcome) -> str:
    """Return one line of the table."""
    entry: dict[str, Any] = dict(one.entry or {})
    overlap, chords, limits = entry["overlap"], entry["between_frames"], entry["limits"]
    name = printable(one.place)
    over = len(name) + 3 - WIDEST
    name = name if over <= 3 else f"...{name[over:]}"
    last = verdict(entry) + (", done before" if one.done_before else "")
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
    sentences = []
    for kind, one_is, are in (
        ("excluded", "is excluded", "are excluded"), ("at_rest", "overlaps", "overlap"),
    ):
        # links without the name of their avatar, which of a recorded skeleton is that of its clip
        names = [" and ".join(one[side].partition("/")[2] or one[side] for side in "ab") for one in entry.get(kind, ())]
        if names:
            count = f"1 pair {one_is}" if len(names) == 1 else f"{len(names)} pairs {are}"
            sentences.append(f"{count} {MEANS[kind]}: {_some(names)}")
    return "; ".join(sentences)


def _deepest(one: dict[str, Any]) -> str:
    return f"{one['frames']} frames, {length(one['deepest_m'])}"


def report(sentence: str) -> None:
    """Print one line on the error stream, with options as on the command line."""
    print(f"avatarsim: {in_words(printable(sentence), 'clean')}", file=sys.stderr, flush=True)


def _report_skipped(clips: ClipFiles) -> None:
    """Name the files and folders that are skipped since they are no motions."""
    if clips.left:
        report(f"left alone, no motions: {_some([path.name for path in clips.left])}")


def _some(names: Sequence[str]) -> str:
    """Return the first few names, and how many more there are."""
    return ", ".join([*names[:NAMED], *([f"{len(names) - NAMED} more"] if len(names) > NAMED else [])])


def _earlier(out: Path, clips: ClipFiles) -> tuple[Trouble, ...]:
    """Return the undone clips of earlier commands into the folder."""
    try:
        return batches.left_undone(out, clips.places)
    except InvalidFile as error:
        report(f"what earlier commands left undone in {out} is not known: {error}")
        return ()


def _report_earlier(summary: Mapping[str, Any], clips: ClipFiles) -> None:
    """Name the undone clips of earlier commands into this folder."""
    names = [str(one["name"]) for one in summary["not_done"] if one["name"] not in clips.places]
    if names:
        report(f"not done, of earlier commands into this folder: {_some(names)}; {batches.FOLDER_CERTIFICATE} says why")
