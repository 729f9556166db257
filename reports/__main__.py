"""`python -m reports write [RUN]`: the pages and the summary again. `diff BASE NEW`: changes for the better and the worse.

`baseline [RUN]` and `headline [RUN]` make a run's figures the committed ones: of later comparisons, and of the README.

Exit codes: 0; diff 1 when something got worse; 2 when a file cannot be used: pages are written without it.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from avatarsim.console import ended, path_option
from avatarsim.errors import AvatarsimError
from reports import BASELINE, PAGE, terminal_summary, write_report
from reports.summaries import baseline, readme
from reports.summaries.text import changed_lines
from reports.tables.changes import against_baseline, changes
from reports.tables.run import read

LATEST = Path("reports/out/latest")
README = Path(__file__).resolve().parent.parent / "README.md"


def parser() -> argparse.ArgumentParser:
    """Return all commands and their options."""
    top = argparse.ArgumentParser(prog="python -m reports", description="Pages and comparisons from files of runs.")
    commands = top.add_subparsers(dest="command", required=True)

    def command(name: str, words: str, folder: str = "run") -> argparse.ArgumentParser:
        made = commands.add_parser(name, help=words)
        if folder == "new":
            made.add_argument("base", type=path_option, help="folder of the earlier run, or a baseline file (.csv)")
        made.add_argument(folder, type=path_option, nargs="?", default=LATEST, help=f"folder of a run (default: {LATEST})")
        return made

    write = command("write", "write index.html, the scenes' pages, summary.md and junit.xml of a run again")
    write.add_argument("--before", type=path_option, help="folder of an earlier run to compare with (default: the one before)")
    command("diff", "list changes for the better and the worse from BASE to NEW", "new")
    keep = command("baseline", "make a run's accuracy the committed baseline")
    keep.add_argument("--to", type=path_option, default=BASELINE, metavar="FILE", help="another file")
    command("headline", "write the README's table and charts from a run")
    return top


def one_before(run: Path) -> Path | None:
    """Return the last earlier run of the same command beside a run, by the time in their names; None without one."""
    own = run.resolve()
    command = own.name.rpartition("-")[2]
    earlier = [folder for folder in own.parent.glob(f"*-*-{command}") if folder.name < own.name]
    return max((folder for folder in earlier if (folder / "results.json").is_file()), default=None)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code."""
    chosen = parser().parse_args(arguments)
    try:
        if chosen.command == "diff":
            new = read(chosen.new)
            if chosen.base.suffix == ".csv":
                differences = against_baseline(baseline.load(chosen.base), new, str(chosen.base))
            else:
                differences = changes(read(chosen.base), new)
            print("\n".join(changed_lines(differences)))
            return 1 if differences.count("worse") else 0
        if chosen.command == "write":
            before = chosen.before or one_before(chosen.run)
            damage = write_report(chosen.run, before, BASELINE)
            print(terminal_summary(chosen.run, before, BASELINE))
            for fault in damage:
                print(f"reports: left out, since it cannot be used: {fault}", file=sys.stderr)
            print(chosen.run / PAGE)
            return 2 if damage else 0
        if chosen.command == "baseline":
            chosen.to.write_text(baseline.text(read(chosen.run)), encoding="utf-8")
            print(chosen.to)
        else:
            readme.write(read(chosen.run), README)
            print(README)
    except (AvatarsimError, OSError) as error:
        print(f"reports: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(ended(main))
