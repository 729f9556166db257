"""A command ends in a code of its own, also where its streams are closed, full, or without a reader; progress is shown."""

import io
import os
import subprocess
import sys
from argparse import ArgumentTypeError
from collections.abc import Callable
from pathlib import Path

import pytest

from avatarsim.cli import main as avatarsim
from avatarsim.console import FAULT, UNSAID, USAGE, Progress, ended, path_option
from reports.__main__ import main as reports
from scenarios.__main__ import main as scenarios


class Clock:
    """A clock that a test sets."""

    def __init__(self) -> None:
        self.now = 100.0

    def monotonic(self) -> float:
        return self.now


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    clock = Clock()
    monkeypatch.setattr("avatarsim.console.time", clock)
    return clock


def test_progress_is_silent_at_first_and_then_now_and_then(clock: Clock) -> None:
    stream = io.StringIO()
    with Progress("decomposing duck.obj", stream) as progress:
        clock.now += 0.9
        assert not progress.due and not Progress("quick", None).due
        progress.step(0.0, "0 parts")
        assert stream.getvalue() == ""
        clock.now += 0.1
        is_due: bool = progress.due
        assert is_due
        for k in range(50):
            clock.now += 0.5
            progress.step(k / 50, f"{k} parts")
    assert 3 <= stream.getvalue().count("duck.obj") <= 6


ROOT = Path(__file__).resolve().parent.parent
PRINTS = "import sys\nfrom avatarsim.console import ended\nsys.exit(ended(lambda: print('x' * {}) or {}))"
FEW, MANY = 10, 1_000_000
"""Characters that wait in the buffer until the end, and that are written before."""


def ran(words: list[str], stdout: int, before: Callable[[], object] | None = None) -> tuple[int, str]:
    done = subprocess.run(
        [sys.executable, *words], cwd=ROOT, stdout=stdout, stderr=subprocess.PIPE, text=True, timeout=60, preexec_fn=before,
    )
    return done.returncode, done.stderr


@pytest.mark.parametrize("many", [FEW, MANY])
def test_output_that_is_full_is_said_once(many: int) -> None:
    with open("/dev/full", "wb") as full:
        code, said = ran(["-c", PRINTS.format(many, 0)], full.fileno())
    assert code == UNSAID and "No space left on device" in said and len(said.splitlines()) == 1


@pytest.mark.parametrize("many", [FEW, MANY])
def test_a_reader_that_has_gone_is_not_complained_about(many: int) -> None:
    here, there = os.pipe()
    os.close(here)
    try:
        assert ran(["-c", PRINTS.format(many, 0)], there) == (UNSAID, "")
    finally:
        os.close(there)


def test_streams_that_are_closed_have_their_codes() -> None:
    code, said = ran(["-c", PRINTS.format(FEW, 0)], subprocess.DEVNULL, lambda: os.close(1))
    assert code == USAGE and len(said.splitlines()) == 1
    assert ran(["-c", PRINTS.format(FEW, 5)], subprocess.DEVNULL, lambda: os.close(2)) == (5, "")


@pytest.mark.parametrize(("raised", "code"), [("SystemExit(2)", 2), ("SystemExit()", 0), ("SystemExit('bad')", USAGE),
                                              ("OSError(28, 'full', 'here')", UNSAID)])
def test_ends_of_other_kinds_keep_their_code(raised: str, code: int) -> None:
    script = f"import sys\nfrom avatarsim.console import ended\ndef main():\n    raise {raised}\nsys.exit(ended(main))"
    found, said = ran(["-c", script], subprocess.DEVNULL)
    assert found == code and "Traceback" not in said and ("here: full" in said) == (code == UNSAID)


def test_a_fault_of_the_program_has_a_code_that_is_no_answer() -> None:
    script = "from avatarsim.console import ended\ndef main():\n    return int('frame_time_max')\nraise SystemExit(ended(main))"
    code, said = ran(["-c", script], subprocess.DEVNULL)
    assert code == FAULT and "Traceback" in said and "ValueError" in said and "frame_time_max" in said


def test_commands_of_the_harness_end_so_too() -> None:
    """The output here is longer than a buffer."""
    with open("/dev/full", "wb") as full:
        code, said = ran(["-m", "scenarios", "metrics"], full.fileno())
    assert code == UNSAID and len(said.splitlines()) == 1


LIMITED = """
import resource, sys
from pathlib import Path
import numpy as np
from avatarsim.console import ended
from avatarsim.files import read_bytes
limit = 4096 * int(Path("/proc/self/statm").read_text().split()[0]) + 50_000_000
resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
print(f"{{1e-9 * limit:.2g}} GB", flush=True)
sys.exit(ended(lambda: {}))
"""
"""A command that may take 50 MB more than its imports."""


@pytest.mark.parametrize(("command", "words"), [
    ("read_bytes(Path({large!r}), 'file', 'any', 10**10)", ["avatarsim.files.read_bytes"]),
    ("np.zeros((10**4, 10**4))", ["(10000, 10000)", "float64"]),
])
def test_too_little_memory_names_what_was_too_large(command: str, words: list[str], tmp_path: Path) -> None:
    with (tmp_path / "large").open("wb") as file:
        file.truncate(10**9)
    program = LIMITED.format(command.format(large=str(tmp_path / "large")))
    done = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, timeout=60)
    assert done.returncode == UNSAID and len(done.stderr.splitlines()) == 1
    assert [word for word in ("MemoryError", done.stdout.strip(), *words) if word not in done.stderr] == []


def test_a_small_file_takes_little_memory(tmp_path: Path) -> None:
    (tmp_path / "small").write_text("x" * 7)
    program = LIMITED.format(f"len(read_bytes(Path({str(tmp_path / 'small')!r}), 'file', 'any'))")
    done = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (7, "")


def hungry(*_: object) -> object:
    raise MemoryError


@pytest.mark.parametrize(("run", "patched"), [
    (lambda: avatarsim(["compile"]), ("avatarsim.cli.compiling.run", hungry)),
    (lambda: scenarios(["list"]), ("scenarios.__main__.COMMANDS", {"list": hungry})),
    (lambda: reports(["write", "."]), ("reports.__main__.write_report", hungry)),
])
def test_every_command_names_where_memory_was_short(
    run: Callable[[], int], patched: tuple[str, object], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(*patched)
    assert ended(run) == UNSAID
    said = capsys.readouterr().err
    assert "MemoryError" in said and f"{__name__}.hungry" in said and "Traceback" not in said


def test_an_empty_path_is_refused() -> None:
    assert path_option("a/b") == Path("a/b")
    with pytest.raises(ArgumentTypeError, match="empty"):
        path_option("")
