"""Parsed values are nested no deeper than later code can follow, whatever the parser itself can; equal in every format."""

import io
import json
from pathlib import Path

import numpy as np
import pytest

from avatarsim.assets.meshes import cache
from avatarsim.errors import InvalidFile
from avatarsim.files import DEEPEST, make_private, parsed_json, read_json, read_toml, write_entry
from reports import write_report
from runfiles import array_file, record
from scenarios.studies.checkpoint import Checkpoint
from tests.hostile import valid_files


def nested(levels: int, form: str) -> str:
    begin, end = form.split("1")
    return begin * levels + "1" + end * levels


@pytest.mark.parametrize("form", ["[1]", '{"a":1}'])
def test_json_ends_at_its_deepest_level(tmp_path: Path, form: str) -> None:
    path = tmp_path / "some.json"
    path.write_text(nested(DEEPEST, form))
    assert read_json(path, "it", "JSON") == json.loads(nested(DEEPEST, form))
    for levels in (DEEPEST + 1, 400, 100_000):
        path.write_text(nested(levels, form))
        with pytest.raises(InvalidFile, match="nested too deeply"):
            read_json(path, "it", "JSON")


def test_many_are_not_deep() -> None:
    assert parsed_json(f"[{'[[1]],' * 5000}[]]", "it", "JSON") == [[[1]]] * 5000 + [[]]
    assert parsed_json("1", "it", "JSON") == 1


def test_toml_ends_there_too(tmp_path: Path) -> None:
    path = tmp_path / "some.toml"
    for levels, written in ((DEEPEST, f"a = {nested(DEEPEST - 1, '[1]')}"), (DEEPEST, f"{'.'.join('a' * DEEPEST)} = 1")):
        path.write_text(written)
        assert list(read_toml(path, "it", "TOML")) == ["a"], levels
    for written in (f"a = {nested(DEEPEST, '[1]')}", f"{'.'.join('a' * (DEEPEST + 1))} = 1"):
        path.write_text(written)
        with pytest.raises(InvalidFile, match="nested too deeply"):
            read_toml(path, "it", "TOML")


@pytest.mark.parametrize("levels", [200, 800])
def test_results_of_deep_objects_are_refused(tmp_path: Path, levels: int) -> None:
    whole = json.loads(valid_files.run()["results.json"])
    whole["rows"][0]["preset"] = "@"
    (tmp_path / "results.json").write_text(json.dumps(whole).replace('"@"', nested(levels, '{"a":1}')))
    with pytest.raises(InvalidFile, match="nested too deeply"):
        write_report(tmp_path)


def test_recordings_and_finished_trials_end_there_too(tmp_path: Path) -> None:
    deep = nested(DEEPEST, '{"a":1}')
    with (tmp_path / "some.npz").open("wb") as file:
        array_file.write(file, {"meta": np.array(f'{{"schema_version": 1, "more": {deep}}}')})
    with pytest.raises(InvalidFile, match="nested too deeply"):
        record.load(tmp_path / "some.npz")
    kept = Checkpoint(tmp_path / "lines", "0")
    kept.put("k", {})
    kept.put("l", {})
    first, last = (tmp_path / "lines").read_text().splitlines()
    (tmp_path / "lines").write_text(f"{first[:-1]}, \"more\": {deep}}}\n{last}\n")
    assert list(Checkpoint(tmp_path / "lines", "0").known) == ["l"]


@pytest.mark.parametrize("levels", [DEEPEST, 100_000])
def test_kept_pieces_of_deep_objects_are_computed_anew(tmp_path: Path, levels: int) -> None:
    with valid_files.cache_in(tmp_path):
        stream = io.BytesIO()
        deep = f'{{"source": "decomposed", "repairs": [], "deviation": {nested(levels, "[1]")}}}'
        np.savez(stream, vertices=np.zeros((4, 3)), counts=np.array([4]), about=np.array(deep))
        [folder] = [folder for folder in cache._folders() if folder.is_relative_to(tmp_path)][:1]
        make_private(folder)
        write_entry(folder / "key.npz", stream.getvalue())
        found, said = cache.load("key")
    assert found is None and "has another layout and was computed anew" in said
