"""Children that answer, raise, die and dawdle."""

import gc
import os
import signal
import time

import pytest

from scenarios.running.processes import THREADS, Died, Pool


def act(word: str) -> str:
    if word == "raise":
        raise ValueError("no such luck")
    if word == "die":
        os.kill(os.getpid(), signal.SIGKILL)
    if word == "leave":
        os._exit(7)
    if word == "dawdle":
        time.sleep(60.0)
    if word == "print":
        print("SPOKEN")
    if word == "collector":
        return str(gc.get_freeze_count() > len(gc.get_objects()))
    if word == "threads":
        return ",".join(os.environ.get(name, "-") for name in THREADS)
    return f"{word} {os.getpid()}"


# children find the function by its module, which is this file under the name that pytest gave it
act.__module__ = "tests.scenarios.running.test_processes"


@pytest.fixture(scope="module")
def found() -> dict[str, str | Died]:
    from tests.scenarios.running import test_processes

    words = ["one", "raise", "die", "two", "leave", "print", "threads", "collector", "dawdle"]
    return dict(Pool(test_processes.act, 3, patience=8.0).results(words))


def test_each_answer_comes_from_a_process_of_its_own(found: dict[str, str | Died]) -> None:
    pids = {str(found[word]).split()[-1] for word in ("one", "two", "print")}
    assert len(pids) == 3 and str(os.getpid()) not in pids


@pytest.mark.parametrize(("word", "said"), [
    ("raise", "ValueError: no such luck"), ("die", "killed by signal 9"), ("leave", "code 7"), ("dawdle", "no answer within 8 s"),
])
def test_who_does_not_answer_has_died_of_something(found: dict[str, str | Died], word: str, said: str) -> None:
    assert isinstance(found[word], Died) and said in str(found[word])


def test_children_run_on_one_thread_and_the_parent_keeps_its_own(found: dict[str, str | Died]) -> None:
    assert found["threads"] == ",".join("1" for _ in THREADS)
    assert [os.environ.get(name) for name in THREADS] != ["1"] * len(THREADS) or os.environ.get("OMP_NUM_THREADS") == "1"


def test_children_do_not_collect_what_their_mother_loaded(found: dict[str, str | Died]) -> None:
    assert found["collector"] == "True"


def test_tidy_tasks_share_processes_until_one_fails() -> None:
    from tests.scenarios.running import test_processes

    words = ["a1", "a2", "raise", "a3", "die", "a4", "b1", "a5"]
    pool = Pool(test_processes.act, 1, tidy=lambda word: word[0] != "b")
    found = dict(pool.results(words))
    pid = {word: str(answer).split()[-1] for word, answer in found.items() if not isinstance(answer, Died)}
    assert pid["a1"] == pid["a2"] != pid["a3"] and pid["a4"] == pid["a5"] not in (pid["a1"], pid["a3"], pid["b1"])
    assert isinstance(found["raise"], Died) and "killed by signal 9" in str(found["die"])


def test_nobody_is_left_when_the_results_are_left_early() -> None:
    import multiprocessing

    from tests.scenarios.running import test_processes

    before = {child.pid for child in multiprocessing.active_children()}
    several = Pool(test_processes.act, 2, tidy=lambda word: True).results(["one", "two", "three", "four"])
    next(several)
    several.close()
    assert {child.pid for child in multiprocessing.active_children()} <= before
