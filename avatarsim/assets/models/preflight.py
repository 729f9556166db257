"""Checks of the names in a model file, before MuJoCo reads it: no entity, no plugin, no file outside one folder.

XML is scanned by expat, which knows nothing of models: the scan checks elements that name files and the numbers of `values`,
follows includes, and returns the bytes that it read with unused elements replaced by spaces: plugins that act on
bodies and joints, and of URDF either visuals or collisions. Only checked bytes are compiled (CWE-367, CWE-611, CWE-22).
"""

import os
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from xml.parsers import expat

from avatarsim.assets.models import values
from avatarsim.errors import InvalidFile
from avatarsim.files import read_bytes

XML_BYTES = 2**24
"""Bytes of all XML of a model together (16.8 MB). The largest known here has 2 MB. More: the compiler passes 1 GB."""

XML_FILES = 256
"""Most XML files of a model. The most known here is 40. More: a file that includes itself twice has no end."""

ELEMENTS = 200_000
"""Most XML elements of a model. A kitchen with its furniture has 3,000. More: the compiler takes minutes."""

DEEPEST_XML = 200
"""Deepest nesting of elements: twice the longest chain of bodies known here. More: MuJoCo's parser recurses as deep."""

CONVERSION = {
    ".pkl": "a pickle runs code of its author when it is opened: open it where you trust it, save an .xml, .urdf or mesh file",
    ".pickle": "as .pkl: open it where you trust it, and save an .xml, .urdf or mesh file",
    ".xacro": "`xacro robot.urdf.xacro > robot.urdf` writes a URDF file",
    ".sdf": "`gz sdf -p` reads it; export a URDF file, or an MJCF file",
    ".usd": "export an MJCF or URDF file", ".usda": "export an MJCF or URDF file", ".usdz": "export an MJCF or URDF file",
    ".fbx": "export a .glb file for a room, and BVH for a skeleton with its motion",
    ".mjb": "save the model as .xml: mj_saveLastXML",
}
"""Suffixes of common formats that are not read, with advice."""

MODELS = (".xml", ".mjcf", ".urdf")
"""Suffixes of model files."""

PARSED_WITH_FILES = {"include", "model"}
"""Elements whose file is XML and belongs to the model itself."""

FOREIGN = ("gazebo", "transmission", "ros2_control")
"""Elements below a URDF robot for other programs. MuJoCo does not read them, so it ignores their plugins."""

MOVED_BY_PLUGIN = ("actuator", "sensor", "body", "composite", "flexcomp")
"""Elements whose plugins act, measure or bend: without them bodies and joints are unchanged. Others make shapes."""

FILLERS = {"mujoco": b"<custom/>", **dict.fromkeys(("worldbody", "body", "frame", "replicate"), b"<frame/>")}
"""Content of an included file of which nothing is left, by the enclosing element. MuJoCo refuses empty files."""

COLLIDE = ("collision", "visual")
"""Shapes that bodies collide with: the file's collision shapes or its visual shapes."""

_COMMENT = re.compile(rb"<!--.*?-->|<\?xml\s[^>]*\?>", re.DOTALL)
_VISUAL = re.compile(rb"<(/?)visual(?=[\s/>])")
_END = re.compile(rb"</\w+\s*>\s*\Z")
_DRIVE = re.compile(r"^[A-Za-z]:[\\/]")


@dataclass(frozen=True)
class Texts:
    """The XML of a model: `main` is the path of the requested file, `texts` the bytes of all files, by path below `folder`.
    `plugins` are the names of removed plugins, `velocities` the limits of speed of URDF joints by name, `meshes` the files of
    MJCF meshes by name, as they are written; `is_robot` is True for URDF, `free_root` for URDF without a link named world, to
    which MuJoCo would fix it."""

    folder: Path
    main: str
    texts: Mapping[str, bytes]
    free_root: bool
    is_robot: bool = False
    plugins: tuple[str, ...] = ()
    velocities: Mapping[str, float] = field(default_factory=dict)
    meshes: Mapping[str, str] = field(default_factory=dict)

    @property
    def bytes(self) -> int:
        """Number of bytes of all XML."""
        return sum(map(len, self.texts.values()))


