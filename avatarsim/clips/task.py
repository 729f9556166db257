"""One clip from its file to its outputs: read, cleaned, written, read back, measured and certified; or audited alone.

The certificate of a clip is written last, and names its inputs, its options and its outputs by their hashes: a clip whose
certificate still agrees with all of them is done.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from avatarsim.assets.models.model import Model
from avatarsim.assets.motions.home import parsed_home
from avatarsim.assets.motions.load import NO_HOME, options_of
from avatarsim.cleaning import Audit, Cleaned, audit, clean
from avatarsim.clips import certificate
from avatarsim.clips.atomic_files import moved, put, require_replaceable, sha256_of, temporary_path, write_atomically
from avatarsim.clips.clip_files import Clip
from avatarsim.clips.inputs import carried_in, files_of, load_models, motion_files, options_for, read
from avatarsim.clips.options import OPTIONS, ClipOptions
from avatarsim.clips.page.clip_page import Shown, clip_page
from avatarsim.clips.page.layout import GENERATOR
from avatarsim.errors import InvalidFile, InvalidInput, StartOverlaps
from avatarsim.scene.body import Body
from avatarsim.scene.carried import Carried
from avatarsim.scene.motion import Motion

CERTIFICATES, PAGES = "certificates", "pages"
"""Folders of the output for files that belong to one clip."""

UNREADABLE, REFUSED, OVERLAPS = "unreadable", "refused", "no free posture"
"""Kinds of trouble."""


@dataclass(frozen=True)
class Task:
    """A clip with its options and output folder (None: an audit, which writes nothing), and whether it is repeated in any case
    (`force`), also in place of a file that another program wrote."""

    clip: Clip
    options: ClipOptions
    out: Path | None
    force: bool = False


@dataclass(frozen=True)
class Outcome:
    """Result of a clip: its entry in the certificate, or the trouble (its kind and a sentence). `done_before`: earlier.
    `notes` are sentences for the user that are not part of the certificate."""

    place: str
    entry: Mapping[str, object] | None = None
    trouble: tuple[str, str] | None = None
    done_before: bool = False
    notes: tuple[str, ...] = ()


def outcome(task: Task, progress: Callable[[float], None] | None = None) -> Outcome:
    """Run the task; errors in files become part of the outcome.
    Raises MissingPackage, and OSError where an output cannot be written."""
    place = task.clip.place
    try:
        return _Clip(task).done(progress)
    except StartOverlaps as error:
        return Outcome(place, trouble=(OVERLAPS, str(error)))
    except InvalidFile as error:
        return Outcome(place, trouble=(UNREADABLE, str(error)))
    except InvalidInput as error:
        return Outcome(place, trouble=(REFUSED, str(error)))


class _Clip:
    """One clip in progress."""

    def __init__(self, task: Task) -> None:
        self.task, self.options = task, task.options
        self.place, self.path = task.clip.place, task.clip.path
        self.carried: tuple[Carried, ...] = ()
        self.reader_options = options_for(task.clip.path, task.options.reading)

    def done(self, progress: Callable[[float], None] | None) -> Outcome:
        files = files_of(self.options)
        key = certificate.key(motion_files(self.path, self.options.reading), files.avatar, files.room, self.options)
        if self.task.out is not None and not self.task.force:
            earlier = finished(self.task.out, self.place, key, self.options.page)
            if earlier is not None:
                return Outcome(self.place, earlier, done_before=True)
        avatar, room = load_models(self.options, files)
        file, unused = read(self.path, self.reader_options)
        model = _model(avatar, file.model(), self.path)
        motion = file.motion(model)
        notes = [*(room.notes if room else ()), *model.notes, *file.notes]
        self.carried = carried_in(file, self.options.reading)
        if self.options.rate is not None:
            motion = motion.resampled(self.options.rate)
            self.carried = tuple(one.resampled(self.options.rate) for one in self.carried)
        if self.options.ground is not None:
            motion = lowered(motion, self.options.ground)
            self.carried = tuple(replace(one, motion=lowered(one.motion, self.options.ground)) for one in self.carried)
        bodies = room.room if room else ()
        reasons = {"home": f": {NO_HOME}"}
        left = (f"--{OPTIONS.get(name, name)} is not for {self.path.suffix} files{reasons.get(name, '')}" for name in unused)
        reported = (*left, *file.notes)
        if self.task.out is None:
            before = audit(motion, model, bodies, self.options.cleaning, self.carried)
            measured = certificate.entry(self.place, file.format, key, motion, before, notes=notes)
            return Outcome(self.place, measured, notes=(*reported, *_of_clip(self.place, before)))
        cleaned = clean(motion, model, bodies, self.options.cleaning, progress, self.carried)
        entry = self._written(file.written(cleaned.motion, model), file.format, key, motion, cleaned, model, room, notes)
        return Outcome(self.place, entry, notes=(*reported, *_of_clip(self.place, cleaned.before)))

    def _written(
        self, content: bytes, format_: str, key: Mapping[str, object], motion: Motion, cleaned: Cleaned, model: Model,
        room: Model | None, notes: list[str],
    ) -> Mapping[str, object]:
        """Write the outputs and return the entry of the certificate, measured on the file that is read back."""
        out = self.task.out
        assert out is not None
        target = out / self.place
        with temporary_path(target) as path:
            put(content, path)
            back, after = self._read_back(path, motion, cleaned, model, room.room if room else ())
            outputs = {"motion": (self.place, sha256_of(path))}
            self._require_free(target, outputs["motion"][1])
            entry = certificate.entry(self.place, format_, key, motion, cleaned.before, after, cleaned, notes, outputs)
            if self.options.page:
                shown = Shown(model, room, motion, back, cleaned.before, after, cleaned.flagged, self.carried)
                page = page_of(self.place)
                require_replaceable(out / page, GENERATOR, self.task.force, page)
                write_atomically(out / page, clip_page(entry, shown, page))
            moved(path, target)
        write_atomically(out / certificate_of(self.place), certificate.text(entry))
        return entry

    def _read_back(
        self, path: Path, motion: Motion, cleaned: Cleaned, model: Model, bodies: tuple[Body, ...]
    ) -> tuple[Motion, Audit]:
        """Read the written motion back with its reader, and measure it."""
        options = dict(self.reader_options)
        if self.options.rate is not None and "rate" in options_of(self.path.suffix.lower()):
            # for a file that states none
            options["rate"] = self.options.rate
        if "home" in options and parsed_home("home", options["home"])[0] is None:
            # a frame as recorded
            options["home"] = f"{self.path}:{options['home']}"
        back = read(path, options)[0].motion(model)
        if len(back) != len(motion):
            raise InvalidFile(f"frames of {self.place} as it was written", len(back), f"{len(motion)}, as it was cleaned")
        fields = ("positions", "rotations", "angles")
        same = all(np.array_equal(getattr(back, name), getattr(cleaned.motion, name)) for name in fields)
        if same:
            return back, cleaned.after
        found = audit(back, model, bodies, self.options.cleaning, self.carried)
        # over frames selected by the input, which the written motion does not contain; rounding changes no digit
        measures = {name: getattr(cleaned.after, name) for name in ("jerk_free", "jerk_held", "foot_slide")}
        return back, replace(found, **measures)

    def _require_free(self, target: Path, content: str) -> None:
        """Raise InvalidInput where a file that this program did not write is in the place of the result."""
        if self.task.force or not target.exists():
            return
        assert self.task.out is not None
        before = certificate.read(self.task.out / certificate_of(self.place))
        known_hashes = {content, certificate.output_hash(before, "motion")}
        if not target.is_file() or sha256_of(target) not in known_hashes:
            valid = "a place without a file that something else wrote; take another folder, or --force to write over it"
            raise InvalidInput("place of the result", self.place, valid)


def _model(avatar: Model | None, own: Model | None, path: Path) -> Model:
    """Return the avatar of the command, else that of the motion file."""
    if avatar is not None:
        return avatar
    if own is None:
        raise InvalidFile(f"avatar for {path.name}", "none", "--avatar with an MJCF or URDF file: this format brings no skeleton")
    return own


def _of_clip(place: str, before: Audit) -> tuple[str, ...]:
    """Return the notes on the recording of a clip, with its place."""
    return tuple(f"{place}: {note}" for note in before.notes)


def lowered(motion: Motion, height: float) -> Motion:
    """Return the motion with its ground moved from a height [m] to 0."""
    return replace(motion, positions=motion.positions - np.array([0.0, 0.0, height]))


def certificate_of(place: str) -> str:
    """Return the path of a clip's certificate below the output folder."""
    return f"{CERTIFICATES}/{place}.json"


def page_of(place: str) -> str:
    """Return the path of a clip's page below the output folder."""
    return f"{PAGES}/{place}.html"


def finished(out: Path, place: str, key: Mapping[str, object], page: bool) -> Mapping[str, object] | None:
    """Return the entry of a clip already done with the same inputs, options and versions and intact outputs; else None."""
    entry = certificate.read(out / certificate_of(place))
    if entry is None or any(entry.get(name) != value for name, value in certificate.plain(key).items()):
        return None
    if page and not (out / page_of(place)).is_file():
        return None
    written = out / place
    try:
        whole = written.is_file() and sha256_of(written) == certificate.output_hash(entry, "motion")
    except OSError:
        return None
    return entry if whole else None
