"""Values as the library's texts have them: settings of an effect, groups of a scene."""
from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

_LONGEST = 65535  #: characters of a text that the library reads


def value_text(value: Any) -> str:
    """A number, a string, a bool, or an array of these, in namelist syntax. Every double is read back exactly."""
    if isinstance(value, str):
        return "'" + value.replace("'", "''") + "'"
    if isinstance(value, (bool, np.bool_)):
        return ".true." if value else ".false."
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    if isinstance(value, (Iterable, np.ndarray)):
        return ", ".join(value_text(v) for v in (value.ravel().tolist() if isinstance(value, np.ndarray) else value))
    raise TypeError(f"{value!r} is not a number, a string, a bool or an array of these")


def settings_text(keys: Mapping[str, Any]) -> str:
    """Keys and values of an effect in one text."""
    for key, value in keys.items():
        if isinstance(value, str) and set(value) & set(";'"):
            raise ValueError(f"{key} = {value!r}: strings of an effect must not contain quotes or semicolons")
    text = "; ".join(f"{key} = {value_text(value)}" for key, value in keys.items() if value is not None)
    if len(text) > _LONGEST:
        raise ValueError(f"the settings of this effect have {len(text)} characters; at most {_LONGEST} are allowed")
    return text


def scene_text(scene: Mapping[str, Any]) -> str:
    """A scene from a dict of groups, {"scene": {"t_end": 40}, "bodies": [{...}, {...}]}, as a namelist."""
    lines = []
    for name, groups in scene.items():
        several = [groups] if isinstance(groups, Mapping) else groups
        if not isinstance(several, Sequence) or not all(isinstance(group, Mapping) for group in several):
            raise TypeError(f"group {name!r} of a scene must be a dict of its keys, or a list of such dicts, not {groups!r}")
        for group in several:
            lines.append(f"&{name}")
            lines.extend(f"   {key} = {value_text(value)}" for key, value in group.items() if value is not None)
            lines.append("/")
    return "\n".join(lines) + "\n"
