"""`python -m reports write [RUN]`: the pages again. `diff BASE NEW`: what got better or worse.

`baseline [RUN]` and `headline [RUN]` make a run's figures the committed ones: of later comparisons, and of the README's table.

Exit codes: 0; diff 1 when something got worse; 2 when a file cannot be used: pages are written without what it holds.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from avatarsim.console import ended, path_option
from avatarsim.errors import AvatarsimError
from reports import PAGE, write_report
from reports.reading.load import Results, load
from reports.summaries import baseline, headline
from reports.summaries.diff import diff

LATEST = Path("reports/out/latest")
COMMITTED, HEADLINE = Path(__file__).with_name("baseline.csv"), Path(__file__).with_name("headline.csv")
README = Path(__file__).resolve().parent.parent / "README.md"


def read(place: Path) -> Results:
    """A run's folder, or a baseline file. Raises InvalidFile."""
    return baseline.load(place) if place.suffix == ".csv" else load(place)


def parser() -> argparse.ArgumentParser:
    """All commands and their options."""
    top = argparse.ArgumentParser(prog="python -m reports", description="Pages and comparisons from files of runs.")
    commands = top.add_subparsers(dest="command", required=True)
    write = commands.add_parser("write", help="write index.html, the scenes' pages, summary.md and junit.xml of a run again")
    write.add_argument("run", type=path_option, nargs="?", default=LATEST, help=f"folder of a run (default: {LATEST})")
    compare = commands.add_parser("diff", help="what got better or worse from BASE to NEW")
    compare.add_argument("base", type=path_option, help="folder of the earlier run, or a baseline file (.csv)")
    compare.add_argument("new", type=path_option, nargs="?", default=LATEST, help=f"folder of the later run (default: {LATEST})")
    keep = commands.add_parser("baseline", help="make a run's accuracy the committed baseline")
    keep.add_argument("run", type=path_option, nargs="?", default=LATEST, help=f"folder of a run (default: {LATEST})")
    keep.add_argument("--to", type=path_option, default=COMMITTED, metavar="FILE", help="another file")
    head = commands.add_parser("headline", help="write the table of the README from a run (`make headline`: its pictures too)")
    head.add_argument("run", type=path_option, nargs="?", default=LATEST, help=f"folder of a run (default: {LATEST})")
    return top


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code."""
    chosen = parser().parse_args(arguments)
    try:
        if chosen.command == "write":
            damage = write_report(chosen.run)
            for said in damage:
                print(f"reports: left out, since it cannot be used: {said}", file=sys.stderr)
            print(chosen.run / PAGE)
            return 2 if damage else 0
        if chosen.command == "baseline":
            chosen.to.write_text(baseline.text(load(chosen.run)), encoding="utf-8")
            print(chosen.to)
            return 0
        if chosen.command == "headline":
            HEADLINE.write_text(headline.numbers(load(chosen.run), chosen.run.resolve().name), encoding="utf-8")
            README.write_text(headline.replaced(README.read_text(encoding="utf-8"), headline.told(headline.load(HEADLINE))),
                              encoding="utf-8")
            print(f"{HEADLINE}\n{README}")
            return 0
        changes = diff(read(chosen.base), load(chosen.new))
    except AvatarsimError as error:
        print(f"reports: {error}", file=sys.stderr)
        return 2
    print(changes.text())
    return 1 if changes.worse else 0


if __name__ == "__main__":
    sys.exit(ended(main))
