"""The page of one clip: both motions in one view, overlap on a time line, and the moments worth seeing, the deepest first."""

import base64
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from heapq import nlargest
from itertools import islice
from pathlib import PurePosixPath
from typing import Any

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets.models.model import Model
from avatarsim.cleaning import Audit, Flagged
from avatarsim.cleaning.result import OVERLAP
from avatarsim.clips.page.drawn_pieces import CORNERS, Surface, corners, surface_of
from avatarsim.clips.page.layout import address, angle, data, esc, length, page, resource, table
from avatarsim.scene.body import Body
from avatarsim.scene.motion import Motion
from avatarsim.scene.shape import Piece
from avatarsim.scene.tracker import poses_of_links
from avatarsim.spatial import rotation

Array = NDArray[np.float64]

NUMBERS = 2_000_000
"""Numbers of poses in a page: 4 MB, 5,000 frames of 30 links before and after. More: it opens too slowly. Longer clips show every
second frame, or every third."""
STEPS = 65_535
"""Values of a coordinate: places to 0.2 mm in 10 m."""
UNIT = 32_767
"""Value of 1 in a quaternion."""
ROOM_CORNERS, FEWEST, PIECES = 10_000, 8, 1_000
"""Corners of a room together, fewest of one piece, and pieces at most: a browser draws 20,000 triangles ten times a second."""
RUNS = 1_500
"""Marks of one kind on the time line at most; those that lie closer together than a pixel become one."""
THINNEST = 1.0 / 600.0
"""Least width of a mark, as a share of the line: a single frame is to be seen."""
MOMENTS = 120
"""Moments with a button of their own; the certificate has all."""


@dataclass(frozen=True, eq=False)
class Shown:
    """What a page shows: the avatar and room, the input and what was written, their measures, and what was flagged."""

    model: Model
    room: Sequence[Body]
    before: Motion
    after: Motion
    audit_before: Audit
    audit_after: Audit
    flagged: Sequence[Flagged]


@dataclass(frozen=True)
class Moment:
    """A frame that is worth seeing, and why."""

    frame: int
    said: str
    worst: bool = False


def clip_page(entry: Mapping[str, Any], shown: Shown, place: str) -> bytes:
    """The page of a clip as bytes; `place` is its path below the output folder, `entry` its part of the certificate."""
    name = str(entry["motion"])
    up = "../" * (len(PurePosixPath(place).parts) - 1)
    moments = moments_of(shown)
    clean = bool(entry["is_clean"])
    verdict = "free of overlap in and between all frames, joints within limits" if clean else "not clean: see the table"
    if entry["excluded"]:
        verdict += f"; {len(entry['excluded'])} pairs are excluded from contact"
    body = "\n".join([
        "<main>",
        f'<p><a href="{up}index.html">All clips</a></p>',
        f"<h1>{esc(name)}</h1>",
        f'<p class="verdict{"" if clean else " left"}"><b>{esc(verdict)}</b><br>'
        f'<span class=soft>{esc(entry["frames"])} frames, {esc(_rate(entry))}; '
        f'<a href="{up}{address(name)}">the motion</a>, '
        f'<a href="{up}certificates/{address(name)}.json">its certificate</a></span></p>',
        STAGE,
        time_line(shown),
        CONTROLS.format(last=len(shown.before) - 1),
        "<h2>Moments</h2>",
        _buttons(moments),
        "<h2>Measures</h2>",
        measures(entry),
        _moved(entry),
        _said(entry),
        "</main>",
        data("clip", replay(shown, moments)),
    ])
    return page(f"{name}: before and after", body, resource("viewer.js"))


