"""Arrays as text that a page can hold and a browser turns back into numbers: whole numbers of 16 bits in base64."""

import base64

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Stretch = tuple[float, float]
"""Least and greatest value that a packed array can hold."""

MISSING, LEAST, MOST = 0, 1, 65535
"""The code of what is no number, and the codes of the least and the greatest value."""


def text(values: NDArray[np.generic]) -> str:
    """The bytes of `values`, little end first, as base64."""
    return base64.b64encode(np.ascontiguousarray(values).astype(values.dtype.newbyteorder("<")).tobytes()).decode("ascii")


def reals(values: Array) -> str:
    """Any numbers, as 32 bits each."""
    return text(np.asarray(values, dtype=np.float32))


def codes(values: Array, stretch: Stretch) -> NDArray[np.uint16]:
    """Evenly from `stretch` into LEAST..MOST; beyond its ends, the ends; MISSING for what is not finite."""
    low, high = stretch
    share = (np.clip(np.where(np.isfinite(values), values, low), low, high) - low) / max(high - low, 1e-300)
    found = LEAST + np.rint(share * (MOST - LEAST))
    return np.asarray(np.where(np.isfinite(values), found, MISSING), dtype=np.uint16)


def quaternions(values: Array) -> str:
    """Unit quaternions (..., 4), each number to 3e-5."""
    return text(np.asarray(np.rint(np.clip(np.nan_to_num(values), -1.0, 1.0) * 32767.0), dtype=np.int16))


def unpacked(packed: str, stretch: Stretch) -> Array:
    """The numbers again, nan where one is missing: what a page does, for tests."""
    found = np.frombuffer(base64.b64decode(packed), dtype="<u2").astype(np.float64)
    low, high = stretch
    return np.asarray(np.where(found == MISSING, np.nan, low + (found - LEAST) / (MOST - LEAST) * (high - low)))
