"""The commands `run`, `check` and `bench`, and the parts that all commands share."""

import argparse
import json
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import asdict, replace
from pathlib import Path

import reports
from avatarsim.errors import AvatarsimError, described, likely
from runfiles.files import clear_halves, latest, plain, point_latest, run_folder
from runfiles.naming import GATED
from runfiles.table import Row
from scenarios.cli.plan import Plan, origin, plan, scenarios, unmatched
from scenarios.cli.table import table
from scenarios.engines import engines_to_run
from scenarios.run.gate import INCOMPLETE, MEANINGS, NOTHING, STOPPED, ceilings, meaning
from scenarios.run.harness import Run
from scenarios.run.processes import workers_of
from scenarios.run.provenance import check_plan, earlier_run, has_ended, provenance, resume_command, write_plan
from scenarios.run.results import is_time


def check(options: argparse.Namespace, words: Sequence[str]) -> int:
    """Put the gated engine to its bounds, in its first preset unless `--preset` names others; accuracy only."""
    made = plan(options, options.engine or [GATED[0]], True)
    gated = frozenset((job.engine, job.preset) for job in made.jobs)
    return carry_out(options, words, replace(made, gated=gated), timed=False, report=True)


def run(options: argparse.Namespace, words: Sequence[str]) -> int:
    """Run one scene, or those of a filter, in all presets of one engine, avatarsim by default; print a table."""
    made = plan(options, options.engine or [GATED[0]], False)
    return carry_out(options, words, replace(made, gated=frozenset({GATED})), timed=True, report=False)


def bench(options: argparse.Namespace, words: Sequence[str]) -> int:
    """Time all jobs that run through, at length; print their times."""
    made = plan(options, engines_to_run(options.engine), False)
    return carry_out(options, words, replace(made, gated=frozenset()), timed=True, report=False)


def carry_out(
    options: argparse.Namespace, words: Sequence[str], made: Plan, timed: bool, report: bool,
    also: Callable[[Run], Sequence[str]] | None = None,
) -> int:
    """Run a plan; write its results and, with `report`, its report; print them. Return the exit code.

    Args:
        also: studies of the measured run; returns their troubles.
    """
    if not made.scenarios:
        return nothing_matched(options)
    ran = begin(options, words, made)
    code = passes(options, made, ran, timed)
    if also and code != STOPPED:
        code = _study(ran, also, code)
    before = _earlier(ran, options)
    if report:
        try:
            trouble = _report(ran.folder, before)
        except KeyboardInterrupt:
            code, trouble = STOPPED, "the report was not written: stopped"
        if trouble:
            code = _incomplete(ran, [trouble], code)
    # the folder of a run that was resumed may lie anywhere
    if code != STOPPED and ran.folder.parent == options.out.resolve():
        point_latest(ran.folder, options.command)
    rows = ran.rows()
    _print(options, rows, made, ran.folder if report and not options.verbose else None, before)
    for note in ran.notes():
        print(note, file=sys.stderr)
    if code == STOPPED:
        # a terminal that was closed takes no text, and the run is safe in its files
        with suppress(OSError):
            print(f"stopped; `{resume_command(ran.folder, words)}` resumes the run", file=sys.stderr)
    print_end(options, code, ran.folder, meaning(code, rows, made.gated))
    return code


def begin(options: argparse.Namespace, words: Sequence[str], made: Plan) -> Run:
    """Make the folder of a run, or take that of the run to resume, with its plan and first results: now it can be resumed.

    Raises InvalidInput where the run to resume has jobs outside the request.
    """
    stays = False
    if options.resume is None:
        folder = run_folder(options.out, options.command).resolve()
    else:
        folder = earlier_run(options.resume, options.command)
        check_plan(folder, made.jobs)
        clear_halves(folder)
        stays = has_ended(folder)
    write_plan(folder, words, made.jobs)
    limits = ceilings() if made.gated else {}
    ran = Run(folder, made.scenarios, made.jobs, made.gated, limits, provenance(words) | origin(made.jobs), stays)
    ran.write(None)
    return ran


