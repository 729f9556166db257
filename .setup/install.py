"""Makes .venv and fills it from requirements.lock; every failure is one plain sentence.

Started by choose_python.py with a supported Python; uses the standard library only. The project itself is installed in editable
mode: it runs from the checkout, from any folder, and .venv/bin/avatarsim is its command. The output of pip goes to
.venv/set-up.log.
"""

import fcntl
import hashlib
import json
import os
import platform
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import time
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
VENV = ROOT / ".venv"
VENV_PYTHON = VENV / "bin" / "python"
COMMAND = VENV / "bin" / "avatarsim"
LOCK = ROOT / "requirements.lock"
PROJECT = ROOT / "pyproject.toml"
STAMP = VENV / "set-up-stamp"
LOG = VENV / "set-up.log"
HERE = f"{sys.version_info[0]}.{sys.version_info[1]}"

# How often a sign of life is printed while pip works [s]; shorter floods the logs of a CI run.
SIGN_OF_LIFE = 20.0

# Messages of pip when it cannot reach an index, as opposed to an index that answers and lacks the package.
NO_NETWORK = re.compile(
    r"NewConnectionError|NameResolutionError|ConnectTimeout|ReadTimeout|ProxyError|Max retries exceeded"
    r"|connection broken|Connection (?:refused|reset|aborted)|Network is unreachable|name resolution",
    re.IGNORECASE,
)


class SetUpStopped(Exception):
    """Carries the one sentence that the user reads."""


def say(line: str) -> None:
    """One line, at once, so that a pipe shows it while the step still runs."""
    print(line, flush=True)


def split_lock(text: str) -> tuple[str, str]:
    """Return (every other pin, pybullet's pin): pybullet is the one package that may be impossible to install."""
    blocks = re.split(r"(?m)^(?=[A-Za-z0-9])", text)
    alone = [block for block in blocks if block.startswith("pybullet==")]
    return "".join(block for block in blocks if block not in alone), "".join(alone)


def pip_sentence(output: str) -> str:
    """Return why pip failed, in one sentence."""
    if "DO NOT MATCH THE HASHES" in output:
        return "a downloaded package differs from its hash in requirements.lock; it was not installed."
    if "No space left on device" in output:
        return "the disk is full."
    if NO_NETWORK.search(output):
        return "no package could be downloaded: there is no network, or the package index does not answer."
    if absent := re.search(r"No matching distribution found for (\S+)", output):
        return f"the package index has no {absent[1]} for this Python and this kind of machine."
    errors = [line.strip() for line in output.splitlines() if line.startswith(("ERROR:", "error:"))]
    return f"pip could not install the packages ({errors[-1] if errors else 'it gave no reason'})."


def compiler_obstacle() -> str:
    """Return the obstacle to compiling a C++ extension here, or nothing."""
    if not any(shutil.which(name) for name in (os.environ.get("CXX", "c++"), "g++", "clang++")):
        return "there is no C++ compiler (g++ or clang++)."
    compiler = os.environ.get("CC") or sysconfig.get_config_var("CC") or "cc"
    if not shutil.which(compiler.split()[0]):
        return f"there is no C compiler ({compiler.split()[0]})."
    if not (Path(sysconfig.get_path("include")) / "Python.h").exists():
        return "Python's header Python.h is missing (on Debian and Ubuntu the package python3-dev brings it)."
    return ""


def build_obstacle(pin: str) -> str:
    """Return why pybullet could not be built from its source, or nothing once it is built."""
    # Without isolation the locked setuptools builds it against the locked numpy; both are there since step 2.
    output = pip_install(pin, "--no-build-isolation", "--use-pep517")
    if output and "Building wheel" in output:
        return "it does not compile here; .venv/set-up.log has the compiler's words."
    return pip_sentence(output) if output else ""


