"""The page and its rounds: events of pointers, keys and the panel in, targets out just before each frame, then what is shown.

One thread owns driver and commands; what viser calls from its own thread is only put in a queue (active object; Lavender and
Schmidt 1996). It hands targets over a few milliseconds before the loop's next frame, so that they wait for nothing; to draw is
the business of another thread, since the messages of a draw take several milliseconds.
"""

import asyncio
import queue
import sys
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import viser
from numpy.typing import NDArray

from avatarsim.errors import AvatarsimError, InvalidInput
from avatarsim.live.drive.driver import Driver
from avatarsim.live.messages import State
from avatarsim.live.ports.protocol import Goals
from avatarsim.live.ports.server import Ports
from avatarsim.live.session import Session
from avatarsim.live.stages import Stage
from avatarsim.live.view.depth import Depth, OwnOverlap
from avatarsim.live.view.drawn import Drawn
from avatarsim.live.view.panel import Panel
from avatarsim.live.view.server import AdmittingServer
from avatarsim.live.view.telling import at_page, at_ports, is_held, overlapping, sentence, table
from avatarsim.player.simplified import ROOM_TRIANGLES, drawn
from avatarsim.scene.motion import Motion
from avatarsim.scene.tracker import TrackerSample, link_poses

Array = NDArray[np.float64]
AHEAD = 3e-3
"""[s] before a frame at which its target is handed over: a tick, a datagram and a late wake-up fit in. More: older targets."""
TURN = 5e-4
"""[s] after which a thread of this process hands over Python's lock. Python's own 5 ms is longer than `AHEAD`, so that a target
would come a frame late; shorter: threads do little but change places."""
DRAWN, TOLD = 1.0 / 30.0, 0.25
"""[s] between two drawings, and between two looks at the figures, as fast as they can be read. Shorter: drawing takes all."""
SOONEST = 1e-3
"""[s] of a wait at least, so that other threads have their turn."""
UP = np.array((0.0, 0.0, 1.0))
"""Up in the world."""
DEEPER = 2.0
"""[m] that a drag with shift over the height of the window moves what is dragged away from the eye."""


@dataclass(frozen=True, eq=False)
class Shows:
    """What a page shows: the session's stage, clips to play, how penetration is measured, where it is served and saved."""

    stage: Stage
    clips: Mapping[str, Motion]
    depth: Depth | None = None
    host: str = "127.0.0.1"
    port: int = 8080
    dark: bool = False
    folder: Path = Path(".")


