"""The command `avatarsim pieces`: a table, JSON, exit codes, help."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from avatarsim.cli import pieces as command
from avatarsim.cli.pieces import main
from tests.assets.meshes.solids import cube, ell, obj_text
from tests.own_cache import keep_pieces_in

HOUSE = Path(__file__).resolve().parents[2]


@pytest.fixture(autouse=True)
def cache_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every test has a cache folder of its own."""
    keep_pieces_in(tmp_path / "cache", monkeypatch)


def files(folder: Path) -> tuple[str, str]:
    """A cube, and an open L."""
    (folder / "cube.obj").write_text(obj_text(cube()), encoding="utf-8")
    vertices, triangles = ell()
    (folder / "open.obj").write_text(obj_text((vertices, triangles[1:])), encoding="utf-8")
    return str(folder / "cube.obj"), str(folder / "open.obj")


def test_the_table_and_the_cache(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    good, _ = files(tmp_path)
    assert main([good]) == 0 and main([good]) == 0
    head, first, _, second = capsys.readouterr().out.splitlines()
    assert head.split() == ["mesh", "source", "pieces", "vertices", "most", "Hausdorff", "of", "size", "seconds", "cache"]
    assert first.split()[:6] == ["cube.obj", "convex", "mesh", "1", "8", "8"] and first.endswith("miss")
    assert second.endswith("hit")


def test_json_and_a_refused_mesh_beside_a_good_one(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    good, opened = files(tmp_path)
    assert main([opened, good, "--json", "--no-cache", "--scale", "0.1"]) == 3
    out, err = capsys.readouterr()
    (row,) = [json.loads(line) for line in out.splitlines()]
    assert row["mesh"] == good and row["vertices"] == [8] and row["from_cache"] is False
    assert row["size"] == pytest.approx(0.1 * 3.0**0.5)
    assert "border edges of open.obj is 3" in err
    assert main([opened, "--hull", "--no-cache"]) == 0
    assert "the hull closes this" in capsys.readouterr().out


def test_a_stop_by_the_user_is_said(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    def stopped(*words: object, **options: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(command, "pieces_of_mesh", stopped)
    assert main(["any.obj"]) == 130
    assert "stopped" in capsys.readouterr().err


def test_help_names_every_option() -> None:
    asked = [sys.executable, "-m", "avatarsim", "pieces", "--help"]
    done = subprocess.run(asked, cwd=HOUSE, capture_output=True, text=True, check=True)
    for word in ("--scale", "--threshold", "--seed", "--hull", "--repair", "--json", "--no-cache", "Hausdorff"):
        assert word in done.stdout
