"""The wheel alone, built and run with README's example and nothing else.
Command: `python -m tests.house.wheel [--python NAME ...] [--with-kernels]`.

Each interpreter gets an environment with the wheel and its requirements in the versions of requirements.lock, a user that is not
root, an empty working folder, and a read-only HOME. Checks: README's example prints the documented output, twice; a missing
extra is named with a command that pip understands; nothing of the checkout and no optional package is loaded.

With `--with-kernels` the wheel is built for each interpreter and contains compiled kernels. With its dependencies installed, the
time from `pip install` to the first frame is then below 5 s.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
NOBODY = 65534
"""Id of the unprivileged user and group that run everything when root starts this."""
PYTHONS = ("python3.11", "python3.12", "python3.13")
PROMISED = 5.0
"""Longest time [s] from `pip install` of a wheel with kernels to the first frame, with its dependencies installed."""
LONGEST = 900.0
"""Longest duration [s] of one step: the engine's kernels are compiled on one core."""

EXTRA = """
from avatarsim.errors import MissingPackage
from avatarsim.assets.meshes import pieces_of_mesh
open("some.stl", "wb").write(bytes(134))
try:
    pieces_of_mesh("some.stl")
except MissingPackage as error:
    print(error)
"""
VERSION = "import platform; print(platform.python_version())"
BASE = "import sys; print(sys.base_prefix); print('python%d.%d' % sys.version_info[:2])"
GENERAL = """
from importlib.util import find_spec
print([name for name in ("runfiles", "reference", "scenarios", "benchmarks", "reports", "tests") if find_spec(name)])
"""
WHERE = """
import avatarsim, os
print(avatarsim.__file__, os.getuid(), os.access(os.environ["HOME"], os.W_OK), os.listdir("."))
"""
LIGHT = """
import sys, avatarsim.simulator
optional = {"pandas", "trimesh", "coacd", "mujoco", "pybullet", "runfiles", "scenarios", "benchmarks"}
print(sorted({name.partition(".")[0] for name in sys.modules} & optional))
"""


@dataclass(frozen=True)
class Answer:
    """Result of one interpreter.
    Its version, seconds of `pip install` of the wheel alone, of the first start and of a later one, and the faults found."""

    version: str
    install: float
    first: float
    later: float
    faults: tuple[str, ...]


class Stopped(Exception):
    """Error of a failed step; its text gives the step and the reason."""


def run(command: Iterable[object], **options: Any) -> str:
    """Return the standard output of a command. Raises Stopped with its last lines if it fails."""
    words = [str(word) for word in command]
    try:
        done = subprocess.run(words, capture_output=True, text=True, timeout=LONGEST, stdin=subprocess.DEVNULL, **options)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise Stopped(str(error)) from error
    if done.returncode != 0:
        last = (done.stderr.strip() or done.stdout.strip() or "it said nothing").splitlines()[-8:]
        raise Stopped(f"{' '.join(words)[:120]} ended with {done.returncode}: " + "\n".join(last))
    return str(done.stdout)


def copied(folder: Path) -> Path:
    """Return a copy of the committed and changed files of this checkout, without leftovers of builds."""
    source = folder / "source"
    source.mkdir()
    listed = run(["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"], cwd=ROOT).split("\0")
    for name in listed:
        if (ROOT / name).is_file() and not (ROOT / name).is_symlink():
            (source / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, source / name)
    return source


def built(python: str | Path, source: Path, folder: Path, *options: str) -> Path:
    """Build the wheel of a copy of this checkout with the packages of an interpreter."""
    pip = [python, "-m", "pip", "wheel", "--no-deps", "--no-build-isolation", "--quiet", *options]
    run([*pip, "-w", folder / "dist", source])
    [wheel] = (folder / "dist").glob("avatarsim-*.whl")
    return wheel


def with_kernels(python: str, source: Path, folder: Path) -> Path:
    """Build the wheel with kernels, in an environment of this interpreter that has only the packages required for it."""
    environment, project = folder / "builder", tomllib.loads((source / "pyproject.toml").read_text(encoding="utf-8"))
    run([python, "-m", "venv", environment])
    installed(environment / "bin" / "python", folder, *project["build-system"]["requires"], *project["project"]["dependencies"])
    return built(environment / "bin" / "python", source, folder, "-C--build-option=--with-kernels")


def installed(python: Path, folder: Path, *wanted: str) -> None:
    """Install packages in the locked versions."""
    (folder / "constraints.txt").write_text(locked(), encoding="utf-8")
    run([python, "-m", "pip", "install", "--quiet", "--only-binary", ":all:", "-c", folder / "constraints.txt", *wanted])


def locked() -> str:
    """Return the locked versions as constraints for pip."""
    text = (ROOT / "requirements.lock").read_text(encoding="utf-8")
    return "".join(f"{name}=={version}\n" for name, version in re.findall(r"(?m)^([\w.-]+)==([^\s;]+)", text))


def example() -> tuple[str, str]:
    """Return README's example and its documented output."""
    code, *_ = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(encoding="utf-8"), re.DOTALL)
    [printed] = re.findall(r"^print\(.*\)  # ([\d.]+):", code, re.MULTILINE)
    return code, printed


def as_nobody() -> dict[str, Any]:
    """Return the options of a process that does not run as root; only root can change the user, and only root has to."""
    return {"user": NOBODY, "group": NOBODY, "extra_groups": []} if os.getuid() == 0 else {}


