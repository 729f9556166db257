"""A swept setting as text to copy: a row for `--settings FILE.toml`, or command line or Python where no row can express it."""

import json

from scenarios.studies.settings.grid import Setting


def copyable(setting: Setting) -> str:
    """Return one line. A preset is named on the command line; options are a row that `scenarios.run.own_settings.read` takes;
    frames cut in parts and effects left out are written in Python."""
    parts = []
    if setting.options:
        row = ", ".join([f"preset = {_value(setting.base)}", *(f"{name} = {_value(v)}" for name, v in setting.options.items())])
        parts.append(f"{setting.engine}.{_value(setting.slug)} = {{{row}}}")
    elif setting.cut == 1 and not setting.narrow:
        return f"--engine {setting.engine} --preset {setting.base}"
    if setting.narrow:
        parts.append(f"replace(scene, narrow={setting.narrow!r})")
    if setting.cut > 1:
        parts.append(f"for _ in range({setting.cut}): engine.advance(sample, dt / {setting.cut})")
    return "; ".join(parts)


def _value(value: object) -> str:
    """Return `value` as TOML writes it; a float to the last digit."""
    if isinstance(value, tuple | list):
        return f"[{', '.join(_value(entry) for entry in value)}]"
    # true, "text", 3 and 0.004 are the same in JSON; a float needs its point or its exponent
    return repr(value) if isinstance(value, float) else json.dumps(value)
