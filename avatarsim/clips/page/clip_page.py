"""The page of one clip: both motions in one view, overlap on a time line, and the moments worth seeing, the deepest first."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from heapq import nlargest
from itertools import islice
from pathlib import PurePosixPath
from typing import Any

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets.models.model import Model
from avatarsim.cleaning import Audit, Flagged
from avatarsim.cleaning.result import OVERLAP
from avatarsim.clips.page.layout import address, angle, data, esc, length, limit_excess, page, resource, table
from avatarsim.player import payload, surfaces, three_js
from avatarsim.player.simplified import ROOM_TRIANGLES, visual_surfaces
from avatarsim.scene.body import Body
from avatarsim.scene.carried import Carried, joined
from avatarsim.scene.motion import Motion
from avatarsim.scene.shape import Piece
from avatarsim.scene.tracker import poses_of_links
from avatarsim.spatial import rotation

Array = NDArray[np.float64]

NUMBERS = 2_000_000
"""Numbers of poses in a page: 4 MB, 5,000 frames of 30 links before and after. More: it opens too slowly. Longer clips show every
second frame, or every third."""
CORNERS, FEWEST, MOST, PIECES = 10_000, 8, 128, 1_000
"""Corners of the hulls of an avatar or a room together, fewest and most of one, those farthest in as many directions, and pieces
of a room at most. More: pages of clips are larger than their motions; fewer: hulls are drawn smaller than they are."""
AZIMUTH = -0.6
"""Azimuth of the camera at first [rad]."""
RUNS = 1_500
"""Marks of one kind on the time line at most; those that lie closer together than a pixel become one."""
THINNEST = 1.0 / 600.0
"""Least width of a mark, as a share of the line, so that a single frame is visible."""
GROUND_WIDTH = 20.0
"""Width [m] above which a body of the room is drawn as ground and not as furniture."""
MOMENTS = 120
"""Most moments with a button; the certificate has all."""


@dataclass(frozen=True, eq=False)
class Shown:
    """Content of a page: the avatar, the room and carried bodies, the input and the written motion, their measures, and flagged
    frames."""

    model: Model
    room: Model | None
    before: Motion
    after: Motion
    audit_before: Audit
    audit_after: Audit
    flagged: Sequence[Flagged]
    carried: Sequence[Carried] = ()


def clip_page(entry: Mapping[str, Any], shown: Shown, place: str) -> bytes:
    """Return the page of a clip; `place` is its path below the output folder, `entry` its part of the certificate."""
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
        time_line(shown),
        LEGEND,
        '<section id=replay data-state=none></section>',
        "" if moments else "<p class=soft>Nothing was flagged.</p>",
        "<h2>Measures</h2>",
        measures(entry),
        _moved(entry),
        _notes(entry),
        "</main>",
        data("clip", replay(name, shown, moments)),
    ])
    scripts = [resource("gif.js", "avatarsim.player"), resource("player.js", "avatarsim.player"), resource("clip.js")]
    library = "../" * (len(PurePosixPath(place).parts) - 2) + three_js.FILE
    return page(f"{name}: before and after", body, "".join(scripts), resource("player.css", "avatarsim.player"), library)


LEGEND = (
    '<p class=soft><span class="key red"></span>overlap, above before, below after <span class="key chord"></span>way to the '
    'next frame not certified <span class="key flag"></span>flagged. In the view the deepest pair of a frame in overlap is red, '
    'furniture brown.</p>'
)


def _rate(entry: Mapping[str, Any]) -> str:
    return "one posture" if entry["rate_hz"] is None else f'{entry["rate_hz"]:g} frames a second'


def moments_of(shown: Shown) -> list[payload.Moment]:
    """Return the deepest overlap before, the deepest after, and the flagged runs, in this order."""
    found = []
    for audit, when in ((shown.audit_before, "before"), (shown.audit_after, "after")):
        if audit.overlapping:
            pair = f", {audit.deepest_pair[0]} in {audit.deepest_pair[1]}" if audit.deepest_pair else ""
            said = f"deepest overlap {when}: {length(audit.deepest)}{pair}"
            found.append(payload.Moment(int(np.argmax(audit.depths)), said, True))
    for run in islice(shown.flagged, MOMENTS):
        pair = f": {run.pair[0]} and {run.pair[1]}" if run.pair else ""
        frames = f"frames {run.first} to {run.last}" if run.last > run.first else f"frame {run.first}"
        found.append(payload.Moment(run.first, f"{frames}, {run.why}{pair}"))
    return found


def runs(marked: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return (first, last) of the runs of marked frames; where there are more than RUNS, near ones are joined."""
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
    """Return two rows of marks over the frames, before and after, and flagged frames between them, as SVG."""
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
    """Return the table of measures, before and after."""
    rows = []

    def row(name: str, of: str, *cells: str) -> None:
        rows.append([esc(name), esc(of), *cells])

    both = ("before", "after")
    overlap, chords, limits = entry["overlap"], entry["between_frames"], entry["limits"]
    row("frames in overlap", f"of {entry['frames']}", *(_count(overlap[when]["frames"]) for when in both))
    row("deepest overlap", "by this program", *(esc(length(overlap[when]["deepest_m"])) for when in both))
    ways = (_count(chords[f"not_certified_{when}"]) for when in both)
    row("ways between frames not certified", f"of {chords['chords']}", *ways)
    opinions = [entry["second_opinion"][when] for when in both]
    by = next((one["by"] for one in opinions if one), None)
    if by:
        cells = [f"{length(one['frames_deepest_m'])} / {length(one['between_deepest_m'])}" if one else "—" for one in opinions]
        row("deepest overlap, in / between frames", f"second opinion, {by}", esc(cells[0]), esc(cells[1]))
    row("joints outside limits, most", "", *(esc(limit_excess(limits, when)) for when in both))
    jerk = entry["jerk_p95_m_s3"]
    for name, key in (("where the input is free", "where_free"), ("elsewhere", "elsewhere")):
        cells = [_per_cubed(jerk[when][key]) for when in both]
        row("jerk, 95th percentile", name, esc(cells[0]), esc(cells[1]))
    slides = [entry["foot_slide_m_s"][when] for when in both]
    row("foot slide", "mean over planted feet", *("—" if one is None else f"{one:.3f} m/s" for one in slides))
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
    if links:
        far = max(links, key=lambda one: float(one["most_m"]))
        changed += (
            f" No link is farther from the input than {length(far['most_m'])} ({far['name']}); the 95th percentile of the link "
            f"that moved most is {length(links[0]['p95_m'])} ({links[0]['name']})."
        )
    parts = [f"<h2>How far it moved</h2><p class=soft>{esc(changed)}</p>"]
    for title, rows in (
        ("link", [[esc(one["name"]), *(esc(length(one[name])) for name in ("rms_m", "p95_m", "most_m"))] for one in links]),
        ("joint", [[esc(one["name"]), esc(angle(one["rms_rad"])), esc(angle(one["p95_rad"]))] for one in joints]),
        ("slide", [[esc(one["name"]), esc(length(one["rms_m"])), esc(length(one["p95_m"]))] for one in entry["moved"]["slides"]]),
    ):
        if rows:
            found = table([title, "root mean square", "95th percentile", *(["largest"] if title == "link" else [])], rows)
            parts.append(f"<details><summary>By {title}</summary>{found}</details>")
    return "\n".join(parts)


