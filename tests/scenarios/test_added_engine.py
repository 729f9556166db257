"""An engine is added by one folder: its adapter and its files of facts. Nothing in the project changes."""

import sys
from pathlib import Path

import pytest

from avatarsim.errors import InvalidFile
from reference.presets import Kind
from runfiles.comparable import silenced_metrics
from runfiles.engines import About, about, engines, run_label
from scenarios import catalog
from scenarios.engines import known, opened, takes_part, variants_of
from scenarios.job import Job
from scenarios.studies.settings.grid import settings_of, short_order
from tests.scenarios.command_line import called, last_run, latest
from tests.scenarios.toy_engine import ABOUT, SWEEP, laid


@pytest.fixture
def site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "site"
    monkeypatch.syspath_prepend(folder)
    for name in [name for name in sys.modules if name.startswith("toy_physics")]:
        monkeypatch.delitem(sys.modules, name)
    return folder


def test_an_engine_that_joins_has_rows_and_a_place_on_the_page(site: Path, tmp_path: Path) -> None:
    laid(site)
    asked = "compare", "--engine", "avatarsim", "toy", "--preset", "default", "tuned", "--filter", "ball_drop"
    # a run of six frames is incomplete
    assert called(tmp_path, *asked) == 3
    rows = [row for row in latest(tmp_path)["rows"] if row["engine"] == "toy"]
    assert {row["preset"] for row in rows} == {"default", "tuned"}
    assert {row["status"] for row in rows if row["metric"] == "residual_overlap_max"} == {"info"}
    page = (last_run(tmp_path) / "index.html").read_text()
    assert "Toy Physics" in page and "#123456" in page and "#abcdef" in page
    assert "7.1" in (last_run(tmp_path) / "engines.html").read_text()


def test_its_files_say_what_the_harness_asks_of_an_engine(site: Path) -> None:
    laid(site)
    assert known()["toy"] == about("toy").adapter == "toy_physics.inner.adapter:Toy" and "toy" not in engines()
    assert not {"toy_physics", "toy_physics.inner"} & set(sys.modules), "nothing of it is imported for that"
    assert run_label("toy/tuned") == "Toy Physics" and about("toy").presets == ("tuned",)
    assert about("toy").has_time_step and not about("toy").reuses_process
    assert silenced_metrics("toy/tuned", ["dynamics"]).keys() == {"apex_error_max"}
    assert about("toy").in_own_words({"dt": 0.5}) == ["toy.step(1/2)"]
    stack, walk = catalog.get("stack_ten"), catalog.get("mocap_run")
    assert (variants_of("toy", stack, ()), variants_of("toy", walk, ())) == (["asleep"], [])
    assert takes_part("toy", "tuned", walk) and not takes_part("toy", "asleep", walk)
    assert Job("stack_ten", "toy", "asleep").settings(opened("toy")).preset == "asleep"


def test_its_sweep_is_of_its_folder(site: Path) -> None:
    laid(site)
    found = settings_of("toy", ("default",))
    assert [(s.name, s.base, dict(s.options)) for s in found] == [
        ("tuned", "tuned", {}), ("tuned dt=1/60", "tuned", {"dt": 1.0 / 60.0}), ("tuned dt=1/240", "tuned", {"dt": 1.0 / 240.0}),
        ("tuned sleep=true", "tuned", {"sleep": True, "range": (0.5, 1.0)}),
    ]
    assert found[-1].calls == ("sleeping",) and all(setting.kinds == tuple(Kind) for setting in found)
    assert short_order("toy", ()) == ("tuned", "tuned dt=1/60", "tuned dt=1/240")


@pytest.mark.parametrize(("old", "new", "key", "value"), [
    ('"#123456"', '"blue"', "colour", "blue"), ('["tuned"]', "[]", "presets", ()), ('name = "toy"', 'name = "b"', "name", "b"),
    ('"apex_error_max"', '"apex"', "dynamics.metrics[0]", "apex"), ('"toy.step({})"', "3", "native.dt", 3),
    ("has_time_step", "has_time_stop", "has_time_stop", True), ("[native]", "[[issues]]\n[native]", "issues[0].title", "missing"),
    ('"#123456"', '"#d55e00"', "colour", "#d55e00"), ("has_time_step = true", 'path = "a"', "path", "a"),
    ("steps = [60, 240]", "steps = [0]", "sweep[1].steps[0]", 0), ('base = "tuned", ', "", "sweep[1]", ""),
    ('["sleeping"]', '["dreaming"]', "sweep[2].calls[0]", "dreaming"), ("short = false", "kinds = [3]", "sweep[2].kinds[0]", 3),
    ("short = false", 'groups = ["none"]', "sweep[2].groups", "none"),
])
def test_a_malformed_fact_or_sweep_names_file_key_and_value(
    site: Path, tmp_path: Path, old: str, new: str, key: str, value: object,
) -> None:
    facts = old in ABOUT
    assert facts or old in SWEEP
    package = laid(site, ABOUT.replace(old, new, 1) if facts else ABOUT, SWEEP if facts else SWEEP.replace(old, new, 1))
    with pytest.raises(InvalidFile) as raised:
        settings_of("toy", about("toy").presets)
    file = str(package / ("about.toml" if facts else "sweep.toml"))
    assert file in raised.value.thing and key in raised.value.thing and raised.value.value == value
    assert called(tmp_path, *(("run", "ball_drop") if facts else ("study", "settings")), "--engine", "toy") == 2


def test_presets_of_the_file_are_those_of_the_adapter(site: Path, tmp_path: Path) -> None:
    package = laid(site, ABOUT.replace('["tuned"]', '["tuned", "fast"]'))
    with pytest.raises(InvalidFile) as raised:
        opened("toy")
    assert str(package / "about.toml") in raised.value.thing and raised.value.value == "fast"
    assert "tuned" in raised.value.valid
    assert called(tmp_path, "run", "ball_drop", "--engine", "toy") != 0


def test_a_condition_that_nothing_knows_is_refused(site: Path) -> None:
    laid(site, ABOUT.replace("bodies may sleep", "at night"))
    with pytest.raises(InvalidFile) as raised:
        takes_part("toy", "asleep", catalog.get("stack_ten"))
    assert raised.value.value == "at night" and "bodies may sleep" in raised.value.valid


def test_a_folder_beside_the_built_in_ones_is_an_engine(tmp_path: Path) -> None:
    (tmp_path / "in_toy").mkdir()
    (tmp_path / "in_toy" / "about.toml").write_text('adapter = "a.b:C"\n' + ABOUT)
    found: About = engines(tmp_path)["toy"]
    assert (found.adapter, found.packages, found.variants["asleep"].scenes) == (
        "a.b:C", ("toy-physics",), "bodies may sleep")
    (tmp_path / "in_other").mkdir()
    facts = ABOUT.replace("#123456", "#123457").replace("#abcdef", "#abcdee")
    (tmp_path / "in_other" / "about.toml").write_text(facts)
    with pytest.raises(InvalidFile) as raised:
        engines.__wrapped__(tmp_path)
    assert "adapter" in raised.value.thing
    (tmp_path / "in_other" / "about.toml").write_text('adapter = "a.b:C"\n' + facts)
    with pytest.raises(InvalidFile) as raised:
        engines.__wrapped__(tmp_path)
    assert raised.value.value == "toy"