STAGE = (
    '<div class=stage id=stage tabindex=0 role=img aria-label="The avatar before and after"><canvas id=view></canvas></div>\n'
    '<p class=told id=told role=status></p>'
)
CONTROLS = (
    '<div class=controls><button id=play type=button>Play</button>'
    '<input id=bar type=range min=0 max="{last}" value=0 step=1 aria-label="Frame">'
    '<select id=speed aria-label="Speed"><option value=0.1>0.1 x</option><option value=0.25>0.25 x</option>'
    '<option value=1 selected>1 x</option></select></div>\n'
    '<div class=controls><label><input type=checkbox id=show-before checked> <span class="key before"></span>before</label>'
    '<label><input type=checkbox id=show-after checked> <span class="key after"></span>after</label>'
    '<label><input type=checkbox id=show-room checked> <span class="key room"></span>room</label>'
    '<label><input type=checkbox id=follow checked> follow</label>'
    '<span class=soft><span class="key red"></span>overlap <span class="key chord"></span>way to the next frame not certified; '
    'drag turns, Ctrl and wheel zoom, space plays, arrows step</span></div>'
)


def _rate(entry: Mapping[str, Any]) -> str:
    return "one posture" if entry["rate_hz"] is None else f'{entry["rate_hz"]:g} frames a second'


def moments_of(shown: Shown) -> list[Moment]:
    """The deepest overlap before, the deepest after, and the runs that were flagged, in this order."""
    found = []
    for audit, when in ((shown.audit_before, "before"), (shown.audit_after, "after")):
        if audit.overlapping:
            pair = f", {audit.deepest_pair[0]} in {audit.deepest_pair[1]}" if audit.deepest_pair else ""
            found.append(Moment(int(np.argmax(audit.depths)), f"deepest overlap {when}: {length(audit.deepest)}{pair}", True))
    for run in islice(shown.flagged, MOMENTS):
        pair = f": {run.pair[0]} and {run.pair[1]}" if run.pair else ""
        frames = f"frames {run.first} to {run.last}" if run.last > run.first else f"frame {run.first}"
        found.append(Moment(run.first, f"{frames}, {run.why}{pair}"))
    return found


def _buttons(moments: Sequence[Moment]) -> str:
    if not moments:
        return "<p class=soft>Nothing was flagged.</p>"
    buttons = [
        f'<button type=button data-frame="{one.frame}"{" class=worst" if one.worst else ""}>{esc(one.said)}</button>'
        for one in moments
    ]
    return f"<div class=moments>{''.join(buttons)}</div>"


