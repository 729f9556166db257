"""The command line of the engine: refusals are a sentence with exit code 2, and nothing is compiled twice."""

import os
import re
from pathlib import Path

import pytest

from avatarsim import compile_ahead
from avatarsim.cli.arguments import parsed
from avatarsim.cli.dispatch import main
from avatarsim.files import VARIABLE
from avatarsim.jit import baseline, places
from avatarsim.jit.places import NAME, Places


@pytest.fixture(autouse=True)
def nothing_is_compiled(monkeypatch: pytest.MonkeyPatch) -> list[Path | None]:
    """Where kernels would be kept, of each time that everything would be compiled; places and environment are put back."""
    asked: list[Path | None] = []

    def compiled(shares: object, stream: object) -> bool:
        asked.append(places.current().write)
        return True

    monkeypatch.setattr(compile_ahead, "run_shares", compiled)
    monkeypatch.setattr(places, "PLACES", places.PLACES)
    for variable in ("NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES"):
        monkeypatch.setenv(variable, "")
    return asked


@pytest.mark.parametrize("command", [[], ["compile"]])
def test_with_and_without_its_command_it_compiles_once(
    command: list[str], nothing_is_compiled: list[Path | None], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    places.use_places(Places(tmp_path / "kernels"))
    assert main(command) == 0
    capsys.readouterr()
    assert main(command) == 0
    assert nothing_is_compiled == [tmp_path / "kernels"]
    assert bool(capsys.readouterr().out) is bool(command)


def test_compiles_for_the_baseline_unless_host_is_asked_for(
    nothing_is_compiled: list[Path | None], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(baseline, "runs_baseline", lambda: True)
    assert main(["compile", "--to", str(tmp_path / "host"), "--cpu", "host"]) == 0
    assert os.environ["NUMBA_CPU_NAME"] == ""
    assert main(["compile", "--to", str(tmp_path / "any")]) == 0
    assert (os.environ["NUMBA_CPU_NAME"], os.environ["NUMBA_CPU_FEATURES"]) == (baseline.NAME, baseline.LISTED)
    assert nothing_is_compiled == [tmp_path / "host" / NAME, tmp_path / "any" / NAME]


@pytest.mark.parametrize(("command", "words"), [
    (["compile", "--cpu", "host"], ["--cpu", "--to"]), (["--parts=motion", "compile"], ["--parts"]),
    (["compile", "--to", "absent/folder"], ["'absent/folder'"]), (["compile", "--to", "a_file", "--cpu", "host"], ["a_file"]),
    (["compile", "--to", "new"], ["x86-64-v3", "--cpu host"]), (["--parts", "motions"], ["'motions'"]),
])
def test_what_is_impossible_is_refused_in_a_sentence(
    command: list[str], words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str],
    nothing_is_compiled: list[Path | None],
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(baseline, "runs_baseline", lambda: False)
    (tmp_path / "a_file").write_text("", encoding="utf-8")
    try:
        code = main(command)
    except SystemExit as ended:
        code = int(str(ended.code))
    said = capsys.readouterr().err
    assert code == 2 and nothing_is_compiled == []
    assert [word for word in words if word not in said] == [] and "Traceback" not in said


def test_the_manuals_container_compiles_into_the_folder_it_reads() -> None:
    manual = (Path(__file__).parents[1] / "docs" / "installing.md").read_text(encoding="utf-8")
    (container,) = re.findall(r"```dockerfile\n(.*?)```", manual, re.DOTALL)
    (command,) = re.findall(r"^RUN avatarsim (.*)$", container, re.MULTILINE)
    (folder,) = re.findall(rf"^ENV {VARIABLE}=(.*)$", container, re.MULTILINE)
    asked = parsed(command.split())
    assert (asked.command, str(asked.to), asked.cpu) == ("compile", folder, None)
