"""What each command of `python -m scenarios` does."""

import argparse
import json
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path

import reports
from avatarsim.errors import AvatarsimError, InvalidInput, UnknownName, described, likely
from runfiles.engines import about
from runfiles.files import clear_halves, latest, plain, point_latest, run_folder
from runfiles.naming import GATED
from runfiles.table import Row
from scenarios.catalog.paper import TABLE_2
from scenarios.cli import offered as scenes_offered
from scenarios.cli.offered import filtered, unmatched
from scenarios.cli.table import table
from scenarios.engines import known, variants_of
from scenarios.job import Job, Outcome, State
from scenarios.run.gate import INCOMPLETE, MEANINGS, NOTHING, STOPPED, Ceilings, bounds_of, ceilings, meaning
from scenarios.run.harness import Run, offers
from scenarios.run.own_settings import OwnSettings, read, tried
from scenarios.run.processes import workers_of
from scenarios.run.provenance import provenance
from scenarios.run.results import is_time
from scenarios.run.resume import check_plan, earlier_run, has_ended, how_to_go_on, write_plan
from scenarios.scenario import Scenario

MOST_SEED = 2**31 - 1
"""Largest seed: what every engine takes as one, some of them as a number of 32 bits."""
PILES = ("stack_ten", "stack_struck", "balls_216")
"""Scenes of many contacts whose times stand beside those of the everyday ones in `bench`."""


@dataclass(frozen=True)
class Plan:
    """What a command will run, and outcomes that are known before anything has run (engines that cannot be opened)."""

    scenarios: dict[str, Scenario]
    jobs: list[Job]
    ready: list[Outcome]
    gated: frozenset[tuple[str, str]]
    own: tuple[OwnSettings, ...] = ()


def scenes(asked: argparse.Namespace) -> dict[str, Scenario]:
    """Scenes that the filter lets through, or the one that is named. Raises UnknownName; their bounds are known metrics.

    Without a filter a measurement of times takes the everyday scenes, with `--full` all.
    """
    name = getattr(asked, "scene", None)
    found = {name: scenes_offered.get(name)} if name else scenes_offered.scenarios(asked.command, asked.filter)
    if asked.filter is not None:
        found = filtered(found, asked.filter)
    elif asked.command == "bench" and not asked.full:
        everyday = {key: scenario for key, scenario in found.items() if scenario.everyday or key in (*TABLE_2, *PILES)}
        said = f"{len(everyday)} everyday scenes, piles and those of Table 2 of {len(found)}"
        print(f"{said}; --full (make: FULL=1) or --filter '*' takes all", file=sys.stderr)
        found = everyday
    for scenario in found.values():
        bounds_of(scenario)
    return found


def plan(asked: argparse.Namespace, names: Sequence[str], first_preset_only: bool) -> Plan:
    """Every scene with every engine, preset and seed. Raises UnknownName for an unknown engine or preset."""
    for name in names:
        if name not in known():
            raise UnknownName("engine", name, known())
    names = list(dict.fromkeys(names))
    if asked.frames is not None and asked.frames < 1:
        raise InvalidInput("--frames", asked.frames, "1 at least")
    if asked.jobs < 0:
        raise InvalidInput("--jobs", asked.jobs, "0 at least")
    if asked.resume is not None:
        earlier_run(asked.resume, asked.command)
    for seed in asked.seed:
        if not 0 <= seed <= MOST_SEED:
            raise InvalidInput("--seed", seed, f"0 to {MOST_SEED}")
    own = read(asked.settings, known(), names) if asked.settings else ()
    found = scenes(asked)
    offered = offers(names, asked.jobs) if found else {}
    missing = [name for name in names if name in offered and offered[name].trouble]
    presets: dict[str, list[tuple[str, OwnSettings | None]]] = {}
    for name, offer in offered.items():
        listed = list(offer.chosen(asked.preset))
        listed = listed[:1] if first_preset_only and not asked.preset else listed
        rows = [row for row in own if row.engine == name]
        for row in rows:
            if row.name in offer.presets:
                raise InvalidInput(f"name of a row in {asked.settings}", row.name, f"none of {name}'s own presets")
            if offer.presets and row.base not in offer.presets:
                raise UnknownName(f"preset of [{name}.{row.name}] in {asked.settings}", row.base, offer.presets)
        presets[name] = [(preset, None) for preset in listed] + [(row.name, row) for row in rows]
    if asked.settings and found:
        tried([row for row in own if row.engine in presets and row.engine not in missing], next(iter(found)), asked.settings,
              asked.jobs)
    known_variants = {variant for name in names for variant in about(name).variants}
    if asked.preset and found and not missing and not any(presets.values()) and not known_variants & set(asked.preset):
        offered_presets = {p for offer in offered.values() for p in offer.presets}
        raise UnknownName("preset", ", ".join(asked.preset), offered_presets | known_variants)
    jobs, ready = [], []
    for scene in found:
        for seed in dict.fromkeys(asked.seed):
            for name in names:
                common = {"scenario": scene, "engine": name, "seed": scenes_offered.seed_of(scene, seed), "full": asked.full,
                          "frames": asked.frames, "catalogue": scenes_offered.catalogue_of(scene)}
                if name in missing:
                    state: State = "crashed" if offered[name].crashed else "not-measured"
                    # one row at least, whatever was asked for: its presets are not known
                    absent = [Job(**common, preset=preset) for preset, _ in presets[name] or [("default", None)]]
                    jobs += absent
                    ready += [Outcome(job, state, offered[name].trouble) for job in absent]
                    continue
                more = variants_of(name, found[scene], asked.preset) if asked.command == "compare" or asked.preset else ()
                for preset, chosen in (*presets.get(name, []), *((variant, None) for variant in more)):
                    base, options = ("", {}) if chosen is None else (chosen.base, chosen.options)
                    jobs.append(Job(**common, preset=preset, base=base, options=options))
    firsts = {name: offer.presets[0] if offer.presets else "default" for name, offer in offered.items()}
    return Plan(found, jobs, ready, frozenset(firsts.items()), own)


