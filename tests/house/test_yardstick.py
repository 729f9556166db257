"""The yardstick separates results that changed from those that did not."""

import json
from pathlib import Path

import pytest

from tests.house import yardstick


def test_a_slice_that_has_moved_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before, asked = tmp_path / "before.json", ["--filter", "ball_drop *0", "--jobs", "1"]
    assert yardstick.main([*asked, "-o", str(before)]) == 0
    hashes = json.loads(before.read_text())
    assert set(hashes) == {"ball_drop default 0", "ball_drop paper 0"}
    assert yardstick.main([*asked, "--against", str(before)]) == 0
    before.write_text(json.dumps({**hashes, "ball_drop paper 0": "0", "gone": "0"}))
    assert yardstick.main([*asked, "--against", str(before)]) == 1
    assert "2 slices, 1 differ" in capsys.readouterr().out
    assert yardstick.main(["--filter", "nothing of that name"]) == 2


def test_every_slice_gives_the_same_bits_again(monkeypatch: pytest.MonkeyPatch) -> None:
    for name, count in (("FRAMES", 60), ("IMPACTS", 2000), ("BATCHES", 1)):
        monkeypatch.setattr(yardstick, name, count)
    found = yardstick.slices()
    for name in ("hostile two", "pairs plates", "impacts"):
        assert found[name]() == found[name]()
