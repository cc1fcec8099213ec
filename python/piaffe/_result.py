"""A result: what was asked, what was found, and what is said of it."""

from __future__ import annotations

import json
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any, Optional, Tuple, Type, TypeVar, final

from . import _piaffe
from ._walk import Walk

if TYPE_CHECKING:
    from os import PathLike

    from matplotlib.figure import Figure

_T = TypeVar("_T")


def _of(kind: Type[_T], entries: dict[str, Any]) -> _T:
    """A record of those entries that it has; lists become tuples."""
    fields: dict[str, Any] = kind.__dataclass_fields__  # type: ignore[attr-defined]
    known = {name: value for name, value in entries.items() if name in fields}
    return kind(**{name: tuple(value) if isinstance(value, list) else value for name, value in known.items()})


class Status(Enum):
    """How an optimization ended."""

    OPTIMAL = "optimal"
    """A local optimum whose receipt holds."""
    INFEASIBLE = "infeasible"
    """No motion keeps to all constraints: they conflict from every start."""
    NOT_CONVERGED = "not-converged"
    """No point was found that can be called an optimum."""
    RECEIPT_FAILED = "receipt-failed"
    """An optimum for the optimizer, but its receipt does not hold."""


@dataclass(frozen=True)
class Finding:
    """A constraint at a time (s) of a phase (from 1); its margin is in natural units, negative where it is violated."""

    constraint: str
    phase: int
    time: float
    margin: float


@dataclass(frozen=True)
class Receipt:
    """What stands behind a result: a second derivation of its motion, which shares no equation with the first."""

    max_violation: float
    """Largest violation of any constraint at `grid` instants of each phase, in natural units."""
    cycle_error: float
    """How far the motion is from a cycle, with the unactuated coordinate integrated anew."""
    kkt_residual: Optional[float]
    """Scaled residual of the first-order optimality conditions."""
    findings: Tuple[Finding, ...]
    """The active constraints."""
    grid: int


@dataclass(frozen=True)
class Gap:
    """Times (s, from the beginning of the phase) between which a constraint could not be proven."""

    constraint: str
    phase: int
    violated: bool
    """That it is violated is certain, not only possible."""
    start: float
    end: float


@dataclass(frozen=True)
class Certificate:
    """What is proven between the instants of the receipt."""

    certified: bool
    """At no time is a margin below −`tolerance`."""
    tolerance: float
    gaps: Tuple[Gap, ...]


@dataclass(frozen=True)
class Sensitivity:
    """What a number of the specification, or the speed, is worth at the optimum."""

    parameter: str
    unit: str
    value: float
    slope: float
    """Change of the cost per change of the number, in their units."""
    elasticity: float
    """Change of the cost in percent per percent of the number."""


@dataclass(frozen=True)
class Stability:
    """What a push is multiplied by in a whole step (two half steps of a mirrored gait); it dies out where that is below 1. None where there is no such number."""

    by_clock: float
    """With joints that follow the time, whenever a foot lands."""
    by_restarted_clock: float
    """With a clock that starts anew when a foot lands."""
    by_phase: Optional[float]
    """With joints that follow the robot's own progress."""


@dataclass(frozen=True)
class Course:
    """The course of a phase: polynomials of the prescribed coordinates (rad, rad/s) and both ends of the unactuated one."""

    duration: float
    """s."""
    q_initial: Tuple[float, ...]
    qd_initial: Tuple[float, ...]
    q_interior: Tuple[Tuple[float, ...], ...]
    """At equally spaced times."""
    q_final: Tuple[float, ...]
    qd_final: Tuple[float, ...]
    beta_initial: float
    betad_initial: float
    beta_final: float
    betad_final: float


@dataclass(frozen=True)
class Statement:
    """An entry of a result beside what its motion makes of it."""

    entry: str
    verdict: str
    """confirmed, not-confirmed, not-checked, or not-derivable: of how the motion was found."""
    reason: Optional[str] = None
    differences: Tuple[Any, ...] = ()


@dataclass(frozen=True)
class Audit:
    """What became of a result when all that it states was derived anew."""

    name: str
    statements: Tuple[Statement, ...]

    @property
    def confirmed(self) -> bool:
        """Whether everything was confirmed that is stated about the motion."""
        of_motion = [s for s in self.statements if s.verdict != "not-derivable"]
        return bool(of_motion) and all(s.verdict == "confirmed" for s in of_motion)

    def __bool__(self) -> bool:
        return self.confirmed


