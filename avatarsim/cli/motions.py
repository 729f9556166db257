"""`avatarsim clean` and `avatarsim audit`: from the words of a command to its table, its files and its exit code."""

import argparse
import os
import re
import sys
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from avatarsim.cleaning import Options
from avatarsim.clips import batch as batches
from avatarsim.clips import certificate
from avatarsim.clips.batch import Batch
from avatarsim.clips.certificate import Trouble
from avatarsim.clips.found import Found, found
from avatarsim.clips.inputs import files_of, given
from avatarsim.clips.page.layout import angle, length
from avatarsim.clips.task import OVERLAPS, UNREADABLE, WORDS, Outcome, Task
from avatarsim.clips.whole_files import alone_in, require_ours, write_whole
from avatarsim.clips.wishes import FLOOR, Reading, Wishes
from avatarsim.console import Progress, printable
from avatarsim.errors import InvalidFile, InvalidInput
from avatarsim.running.stopping import stoppable
from avatarsim.scene.checks import positive

if TYPE_CHECKING:
    from avatarsim.running.processes import Workers

CLEAN, LEFT, UNDONE = 0, 1, 3
"""Exit codes: no overlap; overlap found or left; something could not be read or done."""
STOPPED = 130
"""Exit code of a program that the user stopped."""

AUDIT = "audit.json"
"""File of an audit's measures."""
NAMED = 5
"""Names in a sentence; of more, the number."""
SENTENCES = 24
"""Different sentences on clips that are said; the certificate has all. More would bury the table of a thousand clips."""
OF_READERS = re.compile(
    r"\b(scale|up|rate|skeleton|limits|mass|stature|offsets|joints|quaternion|fix|couplings|root|leave|folder|meshes)=(?:False|\.\.\.)?(?=(\S)?)"
)
"""An option of a reader as its sentences name it."""
WIDEST = 40
"""Characters of a clip's name in the table; of longer ones the end."""
HEAD = {
    "clean": f"{'clip':{WIDEST}} frames  overlap before       after           ways before/after  moved p95  ",
    "audit": f"{'clip':{WIDEST}} frames  overlap              ways not certified  outside limits  ",
}


def run(asked: argparse.Namespace) -> int:
    """The exit code. Raises InvalidInput for options that do not fit, MissingPackage for what is asked for and not installed."""
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
    """Do all clips and write what the whole of them leaves; the exit code."""
    for _, path, why in clips.unreadable:
        say(f"{path}: {why}")
    try:
        models = given(wishes, files_of(wishes))
    except InvalidFile as error:
        say(str(error))
        return UNDONE
    for model in models:
        for said in model.said if model else ():
            say(said)
    is_clean = asked.command == "clean"
    tasks = batches.tasks_of(clips.clips, wishes, asked.out if is_clean else None, is_clean and asked.force)
    workers = _workers(asked, len(tasks), asked.out if asked.out is not None else asked.motions[0].parent)
    if is_clean:
        # what is asked for, should this process be killed
        batches.leave(asked.out, batch)
    try:
        _work(asked.command, tasks, workers, batch)
    finally:
        # also of what was done until the user stopped it
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
            for known, said in [*of_avatar, *((said, said) for said in one.said)]:
                if known not in told:
                    told.add(known)
                    if len(told) <= SENTENCES:
                        say(said)
            step(0.0)

        def step(share: float) -> None:
            done = len(batch.outcomes)
            if done < len(tasks):
                bar.step((done + share) / len(tasks), f"{done} of {len(tasks)} clips")

        batches.run(tasks, workers, batch, ended, step)


def _workers(asked: argparse.Namespace, clips: int, folder: Path) -> "Workers":
    count = asked.workers
    if count is None:
        # without what runs them side by side one after the other, and a single clip here, with its progress
        count = min(clips, len(os.sched_getaffinity(0))) if clips > 1 and find_spec("pebble") is not None else 0
    return batches.workers_of(count, asked.scheduler, folder)


def exit_code(batch: Batch) -> int:
    """Of what has become of all clips."""
    if any(kind != OVERLAPS for _, kind, _ in batch.troubles):
        return UNDONE
    return LEFT if batch.troubles or not all(one["is_clean"] for one in batch.entries) else CLEAN


