"""Jobs on a Dask cluster of two workers on this machine: the same bytes, deaths that are told, and clusters that are refused."""

import json
import os
import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import dask
import pytest
from distributed import LocalCluster

from avatarsim.errors import InvalidInput
from avatarsim.running import cluster as generic
from avatarsim.running.processes import THREADS, Died
from scenarios.__main__ import main
from scenarios.run import processes as module
from scenarios.run.harness import Run
from scenarios.run.processes import cluster, side_by_side
from scenarios.run.provenance import provenance
from tests.scenarios.killed import differing, of_run, run_of

ROOT = Path(__file__).resolve().parents[3]


def act(word: str) -> str:
    if word == "die":
        os.kill(os.getpid(), signal.SIGKILL)
    if word == "raise":
        raise ValueError("no such luck")
    if word == "threads":
        return ",".join(os.environ.get(name, "-") for name in THREADS)
    return f"{word} {os.getpid()}"


# workers find the function by its module, which is this file under the name that pytest gave it
act.__module__ = "tests.scenarios.run.test_cluster"


@contextmanager
def own_workers(workers: int) -> Iterator[LocalCluster]:
    """Loopback alone; what a nanny looks after may start processes of its own only by this setting."""
    with dask.config.set({"distributed.worker.daemon": False}), pytest.MonkeyPatch.context() as patch:
        patch.setenv("PYTHONPATH", os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")]))
        with LocalCluster(n_workers=workers, threads_per_worker=1, host="127.0.0.1", dashboard_address="127.0.0.1:0") as local:
            yield local


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    with own_workers(2) as local:
        yield str(local.scheduler_address)


def test_each_task_has_its_answer_and_a_death_is_told(address: str) -> None:
    from tests.scenarios.run import test_cluster

    words = ["one", "die", "two", "raise", "one", "threads"]
    found = list(side_by_side(test_cluster.act, words, cluster(address)))
    assert sorted(word for word, _ in found) == sorted(words)
    said = {word: str(answer) for word, answer in found}
    assert said["die"] == "its process was killed by signal 9" and said["raise"].startswith("ValueError: no such luck")
    assert said["threads"] == ",".join("1" for _ in THREADS)
    pids = {str(answer).split()[-1] for word, answer in found if word in ("one", "two")}
    assert len(pids) == 3 and all(isinstance(dict(found)[word], Died) for word in ("die", "raise"))


def test_what_is_left_early_leaves_the_cluster_to_the_next(address: str) -> None:
    from tests.scenarios.run import test_cluster

    work = side_by_side(test_cluster.act, ["one"] * 8, cluster(address))
    next(work)
    work.close()
    assert len(list(side_by_side(test_cluster.act, ["two"] * 3, cluster(address)))) == 3


def test_a_comparison_on_a_cluster_leaves_the_same_bytes(address: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("reports.write_report", lambda *_: None)
    words = ["compare", "--engine", "avatarsim", "tracker", "--preset", "default", "--filter", "hand_over_table", "--frames", "6"]
    here, there = tmp_path / "here", tmp_path / "there"
    codes = [main([*words, "--out", str(here), "--jobs", "2"]), main([*words, "--out", str(there), "--scheduler", address])]
    assert codes[0] == codes[1] and len(list(run_of(there).glob("recordings/*.npz"))) == 2
    assert differing(of_run(run_of(here), False), of_run(run_of(there), False)) == []
    assert json.loads((run_of(there) / "results.json").read_text())["provenance"]["timing"]["seconds"] > 0.0


def test_studies_on_a_cluster_find_the_same(address: str, tmp_path: Path) -> None:
    words = ["study", "hard_cases", "contact_law", "--engine", "mujoco", "--preset", "default", "--filter", "squeeze"]
    found = []
    for name, more in (("here", ["--jobs", "2"]), ("there", ["--scheduler", address])):
        assert main([*words, *more, "--out", str(tmp_path / name)]) in (0, 3)
        found.append([(tmp_path / name / "studies" / f"{study}.csv").read_text() for study in ("hard_cases", "contact_law")])
    assert found[0] == found[1] and all("mujoco" in text for text in found[0])


def test_a_cluster_that_runs_other_sources_is_refused(address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "provenance", lambda words: {**provenance(words), "code": "0123456789abcdef"})
    with pytest.raises(InvalidInput, match="--scheduler .*workers of the same code"):
        next(side_by_side(str, [1], cluster(address)))


@pytest.mark.parametrize(("told", "said"), [
    ({}, "a scheduler with workers"), ({"w": ModuleNotFoundError("no scenarios")}, "know this project .*no scenarios"),
    ({"w": {"daemon": True}}, "may start processes"), ({"w": {"folder": (Path("run"), None)}}, "workers of the same folder"),
    ({"v": {}, "w": {"python": "3.10.0"}}, "workers of the same python: w has 3.10.0"),
])
def test_workers_that_would_find_something_else_are_refused(told: dict[str, object], said: str) -> None:
    here = {**module.facts(None), "folder": (Path("run"), 12)}
    found = {worker: {**here, **about} if isinstance(about, dict) else about for worker, about in told.items()}
    with pytest.raises(InvalidInput, match=said):
        cluster("tcp://127.0.0.1:8786").require_same(here, found)


def test_an_address_without_a_scheduler_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(generic, "ANSWERS_WITHIN", 0.5)
    for wrong in ("tcp://127.0.0.1:1", "nowhere://", "tcp://127.0.0.1"):
        with pytest.raises(InvalidInput, match="--scheduler"):
            next(side_by_side(str, [1], cluster(wrong)))


def until_there(path: str) -> str:
    """Return `path`, once there is a file."""
    while path and not Path(path).exists():
        time.sleep(0.01)
    return path


until_there.__module__ = act.__module__


def test_a_cluster_that_has_lost_its_workers_says_so_and_goes_on_with_a_new_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """The nanny of the killed worker starts another one, which takes longer than many looks."""
    from tests.scenarios.run import test_cluster

    monkeypatch.setattr(generic, "LOOK_EVERY", 0.02)
    gate, said, found = tmp_path / "gate", "", []
    with own_workers(1) as local:
        [(first, nanny)] = [(nanny.worker_address, nanny) for nanny in local.workers.values()]
        where = cluster(str(local.scheduler_address))
        work = side_by_side(test_cluster.until_there, ["", str(gate)], where)
        found.append(next(work))
        rest = threading.Thread(target=lambda: found.extend(work))
        rest.start()
        os.kill(nanny.pid, signal.SIGKILL)
        while "no worker" not in said:
            said += capfd.readouterr().err
            time.sleep(0.05)
        gate.touch()
        rest.join()
    said += capfd.readouterr().err
    assert sorted(answer for _, answer in found) == ["", str(gate)]
    assert said.count("no worker") == 1 and local.scheduler_address in said
    assert [line for line in said.splitlines() if "was lost" in line and first in line] and where.lost == [first]


class Client:
    """Workers that are those of a list, look by look, and at the end those of the last one; None: no scheduler."""

    def __init__(self, *looks: set[str] | None) -> None:
        self.looks, self.seen_all = list(looks), threading.Event()

    def nthreads(self) -> dict[str, int]:
        present = self.looks[0] if len(self.looks) == 1 else self.looks.pop(0)
        if len(self.looks) == 1:
            self.seen_all.set()
        if present is None:
            raise OSError("no scheduler")
        return dict.fromkeys(present, 1)


@pytest.mark.parametrize(("looks", "lines", "lost"), [
    ([{"a", "b"}], 0, []), ([{"a"}, set(), set(), set(), {"c"}], 3, ["a", "b"]), ([{"a"}, None, {"a", "b"}], 0, []),
    ([{"a"}, {"a", "late"}, {"a", "b"}], 0, ["late"]), ([None], 0, []),
])
def test_lines_come_while_there_is_no_worker_and_lost_ones_are_known(
    looks: list[set[str] | None], lines: int, lost: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(generic, "LOOK_EVERY", 0.001)
    monkeypatch.setattr(generic, "SAY_EVERY", 0.0)
    client = Client(*looks)
    with generic.Watch(client, "tcp://here:1", ["a", "b"]) as watch:
        if len(looks) > 1:
            client.seen_all.wait()
    assert capsys.readouterr().err.count("tcp://here:1") == lines and watch.lost() == lost


def test_a_run_names_the_workers_that_its_cluster_has_lost(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    lost = cluster("tcp://here:1")
    monkeypatch.setattr(generic.Cluster, "results", lambda self, *asked: iter(self.lost.append("tcp://gone:7") or ()))
    ran = Run(tmp_path, {}, [], frozenset(), {}, {})
    ran.measure([], lost)
    ran.write(0)
    assert any("tcp://gone:7" in note for note in json.loads((tmp_path / "results.json").read_text())["notes"])
