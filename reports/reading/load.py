"""Read one run folder: results.json becomes typed rows, series and engine notes. Nothing is computed here."""

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from os.path import isfile, lexists
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from avatarsim.errors import InvalidFile
from avatarsim.files import read_json
from runfiles.published import MAX_BYTES, SCHEMA_VERSION, check
from runfiles.table import Row

Array = NDArray[np.float64]
Value = TypeVar("Value")


@dataclass(frozen=True, eq=False)
class Series:
    """Numbers per shown frame, NaN where missing: `overlap` [m], shape (frames,); `frame_time` [us], shape (timed,)."""

    overlap: Array
    frame_time: Array


@dataclass(frozen=True)
class EngineNote:
    """Report of one engine on itself in one scene: features that it lacks, and its settings (value, reason or "")."""

    run: str
    scenario: str
    version: str
    unsupported: Mapping[str, str]
    settings: Mapping[str, tuple[str, str]]


@dataclass(frozen=True, eq=False)
class Results:
    """Contents of results.json.

    exit_code    None while a run has not ended
    titles       one sentence on each scene
    notes        remarks of the run
    everyday     scenes that represent the others in short tables
    frame_times  length of a frame [s] by scene
    scales       size of the world by scene, where it is another one made larger or smaller
    lengths      frames of the full length by scene
    """

    rows: tuple[Row, ...]
    series: Mapping[str, Mapping[str, Series]]
    engines: tuple[EngineNote, ...]
    provenance: Mapping[str, object]
    exit_code: int | None
    titles: Mapping[str, str]
    notes: tuple[str, ...]
    everyday: frozenset[str] = frozenset()
    frame_times: Mapping[str, float] = field(default_factory=dict)
    scales: Mapping[str, float] = field(default_factory=dict)
    lengths: Mapping[str, int] = field(default_factory=dict)


def load(run_dir: Path) -> Results:
    """Read `run_dir`/results.json. Raises InvalidFile when it is missing, truncated, empty, not strict, or of another schema."""
    path = run_dir / "results.json"
    # by os.path, which takes names that are too long for the system as names of nothing
    if isfile(run_dir):
        raise InvalidFile(str(run_dir), "a file", "the folder of a run, the one that holds results.json")
    if not lexists(run_dir):
        raise InvalidFile(str(run_dir), "not there", "the folder of a run; `make compare` leaves one")
    valid = "complete, strict JSON in UTF-8, as a run leaves it; a killed run leaves half a file"
    data: Any = read_json(path, str(path), valid, MAX_BYTES, _no_number)
    if isinstance(data, dict) and data.get("schema_version") != SCHEMA_VERSION:
        raise InvalidFile(f"schema_version of {path}", data.get("schema_version"), f"{SCHEMA_VERSION}; run again")
    check(data, path)
    try:
        return _results(data)
    except (KeyError, TypeError, ValueError, AttributeError, OverflowError) as error:
        raise InvalidFile(str(path), f"{type(error).__name__}: {error}", "the layout of schema 1") from error


def _results(data: Mapping[str, Any]) -> Results:
    """Convert the object that the schema allows."""
    scenes = {name: raw if isinstance(raw, dict) else {"title": raw} for name, raw in data.get("scenes", {}).items()}

    def each(key: str, kind: Callable[[Any], Value]) -> dict[str, Value]:
        return {name: kind(raw[key]) for name, raw in scenes.items() if raw.get(key)}

    return Results(
        rows=tuple(_row(raw) for raw in data["rows"]),
        series={scene: {run: _series(raw) for run, raw in runs.items()} for scene, runs in data["series"].items()},
        engines=tuple(_engine_note(raw) for raw in data["engines"]),
        provenance=data["provenance"],
        exit_code=data["exit_code"],
        titles=each("title", _text),
        notes=tuple(_text(note) for note in data.get("notes", ())),
        everyday=frozenset(each("everyday", bool)),
        frame_times=each("dt", float),
        scales=each("scale", float),
        lengths=each("frames", int),
    )


def _no_number(word: str) -> float:
    """Strict JSON has no NaN and no Infinity; our own writer writes them as texts, so this file is from elsewhere or damaged."""
    raise ValueError(f"{word} outside of quotes")


def _text(raw: object) -> str:
    """Return a text without what XML forbids and terminals act upon: messages of crashed engines hold anything."""
    text = str(raw)
    # nearly all texts, and tested at once
    if text.isprintable():
        return text
    return "".join(sign for sign in text if sign in "\n\t" or (sign.isprintable() and not "\ud800" <= sign <= "\udfff"))


def _row(raw: Mapping[str, Any]) -> Row:
    texts = ("scenario", "engine", "preset", "metric", "unit", "note")
    cells: dict[str, Any] = {name: _text(raw.get(name, "")) for name in texts}
    # numbers, words for numbers, or null
    cells |= {name: None if raw.get(name) is None else float(raw[name]) for name in ("value", "bound", "ceiling")}
    return Row(**cells, seed=int(raw.get("seed", 0)), frames=int(raw.get("frames", 0)), status=raw["status"])


def _series(raw: Mapping[str, Any]) -> Series:
    # numbers, words for numbers, and nothing, which becomes nan
    return Series(*(np.array(raw.get(key) or [], dtype=np.float64) for key in ("overlap_m", "frame_time_us")))


def _engine_note(raw: Mapping[str, Any]) -> EngineNote:
    unsupported = raw.get("unsupported", raw.get("cannot_say", {}))  # earlier runs wrote `cannot_say`
    return EngineNote(
        run=f"{raw['name']}/{raw.get('preset') or 'default'}",
        scenario=raw.get("scenario", ""),
        version=raw.get("version", ""),
        unsupported={_text(key): _text(text) for key, text in unsupported.items()},
        settings={_text(key): _setting(value) for key, value in raw.get("settings", {}).items()},
    )


def _setting(raw: object) -> tuple[str, str]:
    """Return a value and its reason: a setting is its value, or a pair whose second part is a text with a blank in it."""
    if isinstance(raw, list) and len(raw) == 2 and isinstance(raw[1], str) and " " in raw[1]:
        return _plain(raw[0]), _text(raw[1])
    return _plain(raw), ""


def _plain(raw: object) -> str:
    return _text(raw if isinstance(raw, str) else json.dumps(raw, ensure_ascii=False))
