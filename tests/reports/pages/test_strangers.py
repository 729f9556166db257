"""Texts from outside remain text, and files remain inside their folder."""

from collections.abc import Callable
from pathlib import Path

import pytest

from avatarsim.errors import InvalidFile
from reports import write_report
from tests.reports.conftest import row
from tests.reports.pages.conftest import filled
from tests.reports.pages.reading import data_of, read

Json = dict[str, object]
HOSTILE = "</script><script>alert(1)</script><img src=http://x.invalid/y onerror=alert(2)>\"'&{{ 7 * 7 }}\u2028]]>"
NAMES = ("../x", "a/b", "..", "/etc/x", 'a"b', "a'b", "<script>", "a b", "a\nb", "", ".hidden", "a\\b", "-x", "a" * 300)


def tree(folder: Path) -> dict[str, bytes]:
    """Return all files below a folder."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


@pytest.mark.parametrize("name", NAMES)
def test_a_scene_never_leaves_the_folder(tmp_path: Path, results: Json, name: str) -> None:
    rows = results["rows"]
    assert isinstance(rows, list)
    folder = filled(tmp_path / "deep" / "run", rows=[*rows, row(name, "avatarsim/default", "residual_overlap_max", 0.0, "m")])
    before = tree(tmp_path)
    try:
        write_report(folder)
    except InvalidFile:
        assert tree(tmp_path) == before
        return
    new = set(tree(tmp_path)) - set(before)
    assert new and all(path.startswith("deep/run/") for path in new)
    assert f"deep/run/scenes/{name}.html" in new and not set(name) & set("/\\\"'<>\n\0")


def test_plain_names_of_other_alphabets_are_scenes_too(tmp_path: Path, results: Json) -> None:
    names = ("Stapel_2", "stack-of.ten", "積み木")
    rows = [row(name, "avatarsim/default", "residual_overlap_max", 0.0, "m") for name in names]
    write_report(filled(tmp_path / "run", rows=rows))
    assert {path.stem for path in (tmp_path / "run" / "scenes").glob("*.html")} == set(names)


def _everywhere(results: Json, text: str) -> Json:
    """Return a run with a text in each place from which a run takes texts."""
    rows, engines = results["rows"], results["engines"]
    assert isinstance(rows, list) and isinstance(engines, list)
    name = text.replace("/", "|")
    strange = [
        row("arm_wall", "avatarsim/default", text, 1.0, text),
        row("arm_wall", f"{name}/{name}", "residual_overlap_max", 1.0, "m"),
        row("ball_drop", "pybullet/default", "run", None, status="crashed", note=text),
        row("ball_drop", "avatarsim/default", "course_error_max", 3.0, "m", bound=1.0, status="fail", note=text),
    ]
    note = {**engines[0], "version": text, "unsupported": {text: text}, "settings": {text: [text, f"a reason {text}"]}}
    provenance = {"commit": text, "cpu": text, "cpus": text, "versions": {"mujoco": text}, text: text}
    scenes = {"arm_wall": {"title": text}}
    return {"rows": [*rows, *strange], "engines": [*engines, note], "scenes": scenes, "notes": [text], "provenance": provenance}


def test_texts_from_outside_are_never_markup(tmp_path: Path, report: Path, results: Json) -> None:
    folder = filled(tmp_path / "run", **_everywhere(results, HOSTILE))
    (folder / "growth.csv").write_text(f'"{HOSTILE.replace(chr(34), chr(34) * 2)}",p50\nx,1\n', encoding="utf-8")
    write_report(folder)
    for path in sorted(folder.rglob("*.html")):
        name = str(path.relative_to(folder))
        page, plain = read(path), read(report / name)
        assert page.unclosed == plain.unclosed == [] and "{{ 49 }}" not in page.text and "&49" not in page.text, name
        assert {tag for tag, *_ in page.links} <= {tag for tag, *_ in plain.links} | {"a", "link"}
        assert not any("x.invalid" in address for tag, _, address in page.links if tag != "a"), name
        assert len(page.scripts) <= len(plain.scripts) and not any(text.strip() == "alert(1)" for _, text in page.scripts), name
    assert HOSTILE[:40] in read(folder / "engines.html").text


@pytest.mark.parametrize("value", ["NaN", "Infinity", "-Infinity", None])
@pytest.mark.parametrize("run", ["avatarsim/default", "mujoco/tuned"])
def test_numbers_that_are_none_do_not_stop_a_report(
    run_dir: Callable[[object], Path], results: Json, value: object, run: str
) -> None:
    series = {"arm_wall": {run: {"overlap_m": [0.0, value, 1e-3], "frame_time_us": [value, 2.0, value]}}}
    rows = results["rows"]
    assert isinstance(rows, list)
    strange = [row("arm_wall", run, metric, 0.0) | {"value": value} for metric in ("course_error_max", "momentum_drift_max")]
    folder = run_dir(results | {"rows": [*rows, *strange], "series": series})
    write_report(folder)
    assert any([data_of(path) for path in folder.rglob("*.html")])