def reachable(python: str, folder: Path) -> str:
    """Return the interpreter, or a copy of it where only root can access it, as in a folder below root's own."""
    try:
        run([os.path.realpath(python), "-c", ""], **as_nobody())
        return python
    except Stopped:
        base, name = run([python, "-c", BASE]).split()
        left = shutil.ignore_patterns("test", "*.a", "__pycache__")
        shutil.copytree(base, folder / "interpreter", symlinks=True, ignore=left)
        return str(folder / "interpreter" / "bin" / name)


def answer(python: str, wheel: Path, folder: Path) -> Answer:
    """Install the wheel for one interpreter and check it. Raises Stopped if a step fails."""
    environment, home, empty, scratch = (folder / name for name in ("environment", "home", "empty", "scratch"))
    run([reachable(python, folder), "-m", "venv", environment])
    inside = environment / "bin" / "python"
    installed(inside, folder, *tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["dependencies"])
    begun = time.monotonic()
    installed(inside, folder, str(wheel))
    install = time.monotonic() - begun
    for place, mode in ((home, 0o555), (empty, 0o777), (scratch, 0o777)):
        place.mkdir()
        place.chmod(mode)
    variables = {"PATH": "/usr/bin:/bin", "HOME": str(home), "TMPDIR": str(scratch), "LANG": "C.UTF-8"}
    # a copied interpreter looks for its library at the old place, and the system's folders may have another of the same name
    variables |= {"LD_LIBRARY_PATH": str(folder / "interpreter" / "lib")} if (folder / "interpreter").exists() else {}
    alone = {"env": variables, "cwd": empty, **as_nobody()}
    faults = []
    version, wanted = run([inside, "-c", VERSION], **alone).strip(), run([python, "-c", VERSION]).strip()
    if version != wanted:
        faults.append(f"Python {version} runs, not {wanted}")
    where, user, writable, held = run([inside, "-c", WHERE], **alone).strip().split(" ", 3)
    if not where.startswith(str(environment)) or user == "0" or writable != "False" or held != "[]":
        faults.append(f"it does not stand alone: {where}, user {user}, HOME may be written to: {writable}, folder: {held}")
    if (loaded := run([inside, "-c", LIGHT], **alone).strip()) != "[]":
        faults.append(f"the engine loads {loaded}")
    code, said = example()
    seconds = []
    for _ in range(2):
        begun = time.monotonic()
        printed = run([inside, "-W", "error::SyntaxWarning", "-c", code], **alone).strip()
        seconds.append(time.monotonic() - begun)
        if printed != said:
            faults.append(f"README's example prints {printed}, not {said}")
    told = run([inside, "-c", EXTRA], **alone).strip()
    command = told.partition("pip install ")[2]
    if not (command and "trimesh" in command and "[" not in command and str(ROOT) not in command):
        faults.append(f"a missing extra is not named with a command that works: {told}")
    for word in ("pieces", "compare"):
        if "usage" not in run([inside, "-m", "avatarsim", word, "--help"], **alone):
            faults.append(f"python -m avatarsim {word} --help prints no usage")
    if (general := run([inside, "-c", GENERAL], **alone).strip()) != "[]":
        faults.append(f"general names among the installed packages: {general}")
    if not list(environment.glob("lib/python*/site-packages/avatarsim/_harness/scenarios/__main__.py")):
        faults.append("the wheel is without the harness that avatarsim compare runs")
    return Answer(version, install, seconds[0], seconds[1], tuple(faults))


def main(words: list[str] | None = None) -> int:
    """Return 0 if the wheel works in every named interpreter, or in all existing ones if none is named; otherwise 1."""
    options = argparse.ArgumentParser(prog="python -m tests.house.wheel", description="The built wheel, alone.")
    said = f"an interpreter (default: those of {', '.join(PYTHONS)} that run)"
    options.add_argument("--python", action="append", metavar="NAME", help=said)
    options.add_argument("--with-kernels", action="store_true", help="a wheel for each interpreter that carries compiled kernels")
    asked, code = options.parse_args(words), 0
    with tempfile.TemporaryDirectory(prefix="wheel-") as made:
        folder = Path(made)
        folder.chmod(0o755)
        source = copied(folder)
        plain = None if asked.with_kernels else built(sys.executable, source, folder)
        for k, python in enumerate(asked.python or PYTHONS):
            path = shutil.which(python)
            if path is None or subprocess.run([path, "-c", ""], capture_output=True, check=False).returncode != 0:
                print(f"{python}: not asked, there is none that runs")
                code |= bool(asked.python)
                continue
            try:
                own = folder / str(k)
                own.mkdir(mode=0o755)
                wheel = plain or with_kernels(path, source, own)
                got = answer(path, wheel, own)
            except Stopped as error:
                print(f"{python}: {error}")
                code = 1
                continue
            faults = [*got.faults, *late(got)] if asked.with_kernels else got.faults
            print(f"{python} ({got.version}), {wheel.name}, {wheel.stat().st_size / 1e6:.2f} MB: {'; '.join(faults) or 'works'}; "
                  f"pip install {got.install:.1f} s, first start {got.first:.1f} s, later {got.later:.1f} s", flush=True)
            code |= bool(faults)
    return code


def late(got: Answer) -> tuple[str, ...]:
    """Return a sentence if a wheel with kernels is slower than PROMISED."""
    took = got.install + got.first
    return () if took < PROMISED else (f"from pip install to the first frame {took:.1f} s, not below {PROMISED:g}",)


if __name__ == "__main__":
    sys.exit(main())