def check(asked: argparse.Namespace, words: Sequence[str]) -> int:
    """The gate: accuracy pass of the gated engine only, its first preset unless `--preset` names others."""
    made = plan(asked, asked.engine or [GATED[0]], True)
    gated = frozenset((job.engine, job.preset) for job in made.jobs)
    return carried_out(asked, words, Plan(made.scenarios, made.jobs, made.ready, gated), timed=False, report=True)


def run(asked: argparse.Namespace, words: Sequence[str]) -> int:
    """One scene (or a filter's worth) in one engine, ours unless told otherwise, with a table and no report."""
    made = plan(asked, asked.engine or [GATED[0]], True)
    return carried_out(asked, words, Plan(made.scenarios, made.jobs, made.ready, frozenset({GATED})), timed=True, report=False)


def carried_out(
    asked: argparse.Namespace, words: Sequence[str], made: Plan, timed: bool, report: bool,
    also: Callable[[Run], Sequence[str]] | None = None,
) -> int:
    """Run a plan, and `also` what is asked about the run once it is measured, which returns its troubles; results and report are
    written before anything is returned, for what there is when the run is stopped."""
    if not made.scenarios:
        return nothing(asked)
    ran = begun(asked, words, made, ceilings())
    code = passes(asked, made, ran, timed)
    if also and code != STOPPED:
        code = studied(ran, also, code)
    if report:
        try:
            trouble = reported(ran.folder, earlier_of(ran, asked))
        except KeyboardInterrupt:
            # Ctrl-C while the report is being written ends the writing too
            code, trouble = STOPPED, "the report was not written: stopped"
        if trouble:
            ran.note, code = trouble, code or INCOMPLETE
            ran.write(None if code == STOPPED else code)
            print(trouble, file=sys.stderr)
    before = earlier_of(ran, asked)
    lead_to(ran, asked, code)
    show(asked, ran.rows(), made.gated, ran.folder if report and not asked.verbose else None, before)
    for said in ran.remarks():
        print(said, file=sys.stderr)
    return finished(asked, words, made, ran, code)


def studied(ran: Run, also: Callable[[Run], Sequence[str]], code: int) -> int:
    """The exit code after `also`; what it could not do stands in the run's notes and leaves the comparison incomplete."""
    try:
        troubles = also(ran)
    except KeyboardInterrupt:
        ran.write(None)
        return STOPPED
    for said in troubles:
        print(said, file=sys.stderr)
    if troubles:
        ran.note, code = "; ".join(troubles), code or INCOMPLETE
        ran.write(code)
    return code


def nothing(asked: argparse.Namespace) -> int:
    """The filter, or one of its patterns, lets no scene through: say which are like it."""
    known = scenes_offered.scenarios(asked.command, asked.filter)
    for pattern in unmatched(known, asked.filter) or [asked.filter]:
        print(f"no scene matches {pattern!r}; there are {likely(pattern, known)}", file=sys.stderr)
    print("`python -m scenarios list` names them all", file=sys.stderr)
    say_last(asked, NOTHING, None)
    return NOTHING


