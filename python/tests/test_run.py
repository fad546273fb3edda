"""Runs in Python: the same bytes as the command line, tables for other libraries, errors, Ctrl-C."""

import csv
import gc
import json
import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
from pathlib import Path

import duckdb
import numpy as np
import pandas as pd
import polars as pl
import pyarrow as pa
import pytest
import sumo_mfc

from conftest import CommandLine

TABLES = ["vehicles.csv", "quality.csv", "edges.csv", "sample.csv", "trace.csv"]


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> sumo_mfc.Result:
    """A part of the city, a quarter of it with bodies, one vehicle traced."""
    config = Path(__file__).parents[2] / "sumo_nets" / "city" / "city.sumocfg"
    return sumo_mfc.run(
        config,
        controller="pid",
        egos="share:0.25",
        seed=1,
        end=120,
        trace="all",
        trace_period=1,
        actuator={"delay_s": 0.1},
        set={"noise.power_db": -20},
        out=tmp_path_factory.mktemp("city"),
        no_report=True,
        quiet=True,
    )


def test_val_bytes_are_those_of_the_command_line(
    result: sumo_mfc.Result, city: Path, tmp_path: Path, command_line: CommandLine
) -> None:
    options = ["--controller", "pid", "--egos", "share:0.25", "--seed", "1", "--end", "120", "--trace", "all"]
    options += ["--trace-period", "1", "--set", "actuator.delay_s=0.1", "--set", "noise.power_db=-20", "--no-report"]
    ended = command_line("run", city, *options, "-o", tmp_path)
    assert ended.returncode == 0, ended.stderr
    for table in TABLES:
        assert (result.dir / table).read_bytes() == (tmp_path / table).read_bytes(), table


def test_tables_hold_what_the_files_hold(result: sumo_mfc.Result) -> None:
    for name in ["vehicles", "quality", "edges", "sample", "trace"]:
        table: sumo_mfc.Table = result.table(name)
        with (result.dir / f"{name}.csv").open() as file:
            rows = list(csv.DictReader(file))
        assert len(table) == len(rows) > 20
        assert table.columns == list(rows[0])
        for column in table.columns:
            texts = [row[column] for row in rows]
            values = table[column]
            if isinstance(values, list):
                assert [value or "" for value in values] == texts
            elif values.dtype == bool:
                assert [str(value).lower() for value in values] == texts
            else:
                np.testing.assert_array_equal(values, [float(text or "nan") for text in texts])


def test_other_libraries_read_the_tables(result: sumo_mfc.Result) -> None:
    vehicles = result.vehicles
    wanted = float(np.nanmean(vehicles["error_rms"]))
    arrow = pa.table(vehicles)
    assert arrow.schema.field("error_rms").metadata[b"unit"] == b"m/s"
    assert arrow.schema.field("samples").type == pa.int64()
    frame = arrow.to_pandas()
    assert isinstance(frame, pd.DataFrame) and frame["error_rms"].mean() == pytest.approx(wanted, rel=1e-12)
    assert pl.DataFrame(vehicles)["error_rms"].mean() == pytest.approx(wanted, rel=1e-12)
    found = duckdb.connect().execute("select avg(error_rms), count(*) from vehicles").fetchone()
    assert found is not None
    assert found[0] == pytest.approx(wanted, rel=1e-12) and found[1] == len(vehicles)


def test_tables_are_handed_over_without_a_copy(result: sumo_mfc.Result) -> None:
    trace = result.trace
    first, second = (pa.RecordBatchReader.from_stream(trace).read_all()["speed"].chunk(0) for _ in range(2))
    assert first.buffers()[1].address == second.buffers()[1].address
    # The memory outlives the table.
    total = float(np.nansum(trace["speed"]))
    del trace, second
    result._tables.clear()
    gc.collect()
    assert float(np.nansum(first.to_numpy())) == total


def test_parquet_is_read_as_csv_is(straight: Path, tmp_path: Path) -> None:
    runs = [
        sumo_mfc.run(straight, trace="all", trace_output=f"t.{form}", vehicles_output=f"v.{form}", no_report=True)
        for form in ["csv", "parquet"]
    ]
    for name in ["vehicles", "trace"]:
        as_csv, as_parquet = (pa.table(getattr(run, name)) for run in runs)
        assert as_csv.num_rows > 0 and as_csv.equals(as_parquet), name


def test_meanings_and_html(result: sumo_mfc.Result) -> None:
    assert result.vehicles.meanings["error_rms"][0] == "m/s"
    assert result.trace.meanings["torque"][0] == "N·m"
    page = result._repr_html_()
    assert f"{result.summary['fleet']['error_rms']['p50']:.4g}" in page and "<table>" in page
    assert "error RMS" in str(result)
    with pytest.raises(KeyError, match="wanted one of id, type"):
        result.vehicles["speeed"]
    with pytest.raises(sumo_mfc.Error, match="found no table roads, wanted one of .*edges"):
        result.table("roads")


def test_a_result_without_a_folder_goes_with_its_object(straight: Path) -> None:
    result = sumo_mfc.run(straight, end=5, no_report=True)
    folder = result.dir
    assert (folder / "run.json").is_file()
    assert isinstance(sumo_mfc.open_result(folder), sumo_mfc.Result)
    del result
    gc.collect()
    assert not folder.exists()


