"""A recorded figure whose skeleton is folded at rest, and a clip of it."""

from pathlib import Path

import numpy as np

from tests.assets.motions.files import bvh, end, joint, root

FRAMES = 30


def hierarchy(shin: float = 0.42, shank: str = "Leg", more: str = "", channels: str = "ZXY") -> str:
    """Return a figure of 1.6 m, y up, whose legs are folded up along its trunk at rest."""
    legs = [
        joint(f"{side}UpLeg", f"{x} 0 0", "ZXY", joint(
            f"{side}{shank}", "0 0.42 0", channels, joint(f"{side}Foot", f"0 {shin} 0", "ZXY", end("0 0 0.15")),
        )) for side, x in (("Left", 0.09), ("Right", -0.09))
    ]
    return root("Hips", "ZXY", joint("Spine", "0 0.1 0", "ZXY", joint("Head", "0 0.45 0", "ZXY", end("0 0.25 0"))), *legs, more)


def rows(columns: int = 30) -> np.ndarray:
    """Return rows with legs turned down, which cross in the middle of the clip, on a trunk that sways."""
    values, share = np.zeros((FRAMES, columns)), np.linspace(0.0, 1.0, FRAMES)
    values[:, 1] = 1.0
    values[:, 6] = 25.0 * np.cos(4.0 * share + 0.3)
    for first, sign in ((12, -1.0), (21, 1.0)):
        values[:, first] = sign * 14.0 * np.sin(np.pi * share) ** 2
        values[:, first + 1] = 180.0
    return values


def written(folder: Path, name: str, values: np.ndarray, text: str = hierarchy()) -> Path:
    (folder / name).write_text(bvh(text, values))
    return folder / name
