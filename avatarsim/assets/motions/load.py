"""The door for motion files: a reader per suffix, and a sentence for what is not read."""

import inspect
from importlib import import_module
from pathlib import Path
from typing import Any

from avatarsim.assets.motions.motion_file import MotionFile
from avatarsim.errors import InvalidFile, UnknownName

READERS: dict[str, str] = {
    ".csv": "avatarsim.assets.motions.table",
    ".npz": "avatarsim.assets.motions.npz",
    ".txt": "avatarsim.assets.motions.deepmimic",
}
"""Suffix to the module whose `read(path, **options)` reads such files. Imported when one is read."""

PICKLES = (".pkl", ".pickle", ".joblib", ".pt", ".pth")
"""Suffixes of pickles, which run what their author wrote into them."""


def load_motion(path: str | Path, **options: Any) -> MotionFile:
    """The motion in a file, by its suffix; `options` are those of the reader.

    Raises InvalidFile for a file that is damaged, too large or of another kind, and UnknownName for an option that its format
    does not have."""
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix in PICKLES:
        valid = (
            "a file that runs no program when it is read. Where you trust it, convert it: "
            f'python -c "import pickle, numpy; numpy.savez(\'{path.stem}.npz\', **pickle.load(open(\'{path.name}\', \'rb\')))"'
        )
        raise InvalidFile(f"motion {path.name}", "a pickle", valid)
    if suffix not in READERS:
        raise InvalidFile(f"suffix of motion {path.name}", suffix, f"one of {', '.join(sorted(READERS))}")
    read = import_module(READERS[suffix]).read
    known = [name for name in inspect.signature(read).parameters if name != "path"]
    for name in options:
        if name not in known:
            raise UnknownName(f"option for {suffix} files", name, known)
    found: MotionFile = read(path, **options)
    return found
