"""The notebooks of the examples run from top to bottom, and draw."""

from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

from lines import REPOSITORY

NOTEBOOKS = sorted((REPOSITORY / "examples" / "python").glob("*.ipynb"))


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs_and_draws(notebook: Path) -> None:
    cells = nbformat.read(notebook, as_version=4)  # type: ignore[no-untyped-call]
    shown = [output for cell in cells.cells if cell.cell_type == "code" for output in cell.outputs]
    assert shown, "a notebook is kept with what it shows"
    # An error in a cell is an exception here.
    done = NotebookClient(cells, timeout=280, resources={"metadata": {"path": str(notebook.parent)}}).execute()
    outputs = [output for cell in done.cells if cell.cell_type == "code" for output in cell.outputs]
    assert any("image/png" in output.get("data", {}) for output in outputs)
    assert not any(output.get("name") == "stderr" for output in outputs), "warnings belong to nobody's eyes"
