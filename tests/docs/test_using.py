"""`docs/using.md`: its Python runs, and its options and statuses are those of the engine."""

import json
import re
from pathlib import Path

import pytest

import avatarsim as av
from avatarsim.lower_loop import STATUS_PLACES
from avatarsim.settings import PostureSettings

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "using.md").read_text(encoding="utf-8")
PYTHON = re.compile(r"^```python\n(.*?)^```$", re.DOTALL | re.MULTILINE)


def section(title: str) -> str:
    """Return the text under a heading of the page, up to the next."""
    [found] = re.findall(rf"^## {title}\n(.*?)(?=^## |\Z)", PAGE, re.DOTALL | re.MULTILINE)
    return str(found)


def rows(title: str) -> set[str]:
    """Return first cells of the table of a section."""
    return set(re.findall(r"^\| `(\w+)` \|", section(title), re.MULTILINE))


def test_blocks_run_in_their_order_and_do_what_is_said(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    [room] = re.findall(r"^```xml\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)
    (tmp_path / "room.xml").write_text(room, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    said = []
    for block in PYTHON.findall(PAGE):
        exec(block, names)
        said.append(capsys.readouterr().out)
    assert len(said) > 8
    in_room, *others = [out for out in said if out]
    shown, cup = (json.loads(found) for found in re.findall(r"\[.*?\]", in_room))
    # the table's top, half a palm and the stand-off; the cup is ahead of the palm, to its right
    assert shown[2] == pytest.approx(0.72 + 0.015 + 2e-4, abs=1e-3) and cup[1] < -0.3
    # moved bodies, records and contacts of the page are printed: half the table, the fist, the requested gap
    moved, placed, touching = others
    assert moved.startswith("hand ") and "table" in moved
    height = float(placed.partition("]")[0].split()[-1])
    assert height == pytest.approx(0.025 + 0.04 + 1e-4, abs=1e-5) and touching.startswith("table hand ")
    records, engine = names["records"], names["engine"]
    assert isinstance(records, tuple) and len(records) == 4
    # closed at the end of the page
    assert isinstance(engine, av.AvatarsimEngine)
    with pytest.raises(av.AvatarsimError):
        engine.contacts()


def test_options_are_settings_of_the_posture() -> None:
    assert len(rows("Options")) > 4 and rows("Options") <= set(PostureSettings._fields)


def test_statuses_are_those_that_a_frame_says() -> None:
    assert len(rows("Records")) > 3 and rows("Records") <= {name for name, _ in STATUS_PLACES}
