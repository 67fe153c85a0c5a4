"""Executes a notebook in a folder, and returns or rewrites it with its results.

Usage: client/examples/execute_notebook.py client/examples/volumes.ipynb    (PYTHONPATH: the absolute path of latvox)
"""

import base64
import io
import pathlib
import sys
import tempfile

import nbclient
import nbformat
from PIL import Image

WIDTH = 480  # of pictures, so that the file stays small


def execute(path, folder):
    """Returns the notebook with new results. `folder`: where it runs, and writes its files."""
    notebook = nbformat.read(path, as_version=4)
    nbclient.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(folder)}}).execute()
    for cell in notebook.cells:
        if cell.cell_type == "code":
            cell.outputs = joined(cell.outputs)
            cell.metadata = {}  # times
    return notebook


def joined(outputs):
    """Joins texts of one stream, which arrive in pieces."""
    whole = []
    for output in outputs:
        if whole and output.output_type == "stream" and whole[-1].get("name") == output.name:
            whole[-1].text += output.text
        else:
            whole.append(output)
    return whole


def shrink(notebook):
    for output in (output for cell in notebook.cells for output in cell.get("outputs", [])):
        picture = output.get("data", {}).get("image/png")
        if picture is None:
            continue
        image = Image.open(io.BytesIO(base64.b64decode(picture))).convert("RGB")
        if image.width > WIDTH:
            image = image.resize((WIDTH, WIDTH * image.height // image.width), Image.Resampling.LANCZOS)
        small = io.BytesIO()
        image.quantize(64).save(small, "png", optimize=True)
        output.data["image/png"] = base64.b64encode(small.getvalue()).decode()


def main(path):
    with tempfile.TemporaryDirectory() as folder:
        notebook = execute(path, folder)
    shrink(notebook)
    nbformat.write(notebook, path)


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]))
