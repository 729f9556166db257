"""Jobs on a Dask cluster of two workers on this machine: equal bytes, deaths, and clusters that are refused."""

import json
import os
import signal
import threading
import time
from collections.abc import Generator, Iterator
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
from scenarios.studies.contact_law import worlds
from scenarios.studies.hard_cases import ask as hard_cases
from scenarios.studies.hard_cases.plan import trials
from tests.scenarios.killed import differing, of_run, run_of

ROOT = Path(__file__).resolve().parents[3]


def act(word: str) -> str:
    name, _, path = word.partition(" ")
    if name == "die":
        os.kill(os.getpid(), signal.SIGKILL)
    if name == "raise":
        raise ValueError("no such luck")
    if name == "threads":
        return ",".join(os.environ.get(name, "-") for name in THREADS)
    while path and not Path(path).exists():
        time.sleep(0.01)
    return f"{word} {os.getpid()}"


# workers find the function by its module, not by the name given by pytest
act.__module__ = "tests.scenarios.run.test_cluster"


@contextmanager
def own_workers(workers: int) -> Iterator[LocalCluster]:
    """Start a cluster on loopback only; a worker with a nanny may start its own processes only with this setting."""
    with dask.config.set({"distributed.worker.daemon": False}), pytest.MonkeyPatch.context() as patch:
        patch.setenv("PYTHONPATH", os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")]))
        with LocalCluster(n_workers=workers, threads_per_worker=1, host="127.0.0.1", dashboard_address="127.0.0.1:0") as local:
            yield local


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    with own_workers(2) as local:
        yield str(local.scheduler_address)


def on(words: list[str], where: generic.Cluster) -> Iterator[tuple[str, str | Died]]:
    from tests.scenarios.run import test_cluster

    return side_by_side(test_cluster.act, words, where)


def test_each_task_has_its_answer_or_how_it_died(address: str) -> None:
    early = on(["one"] * 4, cluster(address))
    next(early)
    assert isinstance(early, Generator)
    early.close()
    words = ["one", "die", "two", "raise", "one", "threads"]
    found = list(on(words, cluster(address)))
    assert sorted(word for word, _ in found) == sorted(words)
    answers = dict(found)
    assert "signal 9" in str(answers["die"]) and "ValueError" in str(answers["raise"])
    assert all(isinstance(answers[word], Died) for word in ("die", "raise"))
    assert answers["threads"] == ",".join("1" for _ in THREADS)
    assert len({str(answer).split()[-1] for word, answer in found if word in ("one", "two")}) == 3


@pytest.mark.usefixtures("no_reports")
def test_a_comparison_on_a_cluster_leaves_the_same_bytes(address: str, tmp_path: Path) -> None:
    words = ["compare", "--engine", "mujoco", "tracker", "--preset", "default", "--filter", "hand_over_table", "--frames", "6"]
    here, there = tmp_path / "here", tmp_path / "there"
    codes = [main([*words, "--out", str(here), "--jobs", "2"]), main([*words, "--out", str(there), "--scheduler", address])]
    assert codes[0] == codes[1] and len(list(run_of(there).glob("recordings/*.npz"))) == 2
    assert differing(of_run(run_of(here), False), of_run(run_of(there), False)) == []
    assert json.loads((run_of(there) / "results.json").read_text())["provenance"]["timing"]["seconds"] > 0.0


def test_studies_on_a_cluster_find_the_same(address: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(hard_cases, "trials", lambda: trials()[:4])
    monkeypatch.setattr(worlds, "SHAPES", worlds.SHAPES[:1])
    monkeypatch.setattr(worlds, "RATES", worlds.RATES[:1])
    words = ["study", "hard_cases", "contact_law", "--engine", "mujoco", "--preset", "default", "--filter", "squeeze"]
    found = []
    for name, more in (("here", ["--jobs", "2"]), ("there", ["--scheduler", address])):
        assert main([*words, *more, "--out", str(tmp_path / name)]) in (0, 3)
        found.append([(tmp_path / name / "studies" / f"{study}.csv").read_text() for study in ("hard_cases", "contact_law")])
    assert found[0] == found[1] and all("mujoco" in text for text in found[0])


def test_a_cluster_that_runs_other_sources_is_refused(address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "provenance", lambda words: {**provenance(words), "code": "0123456789abcdef"})
    with pytest.raises(InvalidInput, match="--scheduler .*code"):
        next(side_by_side(str, [1], cluster(address)))


@pytest.mark.parametrize(("facts", "named"), [
    ({}, "--scheduler"), ({"w": ModuleNotFoundError("no scenarios")}, "no scenarios"), ({"w": {"daemon": True}}, "w"),
    ({"w": {"folder": (Path("run"), None)}}, "folder"), ({"v": {}, "w": {"python": "3.10.0"}}, "python.*w.*3.10.0"),
])
def test_workers_of_another_program_or_folder_are_refused(facts: dict[str, object], named: str) -> None:
    here = {**module.facts(None), "folder": (Path("run"), 12)}
    found = {worker: {**here, **fact} if isinstance(fact, dict) else fact for worker, fact in facts.items()}
    with pytest.raises(InvalidInput, match=named):
        cluster("tcp://127.0.0.1:8786").require_same(here, found)


def test_an_address_without_a_scheduler_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(generic, "ANSWERS_WITHIN", 0.5)
    for wrong in ("tcp://127.0.0.1:1", "nowhere://", "tcp://127.0.0.1"):
        with pytest.raises(InvalidInput, match="--scheduler"):
            next(side_by_side(str, [1], cluster(wrong)))


def test_cluster_that_lost_its_workers_resumes_with_a_new_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """The nanny of the killed worker starts another one, which takes longer than many polls."""
    monkeypatch.setattr(generic, "LOOK_EVERY", 0.02)
    gate, said, found = tmp_path / "gate", "", []
    with own_workers(1) as local:
        [(first, nanny)] = [(nanny.worker_address, nanny) for nanny in local.workers.values()]
        where = cluster(str(local.scheduler_address))
        work = on(["one", f"wait {gate}"], where)
        found.append(next(work))
        rest = threading.Thread(target=lambda: found.extend(work))
        rest.start()
        os.kill(nanny.pid, signal.SIGKILL)
        while local.scheduler_address not in said:
            said += capfd.readouterr().err
            time.sleep(0.05)
        gate.touch()
        rest.join()
    said += capfd.readouterr().err
    assert len(found) == 2 and where.lost == [first] and first in said


class Client:
    """A client with workers from a list, one entry per poll, and at the end those of the last entry; None: no scheduler."""

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
def test_lost_workers_are_told_and_known(
    looks: list[set[str] | None], lines: int, lost: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(generic, "LOOK_EVERY", 0.001)
    monkeypatch.setattr(generic, "REPORT_INTERVAL", 0.0)
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
