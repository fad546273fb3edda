"""Runs, studies, reports: what the command line does, with results as objects."""

import json
import os
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from . import _controllers, _core, _sumo
from ._arguments import arguments
from ._core import Error, Plan
from ._progress import Bar
from ._results import Paper, Result, Study, place

Scenario = str | os.PathLike[str] | None


def tell(notes: list[str], quiet: bool) -> None:
    """Notes, as the command line tells them."""
    for note in [] if quiet else notes:
        print(f"note: {note}", file=sys.stderr)


def run(
    scenario: Scenario = None,
    *,
    out: str | os.PathLike[str] | None = None,
    quiet: bool = False,
    progress: bool | None = None,
    **options: Any,
) -> Result:
    """Runs a scenario (.toml) or any SUMO configuration (.sumocfg) to its end, in this process.

    ``options`` are those of ``sumo-mfc run`` with ``_`` for ``-``: ``controller="pid"``, ``egos="share:0.25"``, ``seed=1``,
    ``end=600``, ``trace="all"``, ``no_report=True``. Keys of the scenario are mappings: ``set={"controller.k_p": 1.2}`` by
    their paths, or ``actuator={"delay_s": 0.2}`` by their section.

    ``out`` is the folder of the result; without it the result is deleted with the object that is returned. ``quiet`` tells
    no notes, ``progress=False`` shows no bar. Ctrl-C ends the run; a result in ``out`` is then marked incomplete.

    Raises ``Error`` with what the command line would say.
    """
    _controllers.files(())
    _sumo.find()
    folder, keep = place(out)
    plan = Plan(arguments(scenario, {**options, "out": folder}))
    tell(plan.notes, quiet)
    bar = Bar(False if quiet else progress)
    try:
        dir, text, notes = plan.run(bar.watch)
    finally:
        bar.close()
    tell(notes, quiet)
    return Result(dir, text, [*plan.notes, *notes], keep)


def check(scenario: Scenario = None, **options: Any) -> str:
    """The resolved scenario in SI units, as TOML; ``options`` as for ``run``. Nothing is run."""
    _sumo.find()
    return Plan(arguments(scenario, options)).toml()


def compare(
    scenario: Scenario = None,
    controllers: Sequence[str] = ("ideal", "classic", "adaptive", "pid"),
    *,
    seeds: str | Sequence[int] | None = None,
    out: str | os.PathLike[str] | None = None,
    quiet: bool = False,
    progress: bool | None = None,
    **options: Any,
) -> Study:
    """Runs a scenario with several controllers on the same traffic; differences are to the first.

    ``seeds`` are numbers, or ``"1..10"`` with both ends; ``jobs`` is how many cases run at the same time. Other options are
    those of ``sumo-mfc compare``; ``out``, ``quiet``, ``progress`` and errors are as for ``run``. Cases are processes of their own. With
    ``out``, the same call after Ctrl-C goes on where it was stopped.
    """
    return _study("compare", scenario, out, quiet, progress, {"controllers": controllers, "seeds": seeds, **options})


def sweep(
    scenario: Scenario = None,
    vary: Mapping[str, Any] | None = None,
    *,
    seeds: str | Sequence[int] | None = None,
    reference: Mapping[str, Any] | None = None,
    out: str | os.PathLike[str] | None = None,
    quiet: bool = False,
    progress: bool | None = None,
    **options: Any,
) -> Study:
    """Runs a study file, or a scenario under all combinations of the values of some keys.

    ``vary={"actuator.delay_s": [0, 0.2], "controller.name": ["ideal", "pid"]}`` makes four settings;
    ``reference={"controller.name": "ideal"}`` is what the others are compared with. All else is as for ``compare``.
    """
    return _study("sweep", scenario, out, quiet, progress, {"vary": vary, "seeds": seeds, "reference": reference, **options})


def _study(
    command: str,
    scenario: Scenario,
    out: str | os.PathLike[str] | None,
    quiet: bool,
    progress: bool | None,
    options: Mapping[str, Any],
) -> Study:
    folder, keep = place(out)
    bar = Bar(False if quiet else progress)
    try:
        text = call([command, *arguments(scenario, {**options, "out": folder})], quiet, bar)
    finally:
        bar.close()
    return Study(folder, text, keep=keep)


def report(
    *dirs: str | os.PathLike[str], out: str | os.PathLike[str] | None = None, vehicle: str | None = None
) -> Path:
    """Writes one HTML page of a result folder, or of two side by side, and returns its path."""
    folders = [Path(dir) for dir in dirs]
    return Path(_core.report(folders, None if out is None else Path(out), vehicle))


def paper(
    test: str = "all", *, out: str | os.PathLike[str] | None = None, quiet: bool = False, **options: Any
) -> Paper:
    """Reproduces an experiment of the paper, without SUMO: ``step``, ``sine``, ``driver``, ``delay``, ``disturb``, ``map``, or
    ``all`` but the map.

    ``options`` are those of ``sumo-mfc paper``: ``preset="default"``. ``results`` has every number beside the published one with its
    verdict, ``counts`` how many came out; figures and ``index.html`` are in ``dir``.
    """
    folder, keep = place(out)
    text = call(["paper", *arguments(test, {**options, "out": folder})], quiet)
    return Paper(folder, text, keep=keep)


def call(words: Sequence[str], quiet: bool, bar: Bar | None = None) -> str:
    """Runs the command line as a process, and returns what it prints; what it tells goes to stderr, or to a bar."""
    _sumo.find()
    with tempfile.TemporaryDirectory(prefix="sumo-mfc-") as folder:
        return _call(words, quiet, bar, Path(folder) / "error.json")


def _call(words: Sequence[str], quiet: bool, bar: Bar | None, errors: Path) -> str:
    told: list[str] = []
    with subprocess.Popen(
        [*_sumo.command(_controllers.files(words)), "--errors", str(errors), *words],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        encoding="utf-8",
        errors="replace",
    ) as process:

        def listen() -> None:
            assert process.stderr is not None
            for line in process.stderr:
                told.append(line)
                if not (quiet or bar is not None and bar.take(line)):
                    print(line, end="", file=sys.stderr, flush=True)

        listener = threading.Thread(target=listen, daemon=True)
        listener.start()
        try:
            assert process.stdout is not None
            text = process.stdout.read()
            code = process.wait()
        except KeyboardInterrupt:
            # A terminal has told it already; a notebook has not. It ends in order within a step.
            process.send_signal(signal.SIGINT)
            process.wait()
            raise
        listener.join()
    if code != 0:
        raise _failed("".join(told).strip() or f"sumo-mfc has ended with {code}", errors)
    return text


def _failed(text: str, errors: Path) -> Error:
    """The error of a process: all that it told, and what it left of its error; of wrong options it leaves nothing."""
    error = Error(text)
    error.message, error.spans = text.splitlines()[0], []
    if errors.is_file():
        left = json.loads(errors.read_text(encoding="utf-8"))
        error.message, error.spans = left["message"], [(file, line, column) for file, line, column in left["spans"]]
    return error
