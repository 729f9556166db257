"""Files to share of a drive: an offline page with the player, whose worst moments are marked, or a moving picture."""

import io
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np
import viser

from avatarsim.assets.models.pieces_of_geoms import Visual
from avatarsim.clips.page.layout import data, esc, page, resource
from avatarsim.engine import FrameRecord
from avatarsim.errors import InvalidInput
from avatarsim.live.messages import Array, State
from avatarsim.live.recording import Frame, Recorded
from avatarsim.live.replaying import replay
from avatarsim.live.session import Session
from avatarsim.live.view.depth import LEAST, OwnOverlap, own_posture
from avatarsim.live.view.page_text import depth
from avatarsim.live.view.scene_meshes import DRAW_INTERVAL, FURNITURE, colour_of, room_colours, surfaces_of
from avatarsim.player import payload, three_js
from avatarsim.player.surfaces import surface
from avatarsim.scene.body import Body, Role
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, link_poses

SECONDS = 6.0
"""[s] of driving in a shared file: small enough for a mail."""
PATIENCE = 120.0
"""[s] after which a filmed viewer need not send more pictures: one that draws in software takes up to 20 s for each."""
PICTURE, PICTURES, FEWEST = (360, 560), 10.0, 6
"""Height and width [px] of a moving picture, its largest number of pictures a second, and the fewest of a slow viewer."""
START = 'startPlayer(document.getElementById("replay"), JSON.parse(document.getElementById("take").textContent));'
"""Script that starts the player."""


@dataclass(frozen=True, eq=False)
class Moment:
    """An instant of driving: `time` [s], the user's sample, and by engine positions (n, 3) [m], orientations (n, 4), angles."""

    time: float
    sample: TrackerSample
    shown: Mapping[str, tuple[Array, Array, Array]]


def driven(session: Session) -> list[Moment]:
    """Return the last seconds of a session. Raises InvalidInput before anything was driven."""
    samples = {target.number: target.sample for target in tuple(session.sent)}
    loops = {name: loop.window.states() for name, loop in list(session.loops.items())}
    lead = loops.pop(session.first.plan.name)
    begin = (lead[-1].time - SECONDS) if lead else 0.0
    found, last = list[Moment](), -1.0
    for state in lead:
        if state.time < begin or state.time - last < 0.9 * DRAW_INTERVAL or state.target not in samples:
            continue
        last = state.time
        others = {name: min(states, key=lambda one: abs(one.due - state.due)) for name, states in loops.items() if states}
        shown = {session.first.plan.name: state, **others}
        found.append(Moment(state.time, samples[state.target], {name: _poses(one) for name, one in shown.items()}))
    if not found:
        raise InvalidInput("states to share", 0, "at least 1: drive something first")
    return found


def _poses(state: State) -> tuple[Array, Array, Array]:
    return state.positions, state.orientations, state.angles


def recorded(found: Recorded) -> list[Moment]:
    """Run a recording again and return its moments. Raises the errors of `replay`, and InvalidInput for one without a frame."""
    samples = [row.sample for row in found.rows if isinstance(row, Frame)]
    step, made = max(1, round(found.plan.rate * DRAW_INTERVAL)), list[Moment]()

    def append(frame: int, record: FrameRecord) -> None:
        if (frame - 1) % step == 0:
            poses = record.shown.positions, record.shown.orientations, record.angles
            made.append(Moment(frame / found.plan.rate, samples[frame - 1], {found.plan.name: poses}))

    replay(found, append)
    if not made:
        raise InvalidInput("frames of the recording", 0, "at least 1")
    return made


