"""Lines that set an engine as a setting of a run was, to copy into a program."""

from pathlib import Path
from typing import Any

from reports.pages.scripts import text
from reports.tables.run import Run
from reports.tables.settings import options_of, preset_options, rows_of
from runfiles.engines import about
from runfiles.naming import stem
from runfiles.native_files import written


def lines(run: Run, row: Any) -> str:
    """Return the text for a setting of `reports.tables.settings`: lines that make it whole, or the command that runs it."""
    one, seed, options = about(row.engine), int(run.rows.seed.iloc[0]), options_of(row.engine, row.options)
    file = Path(written(run.folder, row.scenario, f"{row.engine}/{row.base}", seed)).name
    loads = one.loads.format(file=file, preset=row.base, scene=row.scenario, options=options)
    words, besides = one.in_own_words(options), list[str]()
    takes_all, from_file = ("{" + name + "}" in one.loads for name in ("options", "file"))
    if takes_all:
        words = _in_python(row.options, loads.splitlines()[-1])
    elif not from_file:
        plain = preset_options(run, row.scenario, row.engine, row.base) | options
        words = one.in_own_words({name: value for name, value in plain.items() if name in one.alone})
        besides = [f"{name} = {value}" for name, value in plain.items() if name not in one.alone]
    ending, own = file.split(".")[-2:], next(iter(rows_of(row.engine, row.options)), "")
    return text(
        "setting.txt.j2", row=row, whole=bool(one.loads) and (takes_all or row.alone or row.preset), words=words, loads=loads,
        besides=besides, file=file, missing=from_file and not file,
        made=".".join([stem(row.scenario, row.engine, own, seed), *ending]) if file else "",
    )


def _in_python(options: str, load: str) -> list[str]:
    """Return the lines of a setting that leaves effects out, after which the scene is loaded anew, or cuts frames in parts."""
    without = [line for part in options.split("; ") if part.startswith("replace(")
               for line in ("from dataclasses import replace", f"scene = {part}", load)]
    return without + [part for part in options.split("; ") if part.startswith("for ")]