def wishes_of(asked: argparse.Namespace) -> Wishes:
    """The options as what a clip asks for. Raises InvalidInput for numbers out of range."""
    for name in ("rate", "file_rate", "scale", "stature", "mass", "avatar_scale", "room_scale"):
        if getattr(asked, name) is not None:
            positive(f"--{name.replace('_', '-')}", getattr(asked, name), InvalidInput)
    for names, what in ((("fix", "couplings", "root", "leave", "avatar_scale"), "avatar"), (("room_scale", "room_up"), "room")):
        for name in names:
            if getattr(asked, name) and getattr(asked, what) is None:
                raise InvalidInput(f"--{name.replace('_', '-')}", getattr(asked, name), f"an option beside --{what}")
    if asked.workers is not None and asked.workers < 0:
        raise InvalidInput("--workers", asked.workers, "0 at least")
    given_ = {name: getattr(asked, name) for name in ("margin", "blend") if getattr(asked, name, None) is not None}
    reading = Reading(
        scale=asked.scale, up=asked.up, file_rate=asked.file_rate, quaternion=asked.quaternion, joints=asked.joints,
        mass=asked.mass, limits=not asked.no_limits,
        offsets=asked.offsets if asked.offsets in (None, "mean") else str(Path(asked.offsets).absolute()), stature=asked.stature,
        asf=_absolute(asked.asf), fix=_listed(asked.fix), couplings=asked.couplings, root=asked.root, leave=_listed(asked.leave),
        folder=_absolute(asked.folder), meshes=asked.meshes,
        avatar_scale=asked.avatar_scale, room_scale=asked.room_scale, room_up=asked.room_up,
    )
    room = asked.room if asked.room is None or str(asked.room) == FLOOR else asked.room.absolute()
    return Wishes(
        avatar=None if asked.avatar is None else asked.avatar.absolute(), room=room, rate=asked.rate, reading=reading,
        cleaning=Options(**given_, loose=asked.loose, opinion=not asked.no_opinion), page=not getattr(asked, "no_page", True),
    )


def _absolute(path: Path | None) -> str | None:
    return None if path is None else str(path.absolute())


def _listed(text: str) -> tuple[str, ...]:
    """Names with commas between."""
    return tuple(name.strip() for name in text.split(",") if name.strip())


def row(command: str, one: Outcome) -> str:
    """One line of the table."""
    entry: dict[str, Any] = dict(one.entry or {})
    overlap, chords, limits = entry["overlap"], entry["between_frames"], entry["limits"]
    name = printable(one.place)
    over = len(name) + 3 - WIDEST
    name = name if over <= 3 else f"...{name[over:]}"
    last = ("clean" if entry["is_clean"] else "OVERLAPS") + (", done before" if one.kept else "")
    begin = f"{name:{WIDEST}} {entry['frames']:6}  {_deepest(overlap['before']):20} "
    if command == "audit":
        return f"{begin} {chords['not_certified_before']:18}  {angle(limits['excess_before_rad']):>14}  {last}"
    ways = f"{chords['not_certified_before']} / {chords['not_certified_after']}"
    most = max((link["p95_m"] for link in entry["moved"]["links"]), default=0.0)
    return f"{begin}{_deepest(overlap['after']):15} {ways:>18}  {length(most):>9}  {last}"


def excluded(entry: Mapping[str, Any]) -> str:
    """A sentence on the pairs that are excluded from contact, the same for all clips of an avatar; "" without any."""
    pairs = entry.get("excluded", ())
    told = []
    for why, words in ((certificate.BY_FILE, "by the file"), (certificate.AT_REST, "since they overlap at rest")):
        # links without the name of their avatar, which of a recorded skeleton is that of its clip
        names = [" and ".join(one[side].partition("/")[2] or one[side] for side in "ab") for one in pairs if one["why"] == why]
        if names:
            told.append(f"{f'{len(names)} ' if len(names) < len(pairs) else ''}{words} ({_some(names)})")
    count = "1 pair is" if len(pairs) == 1 else f"{len(pairs)} pairs are"
    return f"{count} excluded from contact, and no proof looks there: {', '.join(told)}" if told else ""


def _deepest(one: dict[str, Any]) -> str:
    return f"{one['frames']} frames, {length(one['deepest_m'])}"


def say(sentence: str) -> None:
    """One line on the error stream; options of readers, which speak of Python, by their words here."""
    print(f"avatarsim: {OF_READERS.sub(_as_option, printable(sentence))}", file=sys.stderr, flush=True)


def _as_option(found: re.Match[str]) -> str:
    name = WORDS.get(found[1], found[1])
    return f"--{name} " if found[2] else f"--{name}"


def _say_left(clips: Found) -> None:
    """Name what is left alone in folders, since it is no motion."""
    if clips.left:
        say(f"left alone, no motions: {_some([path.name for path in clips.left])}")


def _some(names: Sequence[str]) -> str:
    """The first few names, and how many more there are."""
    return ", ".join([*names[:NAMED], *([f"{len(names) - NAMED} more"] if len(names) > NAMED else [])])


def _earlier(out: Path, clips: Found) -> tuple[Trouble, ...]:
    """What earlier commands into the folder left undone."""
    try:
        return batches.left_undone(out, clips.places)
    except InvalidFile as error:
        say(f"what earlier commands left undone in {out} is not known: {error}")
        return ()


def _say_earlier(whole: Mapping[str, Any], clips: Found) -> None:
    """Name what is not done of earlier commands into the same folder."""
    names = [str(one["name"]) for one in whole["not_done"] if one["name"] not in clips.places]
    if names:
        say(f"not done, of earlier commands into this folder: {_some(names)}; {batches.WHOLE} says why")
