"""Many tasks in chunks on an executor: as they finish, whatever becomes of the workers."""

from __future__ import annotations

import os
import time
from collections import defaultdict, deque
from collections.abc import Callable, Hashable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from dataclasses import dataclass, field
from typing import Any, Generic, List, Optional, Tuple, TypeVar, Union

T = TypeVar("T")

#: What answers a chunk, anywhere: its answers, and what each took, s.
Answers = Tuple[List[T], List[float]]

#: An executor, or what makes one: a pool whose worker was killed is of no use any more, and another one is made.
Workers = Union[Executor, Callable[[], Executor]]

#: How often executors are asked whose futures cannot be waited for, s.
POLL = 0.05


class Interrupted(RuntimeError):
    """Chunks failed too often, or the executor is broken and there is no other. What is finished is kept."""


@dataclass
class Chunks(Generic[T]):
    """Chunks of the tasks 0, 1, …, each long enough to be worth its way and short enough to be lost.

    What a task takes is predicted from those of its `kind` that are finished; until one is, chunks have one task. Towards the end they
    get shorter, so that all workers end together.
    """

    kind: Callable[[int], Hashable]
    workers: Workers
    send: Callable[[Executor, List[int]], Any]
    """Sends a chunk and gives its future, of `Answers`."""
    seconds: Tuple[float, float]
    """Shortest and longest chunk, s."""
    retries: int
    """How often a chunk is sent again."""
    in_flight: Optional[int] = None
    """How many chunks are there at a time; by default two for each worker."""
    _spent: dict[Hashable, Tuple[float, int]] = field(default_factory=lambda: defaultdict(lambda: (0.0, 0)))

    def run(self, tasks: Sequence[int]) -> Iterator[Tuple[List[int], List[T]]]:
        """These tasks, in this order at first; chunks as they finish."""
        pending: deque[int] = deque(tasks)
        running: dict[Any, List[int]] = {}
        failed: dict[int, int] = defaultdict(int)
        executor, renewed = self._executor(), 0
        count = _workers(executor)
        try:
            while pending or running:
                broken: Optional[BaseException] = None
                while pending and len(running) < (self.in_flight or 2 * count):
                    chunk = self._next(pending, count)
                    try:
                        running[self.send(executor, chunk)] = chunk
                    except BrokenExecutor as why:
                        broken = why
                        pending.extendleft(reversed(chunk))
                        break
                for future in _done(running):
                    chunk = running.pop(future)
                    try:
                        answers, seconds = future.result()
                    except Exception as why:
                        # A chunk's own questions make rows, whatever they are: this is of a worker, or of the way to it.
                        failed[chunk[0]] += 1
                        if failed[chunk[0]] > self.retries:
                            raise Interrupted(f"{len(chunk)} points from number {chunk[0]} failed {self.retries + 1} times") from why
                        pending.extendleft(reversed(chunk))
                        if isinstance(why, BrokenExecutor):
                            broken = why
                        continue
                    renewed = 0
                    self._learn(chunk, seconds)
                    yield chunk, answers
                if broken is not None and not running:
                    renewed += 1
                    executor = self._renewed(executor, broken, renewed)
        finally:
            for future in running:
                future.cancel()
            if callable(self.workers):
                executor.shutdown(wait=False)

    def _executor(self) -> Executor:
        return self.workers() if callable(self.workers) else self.workers

    def _renewed(self, executor: Executor, why: BaseException, times: int) -> Executor:
        if not callable(self.workers):
            remedy = "give a function that makes one, executor=lambda: ProcessPoolExecutor(), and it goes on by itself"
            raise Interrupted(f"the executor is broken ({why}): {remedy}; or go on with another one") from why
        if times > self.retries:
            raise Interrupted(f"{times} executors, one after another, broke before they had answered anything ({why})") from why
        executor.shutdown(wait=False)
        return self.workers()

    def _learn(self, chunk: List[int], seconds: List[float]) -> None:
        for task, spent in zip(chunk, seconds):
            total, count = self._spent[self.kind(task)]
            self._spent[self.kind(task)] = (total + spent, count + 1)

    def _predicted(self, task: int) -> Optional[float]:
        total, count = self._spent[self.kind(task)]
        return total / count if count else None

    def _next(self, pending: deque[int], workers: int) -> List[int]:
        mean = [total / count for total, count in self._spent.values() if count]
        ahead = len(pending) * (sum(mean) / len(mean)) if mean else 0.0
        least, most = self.seconds
        wanted = min(max(ahead / (4 * workers), least), most)
        chunk = [pending.popleft()]
        length = self._predicted(chunk[0])
        if length is None:
            return chunk
        while pending:
            following = self._predicted(pending[0])
            if following is None or length + following > wanted:
                break
            length += following
            chunk.append(pending.popleft())
        return chunk


def _workers(executor: Executor) -> int:
    """How many an executor has, if it says so."""
    client = getattr(executor, "_client", None)
    if client is not None and hasattr(client, "ncores"):
        return max(1, int(sum(client.ncores().values())))
    return int(getattr(executor, "_max_workers", None) or os.cpu_count() or 1)


def _done(running: dict[Any, List[int]]) -> List[Any]:
    """Those that have finished: at least one, if there are any. In the order in which they were sent."""
    if not running:
        return []
    if all(isinstance(future, Future) for future in running):
        finished = wait(running, return_when=FIRST_COMPLETED).done
        return [future for future in running if future in finished]
    while True:
        done = [future for future in running if future.done()]
        if done:
            return done
        time.sleep(POLL)
