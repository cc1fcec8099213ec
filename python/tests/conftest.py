"""What several tests ask."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Callable

import pytest

import piaffe

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="session")
def quadruped() -> piaffe.Robot:
    return piaffe.robots["quadruped"]


@pytest.fixture(scope="session")
def trot(quadruped: piaffe.Robot) -> piaffe.Gait:
    return quadruped.gait("trot")


@pytest.fixture(scope="session")
def result(trot: piaffe.Gait) -> piaffe.Result:
    return piaffe.optimize(trot, 0.6)


def installed(*words: str) -> subprocess.CompletedProcess[str]:
    """The command line as it is installed, run with these words in the repository."""
    beside = Path(sys.executable).parent / ("piaffe.exe" if os.name == "nt" else "piaffe")
    command = str(beside) if beside.exists() else shutil.which("piaffe")
    assert command is not None
    return subprocess.run([command, *words], cwd=ROOT, capture_output=True, text=True, encoding="utf-8")


@pytest.fixture(scope="session")
def program() -> Callable[..., str]:
    """The command line: what it answers to these words."""

    def run(*words: str) -> str:
        done = installed(*words)
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run


@pytest.fixture(scope="session")
def failing() -> Callable[..., str]:
    """The command line: what it says where it cannot do what these words ask for."""

    def run(*words: str) -> str:
        done = installed(*words)
        assert done.returncode == 1, done.stdout
        return done.stderr

    return run
