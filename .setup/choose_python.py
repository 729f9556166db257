"""Finds a Python that can hold the virtual environment, and starts install.py with it.

`make` runs this file with the first Python it finds, however old. Nothing newer than Python 2.7 may be
written here: an old Python must reach the message about it, not stop at a line it cannot read.
"""

import os
import subprocess
import sys

OLDEST, NEWEST = (3, 11), (3, 13)
SUPPORTED = "Python 3.11, 3.12 or 3.13"
# 3.11 comes first because it is the newest Python for which pybullet offers a ready-made package.
NAMES = ("python3.11", "python3", "python3.12", "python3.13")
FOLDER = os.path.dirname(os.path.abspath(__file__))
VENV_PYTHON = os.path.join(os.path.dirname(FOLDER), ".venv", "bin", "python")

# Runs inside a candidate and prints its version, then the modules it lacks (Debian ships ensurepip apart).
QUESTION = """
import sys
lacking = []
for name in sys.argv[1:]:
    try:
        __import__(name)
    except ImportError:
        lacking.append(name)
print(" ".join([".".join(map(str, sys.version_info[:3]))] + lacking))
"""


def probe(path, modules=("venv", "ensurepip")):
    # type: (str, tuple[str, ...]) -> tuple[str, tuple[int, ...], list[str]] | None
    """Return (path, version, missing modules) of an interpreter, or None if it does not run."""
    try:
        command = [path, "-c", QUESTION] + list(modules)
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        words = process.communicate()[0].decode("ascii", "replace").split()
    except OSError:
        return None
    if process.returncode != 0 or not words:
        return None
    return path, tuple(int(part) for part in words[0].split(".")), words[1:]


def on_path(names, path):
    # type: (tuple[str, ...], str) -> list[str]
    """Return every executable file of these names in the folders of `path`: name by name, then folder by folder."""
    places = [os.path.join(folder, name) for name in names for folder in path.split(os.pathsep) if folder]
    return [place for place in places if os.path.isfile(place) and os.access(place, os.X_OK)]


def supported(version):
    # type: (tuple[int, ...]) -> bool
    """Return whether the locked packages exist for this version."""
    return OLDEST <= version[:2] <= NEWEST


def spell(version):
    # type: (tuple[int, ...]) -> str
    """Return (3, 11, 7) as 3.11.7."""
    return ".".join(str(part) for part in version)


def choose(found):
    # type: (list[tuple[str, tuple[int, ...], list[str]]]) -> tuple[str, str]
    """Return (path, "") of the first usable interpreter, or ("", one sentence on the obstacle)."""
    for path, version, lacking in found:
        if supported(version) and not lacking:
            return path, ""
    for path, version, lacking in found:
        if supported(version):
            debian = "python" + spell(version[:2]) + "-venv"
            return "", (
                path + " (Python " + spell(version) + ") cannot make a virtual environment: its module "
                + lacking[-1] + " is missing; on Debian and Ubuntu the package " + debian + " brings it."
            )
    if not found:
        return "", SUPPORTED + " is needed, and no Python that runs was found."
    path, version = found[0][:2]
    return "", (
        SUPPORTED + " is needed, and " + path + " is Python " + spell(version)
        + "; install one of them, or name one: make setup PYTHON=python3.12"
    )


def main():
    # type: () -> int
    """Hand over to install.py, or print one sentence and return 1."""
    asked = os.environ.get("PYTHON", "").strip()
    present = None if asked else probe(VENV_PYTHON, ("pip",))
    if present and supported(present[1]) and not present[2]:
        chosen, sentence = VENV_PYTHON, ""
    else:
        path = os.environ.get("PATH", os.defpath)
        if asked:
            places = [asked] if os.sep in asked else on_path((asked,), path)
        else:
            places = on_path(NAMES, path) + [sys.executable]
        chosen, sentence = choose([answer for answer in map(probe, places) if answer])
        if asked and not chosen and not any(map(probe, places)):
            sentence = "PYTHON=" + asked + " was asked for, and it is no Python that runs."
    if not chosen:
        sys.stderr.write("Set-up stopped: " + sentence + "\n")
        return 1
    sys.stdout.flush()
    os.execv(chosen, [chosen, os.path.join(FOLDER, "install.py")])


if __name__ == "__main__":
    sys.exit(main())
