"""The command ``sumo-mfc``, also as ``python -m sumo_mfc``.

In front of its arguments ``--load FILE`` loads controllers, and ``--errors FILE`` is where an error leaves the places that it points
to.
"""

import signal
import sys

from . import _controllers, _core, _sumo


def main() -> int:
    """Does what the command line asks for, and returns the exit code."""
    words, files, errors = sys.argv[1:], [], None
    while words[:1] in (["--load"], ["--errors"]) and len(words) > 1:
        if words[0] == "--load":
            files.append(words[1])
        else:
            errors = words[1]
        words = words[2:]
    try:
        for file in files:
            _controllers.load(file)
    except _core.Error as error:
        print(f"Error: {error}", file=sys.stderr)
        return 1
    # The command looks after signals itself; Python would answer Ctrl-C a second time.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    _sumo.find()
    return _core.main(words, _sumo.command(files), errors)


if __name__ == "__main__":
    sys.exit(main())
