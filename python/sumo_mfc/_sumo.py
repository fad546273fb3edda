"""Where SUMO is, and how this package is started as a program."""

import importlib.util
import os
import sys
from collections.abc import Iterable
from pathlib import Path


def command(files: Iterable[str] = ()) -> list[str]:
    """The words that start this package as a program, with the controllers of these files."""
    return [sys.executable, "-m", "sumo_mfc"] + [word for file in files for word in ("--load", file)]


def find() -> None:
    """Lets the SUMO of the extra ``[sumo]`` be found, unless the environment names another one."""
    if os.environ.get("SUMO_BINARY") or os.environ.get("SUMO_HOME"):
        return
    spec = importlib.util.find_spec("sumo")
    for folder in (spec.submodule_search_locations or []) if spec else []:
        if (Path(folder) / "bin" / "sumo").is_file():
            os.environ["SUMO_HOME"] = folder
            return
