"""`docs/ci.md`: its program writes the motion of the example, and its model is that of the example."""

import re
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "ci.md").read_text(encoding="utf-8")
EXAMPLE = ROOT / "examples" / "ci"


def test_files_of_the_page_are_those_of_the_example(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    [program] = re.findall(r"^```python\n(.*?open.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)
    exec(program, {})
    made, kept = (np.genfromtxt(folder / "joints.csv", delimiter=",", skip_header=1) for folder in (tmp_path, EXAMPLE))
    assert made.shape == (61, 3) and made == pytest.approx(kept, abs=2e-5)
    [model] = re.findall(r"^```xml\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)
    assert model == (EXAMPLE / "cell.xml").read_text(encoding="utf-8")