def folder_of(path: Path, folder: str | Path | None = None) -> Path:
    """Return the folder in which all files of a model must lie: `folder`, which must contain the file, or a default.
    This is the file's own folder, or for a URDF file that of its package: the nearest one above with a package.xml."""
    path = _real(path)
    if folder is not None:
        found = _real(Path(folder))
        if found not in path.parents:
            raise InvalidFile(f"folder of {path.name}", str(folder), f"a folder that the file lies in, such as {path.parent}")
        return found
    if path.suffix.lower() == ".urdf":
        for above in path.parents[:4]:
            if (above / "package.xml").is_file():
                return above
    return path.parent


def require_model(path: Path) -> None:
    """Raise InvalidFile for a file whose suffix is not that of a model, with advice."""
    ending = path.suffix.lower()
    if ending in CONVERSION:
        raise InvalidFile(f"format of {path.name}", ending, f"one of {' '.join(MODELS)}; {CONVERSION[ending]}")
    if ending not in MODELS:
        raise InvalidFile(f"format of {path.name}", ending, f"one of {' '.join(MODELS)}")


def texts_of(path: Path, folder: Path, collide: str = "collision") -> Texts:
    """Return the XML of a model and of all files that it includes, all of them in `folder`. Raises InvalidFile.

    Of URDF, `collide` selects the shapes, one of COLLIDE."""
    require_model(path)
    path = _real(path)
    if folder not in path.parents:
        raise InvalidFile(f"place of {path.name}", str(path), f"a file in {folder}")
    main = path.relative_to(folder).as_posix()
    texts: dict[str, bytes] = {}
    plugins: list[str] = []
    velocities: dict[str, float] = {}
    meshes: dict[str, str] = {}
    waiting: list[tuple[str, Path, tuple[values.Element, ...]]] = [(main, path, ())]
    left, free_root, is_robot = XML_BYTES, False, False
    while waiting:
        name, place, around = waiting.pop()
        if name in texts:
            continue
        if len(texts) == XML_FILES:
            raise InvalidFile(f"files of XML of {path.name}", f"more than {XML_FILES}", f"up to {XML_FILES}")
        texts[name] = _plain(read_bytes(place, f"model {name}", "a readable file of XML", left))
        left -= len(texts[name])
        scan = _Scan(name, PurePosixPath(main).parent, folder, collide, around)
        scan.read(texts[name])
        texts[name] = scan.blanked(texts[name])
        plugins += scan.plugins
        waiting += scan.included
        velocities |= scan.velocities
        meshes |= scan.meshes
        free_root |= name == main and scan.is_robot and not scan.has_world
        is_robot |= name == main and scan.is_robot
    return Texts(folder, main, texts, free_root, is_robot, tuple(dict.fromkeys(plugins)), velocities, meshes)


def _plain(content: bytes) -> bytes:
    """Return the text in UTF-8 without parts that expat rejects.
    These are comments, in which authors write invalid XML, declarations, which may not follow a comment, and final zero bytes."""
    return _COMMENT.sub(lambda match: b"\n" * match[0].count(b"\n"), content.rstrip(b"\0"))


