"""The examples and the notebook run as they are."""

import json
import os
import subprocess
import sys

import nbclient
import nbformat
import pytest
from conftest import ROOT

EXAMPLES = ROOT / "python/examples"
#: What each example writes.
FILES = {
    "animation.py": ["hexagon.gif", "part.apng"],
    "own_surface.py": ["ring.png"],
    "picture_for_a_paper.py": ["disc.pdf", "disc.png", "disc.svg"],
}


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.py")), ids=lambda path: path.name)
def test_examples(path, tmp_path):
    done = subprocess.run([sys.executable, "-W", "error", path], capture_output=True, text=True, timeout=120, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert sorted(os.listdir(tmp_path)) == FILES.get(path.name, [])
    assert done.stdout or path.name in FILES


def test_there_are_ten():
    assert len(list(EXAMPLES.glob("*.py"))) == 10


def test_the_notebook(tmp_path):
    """It has no outputs in the repository, and those it makes are what it tells."""
    file = EXAMPLES / "notebook.ipynb"
    notebook = nbformat.read(file, as_version=4)
    nbformat.validate(notebook)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert all(cell.outputs == [] and cell.execution_count is None for cell in code)
    assert json.loads(file.read_text())["metadata"].keys() == {"kernelspec", "language_info"}
    nbclient.NotebookClient(notebook, timeout=300, kernel_name="python3", resources={"metadata": {"path": EXAMPLES}}).execute()
    shown = [set(output.get("data", {})) for cell in code for output in cell.outputs]
    assert sum("image/png" in kinds for kinds in shown) >= 4, shown
    assert not any(output.output_type == "error" for cell in code for output in cell.outputs)
