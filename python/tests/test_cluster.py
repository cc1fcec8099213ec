"""The programs of `docs/cluster.md`, run where what they are about is installed: Ray, submitit and joblib on this machine."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Iterator
from multiprocessing import get_all_start_methods
from pathlib import Path
from typing import Any

import pytest

import piaffe

PAGE = (Path(__file__).parents[2] / "docs/cluster.md").read_text(encoding="utf-8")

DESIGNS = {"links.thigh.mass": [1.4, 1.5, 1.6, 1.7]}


def program(about: str) -> str:
    """The first program of a chapter of the page; before the chapters stands the one of processes."""
    (chapter,) = [text for text in PAGE.split("\n## ") if text.startswith(about)]
    return chapter.split("```python\n")[1].split("```")[0]


@pytest.fixture(scope="module")
def table(quadruped: piaffe.Robot) -> str:
    return piaffe.study(quadruped, DESIGNS, gait="trot", speed=0.6).table().to_csv()


def run(text: str, robot: piaffe.Robot) -> str:
    """The table of the study that a program asks."""
    names: dict[str, Any] = {"piaffe": piaffe, "robot": robot, "designs": DESIGNS}
    exec(text, names)
    study: piaffe.Study = names["study"]
    return study.table().to_csv()


@pytest.fixture
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("method", get_all_start_methods())
def test_processes(method: str, tmp_path: Path) -> None:
    """As a file of its own, however this system or another starts processes."""
    pyarrow = pytest.importorskip("pyarrow.parquet")
    text, found = re.subn(r"range\(\d+\)", "range(3)", program("# Clusters").replace('["energy", "torque"]', '["energy"]'))
    assert found == 1
    start = f"import multiprocessing\nmultiprocessing.set_start_method({method!r}, force=True)\n"
    (tmp_path / "study.py").write_text(start + text, encoding="utf-8")
    subprocess.run([sys.executable, "study.py"], cwd=tmp_path, check=True, timeout=300)
    assert pyarrow.read_table(tmp_path / "study.parquet").num_rows == 3 and (tmp_path / "study.journal").exists()


@pytest.fixture
def ray() -> Iterator[Any]:
    module = pytest.importorskip("ray")
    yield module
    module.shutdown()


@pytest.mark.usefixtures("elsewhere", "ray")
def test_ray(quadruped: piaffe.Robot, table: str) -> None:
    assert run(program("Ray"), quadruped) == table


@pytest.mark.usefixtures("elsewhere")
def test_submitit(quadruped: piaffe.Robot, table: str) -> None:
    pytest.importorskip("submitit")
    # Where there is no Slurm, its executor runs jobs as processes of this machine.
    assert run(program("Slurm"), quadruped) == table


@pytest.mark.usefixtures("elsewhere")
def test_loky(quadruped: piaffe.Robot, table: str) -> None:
    pytest.importorskip("joblib")
    assert run(program("joblib"), quadruped) == table