def pip_install(requirements: str, *options: str) -> str | None:
    """Install these pins with their hashes; return None, or the output of pip when it failed."""
    pins = VENV / "set-up-pins.txt"
    pins.write_text(requirements, encoding="utf-8")
    wanted = len(re.findall(r"(?m)^[A-Za-z0-9]", requirements))
    output = pip("--require-hashes", *options, "--retries", "2", "-r", str(pins), wanted=wanted)
    pins.unlink()
    return output


def pip(*options: str, wanted: int = 1) -> str | None:
    """Run `pip install` in .venv; return None, or its output on failure. `wanted`: number of packages, for the progress."""
    command = [str(VENV_PYTHON), "-I", "-m", "pip", "install", "--no-deps", "--no-input", "--progress-bar", "off"]
    command += ["--disable-pip-version-check", *options]
    with LOG.open("w", encoding="utf-8") as log:
        process = subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL)
    started = told = time.monotonic()
    try:
        while process.poll() is None:
            time.sleep(0.1)
            if time.monotonic() - told >= SIGN_OF_LIFE:
                told = time.monotonic()
                printed = LOG.read_text(encoding="utf-8", errors="replace")
                seen = len(re.findall(r"(?m)^(?:Collecting|Requirement already)", printed))
                place = f", package {min(seen, wanted)} of {wanted}" if wanted > 1 else ""
                say(f"      still at it after {told - started:.0f} s{place}")
    except KeyboardInterrupt:
        process.terminate()
        process.wait()
        raise
    return LOG.read_text(encoding="utf-8", errors="replace") if process.returncode else None


def venv_version() -> str | None:
    """Return the version (such as 3.11) of the Python in .venv, or None if there is none that runs and has pip."""
    question = "import pip, sys; print('%d.%d' % sys.version_info[:2])"
    try:
        answer = subprocess.run([VENV_PYTHON, "-c", question], capture_output=True, text=True, check=False)
    except OSError:
        return None
    return answer.stdout.strip() if answer.returncode == 0 else None


def make_venv() -> None:
    """Create .venv with the running Python, or keep the one that is there."""
    there = venv_version()
    if there == HERE:
        say(f"Bringing .venv up to date\n  1/4 Python {HERE}: .venv is there")
        return
    if there is not None:
        raise SetUpStopped(
            f"Python {HERE} is to be used, and .venv has Python {there}; remove .venv to change it."
        )
    say("Setting up (once; about a minute of computing and a download of 0.5 GB; 1.8 GB in .venv)")
    say(f"  1/4 Python {HERE}: making .venv")
    command = [sys.executable, "-m", "venv", "--clear", str(VENV)]
    made = subprocess.run(command, capture_output=True, text=True, check=False)
    if made.returncode != 0:
        reason = (made.stderr.strip() or made.stdout.strip() or "it gave no reason").splitlines()[-1]
        raise SetUpStopped(
            f"Python {HERE} could not make a virtual environment ({reason}); on Debian and Ubuntu the package"
            f" python{HERE}-venv is needed."
        )


def install_project() -> None:
    """Install the checkout in editable mode, by the locked setuptools and without a network.

    In the mode `compat` all of its packages can be imported from any folder, the harness too; the default finds avatarsim alone.
    """
    say("  4/4 avatarsim itself, from this checkout")
    output = pip("--no-build-isolation", "--no-index", "--config-settings", "editable_mode=compat", "--editable", str(ROOT))
    # The metadata are in .venv as well.
    shutil.rmtree(ROOT / "avatarsim.egg-info", ignore_errors=True)
    if output is not None:
        raise SetUpStopped(f"{pip_sentence(output)} Details: .venv/set-up.log")


