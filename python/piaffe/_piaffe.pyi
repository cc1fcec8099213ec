"""What is written in Rust. Numbers cross as bytes, results as JSON; what a person uses is in the modules around it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from os import PathLike
from typing import final

__all__ = [
    "Error",
    "Gait",
    "Kernels",
    "NoOptimum",
    "Question",
    "Robot",
    "SpecificationError",
    "Stop",
    "__version__",
    "answers",
    "built_in",
    "csv",
    "mjcf",
    "normal",
    "npz",
    "optimize",
    "page",
    "run",
    "verify",
]

__version__: str

class Error(ValueError):
    """What piaffe cannot do with what it was given, why, and what to write instead."""

class SpecificationError(Error):
    """A robot or gait that is none: every mistake, with its place and a remedy."""

class NoOptimum(Error):
    """A result without a motion was asked for its motion: why it has none."""

@final
class Robot:
    """A robot as its files describe it: `Robot(robot, gaits)` with the text of `robot.toml` and those of the gaits by name.

    Robots do not change; they are equal if their files are, and travel to other processes.
    """

    def __new__(cls, robot: str, gaits: Mapping[str, str], notes: Sequence[str] = ...) -> Robot: ...
    @staticmethod
    def from_toml(folder: str | PathLike[str]) -> Robot:
        """The robot of a folder with `robot.toml` and `gaits/*.toml`."""
    @staticmethod
    def from_urdf(
        path: str | PathLike[str],
        *,
        lock: Sequence[str] | Mapping[str, float | None] | None = None,
        foot: Sequence[str] | Mapping[str, tuple[float, float, float] | None] | None = None,
        effort: float | Mapping[str, float] | None = None,
        velocity: float | Mapping[str, float] | None = None,
        gear: float | Mapping[str, float] | None = None,
        rotor: float | Mapping[str, float] | None = None,
        range: Mapping[str, tuple[float, float]] | None = None,
        forward: str | None = None,
        up: str | None = None,
        alike: float = 1e-3,
        mend: bool = False,
        tried: bool = True,
    ) -> Robot:
        """The robot of a URDF or MJCF. What the file does not say is given, or assumed and told in `notes`.

        `lock` names joints that are held still (arms, heads), or gives each an angle of the file, rad; `*` and `?` match
        several, a `/` at the end all joints below too. `foot` names links that touch the ground, or gives each the point of it
        that does, m. `effort` (N·m), `velocity` (rad/s), `gear` (motor turns per turn of the joint) and `rotor` (kg·m² at the
        motor) are numbers for all joints that have none, or by joint. `range` has stops by joint, rad. `forward` and `up` are
        axes of the root link, such as "-y". Legs that differ by no more than the share `alike` are made alike. `mend` takes the nearest possible
        inertia also where the file would be refused for one that no body has. With `tried`, the gaits are those that the robot
        can do, which takes seconds; else those that legs like these have.
        """
    @property
    def name(self) -> str:
        """As the specification calls it."""
    @property
    def gaits(self) -> list[str]:
        """Names of its gaits."""
    @property
    def usual_gaits(self) -> list[str]:
        """Names of those that a study asks about where none is named: those that never leave the ground; where all fly, all."""
    @property
    def notes(self) -> list[str]:
        """What an import took, assumed and dropped, a sentence each."""
    @property
    def files(self) -> dict[str, str]:
        """The specification: paths in the robot's folder, and their texts."""
    @property
    def numbers(self) -> dict[str, float]:
        """The numbers of the specification, by the names with which `set` changes them. Those that are not the same in all gaits are
        not the robot's: `differing` has them, and `Gait.numbers` those of one gait."""
    @property
    def differing(self) -> dict[str, dict[str, float]]:
        """Numbers that are not the same in all gaits that have them: each with its value by gait. `set` gives all gaits one."""
    def unknown(self, names: Sequence[str]) -> list[str]:
        """What is wrong with these names, if they are to be those of numbers."""
    def gait(self, name: str) -> Gait:
        """Derives a gait: 30 to 170 ms for those that are shipped."""
    def set(self, numbers: Mapping[str, float]) -> Robot:
        """The same robot with other numbers, by the keys that lead to them: `{"links.thigh.mass": 1.2}`."""
    def loaded(self, mass: float, at: tuple[float, float, float]) -> Robot:
        """The robot with a point mass (kg) on its platform, at a point in the frame of the legs' mounts (forward, up, right), m."""

