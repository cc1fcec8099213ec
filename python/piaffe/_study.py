"""Many questions: a table of designs in, a table of rows out, the same whoever answers."""

from __future__ import annotations

import csv
import io
import json
import os
import zlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING, Any, List, Optional, Tuple, Union

from . import _piaffe
from ._given import MOST_STARTS, SEEDS, is_number, seconds, whole
from ._piaffe import Error, Question, Robot
from ._schedule import Answers, Chunks, Workers

if TYPE_CHECKING:
    from os import PathLike

    import pandas
    import pyarrow

#: A row of a table, by the names of its columns.
Row = dict[str, Any]

#: The same as the table's columns have it.
Cells = List[Any]


def study(
    robot: Robot,
    designs: Any = None,
    *,
    gait: Union[str, Iterable[str], None] = None,
    speed: Union[float, Iterable[float]],
    criterion: Union[str, Iterable[str]] = "energy",
    real_legs: bool = False,
    also: Union[str, Iterable[str]] = (),
    starts: Optional[int] = None,
    seed: int = 1,
    executor: Optional[Workers] = None,
    chunk: Tuple[float, float] = (1.0, 10.0),
    in_flight: Optional[int] = None,
    retries: int = 3,
    journal: str | PathLike[str] | None = None,
) -> Study:
    """The optima of every design with every gait, criterion and speed (m/s): a point each.

    `designs` are mappings of numbers as in `Robot.set`, or a table of them (of pandas, of pyarrow, or a mapping of columns); a number
    that a design does not name stays as it is. Without designs the robot itself is asked about, and without a `gait` those that never
    leave the ground (where all fly, all). `gait="all"` are those that fly too, whose searches take ten times as long. With `real_legs` the
    limits hold at each real leg too, where the platform rolls: `cost` is then the real joints', and `virtual_cost` that without these limits.
    `also` is what is told of an optimum beyond its receipt: "certificate", "slopes", "stability".

    A point is sought from the optima of `robot` itself, and from `starts` random starts of `seed` that know nothing of these: 1 by
    default, and as many as the evidence asks for where that leads to no optimum.

    Nothing is computed until rows are asked for: `as_completed`, `table`. Without an `executor` all cores of this machine work. With
    one (of `concurrent.futures`, Dask, loky, submitit, …), chunks of points travel to its workers, each of `chunk` seconds at least and
    at most. A chunk whose worker died is sent again, `retries` times at most. A pool of processes does not outlive a worker that was
    killed: give a function that makes one instead, `executor=lambda: ProcessPoolExecutor()`.

    `journal` is a file that keeps rows as they come: the same study with the same journal goes on where it was interrupted.

    A row, and the bytes of the table, depend on nothing but the question.

    Raises `Error` where there is no such question, before anything is computed.
    """
    if not isinstance(robot, Robot):
        raise TypeError(f"`robot` is {robot!r}: give a piaffe.Robot, such as piaffe.robots[\"quadruped\"]")
    starts, seed = whole("starts", starts, most=MOST_STARTS), whole("seed", seed, least=0, most=SEEDS)
    chunk, in_flight, retries = seconds("chunk", chunk), whole("in_flight", in_flight), whole("retries", retries, least=0)
    gaits, criteria, extras = _gaits(robot, gait), _list("criterion", criterion), _list("also", also)
    names, rows = _designs(robot, designs, gaits)
    if executor is not None and not callable(executor) and not callable(getattr(executor, "submit", None)):
        expected = "give one with `submit(function, *arguments)`, a function that makes one, or none for all cores of this machine"
        raise TypeError(f"`executor` is {executor!r}: {expected}")
    speeds = list(speed) if isinstance(speed, Iterable) and not isinstance(speed, str) else [speed]
    question = Question(robot, names, rows, gaits, criteria, speeds, real_legs, starts, seed, extras)
    return Study(question, executor, chunk, in_flight, retries, None if journal is None else Path(journal))


def _gaits(robot: Robot, given: Union[str, Iterable[str], None]) -> List[str]:
    if given is None:
        return robot.usual_gaits
    return robot.gaits if isinstance(given, str) and given == "all" else _list("gait", given)


def _list(name: str, given: Union[str, Iterable[str]]) -> List[str]:
    names = [given] if isinstance(given, str) or not isinstance(given, Iterable) else list(given)
    if any(not isinstance(one, str) for one in names):
        raise TypeError(f"`{name}` is {given!r}: give a name or a list of names")
    return names


def _column(name: str, given: Any) -> List[Any]:
    if isinstance(given, str) or not isinstance(given, Iterable):
        raise TypeError(f"`{name}` is {given!r}: give a list of numbers, one for each design")
    return list(given)


