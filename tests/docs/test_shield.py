"""`docs/shield.md`: its first section, followed with its own file."""

import re
from pathlib import Path

import pytest

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "shield.md").read_text(encoding="utf-8")


def test_an_arm_is_driven_into_the_floor_and_stops_above(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    [arm] = re.findall(r"^```xml\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)
    (tmp_path / "arm.urdf").write_text(arm, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    for block in re.findall(r"^```python\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE):
        exec(block, names)
    joints, stopped, checked = capsys.readouterr().out.splitlines()
    assert joints == "('shoulder', 'elbow', 'wrist')" and checked == "0.0 True"
    asked, sent = (float(height) for height in re.findall(r"(-?\d\.\d+) m", stopped))
    assert asked < -0.15 and 0.04 <= sent < 0.045
