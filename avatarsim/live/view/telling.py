"""What the panel says: frame times beside the rates that they allow, late frames, latency, penetration, statuses in words."""

from collections.abc import Collection, Mapping
from math import isnan

from avatarsim.cleaning.chords import Pair
from avatarsim.live.figures import SPAN, Figures
from avatarsim.live.messages import State
from avatarsim.live.ports.refusals import Refusals

BUDGETS = {"60 Hz": 16.667, "90 Hz": 11.111}
"""[ms] that a frame has at the usual rates."""

NAMED = 4
"""Reasons of refusals that are named, the most frequent; of more, how many."""

SAID = {
    "planning": "looks for a way round", "following": "follows a way round",
    "waiting": "waits: no free way to your posture is known; go back to where the avatar is, or press Reset",
    "goal_not_reached": "held back by what it touches",
}
"""Statuses in words; others are said by their names."""

HELD = ("waiting", "goal_not_reached")
"""Statuses of an avatar that does not come to its user, for which the user's own overlap is a reason."""


def milliseconds(nanoseconds: float) -> str:
    """Milliseconds to a hundredth; three digits of larger ones."""
    value = 1e-6 * nanoseconds
    return f"{value:.2f}" if value < 10.0 else f"{value:.3g}"


def depth(metres: float) -> str:
    """A penetration in millimetres; below a micrometre there is none to an eye or to the promise."""
    if isnan(metres):
        return "?"
    return "none" if metres <= 1e-6 else f"{1e3 * metres:.3g} mm"


def table(figures: Mapping[str, Figures], depths: Mapping[str, float], target: float) -> str:
    """A table of all engines in Markdown: frame time, late frames, penetration of what each shows."""
    lines = ["| | p50 | p99 | worst | late | overlap now |", "|---|---:|---:|---:|---:|---:|"]
    lines += [
        f"| {name} | {milliseconds(of.p50)} | {milliseconds(of.p99)} | {milliseconds(of.worst)} | {100.0 * of.late:.2g}% "
        f"| {depth(depths.get(name, float('nan')))} |"
        for name, of in figures.items()
    ]
    lines += [f"| your own posture | | | | | {depth(target)} |"]
    budgets = ", ".join(f"{ms:.3g} at {rate}" for rate, ms in BUDGETS.items())
    return "\n".join([*lines, "", f"Times in ms, of the last {SPAN:.0f} s. A frame has {budgets}."])


def refused(refusals: Refusals) -> str:
    """What was refused for which reason, the most frequent first; never words of a peer."""
    said = [f"{count} {reason.value} ({peer.value})" for (reason, peer), count in sorted(
        refusals.counts.items(), key=lambda one: -one[1]
    )]
    left = f" and {len(said) - NAMED} more reasons" if len(said) > NAMED else ""
    return f"{'; '.join(said[:NAMED]) or 'none'}{left}"


def at_page(refusals: Refusals) -> str:
    """Connections to the page's own socket that were cut; empty where none was."""
    return f"Connections to this page refused: {refused(refusals)}." if refusals.counts else ""


def at_ports(refusals: Refusals) -> str:
    """What came in at the ports, and what was refused."""
    taken = ", ".join(f"{count} by {peer.value}" for peer, count in refusals.taken.items()) or "none"
    return f"Messages of trackers: {taken}. Refused: {refused(refusals)}."


def is_held(state: State) -> bool:
    """Return True if the avatar does not come to its user."""
    return any(name in HELD for name in state.statuses)


def overlapping(pair: Pair, links: Collection[str]) -> str:
    """Which parts of the user's own posture overlap, and what the user can do."""
    first, second = (f"{'your ' if name in links else 'the '}{name.rpartition('/')[2].replace('_', ' ')}" for name in pair)
    done = "move them apart" if pair[0] in links else "pull it out"
    return f"{second} is inside {first}; {done}, or press Reset"


def sentence(state: State, of: Figures, overlap: str = "") -> str:
    """One line on the driven engine: latency, what was left out, what it reports; `overlap` of the user's own posture."""
    statuses = [SAID.get(name, name.replace("_", " ")) for name in state.statuses]
    if overlap and is_held(state):
        statuses = [SAID.get(name, name.replace("_", " ")) for name in state.statuses if name not in HELD]
        statuses.append(f"waits: {overlap}" if "waiting" in state.statuses else f"held back: {overlap}")
    told = "; ".join(statuses) if statuses else "follows freely"
    left = f", {of.skipped} frames left out" if of.skipped else ""
    stages = ", ".join(f"{name} {1e-3 * cost:.0f} us" for name, cost in of.stages.items() if cost)
    lines = [
        f"**{'Paused. ' if state.is_paused else ''}{told}**",
        f"Latency {milliseconds(of.latency_p50)} ms, p99 {milliseconds(of.latency_p99)} ms{left}. "
        f"Longest on the processor {milliseconds(of.worst_cpu)} of {milliseconds(of.worst)} ms.",
    ]
    if stages:
        lines.append(f"Stages: {stages}.")
    if not state.is_logged:
        lines.append("The log is full: what is driven from here on is not saved. Reset begins another.")
    return "\n\n".join(lines)
