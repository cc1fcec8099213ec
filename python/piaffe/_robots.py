"""The robots that are shipped."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property

from ._piaffe import Robot, built_in


class Robots(Mapping[str, Robot]):
    """The robots that are shipped, by name: `piaffe.robots["rabbit"]`."""

    # They are read when one is asked for first.
    @cached_property
    def _all(self) -> dict[str, Robot]:
        return dict(built_in())

    def __getitem__(self, name: str) -> Robot:
        return self._all[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._all)

    def __len__(self) -> int:
        return len(self._all)

    def __repr__(self) -> str:
        return f"<piaffe.robots: {', '.join(self)}>"


robots = Robots()
