"""Worlds of several engines side by side in one scene graph, and the eye that frames them."""

from collections.abc import Iterable

import numpy as np
import viser

from avatarsim.live.stages import Stage
from avatarsim.live.view.cameras import FIELD, Camera, beside, framed
from avatarsim.live.view.drawn import Drawn
from avatarsim.player.simplified import ROOM_TRIANGLES, drawn
from avatarsim.scene.tracker import link_poses

UP = np.array((0.0, 0.0, 1.0))
"""Up in the world."""


class Worlds:
    """The worlds of engines, by name, in the order in which they were added; each in a view of its own, beside the last one."""

    def __init__(self, server: viser.ViserServer, stage: Stage, names: Iterable[str]) -> None:
        scene, first = stage.scene, len(stage.scene.bodies)
        self._server, self._scene = server, scene
        self._surfaces = drawn(stage.visuals, scene.names[first:]) | drawn(stage.visuals, scene.names[:first], ROOM_TRIANGLES)
        self._beside, self.drawn = beside(scene), dict[str, Drawn]()
        self._labels: dict[str, viser.LabelHandle] = {}
        self._places, self._turns = link_poses(scene.avatars, scene.first_sample)
        server.scene.set_up_direction(UP)
        for name in names:
            self.add(name)
        seen, camera = self.camera("Home"), server.initial_camera
        camera.position, camera.look_at, camera.fov = seen.position, seen.look_at, FIELD

    def add(self, name: str) -> Drawn:
        """Draw the world of one more engine."""
        number = len(self.drawn)
        self.drawn[name] = Drawn(self._server, self._scene, name, number, self._surfaces, number * self._beside)
        if number == 1:
            self._name(next(iter(self.drawn)), 0)
        if number:
            self._name(name, number)
        return self.drawn[name]

    def _name(self, name: str, number: int) -> None:
        """Write the name of an engine above its world."""
        above = self._places.mean(axis=0) + number * self._beside + 0.9 * self._scene.avatars[0].span * UP
        self._labels[name] = self._server.scene.add_label(
            f"/names/{name}", name, position=above, font_screen_scale=1.4, anchor="bottom-center"
        )

    def remove(self, name: str) -> None:
        """Remove the world of an engine other than the first."""
        self.drawn.pop(name).remove()
        if len(self.drawn) == 1:
            name = next(iter(self.drawn))
        for one in {name, *(other for other in self._labels if other not in self.drawn)}:
            if one in self._labels:
                self._labels.pop(one).remove()

    def camera(self, view: str) -> Camera:
        """Return the camera of one of the views, on the first poses of the avatar."""
        avatar, count = self._scene.avatars[0], max(1, len(self.drawn))
        own = slice(len(avatar.links))
        return framed(avatar, self._places[own], self._turns[own], view, np.arange(count)[:, None] * self._beside)

    def look(self, camera: viser.CameraHandle, view: str) -> None:
        """Give a viewer one of the views."""
        seen = self.camera(view)
        camera.position, camera.look_at, camera.up_direction = seen.position, seen.look_at, UP

    def look_all(self, view: str) -> None:
        """Give all viewers, and those to come, one of the views."""
        seen, first = self.camera(view), self._server.initial_camera
        first.position, first.look_at = seen.position, seen.look_at
        for client in self._server.get_clients().values():
            self.look(client.camera, view)