class _Scan:
    """One file of XML, element by element, whose root is replaced by the elements `around` where another file includes it.

    `included` are the files of XML that it names: (path below the folder, path, elements around), `is_robot` is True for URDF and
    `has_world` if that has a link named world; `plugins` are the names of removed ones, `velocities` the limits of speed of its
    joints, and `meshes` files of MJCF meshes by name."""

    def __init__(
        self, name: str, main: PurePosixPath, folder: Path, collide: str, around: tuple[values.Element, ...] = ()
    ) -> None:
        self._name, self._main, self._folder, self._collide = name, main, folder, collide
        self._around = around
        self.plugins: list[str] = []
        self._links, self._seen = 0, frozenset[int]()
        self._blank: list[tuple[int, int]] = []
        self._blank_from = self._blank_depth = -1
        self._ended = False
        self._open: list[values.Element] = []
        self._elements = self._used = 0
        self.included: list[tuple[str, Path, tuple[values.Element, ...]]] = []
        self.velocities: dict[str, float] = {}
        self.meshes: dict[str, str] = {}
        self.is_robot = self.has_world = False
        # UTF-8 whatever the file declares, as MuJoCo's parser takes it
        self._parser = expat.ParserCreate("utf-8")
        self._parser.StartElementHandler = self._start
        self._parser.EndElementHandler = self._end
        # any next token ends a blanked element: text, and also what the compiler would read as text
        self._parser.CharacterDataHandler = self._next
        self._parser.StartCdataSectionHandler = self._next
        self._parser.ProcessingInstructionHandler = self._next
        self._parser.StartDoctypeDeclHandler = self._doctype
        self._parser.EntityDeclHandler = self._doctype

    def read(self, content: bytes) -> None:
        """Scan the whole text; InvalidFile for invalid XML or a forbidden name."""
        try:
            if self._collide == "visual":
                self._seen = _links_with_visuals(content, self._doctype)
            self._parser.Parse(content, True)
        except expat.ExpatError as error:
            raise InvalidFile(f"model {self._name}", f"cut off or not XML: {error}", "a whole file of XML in UTF-8") from error

    def blanked(self, content: bytes) -> bytes:
        """Return the text with unused elements replaced by spaces; line numbers are kept."""
        whole = bytearray(content)
        for first, last in self._blank:
            whole[first:last] = bytes(c if c in b"\r\n" else 32 for c in whole[first:last])
        if self.is_robot and self._collide == "visual":
            # in place of the collisions, which are blank: MuJoCo discards visuals
            return _VISUAL.sub(rb"<\1collision", bytes(whole))
        if self._around and self._used == 1:
            return _END.sub(FILLERS.get(self._around[-1].tag, b"") + rb"\g<0>", bytes(whole))
        return bytes(whole)

    def _settle(self) -> None:
        """Close a blanked element, whose last byte precedes the next token."""
        if self._ended:
            self._blank.append((self._blank_from, self._parser.CurrentByteIndex))
            self._blank_from, self._ended = -1, False

    def _is_left_out(self, tag: str, above: tuple[values.Element, ...]) -> bool:
        """Return True for an unused element below the elements `above`."""
        if not above:
            return False
        if above[0].tag == "robot":
            if above[-1].tag == "link" and tag in COLLIDE:
                # a link that has no visuals keeps its collisions
                return tag != self._collide and (tag == "visual" or self._links - 1 in self._seen)
            return tag == "material" or (len(above) == 1 and tag in FOREIGN)
        return tag == "extension" or (tag == "plugin" and above[-1].tag in MOVED_BY_PLUGIN)

    def _above(self) -> tuple[values.Element, ...]:
        """Return the elements that are open; the root of an included file gives way to those around it."""
        return (*self._around, *self._open[1:]) if self._around and self._open else tuple(self._open)

    def _place(self, what: str) -> str:
        return f"{what} in {self._name}, line {self._parser.CurrentLineNumber},"

    def _doctype(self, *declared: object) -> None:
        raise InvalidFile(self._place("DOCTYPE or entity"), declared[0], "XML without DOCTYPE and entities")

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        self._settle()
        self._elements += 1
        above, own = self._above(), values.Element(tag, attributes)
        self._open.append(own)
        if len(self._open) > DEEPEST_XML:
            raise InvalidFile(self._place("depth of elements"), len(self._open), f"up to {DEEPEST_XML}")
        if self._elements > ELEMENTS:
            raise InvalidFile(self._place("number of elements"), self._elements, f"up to {ELEMENTS}")
        self.is_robot |= not above and tag == "robot"
        self._links += tag == "link"
        self.has_world |= [one.tag for one in self._open] == ["robot", "link"] and attributes.get("name") == "world"
        if self._blank_from < 0 and self._is_left_out(tag, above):
            self._blank_from, self._blank_depth = self._parser.CurrentByteIndex, len(self._open) - 1
        if self._blank_from >= 0:
            if tag == "plugin" and above[0].tag != "robot":
                self.plugins.append(attributes.get("plugin") or attributes.get("instance") or "without a name")
            return
        self._used += 1
        values.require(self._place, above, own)
        if self.is_robot and tag == "limit" and above[-1].tag == "joint" and "velocity" in attributes:
            self.velocities[above[-1].attributes.get("name", "")] = float(attributes["velocity"])
        if tag == "mesh" and "file" in attributes:
            self.meshes[attributes.get("name") or PurePosixPath(attributes["file"]).stem] = attributes["file"]
        if tag == "plugin":
            name = attributes.get("plugin") or attributes.get("name") or attributes.get("instance") or ""
            raise InvalidFile(self._place("<plugin>"), name, "shapes without plugins: a plugin is code, which is not run here")
        if tag == "flexcomp" and "file" in attributes:
            raise InvalidFile(self._place("file of <flexcomp>"), attributes["file"], "rigid bodies; leave deformable ones out")
        for key, value in attributes.items():
            if key.startswith("file") or key in ("assetdir", "meshdir", "texturedir"):
                self._path(tag, key, value)

    def _next(self, *token: str) -> None:
        self._settle()

    def _end(self, tag: str) -> None:
        self._settle()
        self._open.pop()
        self._ended = self._blank_from >= 0 and len(self._open) == self._blank_depth

    def _path(self, tag: str, key: str, value: str) -> None:
        thing = self._place(f"{key} of <{tag}>")
        require_relative(thing, value)
        if tag in PARSED_WITH_FILES and key == "file":
            # as MuJoCo: relative to the requested model, else relative to the file that names it
            bases = dict.fromkeys([self._main, PurePosixPath(self._name).parent])
            name, place = existing(thing, [base / value for base in bases], self._folder)
            around = self._above()[:-1] if tag == "include" else ()
            self.included.append((name, place, around))
        elif key in ("assetdir", "meshdir"):
            inside(thing, self._main / value, self._folder)


