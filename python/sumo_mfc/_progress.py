"""A bar of tqdm, where tqdm is installed and somebody looks at it."""

from collections.abc import Callable
from typing import Any

Watch = Callable[[float, float, float | None], None]


class Bar:
    """Simulated time."""

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

    def _show(self, begin: float, now: float, end: float | None) -> None:
        if self._bar is None:
            total = None if end is None else round(end - begin, 3)
            # None: no bar where stderr is no terminal; notebooks have their own.
            disable = None if self._wanted is None else False
            self._bar = self._make(total=total, unit="s", disable=disable, leave=False, bar_format=None)
        self._bar.update(round(now - begin, 3) - self._bar.n)

    def close(self) -> None:
        """Takes the bar away."""
        if self._bar is not None:
            self._bar.close()
