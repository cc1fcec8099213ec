"""A question and its answer."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

from . import _piaffe
from ._given import MOST_STARTS, SEEDS, whole
from ._piaffe import Gait
from ._result import Result

Criterion = Literal["energy", "torque"]
Examination = Literal["none", "quick", "full"]


def optimize(
    gait: Gait,
    speed: float,
    criterion: Criterion = "energy",
    *,
    set: Mapping[str, float] | None = None,
    real_legs: bool = False,
    starts: int | None = None,
    seed: int = 1,
    examine: Examination = "full",
    threads: int | None = None,
) -> Result:
    """The cheapest periodic motion of a gait at a mean forward speed (m/s), as far as local searches can tell.

    `criterion` is what is least per metre: the work of the actuators ("energy", N) or the squares of their torques ("torque",
    N²·m·s). `set` puts other numbers in the place of the specification's, as `Robot.set` does. With `real_legs` the limits hold at
    each real leg too, where the platform rolls. `starts` is their number, a default walk and random ones of `seed`; if it is not given, as many as the optima
    found let expect others. `examine` is how closely to look at an optimum: "none" is its receipt, "quick" its slopes and stability
    too, "full" also the proof between the receipt's instants and the real legs. The answer is the same for any number of `threads`; no more than there are cores are started, which is the default.

    Whether there is an optimum, and why not, is in the result: `status`, `message`. Ctrl-C ends the search.

    Raises `Error` where the question is none: a speed that is no positive number, a number that the specification has not.
    """
    starts, seed = whole("starts", starts, most=MOST_STARTS), whole("seed", seed, least=0, most=SEEDS)
    threads = whole("threads", threads)
    if set:
        gait = gait.set(set)
    return Result(_piaffe.optimize(gait, speed, criterion, real_legs, starts, seed, examine, threads))