def _links_with_visuals(content: bytes, refuse: Callable[..., None]) -> frozenset[int]:
    """Return the numbers, in their order, of elements called link that have one called visual; `refuse` is given a DOCTYPE."""
    parser = expat.ParserCreate("utf-8")
    parser.StartDoctypeDeclHandler = refuse
    links, above, found = 0, list[str](), set[int]()

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal links
        links += tag == "link"
        if tag == "visual" and above and above[-1] == "link":
            found.add(links - 1)
        above.append(tag)

    parser.StartElementHandler = start
    parser.EndElementHandler = lambda tag: above.pop()
    parser.Parse(content, True)
    return frozenset(found)


def require_relative(thing: str, value: str) -> None:
    """Raise InvalidFile for a path that is not relative to the model: absolute, in a home folder, on a drive, by a scheme."""
    scheme = value.partition("://")[0] if "://" in value else ""
    if value.startswith(("/", "\\", "~")) or _DRIVE.match(value) or scheme not in ("", "package", "model") or "\0" in value:
        raise InvalidFile(thing, value, "a path relative to the file, or package://")


def inside(thing: str, path: PurePosixPath, folder: Path) -> tuple[str, Path]:
    """Resolve a path below `folder`, links followed: its plain form and the place. Raises InvalidFile where it leads out."""
    plain: list[str] = []
    for part in path.parts:
        if part == "..":
            if not plain:
                raise InvalidFile(thing, str(path), _wider(folder, folder / path))
            plain.pop()
        elif part not in (".", ""):
            plain.append(part)
    name = "/".join(plain)
    place = _real(folder / name)
    if place != folder and folder not in place.parents:
        raise InvalidFile(thing, f"{path}, a link to {place}", _wider(folder, place))
    return name, place


def existing(thing: str, paths: list[PurePosixPath], folder: Path) -> tuple[str, Path]:
    """Return the first of `paths` that is a file in `folder`. Raises InvalidFile where one leads out, or none is there."""
    refused: InvalidFile | None = None
    for path in paths:
        try:
            name, place = inside(thing, path, folder)
        except InvalidFile as error:
            refused = refused or error
            continue
        if place.exists():
            return name, place
    raise refused or InvalidFile(thing, str(paths[0]), f"a file that exists in {folder}; folder=... names a wider one")


def _wider(folder: Path, place: Path) -> str:
    """Return the valid alternative to a path that leads to `place`, and how to allow it all the same."""
    wider = os.path.commonpath([folder, os.path.normpath(place)])
    return f'a path that stays in {folder}; folder="{wider}" allows it, if you trust what lies there'


def _real(path: Path) -> Path:
    """Return the path with all links followed. Raises InvalidFile for endless links and names that the system rejects."""
    try:
        return path.resolve()
    except (OSError, RuntimeError, ValueError) as error:
        raise InvalidFile("path", str(path), "a path that leads to a file") from error
