"""Worlds of several engines side by side in one scene graph, and the eye that frames them."""

from collections.abc import Iterable
from itertools import count

import numpy as np
import viser

from avatarsim.live.stages import Stage
from avatarsim.live.view.cameras import FIELD, Camera, framed, world_spacing
from avatarsim.live.view.scene_meshes import SceneMeshes, surfaces_of
from avatarsim.scene.tracker import link_poses

UP = np.array((0.0, 0.0, 1.0))
"""Up in the world."""


class Worlds:
    """Worlds of engines by name, in the order in which they were added; each in a view of its own, next to the last one."""

    def __init__(self, server: viser.ViserServer, stage: Stage, names: Iterable[str]) -> None:
        scene = stage.scene
        self._server, self._scene = server, scene
        self._surfaces = surfaces_of(scene, stage.visuals)
        self._spacing, self.meshes = world_spacing(scene), dict[str, SceneMeshes]()
        self._labels: dict[str, viser.LabelHandle] = {}
        self._places, self._turns = link_poses(scene.avatars, scene.first_sample)
        server.scene.set_up_direction(UP)
        for name in names:
            self.add(name)
        seen, camera = self.camera("Home"), server.initial_camera
        camera.position, camera.look_at, camera.fov = seen.position, seen.look_at, FIELD

    def add(self, name: str) -> SceneMeshes:
        """Draw the world of one more engine."""
        used = {one.number for one in self.meshes.values()}
        number = next(k for k in count() if k not in used)
        self.meshes[name] = SceneMeshes(self._server, self._scene, name, number, self._surfaces, number * self._spacing)
        above = self._places[: len(self._scene.avatars[0].links)].max(axis=0) + 0.3 * self._scene.avatars[0].span * UP
        self._labels[name] = self._server.scene.add_label(
            f"/names/{name}", name, position=above + number * self._spacing, font_screen_scale=1.4, anchor="bottom-center"
        )
        self._see_names()
        return self.meshes[name]

    def remove(self, name: str) -> None:
        """Remove the world of an engine other than the first."""
        self.meshes.pop(name).remove()
        self._labels.pop(name).remove()
        self._see_names()

    def _see_names(self) -> None:
        """Show the names of engines above their worlds, if there are several."""
        for label in self._labels.values():
            label.visible = len(self.meshes) > 1

    def camera(self, view: str) -> Camera:
        """Return the camera of one of the views, on the first poses of the avatar."""
        avatar, numbers = self._scene.avatars[0], sorted(one.number for one in self.meshes.values())
        own = slice(len(avatar.links))
        return framed(avatar, self._places[own], self._turns[own], view, np.array(numbers)[:, None] * self._spacing)

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
