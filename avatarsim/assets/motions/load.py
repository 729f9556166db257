"""Motion files by their suffix: the reader for each, imported at its first use."""

from importlib import import_module
from pathlib import Path
from typing import Any, cast

from avatarsim.assets.motions.motion_file import MotionFile
from avatarsim.errors import InvalidFile, InvalidInput

READERS = {
    ".amc": ("asf_amc", "read_amc"),
    ".bvh": ("bvh", "read_bvh"),
    ".csv": ("table", "read_csv"),
    ".npz": ("npz", "read_npz"),
    ".txt": ("deepmimic", "read_deepmimic"),
}
"""Module of this folder, and its function, for files of a suffix."""

PICKLES = (".pkl", ".pickle", ".joblib", ".pt", ".pth")
"""Suffixes of pickles, which run their author's code."""

NO_HOME = (
    "only recorded skeletons (.amc, .bvh) may be folded at rest and need one; a body of the SMPL family stands at rest in "
    "every clip, and a robot has keyframe= of its model"
)
"""Reason for which a reader lacks this option."""


def load_motion(path: str | Path, **options: object) -> MotionFile:
    """Read the motion in a file, by its suffix. `options` are those of its reader.

    Raises InvalidFile for a suffix without a reader and for an error in the file, InvalidInput for options that its
    reader lacks."""
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix in PICKLES:
        convert = (
            f"import pickle, numpy; numpy.savez('{path.stem}.npz', **{{key: numpy.asarray(value) for key, value in "
            f"pickle.load(open('{path.name}', 'rb')).items()}})"
        )
        valid = f'a file that runs no program when it is read. If you trust it, convert it: python -c "{convert}"'
        raise InvalidFile(f"motion {path.name}", "a pickle", valid)
    if suffix not in READERS:
        raise InvalidFile(f"end of the name of {path.name}", path.suffix, f"one of {', '.join(sorted(READERS))}")
    known = options_of(suffix)
    if options.get("home") is not None and "home" not in known:
        raise InvalidInput(f"home of {path.name}", options["home"], f"none: {NO_HOME}")
    if unknown := sorted(set(options) - set(known)):
        raise InvalidInput(f"option for {path.name}", unknown[0], f"one of {', '.join(sorted(known))}")
    return cast(MotionFile, _reader(suffix)(path, **options))


def options_of(suffix: str) -> tuple[str, ...]:
    """Return the options of the reader for files of this suffix; none for a suffix without a reader."""
    return tuple(_reader(suffix).__kwdefaults__ or ()) if suffix in READERS else ()


def _reader(suffix: str) -> Any:
    module, function = READERS[suffix]
    return getattr(import_module(f"avatarsim.assets.motions.{module}"), function)
