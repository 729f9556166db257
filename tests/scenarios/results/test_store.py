"""Entries come back as they went in, and what is damaged or another's is as good as absent."""

import json
import math
import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from avatarsim.errors import InvalidInput
from scenarios.results.store import Store


def test_an_entry_comes_back(tmp_path: Path) -> None:
    store = Store(tmp_path / "deep" / "found")
    store.put("errors", "abc", {"values": {"x": 0.1}, "note": ""})
    found = Store(tmp_path / "deep" / "found").get("errors", "abc")
    assert found is not None and found["values"] == {"x": 0.1}
    assert store.get("times", "abc") is None and store.get("errors", "abd") is None


@pytest.mark.parametrize("text", ["", "{", "[]", '{"key": "other", "kind": "errors"}', '{"key": "abc", "kind": "times"}'])
def test_what_is_no_entry_is_absent(tmp_path: Path, text: str) -> None:
    store = Store(tmp_path)
    store.path("errors", "abc").write_text(text)
    assert store.get("errors", "abc") is None
    store.put("errors", "abc", {})
    assert store.get("errors", "abc") is not None


@pytest.mark.parametrize("changed", [{"values": 3}, {"values": {"x": 0.2}}, {"sha256": 7}, {"sha256": None}, {"more": {}}])
def test_what_was_changed_is_found_again(tmp_path: Path, changed: dict[str, object]) -> None:
    store = Store(tmp_path)
    store.put("errors", "abc", {"values": {"x": 0.1, "y": math.nan, "z": np.float64(-math.inf), 3: (1, 2)}, "rows": []})
    path = store.path("errors", "abc")
    assert store.get("errors", "abc") is not None
    path.write_text(json.dumps(json.loads(path.read_text()) | changed))
    assert store.get("errors", "abc") is None


def test_a_place_where_nothing_can_be_made_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InvalidInput, match="a folder that can be made"):
        Store(tmp_path / "file" / "below")


def test_a_process_killed_while_it_writes_leaves_whole_entries_only(tmp_path: Path) -> None:
    script = (
        "import sys\nfrom pathlib import Path\nfrom scenarios.results.store import Store\nstore = Store(Path(sys.argv[1]))\n"
        "k = 0\nwhile True:\n    store.put('errors', str(k), {'values': list(range(2000))})\n"
        "    print(k, flush=True)\n    k += 1\n"
    )
    child = subprocess.Popen([sys.executable, "-c", script, str(tmp_path)], stdout=subprocess.PIPE, text=True)
    assert child.stdout is not None
    for _ in range(20):
        last = int(child.stdout.readline())
    os.kill(child.pid, signal.SIGKILL)
    child.wait()
    child.stdout.close()
    store = Store(tmp_path)
    assert all(store.get("errors", str(k)) is not None for k in range(last + 1))
    # the one that was being written is whole or absent
    whole = [path.name.split(".")[0] for path in tmp_path.glob("*.errors.json")]
    assert all(store.get("errors", key) is not None for key in whole)
