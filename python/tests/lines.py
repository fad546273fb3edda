"""Prints the Python blocks of a page, one behind the other: python3 python/tests/lines.py README.md."""

import re
import sys
from pathlib import Path

REPOSITORY = Path(__file__).parents[2]


def lines(page: str) -> str:
    """The Python blocks of a page, as one text."""
    text = (REPOSITORY / page).read_text(encoding="utf-8")
    return "\n".join(re.findall(r"^```python.*?\n(.*?)^```", text, re.MULTILINE | re.DOTALL))


if __name__ == "__main__":
    print(lines(sys.argv[1]), end="")
