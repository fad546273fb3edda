"""The command ``sumo-mfc``, also as ``python -m sumo_mfc``."""

import signal
import sys

from . import _core, _sumo


def main() -> int:
    """Does what the command line asks for, and returns the exit code."""
    # The command looks after signals itself; Python would answer Ctrl-C a second time.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    _sumo.find()
    return _core.main(sys.argv[1:], _sumo.COMMAND)


if __name__ == "__main__":
    sys.exit(main())