def _design(k: int, given: Any) -> dict[str, Any]:
    try:
        return dict(given)
    except (TypeError, ValueError):
        raise TypeError(f"design {k} is {given!r}: give a mapping of numbers by their names") from None


def _designs(robot: Robot, designs: Any, gaits: Sequence[str]) -> Tuple[List[str], List[List[float]]]:
    """Names and numbers of a table of any kind."""
    if designs is None:
        return [], [[]]
    if hasattr(designs, "to_pylist"):
        table = list(designs.to_pylist())
    elif hasattr(designs, "to_dict") and hasattr(designs, "columns"):
        table = list(designs.to_dict("records"))
    elif isinstance(designs, Mapping):
        columns = {name: _column(name, column) for name, column in designs.items()}
        lengths = {name: len(column) for name, column in columns.items()}
        if len(set(lengths.values())) > 1:
            raise Error(f"the columns of the designs have different lengths: {lengths}")
        table = [dict(zip(columns, numbers)) for numbers in zip(*columns.values())]
    elif isinstance(designs, str) or not isinstance(designs, Iterable):
        raise TypeError(f"`designs` is {designs!r}: give mappings of numbers by their names, or a table of them")
    else:
        table = [_design(k, design) for k, design in enumerate(designs)]
    names = list(dict.fromkeys(name for design in table for name in design))
    faults = [
        f"design {k}: `{name}` is {value!r}: give a number"
        for k, design in enumerate(table)
        for name, value in design.items()
        if not is_number(value)
    ]
    known = robot.numbers
    faults += robot.unknown(names)
    for name, values in robot.differing.items():
        left = [k for k, design in enumerate(table) if name not in design] if name in names else []
        asked = {gait: value for gait, value in values.items() if gait in gaits}
        if len(set(asked.values())) == 1:
            known[name] = next(iter(asked.values()))
        elif left:
            each = ", ".join(f"{value!r} in {gait}" for gait, value in asked.items() or values.items())
            faults.append(f"design {left[0]}: `{name}` is not the same in all gaits ({each}): give it, or ask about one gait")
    for name in names:
        left = [k for k, design in enumerate(table) if name not in design]
        if left and not (name in known or name in robot.differing or robot.unknown([name])):
            faults.append(f"design {left[0]}: `{name}` is no single number that stands in the robot's files: give it to every design")
    if faults:
        raise Error("\n".join(faults[:20]) + (f"\nand {len(faults) - 20} more" if len(faults) > 20 else ""))
    return names, [[float(design[name] if name in design else known[name]) for name in names] for design in table]


def _answers(
    outline: Question,
    points: List[Tuple[int, List[float]]],
    stop: Optional[_piaffe.Stop] = None,
) -> Answers[Cells]:
    """A chunk, where it is answered."""
    rows, seconds = _piaffe.answers(outline, points, 1, stop or _piaffe.Stop())
    return json.loads(rows), seconds


class Study:
    """The rows of a study, as they come and as a table. What was answered once is kept."""

    def __init__(
        self,
        question: Question,
        executor: Optional[Workers],
        chunk: Tuple[float, float],
        in_flight: Optional[int],
        retries: int,
        journal: Optional[Path],
    ) -> None:
        self._question = question
        self._executor, self._chunk, self._in_flight, self._retries = executor, chunk, in_flight, retries
        self._journal = None if journal is None else _Journal(journal, question.fingerprint)
        self._rows: dict[int, Cells] = {} if self._journal is None else dict(self._journal.rows)

    @property
    def columns(self) -> List[str]:
        """Names of the table's columns."""
        return [name for name, _ in self._question.columns]

    def __len__(self) -> int:
        """How many points it has."""
        return len(self._question)

    @property
    def done(self) -> int:
        """How many of them are answered."""
        return len(self._rows)

    def as_completed(self) -> Iterator[Row]:
        """All rows: first those that are known, then the others as they finish. `point` counts from 0."""
        columns = self.columns
        known = sorted(self._rows)
        yield from (dict(zip(columns, self._rows[k])) for k in known)
        for chunk in self._run():
            yield from (dict(zip(columns, self._rows[k])) for k in chunk)

    def table(self) -> Table:
        """The rows in the order of the points, when all are answered."""
        for _ in self._run():
            pass
        return Table(self._question.columns, [self._rows[k] for k in range(len(self))])

    def _run(self) -> Iterator[List[int]]:
        """Answers what is open; chunks as they finish."""
        open = [k for k in range(len(self)) if k not in self._rows]
        outline, stop = self._question.outline(), _piaffe.Stop()
        workers = self._executor
        if workers is None and open:
            # What the points have in common is derived on all cores, before each has a point of its own.
            _piaffe.answers(outline, [], None, stop)

        def send(executor: Executor, chunk: List[int]) -> Any:
            points = [self._question.point(k) for k in chunk]
            if self._executor is None:
                return executor.submit(_answers, outline, points, stop)
            return executor.submit(_answers, outline, points)

        threads: Workers = lambda: ThreadPoolExecutor(os.cpu_count())  # noqa: E731
        chunks: Chunks[Cells] = Chunks(
            self._question.kind, workers or threads, send, self._chunk, self._retries, self._in_flight
        )
        try:
            for chunk, rows in chunks.run(open):
                if self._journal is not None:
                    self._journal.add(chunk, rows)
                self._rows.update(zip(chunk, rows))
                yield chunk
        finally:
            stop.set()

    def __repr__(self) -> str:
        return f"<piaffe.Study: {self.done} of {len(self)} points answered>"


