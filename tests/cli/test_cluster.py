"""Clips on a Dask cluster of two workers on this machine: the same bytes as here, and a death that costs one clip alone."""

import os
from pathlib import Path

import dask
import pytest
from distributed import LocalCluster

from avatarsim.cli import main
from tests.clips.made import bvh, content

ROOT = Path(__file__).resolve().parents[2]


def test_clips_on_a_cluster_are_of_the_same_bytes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for k in range(3):
        bvh(tmp_path / "in" / f"c{k}.bvh", seed=k)
    (tmp_path / "in" / "cut.bvh").write_text("HIERARCHY")
    words = ["clean", str(tmp_path / "in"), "--room", "floor"]
    assert main([*words, "-o", str(tmp_path / "here"), "--workers", "0"]) == 3
    # processes that a nanny looks after may start processes of their own only by this setting
    with dask.config.set({"distributed.worker.daemon": False}), monkeypatch.context() as patch:
        patch.setenv("PYTHONPATH", os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")]))
        with LocalCluster(n_workers=2, threads_per_worker=1, host="127.0.0.1", dashboard_address=None) as local:
            assert main([*words, "-o", str(tmp_path / "there"), "--scheduler", str(local.scheduler_address)]) == 3
    assert content(tmp_path / "here") == content(tmp_path / "there") and len(content(tmp_path / "there")) == 12
