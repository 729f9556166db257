"""Certificates: measures of a clip, with its files, options and versions, as JSON of reproducible bytes.

They contain no time, machine or path, so that two runs of one command write equal files. The layout is
`certificate.schema.json` (JSON Schema 2020-12), in this folder.
"""

import json
import math
from collections.abc import Mapping, Sequence
from functools import cache
from importlib.resources import files as resources
from pathlib import Path
from typing import Any

from avatarsim.cleaning import Audit, Cleaned, Moved, Opinion
from avatarsim.cleaning.result import OVERLAP
from avatarsim.clips.inputs import Hashes
from avatarsim.clips.options import ClipOptions
from avatarsim.clips.schema_check import fault
from avatarsim.errors import InvalidFile
from avatarsim.files import parsed_json, read_text
from avatarsim.running.sources import code_hash, versions
from avatarsim.scene.motion import Motion

LAYOUT = 3
"""Version of the layout."""
LINES = 3
"""Levels of a certificate whose members have their own line."""
MARK = '{\n "layout": '
"""First bytes of a folder's certificate."""

LARGEST, LARGEST_FOLDER = 2**27, 2**30
"""Largest size of a clip's certificate, and of a folder's [bytes]. An entry has some 20 kB, so this is a folder of 50,000 clips;
in larger folders the undone clips of earlier commands are not read back."""

Trouble = tuple[str, str, str]
"""(name, kind, why) of a failure."""

OPINIONS = ("coal",)
"""Distributions of the independent judge."""


def key(motion: Hashes, avatar: Hashes, room: Hashes, options: ClipOptions) -> dict[str, object]:
    """Return the inputs that determine the outputs of a clip: hashes of its files, options, and versions."""

    def listed(files: Hashes) -> list[dict[str, str]]:
        return [{"name": name, "sha256": content} for name, content in files]

    return {
        "inputs": {"motion": listed(motion), "avatar": listed(avatar), "room": listed(room)},
        "options": options.as_json(),
        "versions": {**versions(OPINIONS), "code": code_hash()},
    }


def entry(
    place: str, format_: str, decides: Mapping[str, object], motion: Motion, before: Audit, after: Audit | None = None,
    cleaned: Cleaned | None = None, notes: Sequence[str] = (), outputs: Mapping[str, tuple[str, str]] | None = None,
) -> dict[str, object]:
    """Return the entry of one clip: `before` of its input, `after` of the file written and read back, `decides` its `key`."""
    last = after or before
    sentences = [*notes, *before.notes, *last.said]
    found: dict[str, object] = {
        "motion": place, "format": format_, "frames": len(motion), "rate_hz": _rate(motion), **decides,
        "is_clean": last.is_clean,
        "overlap": {"tolerance_m": OVERLAP, "before": _overlap(before), "after": _overlap(after) if after else None},
        "second_opinion": {"before": _opinion(before.opinion), "after": _opinion(after.opinion) if after else None},
        "between_frames": {
            "chords": max(len(motion) - 1, 0), "not_certified_before": before.unproven,
            "not_certified_after": after.unproven if after else None,
        },
        "limits": {
            "excess_before_rad": before.limit_excess, "excess_after_rad": after.limit_excess if after else None,
            "slide_excess_before_m": before.slide_excess, "slide_excess_after_m": after.slide_excess if after else None,
        },
        "jerk_p95_m_s3": {"before": _jerk(before), "after": _jerk(after) if after else None},
        "foot_slide_m_s": {"before": before.foot_slide, "after": after.foot_slide if after else None},
        "excluded": [{"a": one.a, "b": one.b, "depth_m": one.depth} for one in last.excluded],
        "at_rest": [{"a": one.a, "b": one.b, "allowed_m": one.allowed, "depth_m": one.depth} for one in last.at_rest],
        "said": list(dict.fromkeys(sentences)),
    }
    if cleaned is not None:
        found["moved"] = _moved(cleaned.moved)
        found["held_frames"] = int(cleaned.held.sum())
        found["changed_frames"] = int(cleaned.changed.sum())
        found["flagged"] = [
            {"first": one.first, "last": one.last, "why": one.why, "pair": list(one.pair) if one.pair else None}
            for one in cleaned.flagged
        ]
    if outputs is not None:
        found["outputs"] = {name: {"name": path, "sha256": content} for name, (path, content) in outputs.items()}
    return plain(found)


def summary(command: str, entries: Sequence[Mapping[str, object]], troubles: Sequence[Trouble]) -> dict[str, object]:
    """Return the certificate of a folder: its clips by their places, and the undone ones."""
    return {
        "layout": LAYOUT, "command": command,
        "clips": sorted(entries, key=lambda one: str(one["motion"])),
        "not_done": [{"name": name, "kind": kind, "why": why} for name, kind, why in sorted(troubles)],
    }


def _rate(motion: Motion) -> float | None:
    # a rate summed from steps of recorded instants has a tail of rounding errors
    return None if len(motion) < 2 else float(f"{motion.rate:.9g}")


