"""What the tests share: the repository's scenarios, and the command that the wheel has installed."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).parents[2]
#: What `sumo-mfc` is called here: the script that the wheel has put beside Python.
COMMAND = Path(sys.executable).parent / "sumo-mfc"

CommandLine = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture
def straight() -> Path:
    """One car, 120 s."""
    return REPOSITORY / "scenarios" / "straight.toml"


@pytest.fixture
def city() -> Path:
    """A SUMO configuration with 800 vehicles in 600 s."""
    return REPOSITORY / "sumo_nets" / "city" / "city.sumocfg"


@pytest.fixture
def command_line() -> CommandLine:
    """Runs the installed command."""

    def run(*arguments: object) -> subprocess.CompletedProcess[str]:
        words = [str(word) for word in (COMMAND, *arguments)]
        return subprocess.run(words, capture_output=True, text=True, check=False, timeout=300)

    return run
