"""A command that is killed in the middle is gone on with by the same command, and ends with the same bytes."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from avatarsim.cli import main
from tests.clips.made import bvh, content

ROOT = Path(__file__).resolve().parents[2]
CLIPS = 10


@pytest.fixture(scope="module")
def clips(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder of clips."""
    folder = tmp_path_factory.mktemp("clips")
    for k in range(CLIPS):
        bvh(folder / f"c{k:02}.bvh", seed=k)
    return folder


def words(clips: Path, out: Path, workers: int) -> list[str]:
    return ["clean", str(clips), "--room", "floor", "-o", str(out), "--workers", str(workers)]


def command(clips: Path, out: Path, workers: int) -> list[str]:
    return [sys.executable, "-m", "avatarsim", *words(clips, out, workers)]


def of_session(session: int) -> list[int]:
    """Return processes of a session that are not over."""
    found = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            state, _, _, number = path.read_text().rpartition(")")[2].split()[:4]
        except OSError:
            continue
        if int(number) == session and state != "Z":
            found.append(int(path.parent.name))
    return found


def killed(line: list[str], out: Path, after: int) -> None:
    """Run a command, kill it by SIGKILL once so many clips are done, and wait until the processes it started are over."""
    quiet = subprocess.DEVNULL
    with subprocess.Popen(line, cwd=ROOT, start_new_session=True, stdout=quiet, stderr=quiet) as running:
        until = time.monotonic() + 120.0
        while len(list(out.glob("certificates/*.json"))) < after and running.poll() is None and time.monotonic() < until:
            time.sleep(0.002)
        assert running.poll() is None, "over before it was killed"
        running.kill()
        assert running.wait() == -signal.SIGKILL
    require_over(running.pid)


def require_over(session: int) -> None:
    """Wait until all processes of a session are over."""
    until = time.monotonic() + 60.0
    while of_session(session) and time.monotonic() < until:
        time.sleep(0.02)
    assert of_session(session) == []


@pytest.fixture(scope="module")
def wanted(clips: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """Return the files that a command leaves which nothing stops."""
    out = tmp_path_factory.mktemp("wanted") / "out"
    assert main(words(clips, out, 0)) == 0
    return content(out)


@pytest.mark.parametrize("workers", [0, 2])
def test_a_killed_command_goes_on_and_ends_with_the_same_bytes(
    tmp_path: Path, clips: Path, wanted: dict[str, bytes], workers: int
) -> None:
    """It is killed in its first run, and with workers in its second run too."""
    out = tmp_path / "out"
    line = command(clips, out, workers)
    killed(line, out, 2)
    # the files that are there are whole and final, but for those that mark the clips as not done
    halves = [name for name in content(out) if ".avatarsim-" in name]
    open_ = {one["name"] for one in json.loads((out / "certificate.json").read_text())["not_done"]}
    assert open_ == {f"c{k:02}.bvh" for k in range(CLIPS)}
    folder = {"certificate.json", "index.html"}
    assert {name: one for name, one in content(out).items() if name not in {*halves, *folder}}.items() <= wanted.items()
    first = {name: (out / name).stat().st_mtime_ns for name in content(out) if name.startswith("certificates/")}
    if workers:
        killed(line, out, len(first) + 2)
    last = subprocess.run(line, cwd=ROOT, capture_output=True, text=True, timeout=300)
    assert last.returncode == 0, last.stderr
    assert content(out) == wanted
    assert sum(row.endswith("done before") for row in last.stdout.splitlines()) >= (4 if workers else 2)
    assert {name: (out / name).stat().st_mtime_ns for name in first} == first


def test_a_command_that_is_stopped_leaves_what_is_done(tmp_path: Path, clips: Path) -> None:
    out = tmp_path / "out"
    line = command(clips, out, 1)
    with subprocess.Popen(line, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
                          preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL)) as running:
        until = time.monotonic() + 120.0
        while not list(out.glob("certificates/*.json")) and time.monotonic() < until:
            time.sleep(0.002)
        os.kill(running.pid, signal.SIGINT)
        said, err = running.communicate(timeout=120.0)
    assert running.returncode == 130, err
    assert "Traceback" not in err
    whole, count = json.loads((out / "certificate.json").read_text()), len(list(out.glob("certificates/*.json")))
    assert 1 <= count < CLIPS and len(whole["clips"]) == count and len(whole["not_done"]) == CLIPS - count
    require_over(running.pid)
    assert not [path for path in out.rglob("*") if ".avatarsim-" in path.name]


def test_of_two_commands_at_once_one_has_the_folder(tmp_path: Path, clips: Path) -> None:
    line = command(clips, tmp_path / "out", 0)
    both = [subprocess.Popen(line, cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) for _ in range(2)]
    for one in both:
        one.communicate(timeout=300.0)
    assert sorted(one.returncode for one in both) == [0, 2]
    assert len(list((tmp_path / "out" / "certificates").iterdir())) == CLIPS
