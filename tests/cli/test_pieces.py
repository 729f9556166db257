"""The command `avatarsim pieces`: rows of a table or of JSON, and exit codes."""

import json
from pathlib import Path

import pytest

from avatarsim.cli import pieces as command
from avatarsim.cli.pieces import main
from tests.assets.meshes.solids import cube, ell, obj_text
from tests.own_cache import keep_pieces_in


@pytest.fixture(autouse=True)
def cache_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every test has a cache folder of its own."""
    keep_pieces_in(tmp_path / "cache", monkeypatch)


def test_a_mesh_is_kept_and_a_refused_one_beside_it_ends_with_3(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    good, opened = tmp_path / "cube.obj", tmp_path / "open.obj"
    good.write_text(obj_text(cube()), encoding="utf-8")
    opened.write_text(obj_text((ell()[0], ell()[1][1:])), encoding="utf-8")
    for hit in (False, True):
        assert main([str(opened), str(good), "--json", "--scale", "0.1"]) == 3
        out, err = capsys.readouterr()
        (row,) = [json.loads(line) for line in out.splitlines()]
        assert row["mesh"] == str(good) and row["vertices"] == [8] and row["from_cache"] is hit
        assert row["size"] == pytest.approx(0.1 * 3.0**0.5) and "border edges of open.obj is 3" in err
    assert main([str(opened), "--hull", "--no-cache"]) == 0
    assert len(capsys.readouterr().out.splitlines()) >= 2


def test_a_stop_by_the_user_ends_with_130(monkeypatch: pytest.MonkeyPatch) -> None:
    def stopped(*words: object, **options: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(command, "pieces_of_mesh", stopped)
    assert main(["any.obj"]) == 130
