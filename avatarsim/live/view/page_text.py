"""Words and numbers of the page: overlaps in large type, the avatar's action in a word, timing in a fold."""

from collections.abc import Collection, Mapping, Sequence
from html import escape
from math import isnan

import numpy as np

from avatarsim.cleaning.chords import Pair
from avatarsim.live.figures import SPAN, Figures
from avatarsim.live.messages import State
from avatarsim.live.ports.refusals import Refusals
from avatarsim.live.view.scene_meshes import GHOST, OVERLAPPING, Colour

BUDGETS = {"60 Hz": 16.667, "90 Hz": 11.111}
"""[ms] that a frame has at the usual rates."""

NAMED = 4
"""Number of most frequent reasons of refusals that are named; the rest is counted."""

WORDS = {"planning": "plans a way round", "following": "goes round", "waiting": "waits"}
"""Words for statuses; others keep their names."""

STYLE = """<style>
.overlaps{position:fixed;top:14px;left:14px;right:14px;z-index:5;pointer-events:none;text-align:center}
.overlaps div{display:inline-flex;flex-wrap:wrap;justify-content:center;gap:0 1em;border-radius:10px;padding:0 .5em;
  background:color-mix(in srgb,var(--mantine-color-body,#fff) 80%,transparent);
  font:700 clamp(20px,2.5vw,36px)/1.25 system-ui,sans-serif;font-variant-numeric:tabular-nums}
@media(min-width:36em){.overlaps{right:calc(20em + 28px)}}
[inert]:has(.overlaps){display:block!important;opacity:1!important}
.mantine-Notifications-root{top:auto!important;bottom:4.5em!important}
</style>"""
"""Style of the numbers over the scene, left of viser's panel of 20em, which is a drawer in windows up to 36em wide. They are seen
while it is closed; viser's notices, which lie at the top, go to the bottom."""

FIRST_VISIT = (
    '<img hidden alt="" src="data:image/gif;base64,R0lGODlhAQABAAAAACwAAAAAAQABAAA=" onload="'
    "if(matchMedia('(prefers-color-scheme: dark)').matches&&!location.search.includes('darkMode'))location.search='darkMode';"
    "else if(!window.isAtFirst&&matchMedia('(max-width: 36em)').matches)"
    "this.closest('[aria-hidden]').previousElementSibling.click();window.isAtFirst=true\">"
)
"""Element that requests the dark scheme of viser's page, which only the address can set, if the browser prefers it, and closes
the drawer of a narrow window."""

FAST, SLOW, BEHIND = 0.3, 0.02, 4e-3
"""Least speeds of a loose body that bounces and of an avatar that slides [m/s], and least distance of the latter from its user
[m]. Less: bodies at rest, or a lag of a frame, get a word."""

NOT_REACHED = ("waiting", "goal_not_reached")
"""Statuses of an avatar that does not reach its user's posture, for which the user's own overlap is a reason."""


def milliseconds(nanoseconds: float) -> str:
    """Return milliseconds to a hundredth; three digits of larger ones."""
    value = 1e-6 * nanoseconds
    return f"{value:.2f}" if value < 10.0 else f"{value:.3g}"


def depth(metres: float) -> str:
    """Return a penetration in millimetres; below a micrometre it is shown as 0."""
    if isnan(metres):
        return "?"
    value = 1e3 * metres
    return "0" if value <= 1e-3 else f"{value:.0f} mm" if value >= 10.0 else f"{value:.2g} mm"


def numbers(target: float, apart: float, depths: Mapping[str, float], colours: Mapping[str, Colour]) -> str:
    """Return HTML of overlaps [m] in large type: of the user's own posture, which is `apart` [m] from the avatar, and of each
    engine's avatar, in its colour."""
    rows = [("you", target, GHOST), *((name, of, colours[name]) for name, of in depths.items())]
    chips = []
    for name, metres, colour in rows:
        is_inside = metres > 1e-6
        red, green, blue = OVERLAPPING if is_inside else colour
        text = f"{escape(name)}: {depth(metres)}{' inside' if is_inside else ''}"
        if name == "you" and not is_inside and apart > BEHIND:
            text = f"you: {depth(apart)} away"
        shown = 1e3 * metres if is_inside else 0.0
        chips.append(f'<span data-overlap="{shown:.4g}" style="color:rgb({red},{green},{blue})">{text}</span>')
    return f'<div class="overlaps"><div>{"".join(chips)}</div></div>'


