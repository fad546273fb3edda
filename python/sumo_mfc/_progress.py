"""A bar of tqdm, where tqdm is installed and somebody looks at it."""

import re
from collections.abc import Callable
from typing import Any

Watch = Callable[[float, float, float | None], None]

#: What the command line tells of a case that has ended.
ENDED = re.compile(r"\[(\d+)/(\d+)\] ")


class Bar:
    """Simulated time of a run, or ended cases of a study."""

    def __init__(self, wanted: bool | None) -> None:
        self._make: Any = None
        self._bar: Any = None
        self._wanted = wanted
        if wanted is not False:
            try:
                from tqdm.auto import tqdm
            except ImportError:
                return
            self._make = tqdm

    @property
    def watch(self) -> Watch | None:
        """What is called with begin, now and end [s]."""
        return self._show if self._make else None

    def take(self, line: str) -> bool:
        """Shows what a study tells of its cases; False if the line is to be printed."""
        ended = ENDED.match(line)
        if ended is None or self._make is None:
            return False
        self._move(int(ended[1]), int(ended[2]), "case")
        return not self._bar.disable

    def _show(self, begin: float, now: float, end: float | None) -> None:
        self._move(round(now - begin, 3), None if end is None else round(end - begin, 3), "s")

    def _move(self, done: float, total: float | None, unit: str) -> None:
        if self._bar is None:
            # None: no bar where stderr is no terminal; notebooks have their own.
            disable = None if self._wanted is None else False
            self._bar = self._make(total=total, unit=unit, disable=disable, leave=False)
        self._bar.update(done - self._bar.n)

    def close(self) -> None:
        """Takes the bar away."""
        if self._bar is not None:
            self._bar.close()
