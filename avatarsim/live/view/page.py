"""The page and its rounds: events of pointers, keys and the panel, targets just before each frame, then drawing.

One thread owns driver and commands; callbacks in viser's own thread only put events in a queue (active object; Lavender and
Schmidt 1996). It sends targets a few milliseconds before the loop's next frame, so that they wait for nothing; drawing is done
by another thread, since the messages of a draw take several milliseconds.
"""

import queue
import re
import sys
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import viser
from numpy.typing import NDArray

from avatarsim.errors import AvatarsimError
from avatarsim.live.drive.driver import Driver
from avatarsim.live.messages import Order, Plan, State
from avatarsim.live.ports.protocol import Goals
from avatarsim.live.ports.server import Ports
from avatarsim.live.session import Driven, Session
from avatarsim.live.stages import Stage
from avatarsim.live.view.depth import LEAST, Depth, OwnOverlap, own_posture
from avatarsim.live.view.page_text import at_page, at_ports, numbers, overlapping, situation, table, timing, word_of
from avatarsim.live.view.panel import Panel
from avatarsim.live.view.scene_meshes import DRAW_INTERVAL, FLASHING, SceneMeshes
from avatarsim.live.view.server import AdmittingServer
from avatarsim.live.view.share import driven, filmed, shared_page
from avatarsim.live.view.worlds import Worlds
from avatarsim.scene.body import Role
from avatarsim.scene.motion import Motion
from avatarsim.scene.tracker import TrackerSample, link_poses

Array = NDArray[np.float64]
AHEAD = 3e-3
"""[s] before a frame at which its target is sent: a tick, a datagram and a late wake-up fit in. More: older targets."""
TURN = 5e-4
"""[s] after which a thread of this process releases Python's lock. Python's own 5 ms is longer than `AHEAD`, so that a target
would come a frame late; shorter: threads do little but switch."""
OVERLAP_INTERVAL, TIMING_INTERVAL = 0.125, 1.0
"""[s] between two measurements of overlaps, and between two of timing. Shorter: they take the time of drawing."""
NEWEST = 8
"""Largest number of states that a word is about: those of two drawings at the usual rates."""
WORD = 0.8
"""[s] Shortest time for which a word is shown. Shorter: it cannot be read."""
SOONEST = 1e-3
"""[s] Shortest wait, so that other threads have their turn."""
DEEPER = 2.0
"""[m] that a drag with shift over the height of the window moves a link away from the eye."""


@dataclass(frozen=True, eq=False)
class Shows:
    """Contents of a page: the session's stage, clips to play, the measure of penetration, folder and address, and the engines
    that are offered for comparison."""

    stage: Stage
    clips: Mapping[str, Motion]
    depth: Depth | None = None
    host: str = "127.0.0.1"
    port: int = 8080
    dark: bool = False
    folder: Path = Path(".")
    offered: Sequence[Plan] = ()