class Table(Sequence[Row]):
    """The rows of a study in the order of its points, each with the same columns. What there is not to tell is None."""

    def __init__(self, columns: List[Tuple[str, str]], rows: List[Cells]) -> None:
        self._kinds = dict(columns)
        self._rows = rows

    @property
    def columns(self) -> List[str]:
        return list(self._kinds)

    def __len__(self) -> int:
        return len(self._rows)

    def __getitem__(self, k: Any) -> Any:
        return [self[j] for j in range(len(self))[k]] if isinstance(k, slice) else dict(zip(self._kinds, self._rows[k]))

    def column(self, name: str) -> List[Any]:
        """All that stands in a column."""
        k = self.columns.index(name)
        return [row[k] for row in self._rows]

    def to_csv(self, path: str | PathLike[str] | None = None) -> str:
        """A line per row, as `piaffe study` writes it; what there is not to tell is empty."""
        text = io.StringIO()
        lines = csv.writer(text, lineterminator="\n")
        lines.writerow(self.columns)
        lines.writerows(map(_written, row) for row in self._rows)
        if path is not None:
            Path(path).write_text(text.getvalue(), encoding="utf-8")
        return text.getvalue()

    def to_arrow(self) -> pyarrow.Table:
        """Needs pyarrow."""
        import pyarrow

        kinds = {"integer": pyarrow.int64(), "number": pyarrow.float64(), "text": pyarrow.string()}
        columns = zip(*self._rows) if self._rows else [()] * len(self._kinds)
        arrays = [pyarrow.array(column, kinds[kind]) for column, kind in zip(columns, self._kinds.values())]
        return pyarrow.table(arrays, names=self.columns)

    def to_parquet(self, path: str | PathLike[str]) -> None:
        """Needs pyarrow."""
        from pyarrow import parquet

        parquet.write_table(self.to_arrow(), path)

    def to_pandas(self) -> pandas.DataFrame:
        """Needs pandas."""
        import pandas

        return pandas.DataFrame(self._rows, columns=self.columns)

    def __repr__(self) -> str:
        return f"<piaffe.Table: {len(self)} rows of {len(self._kinds)} columns>"


def _written(cell: Any) -> Any:
    """As the program writes it: the shortest digits that are the number, and exponents without more."""
    if not isinstance(cell, float) or "e" not in repr(cell):
        return cell
    digits, exponent = repr(cell).split("e")
    return f"{digits}e{int(exponent)}"


class _Journal:
    """Rows in a file, a line each behind one that names the question. A line that was cut off or changed is not there."""

    def __init__(self, path: Path, question: str) -> None:
        self._path = path
        self.rows: dict[int, Cells] = {}
        lines = path.read_bytes().splitlines(keepends=True) if path.exists() else []
        whole = [line for line in lines if line.endswith(b"\n")]
        if whole and whole[0] != self._first(question):
            raise Error(f"{path} is the journal of another study, or none: give another file, or remove it")
        entries = {line: entry for line in whole[1:] if (entry := self._read(line)) is not None}
        self.rows = dict(entries.values())
        kept = whole[:1] + list(entries)
        if not whole or kept != lines:
            path.write_bytes(b"".join(kept) or self._first(question))

    @staticmethod
    def _first(question: str) -> bytes:
        return json.dumps({"piaffe study": question}).encode() + b"\n"

    @staticmethod
    def _read(line: bytes) -> Optional[Tuple[int, Cells]]:
        try:
            point, cells, check = json.loads(line)
        except ValueError:
            return None
        return (point, cells) if check == _check(point, cells) else None

    def add(self, points: List[int], rows: List[Cells]) -> None:
        with self._path.open("a", encoding="utf-8") as file:
            file.writelines(json.dumps([point, cells, _check(point, cells)]) + "\n" for point, cells in zip(points, rows))


def _check(point: int, cells: Cells) -> int:
    return zlib.crc32(json.dumps([point, cells]).encode())
