"""Writes the lock from pyproject.toml: every package of the checkout with the hashes of all its files.

One file for Python 3.11 to 3.13 and every platform, resolved by uv, fetched into a throw-away folder.
Pins that still fit are kept; `--upgrade` takes the newest versions. No host name, address or index option is
written: where packages come from is for each user to set.
"""

import re
import subprocess
import sys
import tempfile
import venv
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LOCK = ROOT / "requirements.lock"
# A newer uv may order or mark the pins differently: raise it in a commit of its own.
RESOLVER = "uv==0.13.8"
EXTRAS = ("compare", "report", "assets", "hand", "parallel", "cluster", "view", "docs", "dev")
HEADER = """\
# Every package of the checkout, for Python 3.11 to 3.13, with the hashes of all files of each version.
# Written by `make lock` from pyproject.toml; do not edit. `make setup` installs it, pybullet last and apart.
"""


def pins(upgrade: bool, folder: Path) -> str:
    """Return the resolved pins. Raises CalledProcessError when pip or the resolver fails (both have printed the reason)."""
    venv.create(folder, with_pip=True)
    subprocess.run([folder / "bin" / "pip", "install", "--quiet", RESOLVER], check=True)
    wanted = folder / "requirements.lock"
    if LOCK.exists():
        wanted.write_text(LOCK.read_text(encoding="utf-8"), encoding="utf-8")
    command = [str(folder / "bin" / "uv"), "pip", "compile", "pyproject.toml", "--quiet"]
    command += ["--output-file", str(wanted), "--generate-hashes", "--no-header", "--no-annotate"]
    command += ["--no-emit-index-url", "--no-emit-find-links"]
    # One numpy for all Pythons, where that is possible: the same figures everywhere.
    command += ["--universal", "--python-version", "3.11", "--fork-strategy", "fewest"]
    command += [f"--extra={extra}" for extra in EXTRAS] + (["--upgrade"] if upgrade else [])
    subprocess.run(command, cwd=ROOT, check=True)
    # users of later Pythons do not need it; in a checkout `make setup` builds it from source there, if it can
    return re.sub(r"(?m)^(pybullet==\S+) ; [^\\]+ \\$", r"\1 \\", wanted.read_text(encoding="utf-8"))


def main(arguments: list[str]) -> int:
    """Write the lock; it changes only when all of it was resolved."""
    with tempfile.TemporaryDirectory() as folder:
        try:
            resolved = pins("--upgrade" in arguments, Path(folder))
        except subprocess.CalledProcessError as error:
            sys.stderr.write(f"The lock stays as it was: {Path(error.cmd[0]).name} failed.\n")
            return 1
    LOCK.write_text(HEADER + resolved, encoding="utf-8")
    print(f"requirements.lock: {resolved.count('==')} pins")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
