"""Studies, the paper, and the command that comes with the wheel."""

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
import sumo_mfc

from conftest import COMMAND, CommandLine
from test_run import interrupted


def test_val_a_comparison_has_the_bytes_of_the_command_line(
    city: Path, tmp_path: Path, command_line: CommandLine
) -> None:
    study = sumo_mfc.compare(
        city, ["ideal", "pid"], seeds=[1, 2], end=30, out=tmp_path / "here", quiet=True, no_report=True
    )
    options = ["--controllers", "ideal,pid", "--seeds", "1..2", "--end", "30", "--no-report"]
    ended = command_line("compare", city, *options, "-o", tmp_path / "there")
    assert ended.returncode == 0, ended.stderr
    for table in ["cases.csv", "comparison.csv", "vehicles.parquet"]:
        assert (study.dir / table).read_bytes() == (tmp_path / "there" / table).read_bytes(), table
    assert study.text == ended.stdout
    assert len(study.cases) == 4 and set(study.cases["status"]) == {"done"}
    assert "error_rms_mean" in study.comparison["metric"]
    vehicles = pa.table(study.vehicles)
    assert vehicles.num_rows > 50 and vehicles["sumo_duration"].null_count < vehicles.num_rows


def test_a_study_has_a_bar_or_lines(straight: Path, capfd: pytest.CaptureFixture[str]) -> None:
    def told(progress: bool) -> str:
        sumo_mfc.compare(straight, ["ideal", "pid"], seeds=[1], end=10, no_report=True, progress=progress)
        return capfd.readouterr().err

    bar, lines = told(True), told(False)
    assert "/2 [" in bar and "[2/2] case" not in bar, bar
    assert "[1/2] case" in lines and "[2/2] case" in lines and "/2 [" not in lines, lines


def test_a_sweep_varies_keys_and_goes_on_where_it_was(straight: Path, tmp_path: Path) -> None:
    def sweep() -> sumo_mfc.Study:
        return sumo_mfc.sweep(
            straight,
            {"actuator.delay_s": [0, 0.2], "controller.name": ["classic", "pid"]},
            seeds="1..1",
            reference={"controller.name": "classic"},
            end=20,
            out=tmp_path,
            quiet=True,
            no_report=True,
        )

    cases = sweep().cases
    assert sorted(zip(cases["actuator.delay_s"], cases["controller.name"], strict=True)) == [
        ("0", "classic"),
        ("0", "pid"),
        ("0.2", "classic"),
        ("0.2", "pid"),
    ]
    before = {path: path.stat().st_mtime_ns for path in tmp_path.glob("cases/*/vehicles.csv")}
    sweep()
    assert len(before) == 4 and all(path.stat().st_mtime_ns == time for path, time in before.items())


def test_errors_of_studies_are_exceptions(straight: Path, tmp_path: Path) -> None:
    with pytest.raises(sumo_mfc.Error, match='unknown controller "pod"'):
        sumo_mfc.compare(straight, ["ideal", "pod"], seeds=[1], end=5, quiet=True)
    wrong = tmp_path / "wrong.toml"
    config = straight.read_text().replace('config = "..', f'config = "{straight.parents[1]}')
    wrong.write_text(config + "\n[actuator]\ndelay_ms = 20\n")
    studies: list[Callable[[], object]] = [
        lambda: sumo_mfc.run(wrong, quiet=True),
        lambda: sumo_mfc.compare(wrong, ["ideal", "pid"], seeds=[1], end=5, quiet=True),
        lambda: sumo_mfc.sweep(wrong, {"controller.name": ["ideal", "pid"]}, seeds=[1], end=5, quiet=True),
    ]
    found = []
    for study in studies:
        with pytest.raises(sumo_mfc.Error, match="unknown key .*delay_ms") as raised:
            study()
        found.append((raised.value.message, raised.value.spans))
    message, [(file, line, column)] = found[0]
    assert (Path(file).name, wrong.read_text().splitlines()[line - 1], column) == ("wrong.toml", "delay_ms = 20", 1)
    assert found[1:] == [found[0]] * 2, "a study says what a run says"
    with pytest.raises(sumo_mfc.Error, match="2 cases failed") as raised:
        sumo_mfc.compare(straight, ["ideal", "pid"], seeds=[1], end=5, egos="id:nobody", out=tmp_path, quiet=True)
    assert raised.value.spans == []


def test_ctrl_c_ends_a_study(city: Path, tmp_path: Path) -> None:
    script = """
        import sys, sumo_mfc
        try:
            sumo_mfc.compare(sys.argv[1], ["pid", "classic"], seeds=[1], end=100000, jobs=1, out=sys.argv[2])
        except KeyboardInterrupt:
            print("interrupted")
    """
    ended = interrupted(script, tmp_path / "cases" / "0001" / "vehicles.csv.part", city, tmp_path)
    assert (ended.returncode, ended.stdout) == (0, "interrupted\n"), ended.stderr
    assert "stopped: 0 of 2 cases are done" in ended.stderr
    assert json.loads((tmp_path / "cases" / "0001" / "run.json").read_text())["status"] != "complete"


def test_the_paper_is_reproduced() -> None:
    paper = sumo_mfc.paper("step", preset="default", quiet=True)
    # The figures that the README names, of the command line.
    assert "19.3" in paper.text.replace("19.30", "19.3") and (paper.dir / "index.html").is_file()
    results = pa.table(paper.results)
    assert results.num_rows == len((paper.dir / "results.csv").read_text().splitlines()) - 1
    shown = results.to_pandas().query("preset == 'default' and test == 'step' and noise == 'off' and quantity == 'overshoot_1'")
    shown = shown.set_index("controller")
    assert shown.published.dropna().to_dict() == {"classic": 19.5, "adaptive": 8.0}
    assert shown.verdict["classic"] == "reproduced" and abs(shown.value["classic"] - 19.3) < 0.1
    assert paper.results.meanings["value"][1].startswith("Its value")
    counts = dict(zip(paper.counts["preset"], paper.counts["numbers_driven"], strict=True))
    assert counts == {"default": 6.0}


def test_command_and_module_are_one() -> None:
    said = [
        subprocess.run([*words, "list"], capture_output=True, text=True, check=True).stdout
        for words in [[str(COMMAND)], [sys.executable, "-m", "sumo_mfc"]]
    ]
    # Other tests of this process have registered controllers, too.
    assert said[0] == said[1] and set(said[0].splitlines()) <= {"\t".join(choice) for choice in sumo_mfc.choices()}
    version = subprocess.run([str(COMMAND), "--version"], capture_output=True, text=True, check=True).stdout
    assert version == f"sumo-mfc {sumo_mfc.__version__}\n"
    wrong = subprocess.run([str(COMMAND), "walk"], capture_output=True, text=True, check=False)
    assert wrong.returncode == 1 and "unrecognized subcommand" in wrong.stderr
    assert np.unique([kind for kind, _, _ in sumo_mfc.choices()]).tolist() == ["body", "controller", "plant", "target"]


def test_doctor_is_content() -> None:
    said = subprocess.run([sys.executable, "-m", "sumo_mfc", "doctor"], capture_output=True, text=True, check=False)
    assert said.returncode == 0, said.stdout + said.stderr