@final
class Gait:
    """A gait of a robot, with its dynamics derived.

    It does not change, and is derived anew where it arrives in another process.
    """

    def __new__(cls, robot: Robot, name: str) -> Gait: ...
    @property
    def name(self) -> str:
        """As its robot calls it."""
    @property
    def robot(self) -> Robot: ...
    def set(self, numbers: Mapping[str, float]) -> Gait:
        """The same gait of the robot with other numbers: `Robot.set`."""
    @property
    def numbers(self) -> dict[str, float]:
        """The numbers of its specification, the robot's and its own, by the names with which `set` changes them."""
    @property
    def parameters(self) -> dict[str, tuple[float, str]]:
        """The numbers on which it depends, with their units. Those that must stay alike have one name, what differs in braces."""

@final
class Kernels:
    """The kernels of a gait. Each takes rows of doubles as bytes, and gives the rows of every block."""

    def __new__(cls, gait: Gait) -> Kernels: ...
    def names(self) -> tuple[list[str], list[str], int, list[str]]: ...
    def inertia(self, q: bytes) -> list[bytes]: ...
    def bias(self, q: bytes, qd: bytes) -> list[bytes]: ...
    def energy(self, x: bytes, xd: bytes) -> list[bytes]: ...
    def centre_of_mass(self, x: bytes, xd: bytes) -> list[bytes]: ...
    def foot(self, leg: int, x: bytes) -> list[bytes]: ...
    def foot_jacobian(self, leg: int, q: bytes) -> list[bytes]: ...
    def inverse(self, stance: int | None, q: bytes, qd: bytes, actuated_dd: bytes) -> list[bytes]: ...
    def inverse_jacobian(self, stance: int | None, q: bytes, qd: bytes, actuated_dd: bytes) -> list[bytes]: ...

@final
class Stop:
    """Whether work is to be ended."""

    def __new__(cls) -> Stop: ...
    def set(self) -> None: ...

@final
class Question:
    """What a study asks. Its outline answers all of its points, and is small."""

    def __new__(
        cls,
        robot: Robot,
        names: Sequence[str],
        rows: Sequence[Sequence[float]],
        gaits: Sequence[str],
        criteria: Sequence[str],
        speeds: Sequence[float],
        real_legs: bool,
        starts: int | None,
        seed: int,
        beyond: Sequence[str],
    ) -> Question: ...
    def outline(self) -> Question: ...
    def __len__(self) -> int: ...
    @property
    def fingerprint(self) -> str: ...
    @property
    def columns(self) -> list[tuple[str, str]]: ...
    def kind(self, number: int) -> tuple[str, str]: ...
    def point(self, number: int) -> tuple[int, list[float]]: ...

def answers(
    outline: Question, points: Sequence[tuple[int, Sequence[float]]], threads: int | None, stop: Stop
) -> tuple[str, list[float]]: ...
def built_in() -> list[tuple[str, Robot]]: ...
def optimize(
    gait: Gait,
    speed: float,
    criterion: str,
    real_legs: bool,
    starts: int | None,
    seed: int,
    examine: str,
    threads: int | None,
) -> str: ...
def normal(json: str) -> str: ...
def verify(json: str) -> str: ...
def npz(json: str, rate: float) -> bytes: ...
def csv(json: str, rate: float) -> str: ...
def mjcf(json: str) -> str: ...
def page(json: str) -> str: ...
def run(typed: Sequence[str]) -> int: ...