def shared_page(scene: Scene, moments: Sequence[Moment], visuals: Mapping[str, tuple[Visual, ...]]) -> bytes:
    """Return a page that plays moments in a browser, without a server and without Python.

    Args:
        scene: driven scene.
        moments: in order of time, at least one.
        visuals: surfaces drawn in place of pieces, by names of the scene.
    """
    names, first = scene.names, len(scene.bodies)
    pieces = [body.pieces for body in scene.bodies] + [link.pieces for link in scene.links]
    surfaces = {name: surface(own) for name, own in zip(names, pieces, strict=True) if own} | surfaces_of(scene, visuals)
    is_fixed = [k < first and scene.bodies[k].role is Role.FIXED for k in range(len(names))]
    known = [k for k in range(len(names)) if names[k] in surfaces]
    moving, still = [k for k in known if not is_fixed[k]], [k for k in known if is_fixed[k]]
    number = {names[k]: at for at, k in enumerate([*moving, *still])}
    colours = room_colours([scene.bodies[k] for k in still])

    def role(k: int) -> str:
        if is_fixed[k]:
            return "furniture" if colours[names[k]] == FURNITURE else "fixed"
        return "simulated" if k < first else "driven"

    own = range(first, first + len(scene.avatars[0].links))
    engines, overlap = list(moments[0].shown), OwnOverlap(scene)
    wanted = [overlap.at(*own_posture(scene, one.sample, *one.shown[engines[0]])) for one in moments]
    views, said = [], [f"you {depth(max(found[0] for found in wanted))}"]
    for at, name in enumerate(engines):
        depths = [overlap.at(*one.shown[name]) for one in moments]
        said.append(f"{name} {depth(max(found[0] for found in depths))}")
        poses = payload.Poses(*(np.array([one.shown[name][part][moving] for one in moments]) for part in (0, 1)))
        red, green, blue = colour_of(at)
        views.append(payload.View(
            name, f"#{red:02x}{green:02x}{blue:02x}", poses, _captions(name, wanted, depths),
            {at: [pair] for at, pair in _pairs(depths, number).items()},
            _worst("you", wanted) * (at == 0) + _worst(name, depths),
        ))
    ghost = [link_poses(scene.avatars, one.sample) for one in moments]
    of_ghost = [k for k in moving if k in own]
    parts = [np.array([pair[part][[k - first for k in of_ghost]] for pair in ghost]) for part in (0, 1)]
    take = payload.payload(
        [payload.BodyMesh(role(k), surfaces[names[k]]) for k in (*moving, *still)],
        {len(moving) + at: _place(scene.bodies[k]) for at, k in enumerate(still)},
        np.array([one.time - moments[0].time for one in moments]), views, 0,
        ("you", [number[names[k]] for k in of_ghost], payload.Poses(parts[0], parts[1])), lambda *_: -2.3, name=scene.name,
        calm="no overlap", opens=int(np.argmax([found[0] for found in wanted])), ghost_overlaps=_pairs(wanted, number),
    )
    body = (
        f"<main><h1>{esc(scene.name)}</h1><p class=verdict><b>deepest overlap: {esc(', '.join(said))}</b></p>"
        f"<section id=replay data-state=none></section></main>{data('take', take)}"
    )
    scripts = [three_js.library() or "", resource("gif.js", "avatarsim.player"), resource("player.js", "avatarsim.player"), START]
    return page(scene.name, body, "\n".join(scripts), resource("player.css", "avatarsim.player"))


def _place(body: Body) -> tuple[Array, Array]:
    return np.array(body.position), np.array(body.orientation)


Deepest = tuple[float, tuple[str, str] | None]
"""Depth [m], and the pair that overlaps."""


def _captions(name: str, wanted: Sequence[Deepest], depths: Sequence[Deepest]) -> dict[int, tuple[str, str]]:
    return {
        at: (payload.OVERLAP if own > LEAST else payload.GHOST, f"you: {depth(you)} inside; {name}: {depth(own)}")
        for at, ((you, _), (own, _)) in enumerate(zip(wanted, depths, strict=True)) if max(you, own) > LEAST
    }


def _pairs(found: Iterable[Deepest], number: Mapping[str, int]) -> dict[int, tuple[int, int]]:
    """Return the overlapping pair by state."""
    return {at: (number[pair[0]], number[pair[1]]) for at, (_, pair) in enumerate(found) if pair and number.keys() >= set(pair)}


def _worst(name: str, found: Sequence[Deepest]) -> list[payload.Moment]:
    """Return the moment of the deepest overlap, if there is one."""
    at = int(np.argmax([depth for depth, _ in found]))
    metres, pair = found[at]
    if metres <= LEAST or pair is None:
        return []
    return [payload.Moment(at, f"{name}: {depth(metres)} inside, {pair[1]} in {pair[0]}", True)]


def filmed(client: viser.ClientHandle, progress: Callable[[str], object], seconds: float = SECONDS) -> bytes:
    """Return a GIF of a viewer's picture from now on; not to be called from the server's thread.

    A viewer that draws in software needs many seconds for a picture: it is given more time, for `FEWEST` pictures, and the GIF
    then plays faster than the scene.

    Args:
        client: viewer.
        progress: called with the progress in a line.
        seconds: length of the GIF.

    Raises:
        InvalidInput: if fewer than two pictures came in `PATIENCE`.
    """
    from PIL import Image

    frames, stamps, begin = list[Image.Image](), list[float](), time.monotonic()
    end = begin + PATIENCE
    with suppress(TimeoutError):
        # the first picture waits for the browser to compile its shaders
        client.get_render(*PICTURE, timeout=PATIENCE)
        begin = time.monotonic()
        while (now := time.monotonic()) < begin + seconds or len(frames) < FEWEST:
            frames.append(Image.fromarray(client.get_render(*PICTURE, timeout=max(0.0, end - now))[..., :3]))
            stamps.append(now)
            progress(f"recording: {len(frames)} pictures in {time.monotonic() - begin:.0f} s")
            time.sleep(max(0.0, now + 1.0 / PICTURES - time.monotonic()))
    if len(frames) < 2:
        raise InvalidInput("pictures of this browser", len(frames), f"at least 2 in {PATIENCE:.0f} s; *Share* needs none of it")
    stamps.append(time.monotonic())
    speed = min(1.0, seconds / (stamps[-1] - stamps[0]))
    file = io.BytesIO()
    durations = [round(1e3 * speed * (after - before)) for before, after in zip(stamps, stamps[1:], strict=False)]
    frames[0].save(file, "GIF", save_all=True, append_images=frames[1:], duration=durations, loop=0, optimize=True)
    return file.getvalue()
