"""Read one run folder: results.json becomes typed rows, series and engine notes. Nothing is computed here."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from os.path import isfile, lexists
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from avatarsim.errors import InvalidFile
from avatarsim.files import read_json
from runfiles.published import MOST_BYTES, check
from runfiles.table import STATUSES, Row

Array = NDArray[np.float64]

# The layout of results.json that this reader knows. Raising it without teaching `load` the new layout refuses every file.
SCHEMA_VERSION = 1


@dataclass(frozen=True, eq=False)
class Series:
    """Numbers per shown frame, NaN where missing: `overlap` [m], shape (frames,); `frame_time` [us], shape (timed,)."""

    overlap: Array
    frame_time: Array


@dataclass(frozen=True)
class EngineNote:
    """What one engine said about itself in one scene: the words it lacks, and its settings (value, reason or "")."""

    run: str
    scenario: str
    version: str
    cannot_say: Mapping[str, str]
    settings: Mapping[str, tuple[str, str]]


@dataclass(frozen=True, eq=False)
class Results:
    """Everything a report is made of. `titles`: scene -> one sentence about it, where the file has one; `everyday`: the scenes
    that stand for the others in short tables; `families`: scene -> the scene that it is a variant of; `frame_times`: scene ->
    length of a frame [s]; `scales`: scene -> size of its world, where it is another made larger or smaller; `lengths`: scene ->
    frames of its full length, where the file has them; `notes`: the run's own remarks; `exit_code` is None while a run has not
    ended."""

    rows: tuple[Row, ...]
    series: Mapping[str, Mapping[str, Series]]
    engines: tuple[EngineNote, ...]
    provenance: Mapping[str, object]
    exit_code: int | None
    titles: Mapping[str, str]
    notes: tuple[str, ...]
    everyday: frozenset[str] = frozenset()
    families: Mapping[str, str] = field(default_factory=dict)
    frame_times: Mapping[str, float] = field(default_factory=dict)
    scales: Mapping[str, float] = field(default_factory=dict)
    lengths: Mapping[str, int] = field(default_factory=dict)

    def family(self, scene: str) -> str:
        """The scene that `scene` is a variant of: itself where the file does not say."""
        return self.families.get(scene) or scene

    def scenes(self) -> tuple[str, ...]:
        """Scene names in the order in which they first appear."""
        return tuple(self._by_scene)

    def of(self, scene: str) -> Sequence[Row]:
        """The rows of one scene."""
        return self._by_scene.get(scene, ())

    @cached_property
    def _by_scene(self) -> dict[str, list[Row]]:
        found: dict[str, list[Row]] = {}
        for row in self.rows:
            found.setdefault(row.scenario, []).append(row)
        return found


def load(run_dir: Path) -> Results:
    """Read `run_dir`/results.json. Raises InvalidFile when it is missing, truncated, empty, not strict, or of another schema."""
    path = run_dir / "results.json"
    # by os.path, which takes names that are too long for the system as names of nothing
    if isfile(run_dir):
        raise InvalidFile(str(run_dir), "a file", "the folder of a run, the one that holds results.json")
    valid = "complete, strict JSON in UTF-8, as a run leaves it; a killed run leaves half a file"
    if not lexists(run_dir):
        raise InvalidFile(str(run_dir), "not there", "the folder of a run; `make compare` leaves one")
    data: Any = read_json(path, str(path), valid, MOST_BYTES, _no_number)
    if not isinstance(data, dict) or not isinstance(data.get("rows"), list):
        raise InvalidFile(str(path), type(data).__name__, "an object with a list called rows")
    if data.get("schema_version") != SCHEMA_VERSION:
        raise InvalidFile(f"schema_version of {path}", data.get("schema_version"), f"{SCHEMA_VERSION}; run again")
    if not data["rows"]:
        raise InvalidFile(f"rows of {path}", "none", "at least one: a run that ended before its first scene has no report")
    check(data, path)
    try:
        return Results(
            rows=tuple(_row(raw) for raw in data["rows"]),
            series={
                scene: {run: _series(raw) for run, raw in runs.items()} for scene, runs in (data.get("series") or {}).items()
            },
            engines=tuple(_engine_note(raw) for raw in data.get("engines") or ()),
            provenance=dict(data.get("provenance") or {}),
            exit_code=data.get("exit_code"),
            notes=tuple(_text(note) for note in data.get("notes") or ()),
            titles={name: _title(raw) for name, raw in (data.get("scenes") or {}).items()},
            everyday=frozenset(
                name for name, raw in (data.get("scenes") or {}).items() if isinstance(raw, Mapping) and raw.get("everyday")
            ),
            families={
                name: _text(raw["family"])
                for name, raw in (data.get("scenes") or {}).items()
                if isinstance(raw, Mapping) and raw.get("family")
            },
            frame_times={
                name: float(raw["dt"])
                for name, raw in (data.get("scenes") or {}).items()
                if isinstance(raw, Mapping) and raw.get("dt")
            },
            scales={
                name: float(raw["scale"])
                for name, raw in (data.get("scenes") or {}).items()
                if isinstance(raw, Mapping) and raw.get("scale")
            },
            lengths={
                name: int(raw["frames"])
                for name, raw in (data.get("scenes") or {}).items()
                if isinstance(raw, Mapping) and raw.get("frames")
            },
        )
    except (KeyError, TypeError, ValueError, AttributeError, OverflowError) as error:
        raise InvalidFile(str(path), f"{type(error).__name__}: {error}", "the layout of schema 1") from error


def _no_number(word: str) -> float:
    """Strict JSON has no NaN and no Infinity; our own writer writes them as texts, so this file is from elsewhere or damaged."""
    raise ValueError(f"{word} outside of quotes")


def _number(raw: object) -> float | None:
    """A JSON number, or one of the words NaN and Infinity that JSON has no number for; None stays None."""
    if raw is None:
        return None
    if isinstance(raw, bool) or not isinstance(raw, int | float | str):
        raise TypeError(f"{raw!r} is no number")
    return float(raw)


def _text(raw: object) -> str:
    """Text without what XML forbids and terminals act upon: messages of crashed engines hold anything."""
    text = str(raw)
    # nearly all of them, and asked at once
    if text.isprintable():
        return text
    return "".join(sign for sign in text if sign in "\n\t" or (sign.isprintable() and not "\ud800" <= sign <= "\udfff"))


def _row(raw: Mapping[str, object]) -> Row:
    status = next((one for one in STATUSES if one == raw["status"]), None)
    if status is None:
        raise ValueError(f"status {raw['status']!r} is none of {', '.join(STATUSES)}")
    return Row(
        scenario=_text(raw["scenario"]),
        engine=_text(raw["engine"]),
        preset=_text(raw.get("preset") or "default"),
        seed=int(_number(raw.get("seed")) or 0),
        frames=int(_number(raw.get("frames")) or 0),
        metric=_text(raw.get("metric") or ""),
        value=_number(raw.get("value")),
        unit=_text(raw.get("unit") or ""),
        bound=_number(raw.get("bound")),
        ceiling=_number(raw.get("ceiling")),
        status=status,
        note=_text(raw.get("note") or ""),
    )


def _series(raw: Mapping[str, list[object] | None]) -> Series:
    def numbers(key: str) -> Array:
        # the schema has been checked: numbers, words for numbers, and nothing, which becomes nan
        return np.array(raw.get(key) or [], dtype=np.float64)

    return Series(overlap=numbers("overlap_m"), frame_time=numbers("frame_time_us"))


def _engine_note(raw: Mapping[str, object]) -> EngineNote:
    cannot, settings = raw.get("cannot_say") or {}, raw.get("settings") or {}
    if not isinstance(cannot, Mapping) or not isinstance(settings, Mapping):
        raise TypeError("cannot_say and settings are objects")
    return EngineNote(
        run=f"{raw['name']}/{raw.get('preset') or 'default'}",
        scenario=str(raw.get("scenario") or ""),
        version=str(raw.get("version") or ""),
        cannot_say={_text(key): _text(text) for key, text in cannot.items()},
        settings={_text(key): _setting(value) for key, value in settings.items()},
    )


def _setting(raw: object) -> tuple[str, str]:
    """A setting is its value, or a pair [value, reason] whose second part is a text with a blank in it."""
    if isinstance(raw, list) and len(raw) == 2 and isinstance(raw[1], str) and " " in raw[1]:
        return _plain(raw[0]), _text(raw[1])
    return _plain(raw), ""


def _plain(raw: object) -> str:
    return _text(raw if isinstance(raw, str) else json.dumps(raw, ensure_ascii=False))


def _title(raw: object) -> str:
    return _text(raw.get("title") or "") if isinstance(raw, Mapping) else _text(raw)
