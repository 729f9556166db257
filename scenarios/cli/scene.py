"""`avatarsim compare`: a user's own scene in every installed engine, as a table, and limits that some engines are put to.

The package starts it as `python -m scenarios scene`, in a process of its own.
"""

import argparse
import json
import os
from collections.abc import Collection, Iterable, Sequence
from contextlib import nullcontext
from dataclasses import asdict, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import pandas as pd

from avatarsim.cli.reading import reading_options
from avatarsim.console import path_option
from avatarsim.drift import Moved, drift_table, drifted, read_figures, update
from avatarsim.errors import AvatarsimError, InvalidInput, MissingPackage, UnknownName
from reports.summaries.junit import junit
from reports.tables.checks import Checks
from reports.tables.figures import quantity
from runfiles.comparable import RESTING_METRIC
from runfiles.engines import about
from runfiles.files import plain, write_text
from runfiles.metrics import metric
from runfiles.table import RESULTS, Row, csv_text
from scenarios.cli import listing
from scenarios.cli.comparison import take_own_scenes
from scenarios.cli.plan import Plan, plan
from scenarios.cli.table import COLUMNS
from scenarios.engines import engines_to_run, known
from scenarios.job import Job
from scenarios.run.gate import FAILED, INCOMPLETE, PASSED, USAGE, exit_code
from scenarios.run.harness import Run
from scenarios.run.limits import FINITE, checks_of, gates_of, limits_of, with_limits
from scenarios.run.provenance import provenance
from scenarios.run.results import is_time

FORMAT = 1
"""Layout of the JSON of `--json`."""


