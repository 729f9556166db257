"""Settings given by a user: a row each, rejected before anything runs if they cannot be meant."""

from pathlib import Path

import pytest

from avatarsim.errors import InvalidInput
from scenarios.engines import known
from scenarios.run.own_settings import EXAMPLE, OwnSettings, check_settings, read
from tests.agreement.rivals import needs_pybullet
from tests.scenarios.bad_engines import joined
from tests.scenarios.command_line import called, latest

FILE = Path(__file__).resolve().parents[3] / EXAMPLE


def row(engine: str, **options: object) -> OwnSettings:
    return OwnSettings(engine, "mine", "default", options)


@needs_pybullet
def test_every_engine_takes_its_row_of_the_example() -> None:
    rows = read(FILE, known())
    assert [one.engine for one in rows] == ["avatarsim", "mujoco", "pybullet"]
    assert all(one.options and "preset" not in one.options for one in rows)
    check_settings(rows, "ball_drop", FILE, 0)


@pytest.mark.parametrize("workers", [0, 2])
def test_the_first_wrong_row_of_the_file_is_named(workers: int) -> None:
    rows = [row("avatarsim"), row("mujoco", itterations=5), row("avatarsim", tolerence=1e-3)]
    with pytest.raises(InvalidInput, match=r"\[mujoco.mine\] of mine.toml.*'itterations'.*iterations"):
        check_settings(rows, "ball_drop", Path("mine.toml"), workers)
    check_settings([row("avatarsim"), row("mujoco", iterations=5)], "ball_drop", Path("mine.toml"), workers)


@needs_pybullet
def test_a_word_where_a_number_belongs_is_refused() -> None:
    with pytest.raises(InvalidInput, match="solver_iterations.*'many'"):
        check_settings([row("pybullet", solver_iterations="many")], "ball_drop", Path("mine.toml"), 1)


def test_failing_engine_is_no_fault_of_the_settings(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(joined(tmp_path))
    check_settings([row("raises"), row("dies"), row("absent")], "ball_drop", Path("mine.toml"), 2)


def test_each_row_is_a_preset_of_its_run(site: Path, tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text('[tunnels.brisk]\npreset = "other"\ngain = 2.5\n[tunnels."gain=2.5"]\n')
    called(tmp_path, "check", "--engine", "tunnels", "--filter", "ball_drop", "--settings", str(path))
    engines = latest(tmp_path)["engines"]
    assert [entry["preset"] for entry in engines] == ["default", "brisk", "gain=2.5"] and engines[1]["settings"]["gain"] == 2.5


@pytest.mark.parametrize(("text", "named"), [
    ("[nobody.x]\n", "nobody"), ("[tunnels]\ngain = 1\n", "tunnels"), ("[tunnels.default]\n", "default"),
    ("[tunnels.'a/b']\n", "a/b"), ("= 3", "TOML"), ("", "nothing"), ("[tunnels]", "tunnels"), ('[tunnels."a b"]\n', "a b"),
    (f"[tunnels.{'a' * 300}]\n", "aaa"), ("[mujoco.mine]\n", "mujoco"), ("[tunnels.a]\n[mujoco.b]\n", "mujoco"),
    ("[tunnels.a]\nx = 1" + "0" * 5000 + "\n", "TOML"),
    ("[tunnels.a]\n[[tunnels.a.b]]\n[tunnels.a]\n", "TOML"), ('[tunnels.mine]\npreset = "nowhere"\n', "nowhere"),
    ('[tunnels."\u00e9"]\n', "\u00e9"), ('[tunnels.""]\n', "''"),
])
def test_settings_that_cannot_be_meant_are_refused(
    site: Path, tmp_path: Path, text: str, named: str, capsys: pytest.CaptureFixture[str],
) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(text, encoding="utf-8")
    for command in (["check"], ["study", "settings"]):
        words = [*command, "--engine", "tunnels", "--filter", "ball_drop", "--settings", str(path)]
        assert called(tmp_path, *words) == 2 and named in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
