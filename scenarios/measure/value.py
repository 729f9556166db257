"""Values of measures: a number, or the reason why there is none."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Missing:
    """No number, and why. `fault` says whose doing it is:

    engine   it never did what was to be measured (a ball that never came down): a bound on it has failed
    scene    the scene gives no occasion in the frames that were run: not measured
    package  something that measures is not installed: not measured
    """

    reason: str
    fault: Literal["engine", "scene", "package"]


Value = float | Missing
Values = Mapping[str, Value]
