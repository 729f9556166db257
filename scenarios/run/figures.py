"""The figures of a recording, as its own meta holds them: what was measured while all that happened inside frames was at hand."""

from collections.abc import Mapping

from avatarsim.errors import InvalidFile
from runfiles.record import Recording
from scenarios.measure.value import Missing, Value

FIGURES, NOTES = "figures", "notes"
"""Keys in the meta: value or (reason, fault) by metric; remarks by metric."""


def told(values: Mapping[str, Value], notes: Mapping[str, str]) -> dict[str, object]:
    """Figures and remarks, for a recording's meta."""
    kept = {name: [value.reason, value.fault] if isinstance(value, Missing) else float(value) for name, value in values.items()}
    return {FIGURES: kept, NOTES: dict(notes)}


def figures(recording: Recording) -> tuple[dict[str, Value], dict[str, str]]:
    """The same again. Raises InvalidFile where there are none, or others than this harness writes."""
    kept, notes = (recording.meta.get(name) for name in (FIGURES, NOTES))
    if not isinstance(kept, dict) or not isinstance(notes, dict) or len(recording.overlap) not in (0, len(recording.times)):
        raise InvalidFile("figures of a recording", type(kept).__name__, "those that the run measured")
    return {str(name): _value(name, value) for name, value in kept.items()}, {str(k): str(v) for k, v in notes.items()}


def _value(name: object, value: object) -> Value:
    """A figure; numbers that JSON has no word for are texts there (`runfiles.files.plain`)."""
    match value:
        case bool():
            pass
        case int() | float() | "NaN" | "Infinity" | "-Infinity":
            return float(value)
        case [str(reason), "engine" | "scene" | "package" as fault]:
            return Missing(reason, fault)
    raise InvalidFile(f"figure {name} of a recording", value, "a number, or why there is none and where the fault lies")
