"""The small validator of certificates agrees with a whole one, on certificates and on damaged ones."""

import copy
import random
from typing import Any

import jsonschema
import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.clips import certificate
from avatarsim.clips.schema_check import fault
from tests.clips.entries import entry

FOLDER_CERTIFICATE = certificate.schema()
VALUES = st.recursive(
    st.none() | st.booleans() | st.integers(-2, 3) | st.floats(-1.0, 2.0) | st.text(max_size=3) | st.just("0" * 64),
    lambda part: st.lists(part, max_size=3) | st.dictionaries(st.sampled_from(["a", "name", "frames"]), part, max_size=3),
    max_leaves=8,
)


def agree(value: object, schema: dict[str, Any]) -> bool:
    """Return whether both find a value right; they have to agree."""
    ours, theirs = not fault(value, schema, schema), jsonschema.Draft202012Validator(schema).is_valid(value)
    assert ours == theirs, value
    return ours


def damaged(value: Any, rng: random.Random) -> Any:
    """Return a certificate of which one part is missing, is more, or is something else."""
    part = found = copy.deepcopy(value)
    key: Any = None
    while isinstance(part, dict | list) and part and (key is None or rng.random() < 0.75):
        above, key = part, rng.choice(list(part) if isinstance(part, dict) else range(len(part)))
        part = part[key]
    kind = rng.random()
    if kind < 0.3:
        del above[key]
    elif kind < 0.5 and isinstance(part, dict):
        part["more"] = 1
    else:
        above[key] = rng.choice([None, True, -1, 0, 1.5, "x", "0" * 64, [], {}, ["a", "b"], ["a", "b", "c"], {"name": "a"}])
    return found


def test_it_agrees_with_a_whole_validator_on_certificates() -> None:
    rng, right = random.Random(5), 0
    value = certificate.plain(certificate.summary("clean", [entry()], [("a", "b", "c")]))
    assert agree(value, FOLDER_CERTIFICATE)
    for _ in range(600):
        right += agree(damaged(value, rng), FOLDER_CERTIFICATE)
    assert 4 < right < 480


@given(VALUES, st.sampled_from([
    {"type": "integer", "minimum": 0}, {"maximum": 1},
    {"type": "number", "exclusiveMinimum": 0}, {"const": 1}, {"enum": ["a", 0, True]},
    {"anyOf": [{"type": "string", "pattern": "^0"}, {"type": "null"}]}, {"type": "array", "minItems": 1, "maxItems": 2},
    {"items": {"type": "object", "properties": {"a": {"type": "boolean"}}, "required": ["a"], "additionalProperties": False}},
    {"additionalProperties": {"type": "integer"}},
    {"$ref": "#/$defs/x", "$defs": {"x": {"type": "object", "required": ["name"]}}},
]))
def test_it_agrees_on_each_keyword(value: object, schema: dict[str, Any]) -> None:
    agree(value, schema)


def test_a_keyword_that_is_not_known_is_an_error_of_the_schema() -> None:
    with pytest.raises(ValueError, match="keyword uniqueItems"):
        fault([1], {"uniqueItems": True}, {})
    assert fault({"a": [1, "x"]}, {"properties": {"a": {"items": {"type": "integer"}}}}, {})
