"""The examples of client/docs/python.md run, and print what their comments say."""

import re
import shutil

import latvox
from conftest import ROOT
from harness import BUNNY

PAGE = (ROOT / "client/docs/python.md").read_text()


def test_examples_run_and_print_what_they_show(tmp_path, monkeypatch, capsys):
    shutil.copy(BUNNY, tmp_path / "bunny.obj")
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"^```python\n(.*?)^```$", PAGE, re.M | re.S)
    assert len(blocks) > 6
    names = {}
    for block in blocks:
        exec(compile(block, "client/docs/python.md", "exec"), names)
        printed = capsys.readouterr().out
        for shown in re.findall(r"^ *print\(.*\)  # (.*)$", block, re.M):
            assert shown in printed.splitlines(), shown
    assert (tmp_path / "bunny.vdb").exists() and (tmp_path / "bunny.npz").exists()


def test_options_in_the_tables_are_known():
    rows = [line for line in PAGE.splitlines() if line.startswith("|") and "latvox.voxelize(" in line]
    used = {name for row in rows for name in re.findall(r"(\w+)=", row.rpartition("latvox.voxelize(")[2])}
    assert len(rows) == 5 and used <= latvox.KEYWORDS.keys(), used
    for value in {value for row in rows for value in re.findall(r'set="([\w-]+)"', row)}:
        assert len(latvox.voxelize(BUNNY, resolution=16, set=value)) > 0
