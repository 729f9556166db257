"""Options of a command for reading motions and models."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Reading:
    """Options of readers; None: as the file states, or as the reader guesses.

    scale, up       metres of a unit of length, and "y" or "z", of motions
    file_rate       frames a second of motions that state none [1/s]
    quaternion      "wxyz" or "xyzw"
    joints          names of a trajectory's joints, with commas between
    offsets         a file with the rest joints of a body, or "mean" (BVH)
    stature         [m] of a body without offsets
    asf             the skeleton of AMC motions
    home            of a recorded skeleton: a frame, a file, or a file and a frame with a colon between
    mass, limits    of a human of a recorded skeleton [kg], and False for joints without limits
    body            names of bodies whose trees are the avatar
    fix, root, leave, folder, meshes, repair, keyframe, collide, fit    of models, as in `load_avatar`
    exclude         pairs of names that never touch, each with a colon between
    avatar_scale    metres a unit of length of the avatar's model
    object_file, object_scale   file with the shape of the object that motions have poses of, and its metres a unit of length
    room_scale, room_up    of a room: metres a unit of length; of a mesh, the axis that points up"""

    scale: float | None = None
    up: str | None = None
    file_rate: float | None = None
    quaternion: str | None = None
    joints: str | None = None
    offsets: str | None = None
    stature: float | None = None
    asf: str | None = None
    home: str | None = None
    mass: float | None = None
    limits: bool = True
    fix: tuple[str, ...] = ()
    root: str | None = None
    leave: tuple[str, ...] = ()
    folder: str | None = None
    meshes: str | None = None
    repair: str | None = None
    avatar_scale: float | None = None
    room_scale: float | None = None
    room_up: str | None = None
    body: tuple[str, ...] = ()
    keyframe: str | None = None
    collide: str | None = None
    fit: float | None = None
    exclude: tuple[str, ...] = ()
    object_file: str | None = None
    object_scale: float | None = None

    def of_motion(self) -> dict[str, object]:
        """Return the options for readers of motions, by the readers' names."""
        options = {
            "scale": self.scale, "up": self.up, "rate": self.file_rate, "quaternion": self.quaternion, "joints": self.joints,
            "offsets": self.offsets, "stature": self.stature, "skeleton": self.asf,
            "home": self.home, "mass": self.mass, "limits": None if self.limits else False,
        }
        return {name: value for name, value in options.items() if value is not None}

    def of_avatar(self) -> dict[str, object]:
        """Return the options of `load_avatar`."""
        options = {"avatar": self.body, "fix": "all" if self.fix == ("all",) else self.fix, "leave": self.leave,
                 "exclude": tuple((a, b) for a, _, b in (pair.partition(":") for pair in self.exclude)),
                 "root": self.root, "scale": self.avatar_scale, **self._of_model()}
        return {name: value for name, value in options.items() if value}

    def _of_model(self) -> dict[str, object]:
        return {"folder": self.folder, "keyframe": self.keyframe, "collide": self.collide, "meshes": self.meshes,
                "repair": self.repair, "fit": self.fit}

    def of_room(self, is_model: bool, with_avatar: bool) -> dict[str, object]:
        """Return the options of `load_room`, for a model or a mesh; if `with_avatar`, the keyframe is of the avatar's file."""
        options = {"scale": self.room_scale, **self._of_model()}
        if with_avatar:
            options["keyframe"] = None
        if not is_model:
            options |= {"y_up": self.room_up == "y", "folder": None, "keyframe": None, "collide": None}
        return {name: value for name, value in options.items() if value}
