"""The sweep for a terminal: the front of every scene and error, fastest first, and who is not on it for a reason."""

import math
from collections.abc import Sequence

from scenarios.sweep.rows import Row


def table(rows: Sequence[Row]) -> str:
    """A block per scene and error: its front, then what crashed, diverged or went through a wall."""
    lines = []
    for scenario, metric in dict.fromkeys((row.scenario, row.metric) for row in rows):
        here = [row for row in rows if (row.scenario, row.metric) == (scenario, metric)]
        lines.append(f"{scenario}, {metric}{f' [{here[0].unit}]' if here[0].unit else ''}")
        for row in sorted((row for row in here if row.front == "all"), key=lambda row: row.p50):
            lines.append(f"  {row.engine:10} {row.setting:32} {row.error:10.3g} {1e-3 * row.p50:9.4f} ms")
        spoilt = [f"{row.engine}/{row.setting}: {row.state}" for row in here if row.state != "measured"]
        untimed = [f"{row.engine}/{row.setting}" for row in here if row.state == "measured" and math.isnan(row.p50)]
        lines += [f"  no point: {', '.join(spoilt)}"] if spoilt else []
        lines += [f"  not timed: {', '.join(untimed)}"] if untimed else []
    return "\n".join(lines)
