"""The page of a folder: one line per clip with its measures before and after, and the undone clips."""

from collections.abc import Mapping, Sequence
from typing import Any

from avatarsim.clips.page.layout import address, esc, length, page, table

HEAD = [
    "clip", "length", "overlap before", "overlap after", "ways not certified, before / after", "second opinion after",
    "moved, 95th percentile of the link that moved most / largest of any link", "jerk where free, after / before", "flagged",
]


def index_page(summary: Mapping[str, Any]) -> bytes:
    """Return the page of a summary (`certificate.summary`) as bytes."""
    clips: Sequence[Mapping[str, Any]] = summary["clips"]
    troubles: Sequence[Mapping[str, Any]] = summary["not_done"]
    left = [one for one in clips if not one["is_clean"]]
    text = verdict(len(clips), len(left), len(troubles))
    parts = [
        "<main>", "<h1>Cleaned motion</h1>",
        f'<p class="verdict{" left" if left or troubles else ""}"><b>{esc(text)}</b><br><span class=soft>Overlap is the depth by '
        "which shapes go through one another; a way is what a player shows from one frame to the next. "
        'All figures: <a href="certificate.json">certificate.json</a>.</span></p>',
        table(HEAD, [_row(one) for one in clips]) if clips else "<p class=soft>No clip.</p>",
    ]
    if troubles:
        rows = [[esc(one["name"]), esc(one["kind"]), esc(one["why"])] for one in troubles]
        parts += ["<h2>Not done</h2>", table(["file", "kind", "why"], rows)]
    return page("Cleaned motion", "\n".join([*parts, "</main>"]))


def verdict(clips: int, left: int, troubles: int) -> str:
    """Return one sentence on a folder."""
    state = f"{left} not clean" if left else "all free of overlap, in and between frames"
    done = f"{clips} clip{'' if clips == 1 else 's'}: {state}"
    return f"{done}; {troubles} not done" if troubles else done


def _row(one: Mapping[str, Any]) -> list[str]:
    name, overlap, chords = str(one["motion"]), one["overlap"], one["between_frames"]
    link = f'<a href="pages/{address(name)}.html">{esc(name)}</a>' if one["options"]["page"] else esc(name)
    verdict = "<span class=good>clean</span>" if one["is_clean"] else "<span class=bad>not clean</span>"
    opinion = one["second_opinion"]["after"]
    depth = "—" if opinion is None else length(max(opinion["frames_deepest_m"], opinion["between_deepest_m"]))
    most = max(one["moved"]["links"], key=lambda link: link["p95_m"], default=None)
    farthest = max((link["most_m"] for link in one["moved"]["links"]), default=0.0)
    moved = "—" if most is None else f"{length(most['p95_m'])} / {length(farthest)}, {most['name']}"
    return [
        f"{link}<br>{verdict}", esc(f"{one['frames']} frames"), _overlap(overlap["before"]), _overlap(overlap["after"]),
        esc(f"{chords['not_certified_before']} / {chords['not_certified_after']}"), esc(depth), esc(moved), esc(jerk_ratio(one)),
        esc(f"{one['changed_frames']} frames changed, flagged runs: {len(one['flagged'])}"),
    ]


def _overlap(one: Mapping[str, Any]) -> str:
    kind = "bad" if one["frames"] else "good"
    return f"<span class={kind}>{esc(one['frames'])} frames</span>, {esc(length(one['deepest_m']))}"


def jerk_ratio(one: Mapping[str, Any]) -> str:
    """Return the ratio of the jerk of the written motion to the input's, over the frames where the input is free."""
    before, after = (one["jerk_p95_m_s3"][when]["where_free"] for when in ("before", "after"))
    if after is None or not before:
        return "—"
    return f"{after / before:.3g} x"
