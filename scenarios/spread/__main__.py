"""`python -m scenarios.spread [--run FOLDER] [--orders N] [--engine NAME]`.

Runs the scene `chain_order` under many orders of the chains, prints how far what is shown spreads, and writes chain_order.csv
into the run's folder.
"""

import argparse
import sys
from collections.abc import Sequence

from avatarsim.console import ended, path_option
from avatarsim.errors import AvatarsimError, InvalidInput
from runfiles.csv_rows import csv_text
from runfiles.files import OUT, last_comparison, write_text
from runfiles.naming import GATED
from scenarios import catalog
from scenarios.running.harness import offer
from scenarios.spread.orders import Spread, measured

SCENE, NAME, ORDERS = "chain_order", "chain_order.csv", 100
"""The scene, the file of rows, and how many orders are tried."""



def line(row: Spread) -> str:
    """What one preset's spread is, in words."""
    if row.different == 1:
        return f"{row.preset}: {row.orders} orders, all the same to the bit"
    return (
        f"{row.preset}: {row.orders} orders, {row.different} different courses; links {1e3 * row.distance_rms:.3g} mm from their "
        f"mean (rms), {1e3 * row.distance_max:.3g} mm at most, turned {row.angle_rms:.3g} deg, {row.angle_max:.3g} deg at most; "
        f"from the user {1e3 * row.offset_least:.4g} to {1e3 * row.offset_most:.4g} mm, median {1e3 * row.offset_median:.4g} mm; "
        f"overlap {1e3 * row.overlap_max:.3g} mm"
    )


def main(argv: Sequence[str] | None = None) -> int:
    """Run, print, write. 0: done; 2: usage."""
    parser = argparse.ArgumentParser(prog="python -m scenarios.spread", description=str(__doc__).splitlines()[2])
    parser.add_argument("--run", type=path_option, metavar="FOLDER", help="folder for the file (default: the last comparison)")
    parser.add_argument("--orders", type=int, default=ORDERS, metavar="N", help=f"orders tried (default: {ORDERS})")
    parser.add_argument("--engine", default=GATED[0], metavar="NAME", help=f"engine (default: {GATED[0]}), all its presets")
    asked = parser.parse_args(argv)
    try:
        if asked.orders < 1:
            raise InvalidInput("--orders", asked.orders, "1 at least")
        scenario = catalog.get(SCENE).as_run(False)
        scene = scenario.build()
        motion = scenario.motion(scene, 0)
        samples = [motion(k) for k in range(scenario.frames)]
        presets = offer(asked.engine).presets
        found = [measured(asked.engine, preset, scene, samples, scenario.dt, asked.orders) for preset in presets]
        folder = asked.run or last_comparison(OUT, "spread")
        write_text(folder / NAME, csv_text(found, Spread))
    except AvatarsimError as error:
        print(f"{type(error).__name__}: {error}", file=sys.stderr)
        return 2
    print("\n".join(map(line, found)))
    print(f"\n{folder / NAME}")
    return 0


if __name__ == "__main__":
    sys.exit(ended(main))