def add_options(one: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    one.add_argument("scene", nargs="*", metavar="SCENE", help="MJCF, URDF, a mesh as a room, a .live recording")
    scene = one.add_argument_group("scene")
    scene.add_argument("--motion", metavar="FILE", help="motion of the avatar; without one it holds its first posture")
    scene.add_argument("--avatar", type=path_option, metavar="FILE", help="avatar, MJCF or URDF, if the scene holds none")
    scene.add_argument("--room", type=path_option, metavar="FILE", help="room about it: a model, a mesh, or floor")
    scene.add_argument("--scene-scale", type=float, metavar="M", help="metres a unit of length of SCENE (default 1)")
    scene.add_argument("--seconds", type=float, default=5.0, help="how long (default 5; with a motion, of it at most)")
    scene.add_argument("--full", action="store_true", help="all frames, and every sub-step judged; else 10 s at most")
    engines = one.add_argument_group("engines")
    which = "engines, or ENGINE/PRESET (default: all that are installed)"
    engines.add_argument("--engine", nargs="+", action="extend", default=[], metavar="NAME", help=which)
    engines.add_argument("--time", action="store_true", help="also time the frames")
    engines.add_argument("--jobs", type=int, default=os.cpu_count() or 1, metavar="N", help="runs side by side")
    rows = "further rows: tables [engine.name] of settings"
    engines.add_argument("--settings", type=path_option, metavar="FILE.toml", help=rows)
    limits = one.add_argument_group("limits")
    gate = "ENGINE or ENGINE/PRESET that the limits are for (default: those of --engine, else avatarsim)"
    limits.add_argument("--gate", nargs="+", action="extend", default=[], metavar="NAME", help=gate)
    limits.add_argument("--max-overlap", metavar="LENGTH", help="largest overlap of any state shown: 1mm, 50um, with its unit")
    most = "largest value of a metric, in its unit or with one: joint_gap_max=1mm"
    limits.add_argument("--max", nargs="+", action="extend", default=[], metavar="METRIC=VALUE", help=most)
    limits.add_argument("--drift", type=path_option, metavar="FILE", help="file of figures that may not move")
    limits.add_argument("--update-drift", action="store_true", help="keep the figures of this run in that file")
    output = one.add_argument_group("output")
    output.add_argument("--junit", type=path_option, metavar="FILE", help="the checks as JUnit XML")
    output.add_argument("--csv", type=path_option, metavar="FILE", help="all figures, a line each")
    output.add_argument("--json", action="store_true", help="all figures as JSON on standard output, instead of the table")
    output.add_argument("--out", type=path_option, metavar="DIR", help="keep recordings and results in this folder")
    output.add_argument("--metrics", action="store_true", help="list all metrics with their units, and end")
    reading_options(one)
    # for tests: a scene cut short proves nothing about the scene
    one.add_argument("--frames", type=int, default=None, help=argparse.SUPPRESS)
    one.set_defaults(filter=None, seed=[0], resume=None, scheduler=None)


def scene(options: argparse.Namespace, words: Sequence[str]) -> int:
    """Carry out the command; with `--json` an error is an object on standard output. Return the exit code."""
    if options.metrics:
        return listing.metrics(options, words)
    try:
        return _compared(options, words)
    except AvatarsimError as error:
        if not options.json:
            raise
        parts = {name: str(getattr(error, name, "")) for name in ("thing", "value", "valid")}
        print(json.dumps({"error": {"type": type(error).__name__, "text": str(error), **parts}}))
        return INCOMPLETE if isinstance(error, MissingPackage) else USAGE


def _compared(options: argparse.Namespace, words: Sequence[str]) -> int:
    """Compare, print, write the requested files; return the exit code."""
    if not options.scene:
        raise InvalidInput("SCENE", "missing", "one file or more, such as cell.xml")
    if options.update_drift and options.drift is None:
        raise InvalidInput("--update-drift", "alone", "with --drift FILE")
    limits = limits_of(options.max_overlap, options.max)
    gates = gates_of(options.gate, options.engine, limits)
    for name in (word.partition("/")[0] for word in (*options.engine, *gates)):
        if name not in known():
            raise UnknownName("engine", name, known())
    reference = read_figures(options.drift) if options.drift and not options.update_drift else {}
    take_own_scenes(options)
    made = chosen(options, gates)
    gated = [run for run in dict.fromkeys(job.run for job in made.jobs) if _names(gates, run)]
    own = {name: with_limits(one, limits) for name, one in made.scenarios.items()}
    with TemporaryDirectory(prefix="avatarsim-") if options.out is None else nullcontext(options.out) as folder:
        pairs = frozenset((job.engine, job.preset) for job in made.jobs if job.run in gated)
        ran = Run(Path(folder).resolve(), own, made.jobs, pairs, {}, provenance(words))
        ran.measure(made.ready, options.jobs)
        if options.time or any(is_time(name) or name == RESTING_METRIC for name in limits):
            ran.clock(options.full)
        rows = ran.rows()
        checks = checks_of(rows, own, gated, limits)
        code = exit_code(checks)
        if options.out is not None:
            ran.write(code)
    figures = document(ran, rows, checks)
    moved = drifted(reference, figures)
    if options.update_drift:
        update(options.drift, figures)
    code = FAILED if moved else code
    _write(options, rows, checks)
    if options.json:
        print(json.dumps(plain({**figures, "exit_code": code}), allow_nan=False))
    else:
        print(table(ran, rows, limits))
        print("\n".join(verdicts(checks, code, moved)))
    return code


def _names(words: Iterable[str], run: str) -> bool:
    """Return whether one of the words names a run, by its engine or as ENGINE/PRESET."""
    return any(word in (run, run.partition("/")[0]) for word in words)


def chosen(options: argparse.Namespace, gates: Sequence[str]) -> Plan:
    """Plan the engines and presets that are named, without any those of short tables, and the gated ones.

    Raises UnknownName for an engine, or for a preset that does not run in the scene.
    """
    requested = [*options.engine, *gates] if options.engine else gates
    engines = dict.fromkeys(word.partition("/")[0] for word in (requested if options.engine else [*engines_to_run([]), *gates]))
    # as compare, so that variants are planned too
    made = plan(argparse.Namespace(**{**vars(options), "command": "compare", "preset": []}), list(engines), False)
    runs = {job.run for job in made.jobs}
    for word in requested:
        engine = word.partition("/")[0]
        if "/" in word and word not in runs:
            presets = [run.partition("/")[2] for run in runs if run.startswith(f"{engine}/")]
            raise UnknownName(f"preset of {engine}", word.partition("/")[2], presets)
    rows = {f"{one.engine}/{one.name}" for one in made.own}

    def is_wanted(job: Job) -> bool:
        one = about(job.engine)
        usual = job.preset in one.presets if one.path else job.preset not in one.variants
        return job.run in requested or job.run in rows or (usual and (not options.engine or job.engine in requested))

    return replace(made, jobs=list(filter(is_wanted, made.jobs)), ready=[one for one in made.ready if is_wanted(one.job)])


def document(ran: Run, rows: Sequence[Row], checks: Sequence[Row]) -> dict[str, object]:
    """Return all of a comparison as JSON: rows, runs with their versions, and the metrics that occur."""
    entries = {name: metric(name) for name in dict.fromkeys(row.metric for row in rows)}
    versions = [
        {"scenario": one.job.scenario, "run": one.job.run, "version": str(one.about.get("version", "")), "state": one.state,
         "note": one.note, "frames": one.frames} for one in ran.outcomes.values()
    ]
    return {
        "format": FORMAT, "runs": versions, "rows": [asdict(row) for row in rows], "checks": [asdict(row) for row in checks],
        "metrics": {
            name: {"unit": one.unit, "label": one.label, "level": one.level, "share": one.share} for name, one in entries.items()
        },
    }


def table(ran: Run, rows: Sequence[Row], limits: Collection[str]) -> str:
    """Return a line per engine and preset with its version and the figures that the scene has, and a line per missing engine."""
    more = {name: f"{name} {metric(name).unit}".strip() for name in limits if name not in COLUMNS}
    shown, figures = {**COLUMNS, **more}, dict[tuple[str, str, str], str]()
    for row in rows:
        if row.metric in shown and row.value is not None:
            value = row.value * (1e3 if shown[row.metric].endswith(" mm") else 1.0)
            figures[row.scenario, row.run, row.metric] = f"{value:.3g}"
    lines, missing = [], dict[str, str]()
    for outcome in sorted(ran.outcomes.values(), key=lambda one: ran.jobs.index(one.job)):
        job = outcome.job
        if outcome.state == "not-measured" and not outcome.about:
            missing[job.engine] = outcome.note if job.engine in outcome.note else f"{job.engine}: {outcome.note}"
            continue
        line = {"scene": job.scenario, "engine": job.run, "version": str(outcome.about.get("version", ""))}
        line |= {heading: figures.get((job.scenario, job.run, name), "") for name, heading in shown.items()}
        lines.append(line | {"": "" if outcome.state == "measured" else f"{outcome.state}: {outcome.note}"})
    data = pd.DataFrame(lines)
    if len(ran.scenarios) == 1 and lines:
        data = data.drop(columns="scene")
    data = data.loc[:, (data != "").any()] if lines else data
    parts = [f"{one.title} {frames_of(ran, name)} frames of {one.dt:.3g} s." for name, one in ran.scenarios.items()]
    parts += ["", data.to_string(index=False) if lines else "nothing was run"]
    return "\n".join([*parts, *missing.values(), ""])


def frames_of(ran: Run, name: str) -> str:
    """Return the frames of a scene that were run, and of how many, where they are fewer."""
    most = max((one.frames for one in ran.outcomes.values() if one.job.scenario == name), default=0)
    whole = ran.scenarios[name].frames
    return f"{most}" if most in (0, whole) else f"{most} of {whole}"


def verdicts(checks: Sequence[Row], code: int, moved: Sequence[Moved]) -> list[str]:
    """Return a line per check, a table of figures that have drifted, and the verdict."""
    lines, several = [], len({row.scenario for row in checks}) > 1
    for row in checks:
        if row.metric == FINITE and row.status == "pass":
            continue
        limit = "" if row.bound is None else f", limit {quantity(row.bound, row.unit)}"
        value = f"{metric(row.metric).label} {quantity(row.value, row.unit)}{limit}" if row.metric != "run" else ""
        why = row.note if row.status != "pass" and row.value is None else ""
        run = f"{row.scenario}  {row.run}" if several else row.run
        lines.append(f"{row.status:<4}  {run}  {'; '.join(filter(None, [value, why]))}  [{row.metric}]")
    word = {PASSED: "PASS", FAILED: "FAIL", INCOMPLETE: "INCOMPLETE"}[code]
    held = sum(row.status == "pass" for row in checks)
    drift = f"; moved since they were kept: {len(moved)} figures (--update-drift keeps the new ones)" if moved else ""
    count = f"{held} of {len(checks)} checks hold" if checks else "nothing is gated"
    return [*lines, *(["", drift_table(moved), ""] if moved else []), f"{word}: {count}{drift}"]


def _write(options: argparse.Namespace, rows: Sequence[Row], checks: Sequence[Row]) -> None:
    """Write the requested files."""
    if options.csv is not None:
        write_text(options.csv, csv_text(rows, (*RESULTS, "note")))
    if options.junit is not None:
        listed = pd.DataFrame([{**vars(row), "run": row.run, "waiver": row.ceiling} for row in checks])
        passed, failed = (listed[listed.status == status] for status in ("pass", "fail"))
        # a check that was requested and not made is an error, not left out
        broken, none = listed[~listed.status.isin(("pass", "fail"))], listed[:0]
        write_text(options.junit, junit(Checks(passed, none, failed, broken, none, none, True)))
