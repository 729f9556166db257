"""The tables of elements in docs/files.md name every element of MuJoCo's schema."""

import re
from pathlib import Path

import mujoco

FILES = Path(__file__).parents[2] / "docs" / "files.md"


def test_every_element_of_the_schema_is_in_the_table() -> None:
    text = FILES.read_text(encoding="utf-8")
    table = text[text.index("### Every element") : text.index("### Models that were tried")]
    listed = {name for row in table.splitlines() if row.startswith("| `") for name in re.findall(r"`(\w+)`", row.split("|")[1])}
    schema = set(re.findall(r"^\s*(?:\(world\))?(\w+) \(.\)", mujoco.mj_printSchema(False, False), re.MULTILINE))
    assert len(schema) > 100 and schema - listed == set()
