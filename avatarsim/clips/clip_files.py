"""Clips named on a command line: files, and folders (recursive, sorted), each with its place below the output."""

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from avatarsim.assets.motions.load import PICKLES, READERS
from avatarsim.clips.atomic_files import open_nonblocking
from avatarsim.errors import InvalidInput

OUTPUT_NAMES = ("certificate.json", "index.html", "certificates", "pages")
"""Names in the output folder that no clip may have there."""
CLIPS = 1_000_000
"""Most clips of a command. The largest collection known here has 150,000. More: their names alone fill the memory."""


@dataclass(frozen=True, order=True)
class Clip:
    """A motion file at `path`, whose result goes to `place` below the output folder."""

    place: str
    path: Path


@dataclass(frozen=True)
class ClipFiles:
    """Clips of a command in the order of their places, files of folders that are `left` alone since they are no motions, and
    `folders` by their places, including unreadable ones: (place, path, why)."""

    clips: tuple[Clip, ...]
    left: tuple[Path, ...]
    folders: tuple[str, ...]
    unreadable: tuple[tuple[str, Path, str], ...]

    @property
    def places(self) -> frozenset[str]:
        """Return the places of all files and folders that were visited."""
        return frozenset([*(clip.place for clip in self.clips), *self.folders])


def find_clips(named: Sequence[Path], out: Path | None) -> ClipFiles:
    """Return the clips of the `named` files and folders, without files in the folder `out`.

    A file's place is its name; that of a file in a folder is its path in that folder; a folder's place ends in a slash. Raises
    InvalidInput where two clips would have one place, where a result would replace a named input file, and for names that the
    output uses itself."""
    clips: list[Clip] = []
    left: list[Path] = []
    folders: list[str] = []
    unreadable: list[tuple[str, Path, str]] = []
    for path in named:
        # by os.path, which treats names that are too long for the system as missing files
        if not os.path.isdir(path):
            clips.append(Clip(path.name, path))
            continue
        for file in _files(path, out, folders, unreadable):
            if is_motion(file):
                clips.append(Clip(file.relative_to(path).as_posix(), file))
            else:
                left.append(file)
            if len(clips) > CLIPS:
                raise InvalidInput("number of clips", f"above {CLIPS}", f"up to {CLIPS} in one command")
    clips = sorted(set(clips))
    _require_places(clips, out)
    return ClipFiles(tuple(clips), tuple(left), tuple(sorted(set(folders))), tuple(unreadable))


def _files(folder: Path, out: Path | None, looked: list[str], unreadable: list[tuple[str, Path, str]]) -> Iterator[Path]:
    """Yield the files in and below a folder, sorted; links to folders are not followed, since they may lead in a circle."""

    def refused(error: OSError) -> None:
        at = Path(error.filename)
        looked.append(_place(at, folder))
        unreadable.append((looked[-1], at, error.strerror or str(error)))

    inside = _real(out) if out is not None else None
    for place, folders, files in os.walk(folder, onerror=refused):
        looked.append(_place(Path(place), folder))
        folders[:] = sorted(name for name in folders if not name.startswith(".") and _real(Path(place, name)) != inside)
        yield from (Path(place, name) for name in sorted(files) if not name.startswith("."))


def _place(at: Path, named: Path) -> str:
    """Return the place of a folder in the named folder, which itself goes by its own name."""
    return f"{named.name or named if at == named else at.relative_to(named).as_posix()}/"


def is_motion(path: Path) -> bool:
    """Return True if a file of a folder is treated as a motion.
    It is so by its suffix, and for text also by its first character, since notes lie next to clips."""
    suffix = path.suffix.lower()
    if suffix != ".txt":
        return suffix in READERS or suffix in PICKLES
    try:
        with open_nonblocking(path) as file:
            return file.read(64).lstrip(b"\xef\xbb\xbf \t\r\n").startswith((b"{", b"["))
    except OSError:
        # reported later as unreadable
        return True


def _require_places(clips: Sequence[Clip], out: Path | None) -> None:
    if out is None:
        return
    taken: dict[str, Path] = {}
    sources = {_real(clip.path) for clip in clips}
    for clip in clips:
        if clip.place in taken:
            valid = "one clip for each name in the output folder; name the folder above both in their place"
            raise InvalidInput("clips of one name", [str(taken[clip.place]), str(clip.path)], valid)
        taken[clip.place] = clip.path
        if PurePosixPath(clip.place).parts[0] in OUTPUT_NAMES:
            raise InvalidInput("name of a clip", clip.place, f"a name that is none of {', '.join(OUTPUT_NAMES)}")
        if _real(out / clip.place) in sources:
            raise InvalidInput("output folder", str(out), f"a folder in which {clip.place} is no file that is read")


def _real(path: Path) -> Path:
    """Return the path with links followed, as far as the system resolves it."""
    try:
        return path.resolve()
    except (OSError, RuntimeError, ValueError):
        return path.absolute()
