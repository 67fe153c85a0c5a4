"""The notebook runs from its first cell to its last, and prints what it shows."""

import sys

import nbformat
from conftest import PACKAGE, ROOT

sys.path.append(str(ROOT / "client/examples"))

import execute_notebook  # noqa: E402

NOTEBOOK = ROOT / "client/examples/volumes.ipynb"


def texts(notebook):
    return [
        output.get("text") or output.data["text/plain"]
        for cell in notebook.cells
        for output in cell.get("outputs", [])
    ]


def pictures(notebook):
    return ["image/png" in output.get("data", {}) for cell in notebook.cells for output in cell.get("outputs", [])]


def test_the_notebook_prints_what_it_shows(tmp_path, monkeypatch):
    monkeypatch.setenv("PYTHONPATH", str(PACKAGE))
    shown, found = nbformat.read(NOTEBOOK, as_version=4), execute_notebook.execute(NOTEBOOK, tmp_path)
    assert texts(found) == texts(shown)
    assert pictures(found) == pictures(shown) and sum(pictures(found)) == 2
    assert (tmp_path / "phantom.nrrd").stat().st_size > 0 and (tmp_path / "phantom.vti").stat().st_size > 0
