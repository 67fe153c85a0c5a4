"""The examples of client/docs/python.md and README.md run, and print what their comments say."""

import re
import shutil

import latvox
import pytest
from conftest import ROOT
from harness import BUNNY

PAGE = (ROOT / "client/docs/python.md").read_text()


@pytest.mark.parametrize(
    "page, least, files",
    [("client/docs/python.md", 7, ("bunny.vdb", "bunny.npz")), ("README.md", 1, ("bunny.nrrd",))],
)
def test_examples_run_and_print_what_they_show(page, least, files, tmp_path, monkeypatch, capsys):
    shutil.copy(BUNNY, tmp_path / "bunny.obj")
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"^```python\n(.*?)^```$", (ROOT / page).read_text(), re.M | re.S)
    assert len(blocks) >= least
    names = {}
    for block in blocks:
        exec(compile(block, page, "exec"), names)
        printed = capsys.readouterr().out
        for shown in re.findall(r"^ *print\(.*\)  # (.*)$", block, re.M):
            assert shown in printed.splitlines(), shown
    assert all((tmp_path / file).exists() for file in files)


def test_options_in_the_tables_are_known():
    rows = [line for line in PAGE.splitlines() if line.startswith("|") and "latvox.voxelize(" in line]
    used = {name for row in rows for name in re.findall(r"(\w+)=", row.rpartition("latvox.voxelize(")[2])}
    assert len(rows) == 5 and used <= latvox.KEYWORDS.keys(), used
    for value in {value for row in rows for value in re.findall(r'set="([\w-]+)"', row)}:
        assert len(latvox.voxelize(BUNNY, resolution=16, set=value)) > 0
