"""What the benchmark says on the terminal."""

from collections.abc import Sequence

from reference.broad_phase.layouts import CLAIMED
from reference.broad_phase.rows import FLAT, Row, growth


def table(rows: Sequence[Row]) -> str:
    """Nanoseconds per object: a line per layout, motion and kernel, a column per number of objects, and the verdict."""
    sizes = sorted({row.objects for row in rows})
    lines = ["ns per object and frame", f"{'':36s}" + "".join(f"{size:>9d}" for size in sizes)]
    for layout, motion, kernel in dict.fromkeys((row.layout, row.motion, row.kernel) for row in rows):
        found = {row.objects: row for row in rows if (row.layout, row.motion, row.kernel) == (layout, motion, kernel)}
        cells = "".join(f"{1e3 * found[size].us_per_object_p50:9.1f}" if size in found else f"{'-':>9s}" for size in sizes)
        lines.append(f"{layout:6s} {motion:9s} {kernel:18s} {cells}  {verdict(list(found.values()))}")
    wrong = [row for row in rows if not row.found_is_twin]
    lines += [f"WRONG PAIRS: {row.layout}, {row.motion}, {row.objects} objects, {row.kernel}" for row in wrong]
    return "\n".join(lines)


def verdict(rows: Sequence[Row]) -> str:
    """Whether time and memory per object are flat over these numbers of objects, and where they are not."""
    time, slowest, _ = growth(rows, "us_per_object_p50")
    memory, largest, _ = growth(rows, "bytes_per_object")
    flat = time <= FLAT and memory <= FLAT
    where = "" if flat else f", worst at {slowest if time > FLAT else largest}"
    claim = "" if rows[0].motion in CLAIMED else " (not claimed)"
    return f"time x{time:.2f}, memory x{memory:.2f}: {'flat' if flat else 'not flat'}{where}{claim}"