class Page:
    """The page of a session. Raises InvalidInput where its port is taken."""

    def __init__(self, session: Session, driver: Driver, shows: Shows) -> None:
        self.session, self.driver, self.shows = session, driver, shows
        self._events: queue.SimpleQueue[tuple[int, Callable[[], None]]] = queue.SimpleQueue()
        self._scene, self._overlap = session.scene, OwnOverlap(session.scene)
        try:
            self.server = AdmittingServer(shows.host, shows.port, "avatarsim live")
        except OSError as error:
            raise InvalidInput("port of the page", shows.port, f"a port that is free ({error.strerror})") from error
        self._names = {name: k for k, name in enumerate(self._scene.names)}
        self._offset = len(self._scene.bodies)
        self._grabbed: dict[str, tuple[Array, Array, Array]] = {}
        self._tracked: set[str] = set()
        self.drawn: dict[str, Drawn] = {}
        self._gizmos: dict[str, viser.TransformControlsHandle] = {}
        self._there(self._build)
        self._sample: TrackerSample = self._scene.first_sample
        self._stamp, self._is_over = 0, False
        self._ended: AvatarsimError | None = None
        self.ports: Ports | None = None

    def _build(self) -> None:
        """All that the page has, in the server's thread."""
        self.server.scene.set_up_direction(UP)
        camera, seen = self.server.initial_camera, self.shows.stage.camera
        camera.position, camera.look_at = np.asarray(seen.position), np.asarray(seen.look_at)
        visuals, names, first = self.shows.stage.visuals, self._scene.names, len(self._scene.bodies)
        surfaces = drawn(visuals, names[first:]) | drawn(visuals, names[:first], ROOM_TRIANGLES)
        for k, name in enumerate(self.session.loops):
            self.drawn[name] = Drawn(self.server, self._scene, name, k, surfaces)
            self.drawn[name].darken(self.shows.dark)
        self.panel = Panel(self.server, self, list(self.session.loops), list(self.shows.clips), self.shows.dark)
        self._gizmos = self._make_gizmos()
        self._bind_drags()

    def there(self, work: Callable[[], None]) -> None:
        """Have something done in the server's thread, soon. What is written from another one meets events of asyncio there that
        are made for one thread: with several viewers its buffers break."""
        self.server.get_event_loop().call_soon_threadsafe(work)

    def _there(self, work: Callable[[], None]) -> None:
        """The same, and wait until it is done."""
        async def done() -> None:
            work()

        asyncio.run_coroutine_threadsafe(done(), self.server.get_event_loop()).result()

    @property
    def address(self) -> str:
        """Where a browser finds it."""
        return f"http://{self.server.get_host()}:{self.server.get_port()}"

    @property
    def method(self) -> str:
        """The preset of the driven engine at first."""
        return self.session.first.plan.settings.preset

    def post(self, event: Callable[[], None], stamp: int = 0) -> None:
        """Have something done in the page's own thread, before the next target; from any thread. `stamp` [ns] of the monotonic
        clock: when what is behind it arrived, now by default."""
        self._events.put((stamp or time.monotonic_ns(), event))

    def track(self, found: TrackerSample | Goals, stamp: int, source: str) -> None:
        """Follow a tracker: a posture, or goals for links, of which those that are missing are let go."""
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
        """Go on until told otherwise: targets in a thread of their own, drawing in this one. Raises LoopDied where the driven
        loop ends."""
        sys.setswitchinterval(TURN)
        hands = threading.Thread(target=self._lead, name="avatarsim targets", daemon=True)
        hands.start()
        drawn = told = 0.0
        try:
            while not until() and self._ended is None:
                now = time.monotonic()
                if now - told >= TOLD:
                    told = now
                    self._tell()
                self._there(self._draw)
                drawn = max(drawn + DRAWN, now)
                time.sleep(max(SOONEST, drawn + DRAWN - time.monotonic()))
        finally:
            self._is_over = True
            hands.join()
        if self._ended is not None:
            raise self._ended

    def _lead(self) -> None:
        """Targets, one after the other, until the page ends; what ends it otherwise is raised where it is drawn."""
        try:
            while not self._is_over:
                self._target()
        except AvatarsimError as error:
            self._ended = error

    def _target(self) -> None:
        """Wait until shortly before the next frame, and hand its target over."""
        first = self.session.look().get(self.session.first.plan.name)
        period, wait = 1.0 / self.session.first.plan.rate, SOONEST
        if first is not None:
            behind = time.monotonic() - 1e-9 * first.due
            # a loop that says nothing, in a pause, is met at its next instant
            wait = -AHEAD - behind if behind < -AHEAD else period - (behind + AHEAD) % period
        time.sleep(max(SOONEST, wait))
        self._stamp = time.monotonic_ns()
        self._drain()
        self._sample = self.driver.tick(period)
        self.session.send(self._sample, self.driver.source, self._stamp)
        if self.ports is not None and first is not None:
            self.ports.publish(first)

    def _drain(self) -> None:
        """Do what has been posted; the oldest of it is as old as the target is."""
        while True:
            try:
                stamp, event = self._events.get_nowait()
            except queue.Empty:
                return
            self._stamp = min(self._stamp, stamp)
            try:
                event()
            except AvatarsimError as error:
                self.there(partial(self.panel.say, str(error)))

    def _draw(self) -> None:
        """Move all that is drawn to where the newest states have it."""
        states = self.session.states
        with self.server.atomic():
            for name, state in states.items():
                self.drawn[name].show(state, self.session.loops[name].touching)
            positions, orientations = link_poses(self._scene.avatars, self._sample)
            first = self.drawn[self.session.first.plan.name]
            first.show_ghost(positions, orientations)
            for name, gizmo in self._gizmos.items():
                if name not in self._grabbed:
                    k = self._names[name] - self._offset
                    gizmo.position, gizmo.wxyz = positions[k], orientations[k]

    def _tell(self) -> None:
        """Figures and depths."""
        states = self.session.states
        figures = {name: self.session.loops[name].figures() for name in states}
        depths, target = dict[str, float](), float("nan")
        if self.shows.depth is not None:
            for name, state in states.items():
                depths[name] = self.shows.depth(self._scene, state.positions, state.orientations, state.angles)
            first = states.get(self.session.first.plan.name)
            if first is not None:
                positions, orientations = link_poses(self._scene.avatars, self._sample)
                at, count = len(self._scene.bodies), len(self._scene.bodies) + len(positions)
                raw = np.array(first.positions), np.array(first.orientations)
                raw[0][at:count], raw[1][at:count] = positions, orientations
                target = self.shows.depth(self._scene, *raw, self._sample.angles)
        name = self.session.first.plan.name
        if name in states:
            heard = [sentence(states[name], figures[name], self._overlapping(states[name])), at_page(self.server.refusals)]
            if self.ports is not None:
                heard.append(at_ports(self.ports.refusals))
            rows, words = table(figures, depths, target), "\n\n".join(filter(None, heard))
            times = {n: [s.engine_ns for s in self.session.loops[n].states()] for n in states}
            self._there(lambda: self._write(rows, words, times, depths))

    def _overlapping(self, state: State) -> str:
        """What of the user's own posture overlaps, where that holds the avatar back."""
        pair = self._overlap.pair(self._sample) if is_held(state) else None
        return overlapping(pair, self.driver.links) if pair is not None else ""

    def _write(self, rows: str, words: str, times: Mapping[str, list[int]], depths: Mapping[str, float]) -> None:
        """Figures on the panel, and red for what overlaps."""
        self.panel.tell(rows, words)
        self.panel.plot(times)
        for name, depth in depths.items():
            self.drawn[name].mark(depth > 1e-6)

    def _make_gizmos(self) -> dict[str, viser.TransformControlsHandle]:
        """A gizmo for each handle of the stage, for drags along axes and for turns."""
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
        """Links are dragged by the pointer: on the plane of the view, with shift away from the eye."""
        links = self.drawn[self.session.first.plan.name].links
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
        """A drag of a link: what was grabbed follows the pointer, whatever the link does meanwhile."""
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

    def go_home(self, camera: viser.CameraHandle) -> None:
        """Bring the camera of a viewer back to the first view of the stage."""
        seen = self.shows.stage.camera
        camera.position, camera.look_at, camera.up_direction = np.array(seen.position), np.array(seen.look_at), UP

    def see_gizmos(self, visible: bool) -> None:
        """Show the gizmos, or not."""
        for gizmo in self._gizmos.values():
            gizmo.visible = visible

    def close(self) -> None:
        """The end of the page."""
        self.server.stop()