def _notes(entry: Mapping[str, Any]) -> str:
    found = ""
    if entry["said"]:
        found = "<h2>Said</h2>\n<ul class=soft>" + "".join(f"<li>{esc(one)}</li>" for one in entry["said"]) + "</ul>"
    if entry["excluded"]:
        rows = [[esc(one["a"]), esc(one["b"]), esc(length(one["depth_m"]))] for one in entry["excluded"]]
        pairs = table(["link or body", "and", "deepest overlap"], rows)
        found += f"<details><summary>Pairs that are excluded from contact</summary>{pairs}</details>"
    if entry["at_rest"]:
        rows = [
            [esc(one["a"]), esc(one["b"]), esc(length(one["allowed_m"])), esc(length(one["depth_m"]))] for one in entry["at_rest"]
        ]
        pairs = table(["link or body", "and", "may overlap by", "deepest overlap"], rows)
        found += f"<details><summary>Pairs that overlap at home</summary>{pairs}</details>"
    return found


def replay(name: str, shown: Shown, moments: Sequence[payload.Moment]) -> dict[str, object]:
    """Return the player's data: the cleaned motion, the input as its ghost, the room, captions of frames in overlap."""
    avatar = shown.model.avatar
    assert avatar is not None
    avatars = (avatar, *(one.body for one in shown.carried))
    names, links = [name for one in avatars for name in one.link_names], [link for one in avatars for link in one.links]
    most = _corners(sum(len(link.pieces) for link in links))
    seen = visual_surfaces(shown.model.visuals, names)
    hulls = [surfaces.surface(link.pieces, most) for link in links]
    parts = [
        payload.BodyMesh("driven", seen.get(name, hull), hull if name in seen else None)
        for name, hull in zip(names, hulls, strict=True)
    ]
    moving = [k for k, part in enumerate(parts) if len(part.surface[1])]
    frames = len(shown.before)
    step = -(-frames * len(links) * 14 // NUMBERS)
    at = np.array(sorted({*range(0, frames, max(step, 1)), frames - 1, *(one.state for one in moments)}))
    both = []
    for motion in (joined(shown.before, shown.carried), joined(shown.after, shown.carried)):
        places, turns = poses_of_links(avatars, motion.positions[at], motion.rotations[at], motion.angles[at])
        both.append(payload.Poses(places[:, moving], turns[:, moving]))
    room = [body for model in (shown.model, shown.room) if model is not None for body in room_of(model)]
    own = sum(k < len(avatar.links) for k in moving)
    still = [body.name for model in (shown.model, shown.room) if model is not None for body in model.room]
    number = {name: n for n, name in enumerate([*(names[k] for k in moving), *still])}
    before, after = (overlapping(audit, number, at) for audit in (shown.audit_before, shown.audit_after))
    ghost = "before", range(own), payload.Poses(both[0].positions[:, :own], both[0].orientations[:, :own])
    view = payload.View(
        "after", "#7b9cc4", both[1], captions(shown, at), {k: [pair] for k, pair in after.items()},
        moments=[replace(one, state=int(np.searchsorted(at, one.state))) for one in moments],
    )
    return payload.payload(
        [*(parts[k] for k in moving), *room],
        {len(moving) + k: (np.zeros(3), np.array(rotation.IDENTITY)) for k in range(len(room))},
        shown.before.times[at] - shown.before.times[0], [view], 0, ghost, lambda *_: AZIMUTH,
        name=name, frames=at.tolist(), calm=_caption(0.0, 0.0), ground=True, opens=view.moments[0].state if moments else 0,
        ghost_overlaps=before,
    )


def overlapping(audit: Audit, number: Mapping[str, int], at: NDArray[np.int64]) -> dict[int, tuple[int, int]]:
    """Return the deepest pair of those frames ``at`` that overlap, by the place of the frame; bodies by their numbers."""
    found = ((k, audit.pairs[frame]) for k, frame in enumerate(at.tolist()) if frame < len(audit.pairs))
    return {k: (number[pair[0]], number[pair[1]]) for k, pair in found if pair and number.keys() >= set(pair)}


def captions(shown: Shown, at: NDArray[np.int64]) -> dict[int, tuple[str, str]]:
    """Return the captions of the frames ``at`` in which the input or the result overlaps, by their place."""
    depths = [np.where(audit.depths[at] > OVERLAP, audit.depths[at], 0.0) for audit in (shown.audit_before, shown.audit_after)]
    return {
        int(k): (payload.OVERLAP if depths[1][k] > 0.0 else payload.GHOST, _caption(*(float(each[k]) for each in depths)))
        for k in np.flatnonzero((depths[0] > 0.0) | (depths[1] > 0.0))
    }


def _caption(*depths: float) -> str:
    cells = (f"overlap {length(depth)}" if depth > 0.0 else "no overlap" for depth in depths)
    return ", ".join(f"{when}: {text}" for when, text in zip(("before", "after"), cells, strict=True))


def room_of(model: Model) -> list[payload.BodyMesh]:
    """Return the drawn bodies of a model's room, in the world frame.
    With many hulls each has fewer corners, and with very many the largest are drawn."""
    sizes = nlargest(PIECES, (_size(piece) for body in model.room for piece in body.pieces))
    least, most, found = min(sizes, default=0.0), _corners(len(sizes)), []
    seen = visual_surfaces(model.visuals, [body.name for body in model.room], ROOM_TRIANGLES)
    for body in model.room:
        def placed(surface: surfaces.Surface, body: Body = body) -> surfaces.Surface:
            return rotation.rotate(np.array(body.orientation), surface[0]) + np.array(body.position), surface[1]

        hull = placed(surfaces.surface([piece for piece in body.pieces if _size(piece) >= least], most))
        role = "fixed" if _is_ground(hull) else "furniture"
        found.append(payload.BodyMesh(role, placed(seen[body.name]), hull) if body.name in seen else payload.BodyMesh(role, hull))
    return found


def _is_ground(surface: surfaces.Surface) -> bool:
    """Return whether a body is level ground: wider than rooms are, on both sides."""
    return len(surface[0]) > 0 and bool((np.ptp(surface[0][:, :2], axis=0) > GROUND_WIDTH).all())


def _corners(pieces: int) -> int:
    """Return how many corners of a hull are drawn, of so many pieces."""
    return min(max(CORNERS // max(pieces, 1), FEWEST), MOST)


def _size(piece: Piece) -> float:
    """Return the diagonal of a piece [m]."""
    return float(np.linalg.norm(np.ptp(surfaces.corners(piece, MOST), axis=0)))