def runs(marked: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """(first, last) of the runs of marked frames; where there are more than RUNS, near ones are joined."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], marked, [False]]).astype(np.int8)))
    found = [(int(a), int(b) - 1) for a, b in zip(edges[::2], edges[1::2], strict=True)]
    if len(found) <= RUNS:
        return found
    near, joined = len(marked) // RUNS + 1, [found[0]]
    for first, last in found[1:]:
        if first - joined[-1][1] <= near:
            joined[-1] = (joined[-1][0], last)
        else:
            joined.append((first, last))
    return joined


def time_line(shown: Shown) -> str:
    """Two rows of marks over the frames, before and after, and what was flagged between them, as SVG."""
    frames = len(shown.before)
    marks = [f'<rect class=free x=0 y=4 width="{frames}" height=10 /><rect class=free x=0 y=20 width="{frames}" height=10 />']
    for audit, y in ((shown.audit_before, 4), (shown.audit_after, 20)):
        unproven = np.concatenate([~(audit.proven >= 1.0), [False]])
        overlapping = ~(audit.depths <= OVERLAP)
        for kind, marked in (("chord", unproven & ~overlapping), ("red", overlapping)):
            marks += [_mark(kind, first, last, y, 10, frames) for first, last in runs(marked)]
    flagged = np.zeros(frames, dtype=bool)
    for run in shown.flagged:
        flagged[run.first : run.last + 1] = True
    marks += [_mark("flag", first, last, 15, 4, frames) for first, last in runs(flagged)]
    marks.append(f'<rect class=now id=now x=0 y=0 width="{max(frames * THINNEST * 0.6, 1e-3):.4g}" height=34 />')
    return (
        f'<svg class=line id=line viewBox="0 0 {frames} 34" preserveAspectRatio=none role=img '
        f'aria-label="Overlap over the frames: above before, below after">{"".join(marks)}</svg>'
    )


def _mark(kind: str, first: int, last: int, y: int, height: int, frames: int) -> str:
    width = max(last + 1 - first, frames * THINNEST)
    return f'<rect class={kind} x="{min(first, frames - width):.6g}" y={y} width="{width:.6g}" height={height} />'


def measures(entry: Mapping[str, Any]) -> str:
    """The table of measures, before and after."""
    rows = []

    def row(name: str, of: str, *told: str) -> None:
        rows.append([esc(name), esc(of), *told])

    both = ("before", "after")
    overlap, chords, limits = entry["overlap"], entry["between_frames"], entry["limits"]
    row("frames in overlap", f"of {entry['frames']}", *(_count(overlap[when]["frames"]) for when in both))
    row("deepest overlap", "by this program", *(esc(length(overlap[when]["deepest_m"])) for when in both))
    ways = (_count(chords[f"not_certified_{when}"]) for when in both)
    row("ways between frames not certified", f"of {chords['chords']}", *ways)
    opinions = [entry["second_opinion"][when] for when in both]
    by = next((one["by"] for one in opinions if one), None)
    if by:
        told = [f"{length(one['frames_deepest_m'])} / {length(one['between_deepest_m'])}" if one else "—" for one in opinions]
        row("deepest overlap, in / between frames", f"second opinion, {by}", esc(told[0]), esc(told[1]))
    row("joints outside limits, most", "", esc(angle(limits["excess_before_rad"])), esc(angle(limits["excess_after_rad"])))
    jerk = entry["jerk_p95_m_s3"]
    for name, key in (("where the input is free", "where_free"), ("elsewhere", "elsewhere")):
        told = [_per_cubed(jerk[when][key]) for when in both]
        row("jerk, 95th percentile", name, esc(told[0]), esc(told[1]))
    return table(["", "", "before", "after"], rows)


def _per_cubed(jerk: float | None) -> str:
    if jerk is None:
        return "—"
    return f"{jerk:,.0f} m/s³" if jerk >= 100.0 else f"{jerk:.3g} m/s³"


def _count(number: int) -> str:
    return f'<span class={"bad" if number else "good"}>{number}</span>'


def _moved(entry: Mapping[str, Any]) -> str:
    links = sorted(entry["moved"]["links"], key=lambda one: -one["p95_m"])
    joints = sorted(entry["moved"]["joints"], key=lambda one: -one["p95_rad"])
    changed = (
        f"{entry['held_frames']} of {entry['frames']} frames of the input are not free or not within limits; "
        f"{entry['changed_frames']} differ from the input in what was written."
    )
    parts = [f"<h2>How far it moved</h2><p class=soft>{changed}</p>"]
    for title, rows in (
        ("link", [[esc(one["name"]), esc(length(one["rms_m"])), esc(length(one["p95_m"]))] for one in links]),
        ("joint", [[esc(one["name"]), esc(angle(one["rms_rad"])), esc(angle(one["p95_rad"]))] for one in joints]),
    ):
        if rows:
            found = table([title, "root mean square", "95th percentile"], rows)
            parts.append(f"<details><summary>By {title}</summary>{found}</details>")
    return "\n".join(parts)


def _said(entry: Mapping[str, Any]) -> str:
    found = ""
    if entry["said"]:
        found = "<h2>Said</h2>\n<ul class=soft>" + "".join(f"<li>{esc(one)}</li>" for one in entry["said"]) + "</ul>"
    if entry["excluded"]:
        rows = [[esc(one["a"]), esc(one["b"]), esc(one["why"]), esc(length(one["depth_m"]))] for one in entry["excluded"]]
        pairs = table(["link or body", "and", "why", "deepest overlap"], rows)
        found += f"<details><summary>Pairs that are excluded from contact</summary>{pairs}</details>"
    return found


def replay(shown: Shown, moments: Sequence[Moment]) -> dict[str, object]:
    """What the viewer draws: surfaces, and poses of links as whole numbers of 16 bits."""
    avatar = shown.model.avatar
    assert avatar is not None
    surfaces = [surface_of(link.pieces) for link in avatar.links]
    drawn = [k for k, one in enumerate(surfaces) if len(one.triangles)]
    frames = len(shown.before)
    step = -(-frames * len(avatar.links) * 14 // NUMBERS)
    wanted = {*range(0, frames, max(step, 1)), frames - 1, *(one.frame for one in moments)}
    at = np.array(sorted(wanted))
    motions = []
    for motion in (shown.before, shown.after):
        motions.append(poses_of_links((avatar,), motion.positions[at], motion.rotations[at], motion.angles[at]))
    places = np.stack([places[:, drawn] for places, _ in motions])
    least = places.min(axis=(0, 1, 2)) if places.size else np.zeros(3)
    size = float(max((places.max(axis=(0, 1, 2)) - least).max(), 1e-3)) if places.size else 1.0
    # what is in view: the avatar at its widest, about its root
    radius = max((float(np.linalg.norm(surfaces[k].vertices, axis=1).max()) for k in drawn), default=0.0)
    extent = float(np.linalg.norm(places - places[:, :, :1], axis=-1).max()) + radius if places.size else 1.0
    coded = []
    for k, (_, turned) in enumerate(motions):
        whole = np.round((places[k] - least) / size * STEPS).astype("<u2")
        coded.append({"places": _base64(whole), "turns": _base64(np.round(turned[:, drawn] * UNIT).astype("<i2"))})
    return {
        "frames": at.tolist(), "seconds": [float(f"{t:.6g}") for t in shown.before.times[at] - shown.before.times[0]],
        "least": _rounded(least), "size": size, "extent": float(f"{extent:.3g}"),
        "links": [_surface(surfaces[k]) for k in drawn],
        "room": room_of([*shown.model.room, *shown.room]),
        "before": coded[0], "after": coded[1],
        "depths": [[float(f"{depth:.3g}") if depth > OVERLAP else 0 for depth in audit.depths[at]]
                   for audit in (shown.audit_before, shown.audit_after)],
        "first": moments[0].frame if moments else 0,
    }


def _base64(array: NDArray[Any]) -> str:
    return base64.b64encode(np.ascontiguousarray(array).tobytes()).decode()


def _rounded(array: Array) -> list[float]:
    return [float(f"{number:.6g}") for number in np.asarray(array).ravel()]


def _surface(one: Surface) -> dict[str, object]:
    return {"v": _rounded(one.vertices), "t": one.triangles.ravel().tolist()}


def room_of(bodies: Sequence[Body]) -> list[dict[str, object]]:
    """Surfaces of bodies in the world, drawn with fewer corners where there are many pieces; of very many the largest."""
    drawn = nlargest(PIECES, (_size(piece) for body in bodies for piece in body.pieces))
    least = min(drawn, default=0.0)
    most = int(np.clip(ROOM_CORNERS // max(len(drawn), 1), FEWEST, CORNERS))
    return [_placed(body, [piece for piece in body.pieces if _size(piece) >= least], most) for body in bodies]


def _size(piece: Piece) -> float:
    """Diagonal of a piece [m]."""
    return float(np.linalg.norm(np.ptp(corners(piece.shape), axis=0)))


def _placed(body: Body, pieces: Sequence[Piece], most: int) -> dict[str, object]:
    found = surface_of(pieces, most)
    vertices = rotation.rotate(np.array(body.orientation), found.vertices) + np.array(body.position)
    return _surface(Surface(vertices, found.triangles))