def word_of(states: Sequence[State], apart: float, touches: bool, root: int, loose: Sequence[int]) -> str:
    """Return the avatar's action in a word, or an empty text.

    Args:
        states: newest states in order, two at least.
        apart: distance between avatar and ghost [m].
        touches: True if the avatar touches anything.
        root: number of the root of the avatar.
        loose: numbers of the loose bodies.
    """
    if len(states) < 2:
        return ""
    first, last = states[0], states[-1]
    time = max(last.time - first.time, 1e-6)
    speeds = np.linalg.norm(last.positions - first.positions, axis=1) / time
    if any(state.counts.get("impacts") for state in states) and max(speeds[loose], default=0.0) > FAST:
        return "bounces"
    for name, word in WORDS.items():
        if name in last.statuses:
            return word
    return "slides" if apart > BEHIND and touches and speeds[root] > SLOW else ""


def table(figures: Mapping[str, Figures]) -> str:
    """Return the frame times of all engines as a table in Markdown."""
    lines = ["| | p50 | p99 | worst | late |", "|---|---:|---:|---:|---:|"]
    lines += [
        f"| {name} | {milliseconds(of.p50)} | {milliseconds(of.p99)} | {milliseconds(of.worst)} | {100.0 * of.late:.2g}% |"
        for name, of in figures.items()
    ]
    budgets = ", ".join(f"{ms:.3g} at {rate}" for rate, ms in BUDGETS.items())
    return "\n".join([*lines, "", f"Times in ms, of the last {SPAN:.0f} s. A frame has {budgets}."])


def refused(refusals: Refusals) -> str:
    """Return counts of refusals by reason, the most frequent first; never a peer's text."""
    reasons = [f"{count} {reason.value} ({peer.value})" for (reason, peer), count in sorted(
        refusals.counts.items(), key=lambda one: -one[1]
    )]
    left = f" and {len(reasons) - NAMED} more reasons" if len(reasons) > NAMED else ""
    return f"{'; '.join(reasons[:NAMED]) or 'none'}{left}"


def at_page(refusals: Refusals) -> str:
    """Return the number of cut connections to the page's own socket; empty if there are none."""
    return f"Connections to this page refused: {refused(refusals)}." if refusals.counts else ""


def at_ports(refusals: Refusals) -> str:
    """Return the numbers of accepted and refused messages at the ports."""
    accepted = ", ".join(f"{count} by {peer.value}" for peer, count in refusals.accepted.items()) or "none"
    return f"Messages of trackers: {accepted}. Refused: {refused(refusals)}."


def overlapping(pair: Pair, links: Collection[str]) -> str:
    """Return the overlapping parts of the user's own posture, and advice for the user."""
    first, second = (f"{'your ' if name in links else 'the '}{name.rpartition('/')[2].replace('_', ' ')}" for name in pair)
    done = "move them apart" if pair[0] in links else "pull it out"
    return f"{second} is inside {first}; {done}, or press Reset"


def situation(state: State, overlap: str) -> str:
    """Return a line on the obstacle of the avatar; `overlap` of the user's own posture, if that is the cause."""
    statuses = [WORDS.get(name, name.replace("_", " ")) for name in state.statuses if not (overlap and name in NOT_REACHED)]
    parts = [f"held back: {overlap}"] * bool(overlap) + statuses
    lines = [f"**{'Paused. ' if state.is_paused else ''}{'; '.join(parts) or 'follows you'}**"]
    if not state.is_logged:
        lines.append("The log is full: what is driven from here on is not saved. Reset begins another.")
    return "\n\n".join(lines)


def timing(of: Figures) -> str:
    """Return lines on latency, frames left out and stages of the driven engine."""
    left = f", {of.skipped} frames left out" if of.skipped else ""
    lines = [
        f"Latency {milliseconds(of.latency_p50)} ms, p99 {milliseconds(of.latency_p99)} ms{left}. "
        f"Longest on the processor {milliseconds(of.worst_cpu)} of {milliseconds(of.worst)} ms.",
    ]
    if stages := ", ".join(f"{name} {1e-3 * cost:.0f} us" for name, cost in of.stages.items() if cost):
        lines.append(f"Stages: {stages}.")
    return "\n\n".join(lines)