def passes(options: argparse.Namespace, made: Plan, ran: Run, timed: bool) -> int:
    """Measure and time. Return the exit code so far, or STOPPED; the results are written either way."""
    try:
        ran.measure(made.ready, workers_of(options, ran.folder))
        if timed:
            ran.clock(options.full, at_length=options.command == "bench")
        code = ran.code()
    except KeyboardInterrupt:
        code = STOPPED
    # no code in the file: a run that was stopped has not ended
    ran.write(None if code == STOPPED else code)
    return code


def _study(ran: Run, also: Callable[[Run], Sequence[str]], code: int) -> int:
    try:
        troubles = also(ran)
    except KeyboardInterrupt:
        ran.write(None)
        return STOPPED
    return _incomplete(ran, troubles, code) if troubles else code


def _incomplete(ran: Run, troubles: Sequence[str], code: int) -> int:
    """Print troubles and store them as the note of the run; return its code, INCOMPLETE where all checks pass."""
    print("\n".join(troubles), file=sys.stderr)
    ran.note, code = "; ".join(troubles), code or INCOMPLETE
    ran.write(None if code == STOPPED else code)
    return code


def nothing_matched(options: argparse.Namespace) -> int:
    """Print the names that are like the patterns of a filter without a scene."""
    known = scenarios(options.command, options.filter)
    for pattern in unmatched(known, options.filter) or [options.filter]:
        print(f"no scene matches {pattern!r}; there are {likely(pattern, known)}", file=sys.stderr)
    print("`python -m scenarios list` names them all", file=sys.stderr)
    print_end(options, NOTHING, None)
    return NOTHING


def _earlier(ran: Run, options: argparse.Namespace) -> Path | None:
    """Return the last run of the same command, which the report compares with; None without one."""
    before = latest(options.out, options.command)
    earlier = before.resolve() if before.exists() else None
    return earlier if earlier != ran.folder.resolve() else None


def _report(folder: Path, before: Path | None) -> str:
    """Write the report of a run; return a sentence on missing parts, "" if all are there."""
    try:
        damage = reports.write_report(folder, before, reports.BASELINE)
    except (ImportError, AvatarsimError) as error:
        return f"the report was not written: {error}"
    except Exception as error:
        # a fault in a chart must not cost the verdict
        return f"the report was not written: {described(error)}"
    return f"left out of the report, since it cannot be used: {'; '.join(damage)}" if damage else ""


def _print(options: argparse.Namespace, rows: Sequence[Row], made: Plan, folder: Path | None, before: Path | None) -> None:
    """Print rows as JSON, or times, or the summary of the report in `folder`, or the table without one."""
    if options.command == "bench":
        rows = [row for row in rows if is_time(row.metric) or row.status in ("crashed", "not-measured")]
    if options.json:
        print(json.dumps(plain([asdict(row) for row in rows]), allow_nan=False))
    elif options.command == "bench":
        for row in rows:
            value = row.note if row.value is None else f"{row.value:12.4g} {row.unit:3} {row.note}".rstrip()
            print(f"{row.scenario:24} {row.run:20} {row.metric:28} {value}")
    else:
        try:
            print(table(rows) if folder is None else reports.terminal_summary(folder, before, reports.BASELINE))
        except (ImportError, AvatarsimError) as error:
            print(table(rows))
            print(f"the summary was not made: {error}", file=sys.stderr)


def print_end(options: argparse.Namespace, code: int, folder: Path | None, means: str = "") -> None:
    """Print the last line of a command: make turns each code above 0 into its own 2. With `--json` to the error stream."""
    page = "none" if folder is None else str(folder / "index.html" if (folder / "index.html").exists() else folder)
    line = f"avatarsim: exit code {code} ({means or MEANINGS[code]}), report: {page}"
    print(line, file=sys.stderr if options.json else sys.stdout)
