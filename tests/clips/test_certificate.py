"""Certificates keep to their schema, are of the same bytes every time, and name no machine and no time."""

import json
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from avatarsim.cleaning import Options
from avatarsim.clips import certificate
from avatarsim.clips.batch import FOLDER_CERTIFICATE, left_undone
from avatarsim.clips.options import ClipOptions
from avatarsim.errors import InvalidFile
from tests.clips.entries import audit, entry, motion


def valid(value: dict[str, object]) -> None:
    schema = certificate.schema()
    jsonschema.Draft202012Validator.check_schema(schema)
    jsonschema.Draft202012Validator(schema).validate(value)


def test_a_certificate_keeps_to_its_schema() -> None:
    whole = certificate.summary("clean", [entry()], [("bad.bvh", "unreadable", "cut off")])
    valid(json.loads(certificate.text(whole)))
    decides = certificate.key((("a.csv", "0" * 64),), (), (), ClipOptions())
    measured = certificate.entry("a.csv", "csv", decides, motion(), audit(0.02, False))
    valid(json.loads(certificate.text(certificate.summary("audit", [measured], []))))


@pytest.mark.parametrize(("name", "value"), [
    ("frames", 0), ("is_clean", 1), ("format", "fbx"), ("rate_hz", 0.0), ("seconds", 12.0), ("motion", None),
    ("overlap", {"tolerance_m": 1e-6, "before": {"frames": -1, "deepest_m": 0.0, "pair": None}, "after": None}),
])
def test_the_schema_refuses_what_is_no_certificate(name: str, value: object) -> None:
    whole = certificate.summary("clean", [entry() | {name: value}], [])
    with pytest.raises(jsonschema.ValidationError):
        valid(json.loads(json.dumps(whole)))


def test_figures_stand_where_they_belong() -> None:
    one: Any = entry()
    assert one["overlap"]["before"] == {"frames": 1, "deepest_m": 0.03, "pair": ["hand", "table"], "frame": 1}
    assert one["overlap"]["after"] == {"frames": 0, "deepest_m": 0.0, "pair": None, "frame": None} and one["is_clean"] is True
    assert one["between_frames"] == {"chords": 3, "not_certified_before": 1, "not_certified_after": 0}
    assert one["jerk_p95_m_s3"]["before"] == {"where_free": 12.5, "elsewhere": None}
    assert one["foot_slide_m_s"] == {"before": 0.07, "after": 0.07}
    assert one["moved"]["links"][1] == {"name": "arm", "rms_m": 0.02, "p95_m": 0.04, "most_m": 0.06}
    assert one["changed_frames"] == 2
    assert one["moved"]["slides"] == [{"name": "finger", "rms_m": 0.001, "p95_m": 0.002}] and one["held_frames"] == 1
    assert one["excluded"] == [{"a": "a", "b": "b", "depth_m": 0.02}]
    assert one["at_rest"] == [{"a": "walk/a", "b": "walk/c", "allowed_m": 0.01, "depth_m": 0.005}]
    assert one["flagged"][0] == {"first": 1, "last": 2, "why": "overlap", "pair": ["hand", "table"]}
    assert one["said"] == ["read so", "said of the audit"] and one["rate_hz"] == 30.0
    assert one["inputs"]["avatar"][1] == {"name": "assets/a.stl", "sha256": "2" * 64}


def test_equal_runs_leave_equal_bytes_without_machine_or_time() -> None:
    text = certificate.text(certificate.summary("clean", [entry()], []))
    assert text == certificate.text(certificate.summary("clean", [entry()], [])) and text.endswith(b"}\n")
    assert b"/models" not in text and b"/skeletons" not in text
    one: Any = entry()
    assert one["options"]["avatar"] == "robot.xml" and one["options"]["reading"]["asf"] == "02.asf"
    assert set(one["versions"]) >= {"avatarsim", "code", "numpy", "coal"}
    result: Any = certificate.plain(ClipOptions(cleaning=Options(margin=0.002)).as_json())
    assert result["cleaning"]["margin"] == 0.002 and set(result["cleaning"]) == set(vars(Options()))


@pytest.mark.parametrize("content", [b"", b"{", b"[]", b'{"motion": 3}', b"\xff\xfe", b'{"motion": NaN', b"[" * 5000])
def test_what_is_no_certificate_counts_as_none(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "a.json").write_bytes(content)
    assert certificate.read(tmp_path / "a.json") is None and certificate.read(tmp_path / "absent.json") is None
    (tmp_path / "b.json").write_bytes(certificate.text(entry()))
    found = certificate.read(tmp_path / "b.json")
    assert found == entry() and certificate.output_hash(found, "motion") == "3" * 64
    assert certificate.output_hash(None, "motion") is None and certificate.output_hash({"outputs": 3}, "motion") is None


@pytest.mark.parametrize("content", [b"{", b"[]", b'{"not_done": 3}', b'{"not_done": [{"name": 3}]}', b"\xff"])
def test_a_damaged_certificate_of_the_folder_is_refused(tmp_path: Path, content: bytes) -> None:
    assert left_undone(tmp_path, frozenset()) == ()
    (tmp_path / FOLDER_CERTIFICATE).write_bytes(content)
    with pytest.raises(InvalidFile, match=FOLDER_CERTIFICATE):
        left_undone(tmp_path, frozenset())