class Page:
    """The page of a session. Raises InvalidInput if its port is taken."""

    def __init__(self, session: Session, driver: Driver, shows: Shows) -> None:
        self.session, self.driver, self.shows = session, driver, shows
        self._events: queue.SimpleQueue[tuple[int, Callable[[], object]]] = queue.SimpleQueue()
        self._scene, self._overlap = session.scene, OwnOverlap(session.scene)
        self.server = AdmittingServer(shows.host, shows.port, "avatarsim live")
        self._names = {name: k for k, name in enumerate(self._scene.names)}
        self._offset = len(self._scene.bodies)
        self._loose = [k for k, body in enumerate(self._scene.bodies) if body.role is Role.SIMULATED]
        self._grabbed: dict[str, tuple[Array, Array, Array]] = {}
        self._tracked: set[str] = set()
        self._gizmos: dict[str, viser.TransformControlsHandle] = {}
        self._words: dict[str, tuple[str, float, int]] = {}
        self._apart, self._is_new = 0.0, True
        self.server.do(self._build)
        self._sample: TrackerSample = self._scene.first_sample
        self._stamp, self._is_over = 0, False
        self._ended: AvatarsimError | None = None
        self.ports: Ports | None = None

    def _build(self) -> None:
        """Build the contents of the page, in the server's thread."""
        self.worlds = Worlds(self.server, self.shows.stage, self.session.loops)
        self.panel = Panel(self.server, self, list(self.shows.clips), self.shows.dark)
        self._gizmos = self._make_gizmos()
        self.hint = self._make_hint()
        self._bind_drags()

    def _make_hint(self) -> viser.LabelHandle:
        """Return a label at the avatar with a hint, shown until the first action."""
        own = self._scene.avatars[0]
        places, _ = link_poses(self._scene.avatars, self._scene.first_sample)
        above = places[: len(own.links)].max(axis=0)
        text = "drag a hand into something, or walk: i j k l" if self.driver.period else "drag me into the table"
        return self.server.scene.add_label(
            "/hint", text, position=(*places[0, :2], above[2] + 0.1 * own.span), font_screen_scale=1.6, anchor="bottom-center"
        )

    @property
    def address(self) -> str:
        """Address in a browser."""
        return self.server.address

    @property
    def method(self) -> str:
        """First preset of the driven engine."""
        return self.session.first.plan.settings.preset

    def post(self, event: Callable[[], object], stamp: int = 0) -> None:
        """Run a callback in the page's own thread, before the next target; callable from any thread. `stamp` [ns] of the
        monotonic clock: arrival time of its cause, now by default."""
        self._events.put((stamp or time.monotonic_ns(), event))

    def track(self, found: TrackerSample | Goals, stamp: int, source: str) -> None:
        """Follow a tracker: a posture, or goals for links, of which missing ones are released."""
        self.post(lambda: self._by_tracker(found), stamp)

    def _by_tracker(self, found: TrackerSample | Goals) -> None:
        if isinstance(found, TrackerSample):
            self.driver.set_sample(found)
            return
        for name in self._tracked.difference(found.links):
            self.driver.release(name)
        self._tracked = set(found.links)
        for name, goal in found.links.items():
            self.driver.drag(name, goal.position, goal.orientation)

    def rounds(self, until: Callable[[], bool]) -> None:
        """Run until `until` returns True: targets in a thread of their own, drawing in this one. Raises LoopDied if the driven
        loop ends."""
        sys.setswitchinterval(TURN)
        hands = threading.Thread(target=self._lead, name="avatarsim targets", daemon=True)
        hands.start()
        drawn_at = measured = timed = 0.0
        try:
            while not until() and self._ended is None:
                now = time.monotonic()
                if now - measured >= OVERLAP_INTERVAL:
                    measured = now
                    self._show_overlaps()
                if now - timed >= TIMING_INTERVAL:
                    timed = now
                    self._time()
                self.server.do(self._draw)
                drawn_at = max(drawn_at + DRAW_INTERVAL, now)
                time.sleep(max(SOONEST, drawn_at + DRAW_INTERVAL - time.monotonic()))
        finally:
            self._is_over = True
            hands.join()
        if self._ended is not None:
            raise self._ended

    def _lead(self) -> None:
        """Send targets until the page ends; an error is raised in the thread that draws."""
        try:
            while not self._is_over:
                self._target()
        except AvatarsimError as error:
            self._ended = error

    def _target(self) -> None:
        """Wait until shortly before the next frame, and send its target."""
        first = self.session.look().get(self.session.first.plan.name)
        period, wait = 1.0 / self.session.first.plan.rate, SOONEST
        if first is not None:
            behind = time.monotonic() - 1e-9 * first.due
            # a paused loop publishes nothing: wait for its next frame instant
            wait = -AHEAD - behind if behind < -AHEAD else period - (behind + AHEAD) % period
        time.sleep(max(SOONEST, wait))
        self._stamp = time.monotonic_ns()
        self._drain()
        self._sample = self.driver.tick(period)
        self.session.send(self._sample, self._stamp)
        if self.ports is not None and first is not None:
            self.ports.publish(first)

    def _drain(self) -> None:
        """Run posted callbacks; the target takes the stamp of the oldest one."""
        while True:
            try:
                stamp, event = self._events.get_nowait()
            except queue.Empty:
                return
            self._stamp = min(self._stamp, stamp)
            try:
                event()
            except AvatarsimError as error:
                self.panel.show_message(str(error))

    def _draw(self) -> None:
        """Move all meshes objects to the newest states."""
        now, first = time.monotonic(), self.session.first.plan.name
        positions, orientations = link_poses(self._scene.avatars, self._sample)
        with self.server.atomic():
            for name, loop in list(self.session.loops.items()):
                meshes, state = self.worlds.meshes.get(name), loop.state
                if meshes is None or state is None:
                    continue
                if name == first:
                    self._apart = meshes.show_ghost(positions, orientations, state)
                meshes.show(state, loop.touching, now)
                self._show_action(name, meshes, loop.window.states(), now)
            for name, gizmo in self._gizmos.items():
                if name not in self._grabbed:
                    k = self._names[name] - self._offset
                    gizmo.position, gizmo.wxyz = positions[k], orientations[k]
            if self._is_new and self.driver.source != "still":
                self._is_new = self.hint.visible = False

    def _show_action(self, name: str, meshes: SceneMeshes, states: Sequence[State], now: float) -> None:
        """Show the avatar's current action in a word, for some time, with a flash if it is a new one."""
        word, end, seen = self._words.get(name, ("", 0.0, -1))
        touching = self.session.first.touching
        touches, apart = touching is not None and len(touching.contacts) > 0, self._apart
        news = [state for state in states[-NEWEST:] if state.frame >= seen]
        is_driven = name == self.session.first.plan.name
        found = word_of(news, apart, touches, self._offset, self._loose) if is_driven else ""
        if found and (found == word or now >= end or found == "bounces"):
            if found != word:
                meshes.show_word(found, now + FLASHING)
            word, end = found, now + WORD
        elif word and now >= end:
            word = ""
            meshes.show_word("")
        self._words[name] = (word, end, states[-1].frame if states else -1)

    def _show_overlaps(self) -> None:
        """Show overlaps, and the obstacle of the avatar."""
        depths, name = dict[str, float](), self.session.first.plan.name
        states = self.session.states
        first = states.get(name)
        if first is None:
            return
        wanted, target = own_posture(self._scene, self._sample, first.positions, first.orientations, first.angles), 0.0
        if self.shows.depth is not None:
            for one, state in states.items():
                depths[one] = self.shows.depth(self._scene, state.positions, state.orientations, state.angles)
            target = self.shows.depth(self._scene, *wanted)
        pair = self._overlap.at(*wanted)[1]
        overlap = overlapping(pair, self.driver.links) if pair is not None else ""
        heard = [situation(first, overlap), at_page(self.server.refusals)]
        if self.ports is not None:
            heard.append(at_ports(self.ports.refusals))
        colours = {one: meshes.colour for one, meshes in list(self.worlds.meshes.items())}
        depths = {one: found for one, found in depths.items() if one in colours}
        above, words = numbers(target, self._apart, depths, colours), "\n\n".join(filter(None, heard))
        self.server.do(lambda: self._write(above, words, depths, target))

    def _write(self, above: str, words: str, depths: Mapping[str, float], target: float) -> None:
        """Show numbers over the scene, words on the panel, and red for overlaps."""
        self.panel.show_numbers(above, words)
        first = self.session.first.plan.name
        for name, depth in depths.items():
            if name in self.worlds.meshes:
                self.worlds.meshes[name].mark(depth > LEAST, name == first and target > LEAST)
                self.worlds.meshes[name].see_through(self._apart)

    def _time(self) -> None:
        """Show the timing of all loops."""
        figures = {name: loop.window.figures() for name, loop in list(self.session.loops.items())}
        words = table(figures), timing(figures[self.session.first.plan.name])
        self.server.do(lambda: self.panel.time(*words))

    def _make_gizmos(self) -> dict[str, viser.TransformControlsHandle]:
        """Return a gizmo for each handle of the stage, for drags along axes and for turns."""
        made = {}
        for name in self.shows.stage.handles:
            gizmo = self.server.scene.add_transform_controls(
                f"/gizmos/{name}", scale=0.18, depth_test=False, opacity=0.8, visible=False
            )

            # async, so that phases keep their order
            async def moved(event: viser.TransformControlsEvent, name: str = name) -> None:
                position, turn, phase = np.array(event.target.position), np.array(event.target.wxyz), event.phase
                self.post(lambda: self._by_gizmo(name, phase, position, turn))

            gizmo.on_update(moved)
            made[name] = gizmo
        return made

    def _by_gizmo(self, name: str, phase: str, position: Array, turn: Array) -> None:
        if phase == "end":
            self._grabbed.pop(name, None)
            self.driver.release(name)
            return
        self._grabbed[name] = (position, position, position)
        self.driver.drag(name, position, turn)

    def _bind_drags(self) -> None:
        """Bind pointer drags of links: on the plane of the view, with shift away from the eye."""
        links = self.worlds.meshes[self.session.first.plan.name].links
        for name in self.driver.links:
            link = links.get(self._names[name])
            if link is None:
                continue

            async def dragged(event: viser.SceneNodeDragEvent[viser.MeshHandle], name: str = name) -> None:
                start, end = np.array(event.start_position), np.array(event.end_position)
                eye, down = np.array(event.client.camera.position), event.end_screen_pos[1] - event.start_screen_pos[1]
                phase, is_depth = event.phase, event.modifier == "shift"
                self.post(lambda: self._by_pointer(name, phase, start, end, eye, -down if is_depth else None))

            for mesh in link.meshes:
                mesh.on_drag("left")(dragged)
                mesh.on_drag("left", modifier="shift")(dragged)

    def _by_pointer(self, name: str, phase: str, start: Array, end: Array, eye: Array, up: float | None) -> None:
        """Drag a link: the grabbed point follows the pointer, whatever the link does meanwhile."""
        if phase == "end":
            self._grabbed.pop(name, None)
            self.driver.release(name)
            return
        if phase == "start" or name not in self._grabbed:
            state = self.session.first.state
            if state is None:
                return
            at = state.positions[self._names[name]]
            away = (start - eye) / max(1e-9, float(np.linalg.norm(start - eye)))
            self._grabbed[name] = (np.array(at), start, away)
        at, grabbed, away = self._grabbed[name]
        goal = at + (end - grabbed if up is None else DEEPER * up * away)
        self.driver.drag(name, goal, None)

    def compare(self, name: str) -> None:
        """Show an offered engine next to the driven one, from the start of the scene on; or end that."""
        if name in self.session.loops:
            self.session.leave(name)
            self.server.post(lambda: self._see_less(name))
            return
        plan = next(plan for plan in self.shows.offered if plan.name == name)
        self.panel.show_message(f"{name} is loading")
        threading.Thread(target=self._load, args=(plan,), name=f"avatarsim loads {name}", daemon=True).start()

    def _load(self, plan: Plan) -> None:
        """Load a loop, which may take seconds, and pass it to the thread of the targets."""
        loop = Driven(plan)
        try:
            loop.is_loaded()
        except AvatarsimError as error:
            loop.close()
            self.panel.show_message(str(error))
            return
        self.post(partial(self._join, loop))

    def _join(self, loop: Driven) -> None:
        """Add a loaded loop to the session and restart the scene, so that all engines get the same input."""
        self.session.join(loop)
        self.server.post(partial(self._see_more, loop.plan.name))
        self.session.command(Order.RESET)
        self.driver.reset()

    def _see_more(self, name: str) -> None:
        self.worlds.add(name)
        self.worlds.look_all("Home")
        self.panel.show_message("")

    def _see_less(self, name: str) -> None:
        self.worlds.remove(name)
        self.worlds.look_all("Home")

    def share(self, client: viser.ClientHandle) -> None:
        """Send a viewer an offline page of the last seconds; in a thread of its own, since each state is measured."""
        self._send(client, "html", lambda: shared_page(self._scene, driven(self.session), self.shows.stage.visuals))

    def film(self, client: viser.ClientHandle) -> None:
        """Send a viewer a moving picture of its view in the next seconds."""
        self._send(client, "gif", lambda: filmed(client, self.panel.show_message))

    def _send(self, client: viser.ClientHandle, suffix: str, make: Callable[[], bytes]) -> None:
        def work() -> None:
            try:
                content = make()
            except (AvatarsimError, RuntimeError) as error:
                # also if the viewer has gone
                self.panel.show_message(str(error))
                return
            name = f"{re.sub('[^a-zA-Z0-9]+', '-', self._scene.name)}.{suffix}"
            self.server.post(lambda: client.send_file_download(name, content, save_immediately=True))
            self.panel.show_message(f"{name}: {len(content) / 1e6:.1f} MB")

        self.panel.show_message("working ...")
        threading.Thread(target=work, name=f"avatarsim {suffix}", daemon=True).start()

    def see_gizmos(self, visible: bool) -> None:
        """Show the gizmos, or not."""
        for gizmo in self._gizmos.values():
            gizmo.visible = visible

    def close(self) -> None:
        """Stop the server of the page."""
        self.server.stop()
