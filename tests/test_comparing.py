"""`av.compare` and `avatarsim compare`: a process of its own, from an empty folder, with errors of their own types."""

import subprocess
import sys
from pathlib import Path

import pytest

import avatarsim as av
from avatarsim import comparing
from avatarsim.cli import main
from avatarsim.errors import InvalidFile, InvalidInput, MissingPackage, UnknownName

ROOT = Path(__file__).resolve().parents[1]
BOX = """<mujoco><worldbody><geom name="ground" type="plane" size="5 5 .1"/>
<body name="a" pos="0 0 0.3"><freejoint/><geom type="box" size=".1 .1 .1" mass="1"/></body></worldbody></mujoco>"""
QUICK = ("--frames", "30", "--jobs", "0")


@pytest.fixture
def box(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """A scene in a folder with modules of the harness' names, which are the user's own."""
    for name in ("scenarios", "runfiles", "reports"):
        (tmp_path / f"{name}.py").write_text("raise SystemExit('the module of the user')")
    (tmp_path / "box.xml").write_text(BOX)
    monkeypatch.chdir(tmp_path)
    return "box.xml"


def test_a_table_has_a_row_per_engine_and_preset(box: str) -> None:
    table = av.compare(box, engines=["avatarsim", "tracker"], options=QUICK)
    assert list(table.index) == ["avatarsim/default", "tracker/default"]
    assert table.overlap["avatarsim/default"] == table.residual_overlap_max["avatarsim/default"] <= 1e-6
    assert set(table.state) == {"measured"} and (table.version != "").all()
    assert table.attrs["metrics"]["residual_overlap_max"]["unit"] == "m"


@pytest.mark.parametrize(("arguments", "kind", "value"), [
    ({"engines": ["nobody"]}, UnknownName, "nobody"), ({"motion": "nowhere.csv"}, InvalidFile, None),
    ({"options": ("--max", "nothing=1")}, UnknownName, "nothing"),
])
def test_an_error_of_the_other_process_keeps_its_type(
    box: str, arguments: dict[str, object], kind: type[InvalidInput], value: str | None
) -> None:
    with pytest.raises(kind) as raised:
        av.compare(box, **arguments)  # type: ignore[arg-type]
    assert raised.value.valid and value in (None, raised.value.value)


def test_words_for_sequences_are_refused() -> None:
    with pytest.raises(InvalidInput):
        comparing.words_of(engines="mujoco")


def test_a_missing_extra_names_its_package(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(comparing, "find_spec", lambda name: None)
    with pytest.raises(MissingPackage) as raised:
        av.compare("box.xml")
    assert raised.value.extra == "compare" and "pip install" in str(raised.value)
    assert main(["compare", "box.xml"]) == 3 and "pip install" in capsys.readouterr().err
    assert main(["compare", "--help"]) == 0
    said = capsys.readouterr().out
    assert "--max-overlap" in said and "pip install" in said


def test_the_command_ends_with_the_code_of_the_comparison(box: str) -> None:
    words = ["compare", box, "--engine", "tracker", "--gate", "tracker", "--max-overlap", "1m", *QUICK]
    done = subprocess.run(
        [sys.executable, "-P", "-c", "import sys; from avatarsim.cli import main; sys.exit(main(sys.argv[1:]))", *words],
        env={"PATH": "/usr/bin:/bin", "PYTHONPATH": str(ROOT)}, capture_output=True, text=True, check=False,
    )
    assert done.returncode == 0 and "tracker/default" in done.stdout


def test_a_wheel_runs_the_harness_that_it_holds(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(comparing, "PACKAGE", tmp_path / "avatarsim")
    monkeypatch.setattr(comparing, "SHIPPED", tmp_path / "avatarsim" / "_harness")
    with pytest.raises(InvalidFile):
        comparing.harness()
    for name in ("scenarios/__main__.py", "runfiles/metrics.toml"):
        (comparing.SHIPPED / name).parent.mkdir(parents=True)
        (comparing.SHIPPED / name).touch()
    assert comparing.harness() == comparing.SHIPPED
    words, environment = comparing.command(["x.xml"])
    assert words[1:] == ["-P", "-m", "scenarios", "scene", "x.xml"]
    assert environment["PYTHONPATH"].split(":")[0] == str(comparing.SHIPPED)
