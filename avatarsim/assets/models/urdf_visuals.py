"""Parts that pages draw of URDF files: their `<visual>` shapes, read when a page is drawn.

The loader blanks visuals, so that a visual mesh neither refuses a model nor takes time. A page compiles the file once
more, with visuals in place of collisions, and draws the colliding shapes where that fails.
"""

from collections.abc import Mapping
from pathlib import Path

from avatarsim.assets.models.compiled import compiled
from avatarsim.assets.models.pieces_of_geoms import Frames, Geoms, Visual
from avatarsim.errors import InvalidFile


def visuals_of_urdf(
    path: Path, folder: str | Path | None, scale: float, names: tuple[str, ...], frames: Mapping[str, Frames],
    own: Mapping[str, tuple[Visual, ...]],
) -> Mapping[str, tuple[Visual, ...]]:
    """Return the drawn parts of the links of a URDF file; `own` for links without visuals, and where visuals do not compile.

    Args:
        path: the file.
        folder: the folder of all of its files, as in `load_avatar`.
        scale: metres a unit of length.
        names: the names of the file's bodies.
        frames: the bodies of each scene name, and their frames relative to it.
        own: parts that are drawn without visuals.
    """
    try:
        model = compiled(path, folder, scale, "visual")
        if model.body_name != names:
            return own
        geoms = Geoms(model)
        found = {name: geoms.parts(of, [geom for body in of for geom in geoms.of(body)]) for name, of in frames.items()}
        return {**own, **{name: parts for name, parts in found.items() if parts}}
    except InvalidFile:
        return own
