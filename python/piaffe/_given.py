"""What is given beside a robot: looked at before anything is computed."""

from __future__ import annotations

import operator
from typing import Any, TypeVar, Union

from ._piaffe import Error

#: Starts that a search can have.
MOST_STARTS = 100_000

#: The largest seed.
SEEDS = 2**64 - 1

#: What counts in this machine's words.
MOST = 2**63 - 1

Whole = TypeVar("Whole", int, Union[int, None])


def whole(name: str, value: Whole, *, least: int = 1, most: int = MOST) -> Whole:
    """A whole number within these bounds, or None where it may be left out."""
    if value is None:
        return value
    try:
        number = operator.index(value)
    except TypeError:
        number = None
    if number is None or isinstance(value, bool):
        raise TypeError(f"`{name}` is {value!r}: give a whole number")
    if not least <= number <= most:
        raise Error(f"`{name}` is {number}: give {f'at least {least}' if number < least else f'at most {most}'}")
    return number


def is_number(value: Any) -> bool:
    """Whether it is a finite number, of whatever library."""
    try:
        return not isinstance(value, (str, bool)) and abs(float(value)) < float("inf")
    except (TypeError, ValueError, OverflowError):
        return False


def seconds(name: str, value: Any) -> tuple[float, float]:
    """The shortest and the longest of something, s."""
    try:
        least, most = value
    except (TypeError, ValueError):
        raise TypeError(f"`{name}` is {value!r}: give the shortest and the longest, s, such as (1.0, 10.0)") from None
    if not (is_number(least) and is_number(most)):
        raise TypeError(f"`{name}` is {value!r}: give two numbers of seconds")
    if not 0.0 <= least <= most:
        raise Error(f"`{name}` is {value!r}: give the shortest first, and nothing negative")
    return float(least), float(most)