def _overlap(one: Audit) -> dict[str, object]:
    pair = list(one.deepest_pair) if one.deepest_pair else None
    return {"frames": one.overlapping, "deepest_m": one.deepest, "pair": pair, "frame": one.deepest_frame}


def _opinion(one: Opinion | None) -> dict[str, object] | None:
    if one is None:
        return None
    return {
        "by": one.by, "frames": one.frames, "frames_overlapping": one.frames_overlapping, "frames_deepest_m": one.frames_deepest,
        "between": one.between, "between_overlapping": one.between_overlapping, "between_deepest_m": one.between_deepest,
    }


def _jerk(one: Audit) -> dict[str, object]:
    return {"where_free": one.jerk_free, "elsewhere": one.jerk_held}


def _moved(one: Moved) -> dict[str, object]:
    links = zip(one.links, one.link_rms, one.link_p95, one.link_most, strict=True)
    joints = zip(one.joints, one.joint_rms, one.joint_p95, strict=True)
    slides = zip(one.slides, one.slide_rms, one.slide_p95, strict=True)
    return {
        "links": [
            {"name": name, "rms_m": float(rms), "p95_m": float(p95), "most_m": float(most)} for name, rms, p95, most in links
        ],
        "joints": [{"name": name, "rms_rad": float(rms), "p95_rad": float(p95)} for name, rms, p95 in joints],
        "slides": [{"name": name, "rms_m": float(rms), "p95_m": float(p95)} for name, rms, p95 in slides],
    }


def plain(value: Mapping[str, object]) -> dict[str, object]:
    """Return the value as JSON represents it: tuples as lists, and numbers that JSON cannot represent as null."""
    found: dict[str, object] = json.loads(json.dumps(_finite(value), allow_nan=False))
    return found


def _finite(value: object) -> object:
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {str(name): _finite(one) for name, one in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(one) for one in value]
    return value


def text(value: Mapping[str, object]) -> bytes:
    """Return a certificate as bytes: equal values give equal bytes, and names that are not valid text are preserved."""
    return (_in_lines(_finite(value), LINES, "\n") + "\n").encode()


def _in_lines(value: object, deep: int, end: str) -> str:
    """Return `value` as JSON with one line per member of its first `deep` levels.
    So each part of an entry has one line, in a third of the bytes."""
    if deep and value and isinstance(value, dict | list):
        parts = value.values() if isinstance(value, dict) else value
        names = [f"{json.dumps(name)}: " for name in value] if isinstance(value, dict) else [""] * len(value)
        lines = [name + _in_lines(part, deep - 1, f"{end} ") for name, part in zip(names, parts, strict=True)]
        begin, close = "{}" if isinstance(value, dict) else "[]"
        return f"{begin}{end} " + f",{end} ".join(lines) + f"{end}{close}"
    return json.dumps(value, allow_nan=False)


def read(path: Path) -> dict[str, object] | None:
    """Read the certificate of one clip; None where there is none, or the file does not have this layout."""
    try:
        found = _parsed(path, LARGEST)
    except InvalidFile:
        return None
    whole = schema()
    return found if isinstance(found, dict) and not fault(found, whole["$defs"]["clip"], whole) and _is_of_clean(found) else None


def not_done(path: Path) -> tuple[Trouble, ...]:
    """Return the undone clips of a folder's certificate. Raises InvalidFile for a file that does not have this layout."""
    found, whole, name = _parsed(path, LARGEST_FOLDER), schema(), "not_done"
    part = found.get(name) if isinstance(found, dict) else None
    wrong = fault(part, whole["properties"][name], whole, name)
    if wrong:
        raise InvalidFile(f"certificate {path.name}", wrong, "as `avatarsim clean` writes it")
    return tuple((one["name"], one["kind"], one["why"]) for one in part or ())


def _parsed(path: Path, largest: int) -> object:
    thing, valid = f"certificate {path.name}", "the whole file, as `avatarsim clean` writes it"
    return parsed_json(read_text(path, thing, valid, largest), thing, valid, _no_number)


def _is_of_clean(one: Mapping[str, Any]) -> bool:
    """Return True if a valid entry is of a clip that was cleaned, not only audited."""
    after = (one["overlap"]["after"], one["between_frames"]["not_certified_after"], one["jerk_p95_m_s3"]["after"])
    return None not in after and {"moved", "held_frames", "changed_frames", "flagged", "outputs"} <= set(one)


def _no_number(text: str) -> object:
    """Raise an error for a constant that JSON does not have; Python's reader accepts three."""
    raise ValueError(f"{text} is no JSON")


def output_hash(one: Mapping[str, object] | None, name: str) -> str | None:
    """Return the SHA-256 of one output of an entry; None where it has none."""
    outputs = one.get("outputs") if one else None
    about = outputs.get(name) if isinstance(outputs, dict) else None
    return str(about.get("sha256")) if isinstance(about, dict) else None


@cache
def schema() -> dict[str, Any]:
    """Return the JSON schema of `summary`."""
    found: dict[str, Any] = json.loads(resources("avatarsim.clips").joinpath("certificate.schema.json").read_text("utf-8"))
    return found