def test_errors_say_what_the_command_line_says(tmp_path: Path, command_line: CommandLine, straight: Path) -> None:
    file = tmp_path / "my.toml"
    file.write_text(f'[sumo]\nconfig = "{straight.parents[1]}/sumo_nets/straight/straight.sumocfg"\n[actuator]\ndelay_ms = 2\n')
    with pytest.raises(sumo_mfc.Error, match="did you mean actuator.delay_s") as raised:
        sumo_mfc.run(file)
    ended = command_line("run", file)
    assert ended.returncode == 1
    assert str(raised.value).strip() == ended.stderr.strip()
    assert raised.value.spans == [(str(file), 4, 1)]
    assert "unknown key actuator.delay_ms" in raised.value.message
    with pytest.raises(sumo_mfc.Error, match=r'controller.name: unknown controller "pod" \(did you mean "pid"'):
        sumo_mfc.run(straight, controller="pod")
    with pytest.raises(sumo_mfc.Error, match="--set controller.k_p=.*wanted a number"):
        sumo_mfc.run(straight, set={"controller.k_p": "much"})
    with pytest.raises(sumo_mfc.Error, match="unexpected argument '--sede'.*\n.*\n.*--seed"):
        sumo_mfc.run(straight, sede=3)
    with pytest.raises(sumo_mfc.Error, match="already holds a result"):
        for _ in range(2):
            sumo_mfc.run(straight, end=2, out=tmp_path / "twice", no_report=True)


def test_check_resolves_without_running(straight: Path, tmp_path: Path, command_line: CommandLine) -> None:
    text = sumo_mfc.check(straight, controller="pid", seed=7)
    assert text == command_line("check", straight, "--controller", "pid", "--seed", 7).stdout
    assert 'name = "pid"' in text
    resolved = tmp_path / "resolved.toml"
    resolved.write_text(text)
    assert sumo_mfc.check(resolved) == text


def test_notes_and_report(city: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    result = sumo_mfc.run(city, end=10, out=tmp_path / "told")
    told = capfd.readouterr().err
    assert result.notes and all(f"note: {note}\n" in told for note in result.notes)
    assert (result.dir / "report.html").stat().st_size > 10_000
    sumo_mfc.run(city, end=10, out=tmp_path / "quiet", quiet=True, no_report=True)
    assert capfd.readouterr() == ("", "")
    page = sumo_mfc.report(result.dir, tmp_path / "quiet", out=tmp_path / "both.html")
    assert page == tmp_path / "both.html" and page.stat().st_size > 10_000


def test_other_threads_go_on_meanwhile(city: Path) -> None:
    ticks: list[float] = []
    ended = threading.Event()

    def tick() -> None:
        while not ended.wait(0.01):
            ticks.append(time.perf_counter())

    thread = threading.Thread(target=tick)
    thread.start()
    begun = time.perf_counter()
    sumo_mfc.run(city, end=400, no_report=True, quiet=True)
    took = time.perf_counter() - begun
    ended.set()
    thread.join()
    assert took > 0.3 and len(ticks) > 20 * took, (len(ticks), took)


def test_progress_is_told(city: Path) -> None:
    from sumo_mfc._arguments import arguments
    from sumo_mfc._core import Plan

    seen: list[tuple[float, float, float | None]] = []
    result, keep = sumo_mfc._results.place(None)
    Plan(arguments(city, {"end": 400, "no_report": True, "out": result})).run(lambda *times: seen.append(times))
    assert len(seen) > 3 and {(begin, end) for begin, _, end in seen} == {(0.0, 400.0)}
    now = [now for _, now, _ in seen]
    assert now == sorted(now) and now[-1] > now[0]
    assert keep is not None


def interrupted(script: str, ready: Path, *arguments: object) -> subprocess.CompletedProcess[str]:
    """Runs a script, and sends it SIGINT once `ready` is there."""
    words = [sys.executable, "-c", textwrap.dedent(script), *map(str, arguments)]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        deadline = time.monotonic() + 60
        while not ready.exists():
            assert process.poll() is None and time.monotonic() < deadline
            time.sleep(0.05)
        time.sleep(2)  # SUMO loads within it, and the run goes on for longer.
        process.send_signal(signal.SIGINT)
        try:
            out, err = process.communicate(timeout=30)
        finally:
            process.kill()
    return subprocess.CompletedProcess(words, process.returncode, out, err)


def test_ctrl_c_ends_a_run_and_keeps_what_there_is(city: Path, tmp_path: Path) -> None:
    script = """
        import os, signal, sys, sumo_mfc
        try:
            sumo_mfc.run(sys.argv[1], end=100000, trace="all", out=sys.argv[2], quiet=True)
        except KeyboardInterrupt:
            print("interrupted")
        try:  # Python's own handler is still there.
            os.kill(os.getpid(), signal.SIGINT)
            for _ in range(1000): pass
        except KeyboardInterrupt:
            print("again")
    """
    ended = interrupted(script, tmp_path / "out" / "vehicles.csv.part", city, tmp_path / "out")
    assert (ended.returncode, ended.stdout, ended.stderr) == (0, "interrupted\nagain\n", "")
    manifest = json.loads((tmp_path / "out" / "run.json").read_text())
    assert manifest["status"] == "incomplete"
    assert len(sumo_mfc.open_result(tmp_path / "out").vehicles) > 0


def test_the_environment_chooses_sumo(straight: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SUMO_BINARY", "/nowhere/sumo")
    with pytest.raises(sumo_mfc.Error, match="/nowhere/sumo"):
        sumo_mfc.run(straight, end=2)
    monkeypatch.delenv("SUMO_BINARY")
    monkeypatch.delenv("SUMO_HOME", raising=False)
    assert sumo_mfc.run(straight, end=2, no_report=True).summary["counts"]["vehicles"] == 1
    assert Path(os.environ["SUMO_HOME"]).joinpath("bin", "sumo").is_file()
