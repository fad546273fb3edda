"""Results, which lie in folders."""

import html
import json
import os
import tempfile
from pathlib import Path
from typing import Any

from . import _core
from ._core import Error, Table


class Folder:
    """A result folder. One without a name of its own is deleted with this object."""

    def __init__(
        self, dir: Path, text: str = "", notes: list[str] | None = None, keep: tempfile.TemporaryDirectory[str] | None = None
    ) -> None:
        self.dir = dir
        #: What the command line prints at the end; empty for a result that was opened.
        self.text = text
        #: What the user should know.
        self.notes = notes or []
        self._keep = keep
        self._tables: dict[str, Table] = {}

    def table(self, name: str) -> Table:
        """A table of the folder by the name of its file without suffix, as ``schema.json`` describes it."""
        if name not in self._tables:
            self._tables[name] = _core.read_table(self.dir, name)
        return self._tables[name]

    def json(self, name: str) -> dict[str, Any]:
        """A JSON file of the folder."""
        try:
            read: dict[str, Any] = json.loads((self.dir / name).read_text(encoding="utf-8"))
        except OSError as error:
            raise Error(f"{self.dir / name}: {error.strerror}") from error
        return read

    def __repr__(self) -> str:
        return f"<sumo_mfc.{type(self).__name__} in {self.dir}>"

    def __str__(self) -> str:
        return self.text.rstrip() or repr(self)

    def _repr_html_(self) -> str:
        return f"<pre>{html.escape(str(self))}</pre>"


class Result(Folder):
    """The result of a run."""

    @property
    def vehicles(self) -> Table:
        """One row per ego that departed: its errors [m/s], times [s], torques [N·m], how it ended (``vehicles.csv``)."""
        return self.table(self._stem("vehicles", "vehicles"))

    @property
    def quality(self) -> Table:
        """Ratings of drive quality, comfort and work per ego (``quality.csv``)."""
        return self.table("quality")

    @property
    def trace(self) -> Table:
        """The traced egos over time (``trace.csv``); needs ``trace="all"`` or ids when the run is made."""
        return self.table(self._stem("trace", "trace_file"))

    @property
    def edges(self) -> Table:
        """Errors and mean speeds per edge (``edges.csv``)."""
        return self.table("edges")

    @property
    def sample(self) -> Table:
        """At most 200 egos, once a second (``sample.csv``)."""
        return self.table("sample")

    @property
    def summary(self) -> dict[str, Any]:
        """Counts, SUMO's totals, mean and quantiles of the fleet (``summary.json``)."""
        return self.json("summary.json")

    def _stem(self, name: str, key: str) -> str:
        """The table of vehicles and the trace may have been given another name."""
        files = self.json("schema.json")["files"]
        wanted = {"vehicles": "reason", "trace": "measured_speed"}[name]
        found = [file for file, about in files.items() if any(c["name"] == wanted for c in about.get("columns", []))]
        return found[0].rpartition(".")[0] if found else name

    def _repr_html_(self) -> str:
        summary = self.summary
        counts = ", ".join(f"{count} {html.escape(name)}" for name, count in summary["counts"].items() if count)
        names = ["mean", "p05", "p50", "p95", "max"]
        head = "".join(f"<th>{name}</th>" for name in ["", *names])
        rows = "".join(
            f"<tr><th>{html.escape(column)}</th>" + "".join(f"<td>{spread[name]:.4g}</td>" for name in names) + "</tr>"
            for column, spread in summary["fleet"].items()
        )
        place = html.escape(str(self.dir))
        return f"<p>{counts}<br>{place}</p><table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>"


class Study(Folder):
    """The result of a comparison or a sweep."""

    @property
    def comparison(self) -> Table:
        """One row per setting and metric: mean, interval, difference to the reference (``comparison.csv``)."""
        return self.table("comparison")

    @property
    def cases(self) -> Table:
        """One row per case: what was varied, seed, status, every metric (``cases.csv``)."""
        return self.table("cases")

    @property
    def vehicles(self) -> Table:
        """All vehicles of all cases (``vehicles.parquet``)."""
        return self.table("vehicles")


class Paper(Folder):
    """The paper's experiments, reproduced."""

    @property
    def results(self) -> Table:
        """One row per number that came out: test, preset, controller, quantity, value, the published value where there is one, and the
        verdict (``results.csv``)."""
        return self.table("results")

    @property
    def counts(self) -> Table:
        """One row per preset and recording: how many of the paper's numbers, facts and claims came out (``counts.csv``)."""
        return self.table("counts")


def open_result(dir: str | os.PathLike[str]) -> Result | Study:
    """Opens the folder of a run, a comparison or a sweep."""
    folder = Path(dir)
    if (folder / "study.json").is_file():
        return Study(folder)
    if (folder / "run.json").is_file():
        return Result(folder)
    raise Error(f"{folder}: found neither run.json nor study.json, wanted the folder of a run or of a study")


def place(out: str | os.PathLike[str] | None) -> tuple[Path, tempfile.TemporaryDirectory[str] | None]:
    """The folder that is asked for, or one that is deleted with the object that it is given to."""
    if out is not None:
        return Path(out), None
    keep = tempfile.TemporaryDirectory(prefix="sumo-mfc-", ignore_cleanup_errors=True)
    return Path(keep.name), keep
