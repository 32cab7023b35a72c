"""The notebooks of docs/notebooks run from the first cell to the last."""

import os
from pathlib import Path

import nbformat
import pytest
from nbconvert.preprocessors import ExecutePreprocessor

NOTEBOOKS = sorted((Path(__file__).resolve().parents[2] / "docs" / "notebooks").glob("*.ipynb"))
# Seconds for a cell. Sanitizers make a search twenty times as long.
PATIENCE = 3600 if "CARNOT_SANITIZED" in os.environ else 300


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_runs(path, tmp_path):
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert not any(cell.outputs for cell in code)  # they are made, not kept
    runner = ExecutePreprocessor(timeout=PATIENCE, kernel_name="python3")
    runner.preprocess(notebook, {"metadata": {"path": str(tmp_path)}})
    pictures = [out for cell in code for out in cell.outputs if "image/png" in out.get("data", {})]
    assert pictures


def test_there_are_three():
    assert len(NOTEBOOKS) == 3
