"""Comparison of a user's own scene in all installed engines: the command `avatarsim compare`, and `av.compare`.

The harness runs in a process of its own. In a wheel it lies in the folder `_harness` of this package, which is on the path of
that process alone: its packages have general names, such as `scenarios`, and a user's own modules of these names stay theirs.
"""

import json
import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from avatarsim import errors
from avatarsim.errors import AvatarsimError, InvalidFile, InvalidInput, MissingPackage

if TYPE_CHECKING:
    import pandas as pd

PACKAGE = Path(__file__).resolve().parent
SHIPPED = PACKAGE / "_harness"
"""Folder of the harness in a wheel; setup.py fills it."""
ENTRY = Path("scenarios", "__main__.py")
NEEDED: Mapping[str, str] = {"pandas": "pandas", "tqdm": "tqdm", "pebble": "pebble", "coal": "coal", "mujoco": "mujoco"}
"""Modules without which no scene is compared -> their distributions: tables, processes, the judge, and the reader of models."""
STOPPED = 130
"""Exit code after Ctrl-C."""
PathLike = str | Path


def harness() -> Path:
    """Return the folder with the packages of the harness: the checkout's own, else that of the wheel. Raises InvalidFile."""
    for folder in (PACKAGE.parent, SHIPPED):
        if (folder / ENTRY).is_file() and (folder / "runfiles" / "metrics.toml").is_file():
            return folder
    raise InvalidFile(f"harness of {PACKAGE}", "missing", "a checkout, or a wheel that was built from one")


def command(words: Sequence[str]) -> tuple[list[str], dict[str, str]]:
    """Return the command line and the environment of a comparison. Raises MissingPackage where the extra is not installed."""
    for module, distribution in NEEDED.items():
        if find_spec(module) is None:
            raise MissingPackage(distribution, "compare", "avatarsim compare")
    folder = str(harness())
    path = os.pathsep.join(filter(None, [folder, os.environ.get("PYTHONPATH", "")]))
    # -P: a module in the user's folder is not imported in the place of the harness, in children neither
    environment = {**os.environ, "PYTHONPATH": path, "PYTHONSAFEPATH": "1"}
    return [sys.executable, "-P", "-m", "scenarios", "scene", *words], environment


def run(words: Sequence[str]) -> int:
    """Carry out `avatarsim compare`; return its exit code. Raises MissingPackage."""
    line, environment = command(words)
    sys.stdout.flush()
    with subprocess.Popen(line, env=environment) as process:
        while True:
            try:
                return process.wait()
            except KeyboardInterrupt:
                # the terminal sends Ctrl-C to both, and the other one ends with its own message
                continue


def compared(scene: PathLike, words: Sequence[str] = ()) -> Mapping[str, Any]:
    """Return the comparison of a scene as `avatarsim compare --json` prints it.

    Progress and remarks go to standard error.

    Raises:
        AvatarsimError: that of the comparison, of its own type.
    """
    line, environment = command([str(scene), "--json", *words])
    ran = subprocess.run(line, env=environment, stdout=subprocess.PIPE, stdin=subprocess.DEVNULL, text=True, encoding="utf-8")
    try:
        results: Mapping[str, Any] = json.loads(ran.stdout)
    except ValueError:
        how = "was stopped" if ran.returncode == STOPPED else f"ended with code {ran.returncode}"
        raise AvatarsimError(f"the comparison of {scene} {how}; standard error has why") from None
    if "error" in results:
        raise _error(results["error"])
    return results


def _error(described: Mapping[str, str]) -> AvatarsimError:
    """Return the error of another process, with its type and text; of an invalid input with its parts."""
    kind = getattr(errors, described["type"], AvatarsimError)
    error: AvatarsimError = kind.__new__(kind)
    Exception.__init__(error, described["text"])
    if isinstance(error, InvalidInput):
        error.thing, error.value, error.valid = described["thing"], described["value"], described["valid"]
    return error


def compare(
    scene: PathLike, motion: PathLike | None = None, *, avatar: PathLike | None = None, room: PathLike | None = None,
    engines: Sequence[str] = (), seconds: float | None = None, options: Sequence[str] = (),
) -> "pd.DataFrame":
    """Run a scene of your own in every installed engine, and measure the states that each shows.

    Args:
        scene: MJCF, URDF, a mesh as a room, or a recording of `avatarsim live`.
        motion: motion of the avatar; without one it holds its first posture.
        avatar: file of the avatar, if the scene holds none.
        room: file of the room about it, or the word "floor".
        engines: "mujoco" or "mujoco/tuned"; all that are installed by default.
        seconds: length [s], 5 by default; with a motion, of it at most.
        options: further words of the command line, such as ("--file-rate", "60"); `avatarsim compare --help` lists them.

    Returns:
        A row per engine and preset, by its name "mujoco/tuned": version, state ("measured", or why there are no figures, in
        note), frames, overlap, and every metric that the scene has, in its unit. `overlap` is residual_overlap_max [m]. Units and
        labels are in `table.attrs["metrics"]`.

    Raises:
        MissingPackage: where the extra `compare` is not installed.
        InvalidInput: for a file, an engine, a preset or an option that is not valid.
    """
    return table(compared(scene, words_of(motion, avatar, room, engines, seconds, options)))


def words_of(
    motion: PathLike | None = None, avatar: PathLike | None = None, room: PathLike | None = None, engines: Sequence[str] = (),
    seconds: float | None = None, options: Sequence[str] = (),
) -> list[str]:
    """Return the arguments of `compare` as words of the command line."""
    if isinstance(engines, str) or isinstance(options, str):
        raise InvalidInput("engines and options", (engines, options), "sequences of texts")
    named = {"motion": motion, "avatar": avatar, "room": room, "seconds": seconds}
    words = [f"--{name}={value}" for name, value in named.items() if value is not None]
    return [*words, *(["--engine", *engines] if engines else []), *map(str, options)]


def table(results: Mapping[str, Any]) -> "pd.DataFrame":
    """Return a comparison as `compare` does."""
    import pandas as pd

    runs = {one["run"]: {name: one[name] for name in ("version", "state", "note", "frames")} for one in results["runs"]}
    for one in runs.values():
        one["overlap"] = float("nan")
    for row in results["rows"]:
        if row["metric"] != "run":
            value = float("nan") if row["value"] is None else float(row["value"])
            runs[f"{row['engine']}/{row['preset']}"][row["metric"]] = value
            if row["metric"] == "residual_overlap_max":
                runs[f"{row['engine']}/{row['preset']}"]["overlap"] = value
    made = pd.DataFrame.from_dict(runs, orient="index").rename_axis("engine")
    made.attrs["metrics"] = dict(results["metrics"])
    return made
