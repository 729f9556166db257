"""Values of measures: a number, or the reason why there is none; and the mark of a function that measures."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal, TypeVar


@dataclass(frozen=True)
class Missing:
    """No number, and the reason.

    `fault` names its cause.
    engine   it never did the measured thing (a ball that never came down): a bound on it has failed
    scene    the scene gives no occasion in the frames that were run: not measured
    package  a package that measures is not installed: not measured
    """

    reason: str
    fault: Literal["engine", "scene", "package"]


Value = float | Missing
Values = Mapping[str, Value]

Function = TypeVar("Function", bound=Callable[..., Values])


def measure(function: Function) -> Function:
    """Mark a function that measures: every recording is measured by all of them.

    Its parameters are among `recording`, `scenario` and `scene`; it returns values by metric, each of which has an entry in
    runfiles/metrics.toml, and nothing for a scene that it does not apply to.
    """
    function.measures = True  # type: ignore[attr-defined]
    return function
