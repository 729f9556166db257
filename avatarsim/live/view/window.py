"""A page that shows the records of the user's own loop."""

import time
import webbrowser
from types import TracebackType
from typing import Self

from avatarsim.engine import FrameRecord
from avatarsim.live.messages import State
from avatarsim.live.stages import Stage
from avatarsim.live.view.scene_meshes import DRAW_INTERVAL
from avatarsim.live.view.server import AdmittingServer
from avatarsim.live.view.worlds import Worlds
from avatarsim.scene.tracker import TrackerSample, checked, link_poses
from avatarsim.simulator import AvatarsimEngine


class Window:
    """A page in the browser that shows the records of the user's own loop, as a context manager.

    `server` is viser's: the user can add widgets and nodes to it. Raises InvalidInput for a port that is taken and for a scene
    without an avatar."""

    def __init__(self, engine: AvatarsimEngine, port: int = 8080, opens_browser: bool = True) -> None:
        self._scene = engine.scene
        stage = Stage(self._scene)
        self.server, self._last = AdmittingServer("127.0.0.1", port, "avatarsim"), 0.0
        self._meshes = self.server.do(lambda: Worlds(self.server, stage, [engine.name])).meshes[engine.name]
        if opens_browser:
            webbrowser.open(self.address)

    @property
    def address(self) -> str:
        """Address of the page."""
        return self.server.address

    def sync(self, record: FrameRecord, sample: TrackerSample | None = None) -> None:
        """Show a record, and with `sample` the user's own posture as a ghost. Returns at once, and skips records beyond 30 a
        second. Raises InvalidSample for a sample that does not fit."""
        if time.monotonic() - self._last >= DRAW_INTERVAL:
            self.sync_now(record, sample, wait=False)

    def sync_now(self, record: FrameRecord, sample: TrackerSample | None = None, wait: bool = True) -> None:
        """Show a record regardless of when the last one was shown; with `wait` return when it has been sent to viewers."""
        now = self._last = time.monotonic()
        ghost = None if sample is None else link_poses(self._scene.avatars, checked(sample, self._scene.avatars))
        shown = record.shown
        state = State(
            0, shown.time, shown.positions, shown.orientations, record.angles, 0, -1, 0, False, 0, 0, record.statuses,
            record.counts, record.stage_ns, "",
        )

        def draw() -> None:
            with self.server.atomic():
                if ghost is not None:
                    apart = self._meshes.show_ghost(*ghost, state)
                    self._meshes.see_through(apart)
                self._meshes.show(state, None, now)

        (self.server.do if wait else self.server.post)(draw)

    def close(self) -> None:
        """Stop the page."""
        self.server.stop()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()
