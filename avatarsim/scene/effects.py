"""Which effects a scene calls for: derived once from its parts, narrowed by its author if they wish."""

from dataclasses import dataclass, fields, replace

from avatarsim.errors import InvalidScene


@dataclass(frozen=True)
class Effects:
    """One switch per effect; `frame.py` is the one place that looks at them."""

    overlap_removal: bool = True
    kinematics: bool = True
    self_contact: bool = True
    limits: bool = True
    reach_cones: bool = True
    coupling: bool = True
    dynamics: bool = True
    restitution: bool = True
    friction: bool = True
    gyroscopic: bool = True
    continuous: bool = True
    sleeping: bool = True

    def __post_init__(self) -> None:
        for switch in fields(self):
            value = getattr(self, switch.name)
            if not isinstance(value, bool):
                raise InvalidScene(f"effect {switch.name}", value, "True or False")

    def narrowed(self, *off: str) -> "Effects":
        """The same effects without those named in `off`."""
        return self._switched(off, False)

    def widened(self, *on: str) -> "Effects":
        """The same effects and those named in `on`."""
        return self._switched(on, True)

    def _switched(self, names: tuple[str, ...], on: bool) -> "Effects":
        known = [f.name for f in fields(self)]
        for name in names:
            if name not in known:
                raise InvalidScene("effect", name, "one of " + ", ".join(known))
        return replace(self, **dict.fromkeys(names, on))

    def missing_from(self, derived: "Effects") -> tuple[str, ...]:
        """Names of effects that `derived` has and this one lacks: what an author took away."""
        return tuple(f.name for f in fields(self) if getattr(derived, f.name) and not getattr(self, f.name))