def install_pybullet(pin: str) -> bool:
    """Install pybullet from its wheel or, where there is none, from source; False if it is left out."""
    say("  3/4 pybullet")
    output = pip_install(pin, "--only-binary", ":all:")
    if output is None:
        return True
    why = pip_sentence(output)
    if "No matching distribution" in output and not NO_NETWORK.search(output):
        say("      there is no ready-made pybullet for this Python, so it is built from source now:")
        say("      about 4 minutes on 2 cores, and it needs a C++ compiler")
        why = compiler_obstacle() or build_obstacle(pin)
        if not why:
            return True
    say(f"      pybullet is left out: {why}")
    kept = extract_pybullet_data(pin)
    say(f"      Its data folder (motion clips, meshes) is {'there all the same' if kept else 'missing too'}.")
    say("      Everything else works; pybullet's rows will say not-measured. `make setup` tries it again.")
    return False


def extract_pybullet_data(pin: str) -> bool:
    """Take pybullet's data folder out of the wheel made for Python 3.11; False if that wheel cannot be had.

    Clips and meshes are plain files, the same for every Python, and most scenes need them.
    """
    with tempfile.TemporaryDirectory() as folder:
        pins = Path(folder) / "pins.txt"
        pins.write_text(pin, encoding="utf-8")
        command = [str(VENV_PYTHON), "-I", "-m", "pip", "download", "--require-hashes", "--no-deps", "--only-binary", ":all:"]
        command += ["--python-version", "3.11", "--implementation", "cp", "--abi", "cp311", "--no-input", "--retries", "2"]
        command += ["--platform", f"manylinux2014_{platform.machine()}", "--progress-bar", "off", "-d", folder, "-r", str(pins)]
        subprocess.run(command, capture_output=True, stdin=subprocess.DEVNULL, check=False)
        for wheel in Path(folder).glob("*.whl"):
            with zipfile.ZipFile(wheel) as archive:
                members = [name for name in archive.namelist() if name.startswith("pybullet_data/")]
                archive.extractall(VENV / "lib" / f"python{HERE}" / "site-packages", members)
            return bool(members)
    return False


def set_up() -> None:
    """Run the four steps; skip those that the stamp lists as done for this very lock and pyproject.toml."""
    others, pybullet = split_lock(LOCK.read_text(encoding="utf-8"))
    packages = {"lock": digest(others + pybullet), "python": HERE, "pybullet": True}
    project = {"project": digest(PROJECT.read_text(encoding="utf-8"))}
    stamp = json.loads(STAMP.read_text(encoding="utf-8")) if STAMP.exists() else {}
    if stamp == packages | project and COMMAND.exists():
        STAMP.touch()
        say(".venv is ready.")
        return
    if {name: stamp.get(name) for name in packages} != packages:
        make_venv()
        say(f"  2/4 {len(re.findall(r'(?m)^[A-Za-z0-9]', others))} packages from requirements.lock")
        if (output := pip_install(others)) is not None:
            raise SetUpStopped(f"{pip_sentence(output)} Details: .venv/set-up.log")
        packages["pybullet"] = install_pybullet(pybullet)
    install_project()
    STAMP.write_text(json.dumps(packages | project), encoding="utf-8")
    say("Set-up is complete.")


def digest(text: str) -> str:
    """Return SHA-256 of a text."""
    return hashlib.sha256(text.encode()).hexdigest()


def wait_for_turn(latch: int) -> None:
    """Return when no other set-up is at work in this folder."""
    try:
        fcntl.flock(latch, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        say("Another set-up is at work here; waiting for it.")
        fcntl.flock(latch, fcntl.LOCK_EX)


def main() -> int:
    """Return 0 when the environment is ready, with or without pybullet; 1 after one sentence otherwise."""
    # Two makes at once must not fill the same folder; the lock file serves as the latch and is only read.
    with LOCK.open(encoding="utf-8") as latch:
        try:
            wait_for_turn(latch.fileno())
            set_up()
        except SetUpStopped as stopped:
            sys.stderr.write(f"Set-up stopped: {stopped}\n")
        except OSError as error:
            sys.stderr.write(f"Set-up stopped: {error}\n")
        except KeyboardInterrupt:
            sys.stderr.write("Set-up interrupted; run the same command again to go on.\n")
        else:
            return 0
    return 1


if __name__ == "__main__":
    sys.exit(main())
