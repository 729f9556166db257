"""Motion files by the end of their names: which reader takes which, imported when it is first asked for."""

from importlib import import_module
from pathlib import Path
from typing import cast

from avatarsim.assets.motions.motion_file import MotionFile
from avatarsim.errors import InvalidFile, InvalidInput

READERS = {
    ".amc": ("asf_amc", "read_amc"),
    ".bvh": ("bvh", "read_bvh"),
}
"""The module of this folder, and the function in it, that reads files whose names end so."""


def load_motion(path: str | Path, **options: object) -> MotionFile:
    """The motion in a file, by the end of its name. `options` are those of its reader.

    Raises InvalidFile for an ending that no reader takes and for what is wrong with the file, InvalidInput for options that its
    reader has not."""
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in READERS:
        raise InvalidFile(f"end of the name of {path.name}", path.suffix, f"one of {', '.join(sorted(READERS))}")
    module, function = READERS[suffix]
    reader = getattr(import_module(f"avatarsim.assets.motions.{module}"), function)
    unknown = sorted(set(options) - set(reader.__kwdefaults__ or ()))
    if unknown:
        raise InvalidInput(f"option for {path.name}", unknown[0], f"one of {', '.join(sorted(reader.__kwdefaults__ or ()))}")
    return cast(MotionFile, reader(path, **options))
