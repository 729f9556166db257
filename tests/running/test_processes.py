"""Processes of jobs that answer, raise, die, dawdle and hang, while they work or while they send."""

import gc
import itertools
import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Generator
from pathlib import Path

import pytest

from avatarsim.errors import InvalidInput
from avatarsim.running.processes import THREADS, Died, alone, side_by_side

ROOT = Path(__file__).resolve().parents[2]
LARGE = 40_000_000
"""Bytes of an answer that takes a while to send."""


def act(word: str) -> str:
    if word == "raise":
        raise ValueError("no such luck")
    if word == "die":
        os.kill(os.getpid(), signal.SIGKILL)
    if word == "leave":
        os._exit(7)
    if word == "dawdle":
        time.sleep(60.0)
    if word == "hang":
        # in C, holding Python's lock: no signal handler of Python's runs
        sum(itertools.repeat(0))
    if word == "half":
        threading.Timer(0.015, os.kill, (os.getpid(), signal.SIGKILL)).start()
        return "x" * LARGE
    if word == "print":
        print("SPOKEN")
    if word == "collector":
        return str(gc.get_freeze_count() > len(gc.get_objects()))
    if word == "threads":
        return ",".join(os.environ.get(name, "-") for name in THREADS)
    return f"{word} {os.getpid()}"


# children find the function by its module, which is this file under the name that pytest gave it
act.__module__ = "tests.running.test_processes"


@pytest.fixture(scope="module")
def found() -> dict[str, str | Died]:
    from tests.running import test_processes

    words = ["one", "raise", "die", "two", "leave", "print", "threads", "collector", "dawdle"]
    return dict(side_by_side(test_processes.act, words, 3, patience=8.0))


def test_each_answer_comes_from_a_process_of_its_own(found: dict[str, str | Died]) -> None:
    pids = {str(found[word]).split()[-1] for word in ("one", "two", "print")}
    assert len(pids) == 3 and str(os.getpid()) not in pids


@pytest.mark.parametrize(("word", "said"), [
    ("raise", "ValueError: no such luck"), ("die", "killed by signal 9"), ("leave", "code 7"), ("dawdle", "no answer within 8 s"),
])
def test_who_does_not_answer_has_died_of_something(found: dict[str, str | Died], word: str, said: str) -> None:
    assert isinstance(found[word], Died) and said in str(found[word])


def test_children_run_on_one_thread_and_collect_only_their_own(found: dict[str, str | Died]) -> None:
    assert found["collector"] == "True"
    assert found["threads"] == ",".join("1" for _ in THREADS)
    assert [os.environ.get(name) for name in THREADS] != ["1"] * len(THREADS) or os.environ.get("OMP_NUM_THREADS") == "1"


def test_without_workers_tasks_run_here_and_fewer_are_refused() -> None:
    assert dict(side_by_side(act, ["one", "two"], 0)) == {word: f"{word} {os.getpid()}" for word in ("one", "two")}
    with pytest.raises(InvalidInput, match="number of workers is -1"):
        list(side_by_side(act, ["one"], -1))


def test_everyone_who_dies_is_told_how() -> None:
    """Threads that look after processes would lose the news of one end in seventy: each start of one checks all others."""
    from tests.running import test_processes

    before = threading.active_count()
    for _, how in side_by_side(test_processes.act, ["die"] * 24, 4):
        assert isinstance(how, Died) and "signal 9" in str(how)
    assert threading.active_count() == before


def tidy(word: str) -> bool:
    return word[0] != "b"


def test_tidy_tasks_share_processes_until_one_fails() -> None:
    from tests.running import test_processes

    words = ["a1", "a2", "raise", "a3", "die", "a4", "b1", "a5"]
    found = dict(side_by_side(test_processes.act, words, 1, tidy))
    pid = {word: str(answer).split()[-1] for word, answer in found.items() if not isinstance(answer, Died)}
    assert pid["a1"] == pid["a2"] != pid["a3"] and pid["a4"] == pid["a5"] not in (pid["a1"], pid["a3"], pid["b1"])
    assert isinstance(found["raise"], Died) and "killed by signal 9" in str(found["die"])


@pytest.mark.parametrize("shared", [alone, tidy])
def test_a_process_killed_while_it_sends_takes_no_other_along(shared: Callable[[str], bool]) -> None:
    from tests.running import test_processes

    words = ["half", "one", "half ", "two", "three"]
    found = dict(side_by_side(test_processes.act, words, 2, shared, patience=20.0))
    assert isinstance(found["half"], Died) and "killed by signal 9" in str(found["half"])
    assert [str(found[word]).split()[0] for word in ("one", "two", "three")] == ["one", "two", "three"]


@pytest.mark.parametrize("shared", [alone, tidy])
def test_a_hang_in_compiled_code_is_ended(shared: Callable[[str], bool]) -> None:
    from tests.running import test_processes

    before = {child.pid for child in multiprocessing.active_children()}
    [(_, how)] = side_by_side(test_processes.act, ["hang"], 1, shared, patience=0.5)
    assert str(how) == "no answer within 0.5 s"
    assert {child.pid for child in multiprocessing.active_children()} <= before


@pytest.mark.parametrize("shared", [alone, tidy])
def test_no_process_is_left_when_the_results_are_left_early(shared: Callable[[str], bool]) -> None:
    from tests.running import test_processes

    before = {child.pid for child in multiprocessing.active_children()}
    several = side_by_side(test_processes.act, ["one", "dawdle", "two", "three"], 2, shared)
    next(several)
    assert isinstance(several, Generator)
    several.close()
    assert {child.pid for child in multiprocessing.active_children()} <= before


PARENT = """
import time
from contextlib import closing
from avatarsim.errors import InvalidInput
from avatarsim.running.processes import side_by_side
from tests.running import test_processes
with closing(side_by_side(test_processes.act, ["one", "two"], 2, test_processes.tidy)) as work:
    print(next(work)[1], next(work)[1], flush=True)
    # in pieces: a signal between the print and the sleep is handled when the piece is over, not after a minute
    for _ in range(600):
        time.sleep(0.1)
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL])
def test_idle_processes_end_with_their_parent_however_it_ends(number: signal.Signals) -> None:
    line = [sys.executable, "-c", PARENT]
    with subprocess.Popen(
        line, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
        # a shell's background job ignores Ctrl-C, and so would all that it starts: as at a terminal instead
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    ) as running:
        assert running.stdout is not None
        left = {int(word) for word in running.stdout.readline().split() if word.isdigit()}
        assert len(left) == 2
        running.send_signal(number)
        assert running.wait(timeout=60.0) == -number
        deadline = time.monotonic() + 30.0
        while left and time.monotonic() < deadline:
            time.sleep(0.05)
            left = {pid for pid in left if (Path("/proc") / str(pid)).exists()}
        assert not left
