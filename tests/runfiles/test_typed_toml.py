"""Any table is read as the types of its fields, or refused with InvalidFile."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from avatarsim.errors import InvalidFile
from runfiles.typed_toml import read

PLAIN = st.booleans() | st.integers(-9, 9) | st.sampled_from(["", "a", "b", "1.2"])
VALUES = PLAIN | st.lists(PLAIN, max_size=2)


@dataclass(frozen=True)
class Inner:
    kind: Literal["a", "b"]
    words: tuple[str, ...] = ()


@dataclass(frozen=True)
class Outer:
    text: str
    flag: bool = False
    count: Annotated[int, range(1, 5)] = 1
    version: Annotated[str, r"\d\.\d"] = "0.0"
    anything: object = None
    either: str | Mapping[str, str] = ""
    inner: Inner = Inner("a")


GOOD: dict[str, Any] = {
    "text": lambda v: isinstance(v, str), "flag": lambda v: isinstance(v, bool), "count": lambda v: type(v) is int and 0 < v < 5,
    "version": lambda v: v == "1.2", "anything": lambda v: True, "either": lambda v: isinstance(v, str),
}


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
@given(st.fixed_dictionaries({"text": VALUES}, optional={name: VALUES for name in [*GOOD, "other"] if name != "text"}))
def test_values_fit_their_fields_or_are_refused(tmp_path: Path, values: dict[str, object]) -> None:
    path = tmp_path / "a.toml"
    path.write_text("".join(f"{name} = {json.dumps(value)}\n" for name, value in values.items()))
    bad = [name for name, value in values.items() if name == "other" or not GOOD[name](value)]
    if not bad:
        found = read(path, Outer)
        assert all(getattr(found, name) == (tuple(v) if isinstance(v, list) else v) for name, v in values.items())
        return
    with pytest.raises(InvalidFile) as raised:
        read(path, Outer)
    assert raised.value.thing in [f"{name} in {path}" for name in bad]


@pytest.mark.parametrize(("text", "key"), [
    ("", "text"), ('text = "a"\n[inner]\nkind = "c"', "inner.kind"), ('text = "a"\n[inner]', "inner.kind"),
    ('text = "a"\n[inner]\nkind = "a"\nwords = ["b", 1]', "inner.words[1]"), ('text = "a"\n[either]\nx = 1', "either.x"),
])
def test_a_missing_or_inner_key_is_named(tmp_path: Path, text: str, key: str) -> None:
    path = tmp_path / "a.toml"
    path.write_text(text)
    with pytest.raises(InvalidFile) as raised:
        read(path, Outer)
    assert raised.value.thing == f"{key} in {path}"
