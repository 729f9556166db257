"""Arrays as text that a page can hold and a browser turns back into numbers: whole numbers of 16 bits in base64."""

import base64

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MISSING, LEAST, MOST = 0, 1, 65535
"""The code of what is no number, and the codes of the least and the greatest value."""


def text(values: NDArray[np.generic]) -> str:
    """Return the bytes of ``values``, little end first, as base64."""
    return base64.b64encode(np.ascontiguousarray(values).astype(values.dtype.newbyteorder("<")).tobytes()).decode("ascii")


def codes(values: Array, low: Array | float, high: Array | float) -> NDArray[np.uint16]:
    """Spread values evenly from LEAST at ``low`` to MOST at ``high``; MISSING for what is not finite."""
    share = (np.clip(np.where(np.isfinite(values), values, low), low, high) - low) / np.maximum(np.subtract(high, low), 1e-300)
    return np.asarray(np.where(np.isfinite(values), LEAST + np.rint(share * (MOST - LEAST)), MISSING), dtype=np.uint16)


def quaternions(values: Array) -> str:
    """Return unit quaternions (..., 4), each number to 3e-5."""
    return text(np.asarray(np.rint(np.clip(np.nan_to_num(values), -1.0, 1.0) * 32767.0), dtype=np.int16))
