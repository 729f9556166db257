"""Inputs of a clip: its motion, the avatar and the room, with the SHA-256 of every file read."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path, PurePosixPath
from xml.etree import ElementTree

from avatarsim.assets.models import preflight
from avatarsim.assets.models.load import load_avatar, load_room
from avatarsim.assets.models.mesh_files import candidates
from avatarsim.assets.models.model import Model
from avatarsim.assets.motions.asf_amc import skeleton_next_to
from avatarsim.assets.motions.carried_object import load_object
from avatarsim.assets.motions.home import ENDINGS, parsed_home
from avatarsim.assets.motions.load import load_motion, options_of
from avatarsim.assets.motions.motion_file import MotionFile
from avatarsim.assets.motions.object_poses import PLACES, TURNS
from avatarsim.clips.atomic_files import sha256_of
from avatarsim.clips.options import FLOOR, ClipOptions
from avatarsim.clips.reading import Reading
from avatarsim.errors import InvalidFile
from avatarsim.files import check
from avatarsim.scene.carried import Carried

FILE_BYTES = 2**28
"""Largest size of a motion file [bytes]; readers have limits of their own, this one is for hashing."""

Hashes = tuple[tuple[str, str], ...]
"""(name, SHA-256) of files."""

MEAN = "mean"
"""Value that selects a method of reading BVH in place of a file of offsets."""


@dataclass(frozen=True)
class Files:
    """Hashes of the files of a command's avatar and room; empty without files, and for level ground."""

    avatar: Hashes
    room: Hashes


def files_of(options: ClipOptions) -> Files:
    """Return hashes of the files of avatar and room. Raises InvalidFile for unreadable files."""
    folder = options.reading.folder
    avatar = () if options.avatar is None else _files(options.avatar, folder)
    room = () if options.room is None or str(options.room) == FLOOR else _files(options.room, folder)
    return Files(avatar, room)


def load_models(options: ClipOptions, files: Files) -> tuple[Model | None, Model | None]:
    """Load avatar and room of a command, once per process while their files do not change. Raises InvalidFile, InvalidInput."""
    avatar = None if options.avatar is None else _avatar(options.avatar, options.reading, files.avatar)
    return avatar, None if options.room is None else _room(options.room, options.reading, avatar is not None, files.room)


@lru_cache(maxsize=2)
def _avatar(path: Path, reading: Reading, files: Hashes) -> Model:
    model = load_avatar(path, **reading.of_avatar())  # type: ignore[arg-type]
    if model.avatar is None:
        raise InvalidFile(f"avatar in {path.name}", "none", "a file with joints; a room goes with --room")
    return model


@lru_cache(maxsize=2)
def _room(path: Path, reading: Reading, with_avatar: bool, files: Hashes) -> Model:
    if str(path) == FLOOR:
        return load_room(FLOOR)
    is_model = path.suffix.lower() in preflight.MODELS
    return load_room(path, **reading.of_room(is_model, with_avatar))  # type: ignore[arg-type]


def _hashed(path: Path, name: str) -> tuple[str, str]:
    check(path, f"file {name}", "a readable file", FILE_BYTES)
    try:
        status = path.stat()
        return name, _sha256(path, status.st_ino, status.st_size, status.st_mtime_ns)
    except OSError as error:
        raise InvalidFile(f"file {name}", error.strerror or str(error), "a readable file") from error


@lru_cache(maxsize=4096)
def _sha256(path: Path, number: int, size: int, written: int) -> str:
    """Return the hash of a file of this number, size and time: a model of a thousand clips is hashed once."""
    return sha256_of(path)


def _files(path: Path, folder: str | None) -> Hashes:
    """Return hashes of a model's or mesh's file and of all files that it names. Raises InvalidFile for unreadable files."""
    if path.suffix.lower() not in preflight.MODELS:
        return (_hashed(path, path.name),)
    base = preflight.folder_of(path, folder)
    texts = preflight.texts_of(path, base)
    found = {name: base / name for name in texts.texts}
    for name, place in _named(texts):
        found[name] = place
    return tuple(_hashed(place, name) for name, place in sorted(found.items()))


def _named(texts: preflight.Texts) -> Iterator[tuple[str, Path]]:
    """Yield the mesh files of a model: (path below its folder, place). The model's reader rejects missing ones."""
    trees = [ElementTree.fromstring(content) for content in texts.texts.values()]
    folders = {node.get("meshdir") or node.get("assetdir") or "" for tree in trees for node in tree.iter("compiler")} | {""}
    bases = [PurePosixPath(name).parent for name in texts.texts]
    for mesh in (node for tree in trees for node in tree.iter("mesh")):
        file = mesh.get("file") or mesh.get("filename")
        if not file:
            continue
        for meshdir in sorted(folders):
            try:
                yield preflight.existing(f"mesh {file}", candidates(file, meshdir, True, bases), texts.folder)
            except InvalidFile:
                continue
            break


def motion_files(path: Path, reading: Reading) -> Hashes:
    """Return hashes of a motion file and of its skeleton file, if it has one. Raises InvalidFile."""
    suffix = path.suffix.lower()
    companions = [skeleton_of(path, reading)] if suffix == ".amc" else []
    if reading.offsets is not None and suffix == ".npz" and reading.offsets != MEAN:
        companions.append(Path(reading.offsets))
    if suffix in ENDINGS:
        companions.append(parsed_home("home", reading.home)[0])
    shape = () if reading.object_file is None else _files(Path(reading.object_file), None)
    return (*(_hashed(one, one.name) for one in [path, *companions] if one is not None), *shape)


def carried_in(file: MotionFile, reading: Reading) -> tuple[Carried, ...]:
    """Return the object of a motion file, where its shape is known. Raises InvalidFile for a shape without poses."""
    if file.object is None:
        if reading.object_file is not None:
            valid = f"a motion with one of {', '.join(PLACES)} and one of {', '.join(TURNS)}"
            raise InvalidFile(f"poses of the object {Path(reading.object_file).name}", None, valid)
        return ()
    if reading.object_file is None and file.object.size is None:
        return ()
    return (load_object(file.object, reading.object_file, scale=reading.object_scale),)


def skeleton_of(path: Path, reading: Reading) -> Path | None:
    """Return the ASF file of an AMC file: the one of the options, else by its name."""
    return skeleton_next_to(path) if reading.asf is None else Path(reading.asf)


def options_for(path: Path, reading: Reading) -> dict[str, object]:
    """Return the options for the reader of a motion; of AMC with the skeleton's path, so that a copy elsewhere uses it too."""
    options = reading.of_motion()
    skeleton = skeleton_of(path, reading) if path.suffix.lower() == ".amc" else None
    return options if skeleton is None else {**options, "skeleton": str(skeleton)}


def read(path: Path, options: Mapping[str, object]) -> tuple[MotionFile, tuple[str, ...]]:
    """Read the motion at `path`; also return those of `options` that its format lacks. Raises InvalidFile, InvalidInput."""
    known = options_of(path.suffix.lower())
    used = {name: value for name, value in options.items() if name in known}
    return load_motion(path, **used), tuple(sorted(set(options) - set(used)))
