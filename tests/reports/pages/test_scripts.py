"""Data in a page is read back unchanged, and cannot close its element."""

import base64
import gzip
import hashlib
import json
import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from reports.pages import scripts

texts = st.text(st.characters(blacklist_categories=["Cs"])) | st.sampled_from(["</script>", "<!--", "]]>", "\u2028", "'\"&"])
values = st.recursive(
    st.none() | st.booleans() | st.integers(-(2**53), 2**53) | st.floats(allow_nan=False, allow_infinity=False) | texts,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(texts, inner, max_size=4),
)


@given(values)
def test_data_comes_back_and_opens_no_tag(value: Any) -> None:
    text = scripts.data(value)
    assert json.loads(text) == value and "<" not in text


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, {"a": [math.nan]}])
def test_a_number_that_json_has_no_word_for_is_refused(value: object) -> None:
    with pytest.raises(ValueError, match="JSON"):
        scripts.data(value)


@given(st.binary(max_size=500))
def test_packed_bytes_come_back_and_are_the_same_each_time(content: bytes) -> None:
    text = scripts.packed(content)
    assert gzip.decompress(base64.b64decode(text)) == content and text == scripts.packed(content)


@given(st.lists(st.text(max_size=20), max_size=4))
def test_a_policy_allows_its_scripts_and_nothing_from_elsewhere(sources: list[str]) -> None:
    found = {part.split()[0]: part.split()[1:] for part in scripts.policy(sources).split(";")}
    digests = [f"'sha256-{base64.b64encode(hashlib.sha256(one.encode()).digest()).decode()}'" for one in sources]
    assert found["default-src"] == ["'none'"] and found["script-src"] == (digests or ["'none'"])
    assert not any("http" in word or word in ("*", "'unsafe-eval'") for words in found.values() for word in words)
    assert "'unsafe-inline'" not in found["script-src"]


def test_libraries_cannot_end_their_script() -> None:
    assert "</script" not in scripts.vega() and "vegaEmbed" in scripts.vega() and all(scripts.data_tables())