@final
@dataclass(frozen=True, eq=False, repr=False)
class Result:
    """An answer of `optimize`. It does not change; it equals another that says the same, whatever time that took.

    The whole of it is `entries`, as the program's JSON has it; what is asked for most has a name here.
    """

    _text: str

    @cached_property
    def _entries(self) -> dict[str, Any]:
        entries: dict[str, Any] = json.loads(self._text)
        return entries

    @property
    def entries(self) -> dict[str, Any]:
        """All of it, as the JSON has it: a copy."""
        entries: dict[str, Any] = json.loads(self._text)
        return entries

    @property
    def gait(self) -> str:
        return str(self._entries["gait"])

    @property
    def robot(self) -> str:
        return str(self._entries["robot"])

    @property
    def criterion(self) -> str:
        return str(self._entries["criterion"])

    @property
    def speed(self) -> float:
        """Mean forward speed that was asked for, m/s."""
        return float(self._entries["speed"])

    @property
    def status(self) -> Status:
        return Status(self._entries["status"])

    @property
    def optimal(self) -> bool:
        return self.status is Status.OPTIMAL

    @property
    def message(self) -> str:
        """How the search ended, in words."""
        return str(self._entries["message"])

    @property
    def cost(self) -> Optional[float]:
        """The criterion per metre of travel, in `unit`; None without an optimum."""
        return self._entries["cost"]  # type: ignore[no-any-return]

    @property
    def unit(self) -> str:
        return {"energy": "N", "torque": "N²·m·s"}[self.criterion]

    @property
    def costs(self) -> dict[str, float]:
        """Both criteria of the motion: "energy" (N) and "torque" (N²·m·s). Empty without an optimum."""
        return dict(self._entries["costs"] or {})

    @property
    def durations(self) -> Tuple[float, ...]:
        """Of the phases, s."""
        return tuple(self._entries["durations"])

    @property
    def step_length(self) -> Optional[float]:
        """Travel in these phases, m: of a mirrored gait that of a half step."""
        return self._entries["step_length"]  # type: ignore[no-any-return]

    @property
    def phases(self) -> Tuple[Course, ...]:
        """The motion: its variables, phase by phase."""
        inner = [{**h, "q_interior": [tuple(q) for q in h["q_interior"]]} for h in self._entries["variables"]]
        return tuple(_of(Course, h) for h in inner)

    @property
    def receipt(self) -> Optional[Receipt]:
        receipt = self._entries["receipt"]
        return receipt and _of(Receipt, {**receipt, "findings": [_of(Finding, f) for f in receipt["findings"]]})

    @property
    def certificate(self) -> Optional[Certificate]:
        proof = self._entries.get("certificate")
        if not proof:
            return None
        gaps = tuple(_of(Gap, {**gap, "start": gap["from"], "end": gap["to"]}) for gap in proof["gaps"])
        return Certificate(proof["standing"] == "certified", proof["tolerance"], gaps)

    @property
    def sensitivities(self) -> dict[str, Sensitivity]:
        """By the names of the numbers, those first that are worth most. Empty where there are none: see `not_examined`."""
        slopes = (self._entries.get("sensitivities") or {"slopes": []})["slopes"]
        return {s["parameter"]: _of(Sensitivity, s) for s in slopes}

    @property
    def stability(self) -> Optional[Stability]:
        told = self._entries.get("stability")
        factor = told and told["phase"].get("factor")
        return told and Stability(told["clock"]["factor"], told["restarted_clock"]["factor"], factor)

    @property
    def not_examined(self) -> dict[str, str]:
        """Entries that an optimum might have and this one has not, with the reasons."""
        return {open["entry"]: open["reason"] for open in self._entries.get("not_examined", ())}

    @property
    def conflicts(self) -> Tuple[str, ...]:
        """Where there is no motion: the constraints that contradict each other, worst first."""
        return tuple(conflict["constraint"] for conflict in self._entries["conflicts"])

    @property
    def nearest_speed(self) -> Optional[float]:
        """Where there is no motion: the nearest speed at which an optimum was found, m/s."""
        return self._entries["nearest_speed"]  # type: ignore[no-any-return]

    @property
    def seconds(self) -> float:
        """Wall time of the search."""
        return float(self._entries["seconds"])

    def verify(self) -> Audit:
        """Derives anew all that is stated here, from the specification and the motion's variables alone."""
        audit = json.loads(_piaffe.verify(self._text))
        return Audit(audit["name"], tuple(_of(Statement, s) for s in audit["statements"]))

    def walk(self, rate: float = 1000.0) -> Walk:
        """One whole step in the world, `rate` moments per second. Raises `NoOptimum` where there is no motion."""
        return Walk._read(_piaffe.npz(self._text, rate))

    def plot(self) -> Figure:
        """The motion as figures: legs, joint angles, torques and reaction. Needs matplotlib."""
        from ._plot import figure

        return figure(self)

    def to_mjcf(self) -> str:
        """The real robot for MuJoCo (z up), with a keyframe where the walk begins."""
        return _piaffe.mjcf(self._text)

    def to_csv(self, rate: float = 1000.0) -> str:
        """The walk as a table: a row per moment, a column per number."""
        return _piaffe.csv(self._text, rate)

    def to_html(self) -> str:
        """The page that shows it: the walk to be played, all figures, the receipt in words. It needs no network."""
        return _piaffe.page(self._text)

    def _repr_html_(self) -> Optional[str]:
        if not self.optimal:
            return None
        return f'<iframe srcdoc="{escape(self.to_html())}" width="100%" height="800" style="border:0"></iframe>'

    def to_json(self) -> str:
        """All of it, as the command line writes it."""
        return self._text + "\n"

    @classmethod
    def from_json(cls, text: str) -> Result:
        """The result that a JSON states. Whether that is so, `verify` says."""
        return cls(_piaffe.normal(text))

    def save(self, path: str | PathLike[str]) -> None:
        Path(path).write_text(self.to_json(), encoding="utf-8")

    @classmethod
    def load(cls, path: str | PathLike[str]) -> Result:
        return cls.from_json(Path(path).read_text(encoding="utf-8"))

    @cached_property
    def _content(self) -> str:
        # The search's wall time is no part of what it found.
        return json.dumps({key: value for key, value in self._entries.items() if key != "seconds"}, sort_keys=True)

    def __eq__(self, other: object) -> bool:
        return self._content == other._content if isinstance(other, Result) else NotImplemented

    def __hash__(self) -> int:
        return hash(self._content)

    def __reduce__(self) -> Tuple[Type[Result], Tuple[str]]:
        return (Result, (self._text,))

    def __repr__(self) -> str:
        task = f"{self.gait} of {self.robot}, least {self.criterion} at {self.speed:g} m/s"
        found = self.message if self.cost is None else f"{self.cost:.6g} {self.unit}"
        return f"<piaffe.Result {task}: {found}>"
