"""The notebook runs, and stubs are what they say of the module."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

PYTHON = Path(__file__).parents[1]


def test_the_notebook_runs() -> None:
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    for file in sorted((PYTHON / "examples").glob("*.ipynb")):
        notebook = nbformat.read(file, as_version=4)
        nbclient.NotebookClient(notebook, timeout=60, resources={"metadata": {"path": str(PYTHON / "tests")}}).execute()
        pages = [output for cell in notebook.cells for output in cell.get("outputs", []) if "text/html" in str(output)]
        assert pages, "no result showed itself"


def test_the_document_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = (PYTHON.parent / "docs/python.md").read_text(encoding="utf-8")
    blocks = [block.split("```")[0] for block in text.split("```python\n")[1:]]
    assert len(blocks) >= 3
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    for block in blocks:
        exec(block, names)
    assert {file.name for file in tmp_path.iterdir()} == {"trot.png", "trot.json", "study.csv"}


def test_types_hold() -> None:
    pytest.importorskip("mypy")
    done = subprocess.run([sys.executable, "-m", "mypy", "tests"], cwd=PYTHON, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_stubs_are_of_this_module() -> None:
    pytest.importorskip("mypy")
    words = [sys.executable, "-m", "mypy.stubtest", "piaffe._piaffe", "--ignore-disjoint-bases"]
    done = subprocess.run(words, cwd=PYTHON / "tests", capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_importing_is_quick() -> None:
    """What is not needed for it is imported when it is."""
    program = "import sys, piaffe; print([name for name in ('numpy', 'matplotlib', 'pandas', 'dask') if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", program], cwd=PYTHON / "tests", capture_output=True, text=True)
    assert done.stdout == "[]\n", done.stdout + done.stderr