def begun(asked: argparse.Namespace, words: Sequence[str], made: Plan, limits: Ceilings) -> Run:
    """The run's folder, with its plan and a results.json that says that it has begun: from here on it can be resumed. The results
    of an earlier run that had ended stay until this one ends. Raises InvalidInput where that one has what is not asked for."""
    stays = False
    if asked.resume is None:
        folder = run_folder(asked.out, asked.command).resolve()
    else:
        folder = earlier_run(asked.resume, asked.command)
        check_plan(folder, made.jobs)
        clear_halves(folder)
        stays = has_ended(folder)
    write_plan(folder, words, made.jobs)
    origin = provenance(list(words)) | scenes_offered.origin(made.jobs)
    ran = Run(folder, made.scenarios, made.jobs, made.gated, limits, origin, stays)
    ran.write(None)
    return ran


def lead_to(ran: Run, asked: argparse.Namespace, code: int) -> None:
    """Let the link of the command lead to a run that has come to its end. The folder of one that was resumed may lie anywhere,
    and a file of the link's name beside it may be of something else."""
    if code != STOPPED and ran.folder.parent == asked.out.resolve():
        point_latest(ran.folder, asked.command)


def passes(asked: argparse.Namespace, made: Plan, ran: Run, timed: bool, at_length: bool = False) -> int:
    """Measure and time, many scenes at a glance unless `at_length`; the exit code so far, or STOPPED.
    What is known is written either way."""
    try:
        ran.measure(made.ready, workers_of(asked, ran.folder))
        if timed:
            ran.clock(asked.full, at_length)
        code = ran.code()
    except KeyboardInterrupt:
        code = STOPPED
    # no code in the file: a run that was stopped has not ended
    ran.write(None if code == STOPPED else code)
    return code


def finished(asked: argparse.Namespace, words: Sequence[str], made: Plan, ran: Run, code: int) -> int:
    """The last words of a run, and its code."""
    if code == STOPPED:
        with suppress(OSError):
            # a terminal that was closed takes no words, and the run is safe in its files
            print(how_to_go_on(ran.folder, words), file=sys.stderr)
    say_last(asked, code, ran.folder, meaning(code, ran.rows(), made.gated))
    return code


def earlier_of(ran: Run, asked: argparse.Namespace) -> Path | None:
    """The last run of the same command, to compare with; None without one."""
    before = latest(asked.out, asked.command)
    found = before.resolve() if before.exists() else None
    return found if found is not None and found != ran.folder.resolve() else None


def reported(folder: Path, before: Path | None = None) -> str:
    """Write the report of a run, beside an earlier one; empty, or one sentence about why there is none, or what it is without.
    The figures are safe in their files before."""
    try:
        damage = reports.write_report(folder, before, reports.BASELINE)
    except (ImportError, AvatarsimError) as error:
        return f"the report was not written: {error}"
    except Exception as error:
        # a fault in a chart must not cost the verdict
        return f"the report was not written: {described(error)}"
    return f"left out of the report, since it cannot be used: {'; '.join(damage)}" if damage else ""


def show(
    asked: argparse.Namespace, rows: Sequence[Row], gated: frozenset[tuple[str, str]], folder: Path | None = None,
    before: Path | None = None,
) -> None:
    """All rows as JSON; else the summary of the report in ``folder``, or a line per scene and engine without one."""
    if asked.json:
        print(json.dumps(plain([asdict(row) for row in rows]), allow_nan=False))
        return
    try:
        print(table(rows, gated) if folder is None else reports.said(folder, before, reports.BASELINE))
    except (ImportError, AvatarsimError) as error:
        print(table(rows, gated))
        print(f"the summary was not made: {error}", file=sys.stderr)


def say_last(asked: argparse.Namespace, code: int, folder: Path | None, means: str = "") -> None:
    """How every command ends. Make turns each code above 0 into its own 2; here the real one can be read.

    With `--json` it goes to the error stream: what reads the rows reads nothing else."""
    page = "none" if folder is None else str(folder / "index.html" if (folder / "index.html").exists() else folder)
    line = f"avatarsim: exit code {code} ({means or MEANINGS[code]}), report: {page}"
    print(line, file=sys.stderr if asked.json else sys.stdout)


def bench(asked: argparse.Namespace, words: Sequence[str]) -> int:
    """Frame times: both passes (only what ran through is timed), printed as microseconds per rendered frame."""
    found = plan(asked, asked.engine or list(known()), False)
    made = Plan(found.scenarios, found.jobs, found.ready, frozenset())
    if not made.scenarios:
        return nothing(asked)
    ran = begun(asked, words, made, {})
    code = passes(asked, made, ran, timed=True, at_length=True)
    lead_to(ran, asked, code)
    rows = [row for row in ran.rows() if is_time(row.metric) or row.status in ("crashed", "not-measured")]
    if asked.json:
        show(asked, rows, frozenset())
    else:
        for row in rows:
            value = row.note if row.value is None else f"{row.value:12.4g} {row.unit:3} {row.note}".rstrip()
            print(f"{row.scenario:24} {row.run:20} {row.metric:28} {value}")
    return finished(asked, words, made, ran, code)
