"""Keywords of Python as arguments of the command line, which checks them."""

import json
import os
from collections.abc import Iterable, Mapping
from typing import Any

from ._core import Error

#: Options whose several values stand in one argument.
JOINED = {"trace", "controllers", "seeds"}


def literal(value: Any) -> str:
    """A value as TOML."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (str, os.PathLike)):
        return json.dumps(os.fspath(value), ensure_ascii=False)
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{json.dumps(str(key))} = {literal(inner)}" for key, inner in value.items()) + " }"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(literal, value)) + "]"
    # Numbers, those of NumPy included. Python's shortest form of a float reads back as the same float.
    return str(value)


def keys(prefix: str, values: Mapping[str, Any]) -> Iterable[tuple[str, Any]]:
    """Keys by their TOML path: ``{"noise": {"power_db": 0}}`` is ``noise.power_db``."""
    for key, value in values.items():
        path = f"{prefix}.{key}" if prefix else key
        if isinstance(value, Mapping):
            yield from keys(path, value)
        else:
            yield path, value


def _values(values: Any) -> str:
    """Several values for one option."""
    if isinstance(values, str) or not isinstance(values, Iterable):
        return str(values)
    return ",".join(str(value).lower() if isinstance(value, bool) else str(value) for value in values)


def arguments(scenario: str | os.PathLike[str] | None, options: Mapping[str, Any]) -> list[str]:
    """The arguments that say the same.

    ``seed=1`` is ``--seed=1``, ``force=True`` is ``--force``; None and False are left out. Keys of the scenario are
    mappings, ``set={"controller.k_p": 1.2}`` or ``controller={"k_p": 1.2}``, or names with points.
    """
    words = [] if scenario is None else [os.fspath(scenario)]
    sumo_options: list[str] = []
    for name, value in options.items():
        flag = "--" + name.replace("_", "-")
        if value is None or value is False and "." not in name:
            continue
        if name == "sumo_options":
            sumo_options = [str(word) for word in value]
        elif name == "set":
            words += [f"--set={key}={literal(inner)}" for key, inner in keys("", value)]
        elif name == "vary":
            words += [f"--vary={key}={_values(values)}" for key, values in value.items()]
        elif name == "reference" and isinstance(value, Mapping):
            words += [f"--reference={key}={_values(chosen)}" for key, chosen in value.items()]
        elif name == "slurm":
            words += [f"--slurm={key}={asked}" for key, asked in value.items()]
        elif "." in name or isinstance(value, Mapping):
            pairs = keys(name, value) if isinstance(value, Mapping) else [(name, value)]
            words += [f"--set={key}={literal(inner)}" for key, inner in pairs]
        elif value is True:
            words.append(flag)
        elif name in JOINED:
            words.append(f"{flag}={_values(value)}")
        elif isinstance(value, (list, tuple)):
            words += [f"{flag}={os.fspath(one) if isinstance(one, os.PathLike) else one}" for one in value]
        else:
            words.append(f"{flag}={os.fspath(value) if isinstance(value, os.PathLike) else value}")
    return words + (["--", *sumo_options] if sumo_options else [])


def pairs(values: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Keys of the scenario with their values as TOML."""
    return [(key, literal(value)) for key, value in keys("", values)]


def section(name: str, value: Any, choice: str) -> dict[str, Any]:
    """A section given as the name of its choice, or as a mapping of its keys."""
    if value is None:
        return {}
    if isinstance(value, Mapping):
        return {name: value}
    if isinstance(value, str):
        return {name: {choice: value}}
    raise Error(f"{name}: found {value!r}, wanted a name or a mapping of keys")
