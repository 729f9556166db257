"""Effects of scenes: which are simulated, what they cost, and what breaks without them."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from avatarsim.errors import InvalidFile
from avatarsim.files import read_json
from runfiles.published import MOST_BYTES

FILE = "ablation.json"


def effects(folder: Path) -> pd.DataFrame | None:
    """Read what each effect of a scene costs; None where nothing was tried.

    Returns:
        Columns scenario, effect, share (of the frame time, negative where the effect saves time), with_us, without_us [us],
        broken: metrics that get worse without it. Effects that a scene does not call for have no row.

    Raises:
        InvalidFile: for a damaged file.
    """
    path = folder / FILE
    if not path.exists():
        return None
    valid = "the whole file that one command wrote"
    data: Any = read_json(path, str(path), valid, MOST_BYTES)
    try:
        found = [_effect(line) for line in data["lines"] if line["share"] is not None]
    except (KeyError, TypeError, ValueError, IndexError, AttributeError, OverflowError) as error:
        raise InvalidFile(str(path), f"{type(error).__name__}: {error}", valid) from error
    return pd.DataFrame(found) if found else None


def _effect(line: Mapping[str, Any]) -> dict[str, object]:
    share = float(line["share"])
    if not share <= 1.0:
        raise ValueError(f"a share of {share} of the frame")
    return {
        "scenario": str(line["scenario"]),
        "effect": str(line["effect"]),
        "share": share,
        "with_us": float(line["with_us"]),
        "without_us": float(line["without_us"]),
        "broken": [str(name) for name, *_ in line["broken"]],
    }
