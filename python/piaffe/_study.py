"""Many questions: a table of points in, a table of rows out, the same whoever answers them."""

from __future__ import annotations

import csv
import hashlib
import io
import json
import os
from collections.abc import Hashable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, List, Optional, Tuple

from . import _piaffe
from ._piaffe import Error, Robot
from ._schedule import Answers, Chunks, Interrupted, Workers

if TYPE_CHECKING:
    from os import PathLike

    import pandas
    import pyarrow

__all__ = ["Interrupted", "Row", "Study", "Table", "study"]

#: The answer to a point: the columns of a table.
Row = dict[str, Any]

#: What a point has beside numbers of the specification.
QUESTION = ("gait", "criterion", "speed")

#: What a row says of its answer, before slopes and reason.
ANSWER = (
    "status",
    "cost",
    "energy",
    "torque",
    "step_length",
    "durations",
    "violation",
    "cycle_error",
    "kkt_residual",
    "certified",
    "active",
)


def study(
    points: Any,
    robot: Robot,
    *,
    gait: Optional[str] = None,
    criterion: str = "energy",
    starts: Optional[int] = None,
    seed: int = 1,
    executor: Optional[Workers] = None,
    chunk: Tuple[float, float] = (1.0, 10.0),
    in_flight: Optional[int] = None,
    retries: int = 3,
    journal: str | PathLike[str] | None = None,
) -> Study:
    """The optima of many points: designs of a robot, gaits, criteria, speeds.

    `points` are mappings, or a table (of pandas, of pyarrow, or a mapping of columns). Each has a `speed` (m/s), and may have a `gait`
    and a `criterion`, else those given here. All other entries are numbers of the specification, as in `Robot.set`:
    `{"speed": 0.6, "links.thigh.mass": 1.2}`. `starts` and `seed` are those of `optimize`, and so are the optima.

    Nothing is computed until rows are asked for: `as_completed`, `table`. Without an `executor` all cores of this machine work. With
    one (of `concurrent.futures`, Dask, loky, submitit, …), chunks of points travel to its workers, each of `chunk` seconds at least and
    at most. A chunk whose worker died is sent again, `retries` times at most. A pool of processes does not outlive a worker that was
    killed: give a function that makes one instead, `executor=lambda: ProcessPoolExecutor()`.

    `journal` is a file that keeps rows as they come: the same study with the same journal goes on where it was interrupted.

    A row, and the bytes of the table, depend on nothing but the question.

    Raises `Error` where a point is none, before anything is computed.
    """
    table = _records(points)
    known = set(robot.gaits)
    faults: List[str] = []
    gait = gait or (robot.gaits[0] if len(known) == 1 else None)
    asked: List[Row] = []
    for k, point in enumerate(table):
        question = {"gait": point.get("gait", gait), "criterion": point.get("criterion", criterion), "speed": point.get("speed")}
        if question["gait"] not in known:
            faults.append(f"point {k}: `gait` is {question['gait']!r}; the robot has {', '.join(robot.gaits)}")
        if question["criterion"] not in ("energy", "torque"):
            faults.append(f"point {k}: `criterion` is {question['criterion']!r}; give \"energy\" or \"torque\"")
        numbers = {name: value for name, value in point.items() if name not in QUESTION}
        for name, value in (("speed", question["speed"]), *numbers.items()):
            if not _is_number(value):
                faults.append(f"point {k}: `{name}` is {value!r}; give a number")
        asked.append({**question, **numbers})
    if not asked:
        faults.append("there are no points")
    faults += _piaffe.unknown(robot, list(dict.fromkeys(name for point in asked for name in point if name not in QUESTION)))
    if faults:
        more = f"\nand {len(faults) - 20} more" if len(faults) > 20 else ""
        raise Error("\n".join(faults[:20]) + more)
    return Study(robot, asked, starts, seed, executor, chunk, in_flight, retries, journal)


def _records(points: Any) -> List[Mapping[str, Any]]:
    """The points of a table of any kind."""
    if hasattr(points, "to_pylist"):
        return list(points.to_pylist())
    if hasattr(points, "to_dict") and hasattr(points, "columns"):
        return list(points.to_dict("records"))
    if isinstance(points, Mapping):
        columns = {name: list(column) for name, column in points.items()}
        lengths = {name: len(column) for name, column in columns.items()}
        if len(set(lengths.values())) > 1:
            raise Error(f"the columns of the points have different lengths: {lengths}")
        return [dict(zip(columns, values)) for values in zip(*columns.values())]
    return list(points)


def _is_number(value: Any) -> bool:
    try:
        return not isinstance(value, (str, bool)) and abs(float(value)) < float("inf")
    except (TypeError, ValueError):
        return False


def _answers(
    robot: Robot,
    points: List[Tuple[dict[str, float], str, str, float]],
    starts: Optional[int],
    seed: int,
    stop: Optional[_piaffe.Stop] = None,
) -> Answers[Row]:
    """A chunk, where it is answered."""
    rows, seconds = _piaffe.answers(robot, points, starts, seed, stop or _piaffe.Stop())
    return json.loads(rows), seconds


class Study:
    """The rows of a study, as they come and as a table. What was answered once is kept."""

    def __init__(
        self,
        robot: Robot,
        points: List[Row],
        starts: Optional[int],
        seed: int,
        executor: Optional[Workers],
        chunk: Tuple[float, float],
        in_flight: Optional[int],
        retries: int,
        journal: str | PathLike[str] | None,
    ) -> None:
        self.robot = robot
        self.points = points
        self._search = (starts, seed)
        self._executor, self._chunk, self._in_flight, self._retries = executor, chunk, in_flight, retries
        self._rows: dict[int, Row] = {}
        self._journal = None if journal is None else _Journal(Path(journal), self._question)
        if self._journal is not None:
            self._rows.update(self._journal.rows)

    @cached_property
    def _question(self) -> str:
        question = [_piaffe.__version__, self.robot.files, self.points, self._search]
        return hashlib.sha256(json.dumps(question, sort_keys=True, default=float).encode()).hexdigest()

    def __len__(self) -> int:
        return len(self.points)

    @property
    def done(self) -> int:
        """How many points are answered."""
        return len(self._rows)

    def as_completed(self) -> Iterator[Row]:
        """All rows: first those that are known, then the others as they finish. `point` counts from 0."""
        yield from (self._row(k) for k in sorted(self._rows))
        for chunk in self._run():
            yield from map(self._row, chunk)

    def table(self) -> Table:
        """The rows in the order of the points, when all are answered."""
        for _ in self._run():
            pass
        return Table(self._columns, [self._row(k) for k in range(len(self))])

    def _run(self) -> Iterator[List[int]]:
        stop = _piaffe.Stop()
        local = self._executor is None

        def send(executor: Executor, chunk: List[int]) -> Any:
            task = (self.robot, [self._task(k) for k in chunk], *self._search)
            return executor.submit(_answers, *task, stop) if local else executor.submit(_answers, *task)

        workers: Workers = self._executor or (lambda: ThreadPoolExecutor(os.cpu_count()))
        kinds = [(point["gait"], point["criterion"]) for point in self.points]
        chunks: Chunks[Row] = Chunks(kinds, workers, send, self._chunk, self._retries, self._in_flight)
        try:
            for chunk, rows in chunks.run(self._open()):
                if self._journal is not None:
                    self._journal.add(chunk, rows)
                self._rows.update(zip(chunk, rows))
                yield chunk
        finally:
            stop.set()

    def _task(self, k: int) -> Tuple[dict[str, float], str, str, float]:
        point = self.points[k]
        return self._numbers(k), point["gait"], point["criterion"], float(point["speed"])

    def _numbers(self, k: int) -> dict[str, float]:
        return {name: float(value) for name, value in self.points[k].items() if name not in QUESTION}

    def _open(self) -> List[int]:
        """Points without an answer, those of a design side by side: its dynamics are derived once."""
        designs: dict[Hashable, int] = {}
        for k, point in enumerate(self.points):
            designs.setdefault((point["gait"], *self._numbers(k).items()), k)
        open = (k for k in range(len(self)) if k not in self._rows)
        return sorted(open, key=lambda k: (designs[(self.points[k]["gait"], *self._numbers(k).items())], k))

    @cached_property
    def _varied(self) -> List[str]:
        return list(dict.fromkeys(name for point in self.points for name in point if name not in QUESTION))

    @property
    def _columns(self) -> List[str]:
        slopes = [f"slope.{name}" for name in ("speed", *self._varied)]
        return ["point", *QUESTION, *self._varied, *ANSWER, *slopes, "reason"]

    def _row(self, k: int) -> Row:
        answer = self._rows[k]
        slopes = {f"slope.{name}": slope for name, slope in answer.get("slopes", {}).items()}
        known = {"point": k, **self.points[k], **answer, **slopes}
        return {column: known.get(column) for column in self._columns}


class Table(Sequence[Row]):
    """Rows with the same columns, in the order of the question. Durations (s) and active limits are lists."""

    def __init__(self, columns: List[str], rows: List[Row]) -> None:
        self.columns = columns
        self._rows = rows

    def __len__(self) -> int:
        return len(self._rows)

    def __getitem__(self, k: Any) -> Any:
        return self._rows[k]

    def to_csv(self, path: str | PathLike[str] | None = None) -> str:
        """A line per row. Lists are separated by semicolons; what is absent is empty."""
        text = io.StringIO()
        lines = csv.writer(text, lineterminator="\n")
        lines.writerow(self.columns)
        lines.writerows([_cell(row[column]) for column in self.columns] for row in self._rows)
        if path is not None:
            Path(path).write_text(text.getvalue(), encoding="utf-8")
        return text.getvalue()

    def to_arrow(self) -> pyarrow.Table:
        """A table of pyarrow."""
        import pyarrow

        return pyarrow.table({column: [row[column] for row in self._rows] for column in self.columns})

    def to_parquet(self, path: str | PathLike[str]) -> None:
        """Needs pyarrow."""
        from pyarrow import parquet

        parquet.write_table(self.to_arrow(), path)

    def to_pandas(self) -> pandas.DataFrame:
        """Needs pandas."""
        import pandas

        return pandas.DataFrame(self._rows, columns=self.columns)

    def __repr__(self) -> str:
        return f"<piaffe.Table: {len(self)} rows of {len(self.columns)} columns>"


def _cell(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, list):
        return ";".join(map(_cell, value))
    return repr(value) if isinstance(value, float) else str(value)


class _Journal:
    """Rows in a file, a line each behind one that names the question. A line that was cut off is not there."""

    def __init__(self, path: Path, question: str) -> None:
        self._path = path
        self.rows: dict[int, Row] = {}
        lines = path.read_bytes().splitlines(keepends=True) if path.exists() else []
        whole = [line for line in lines if line.endswith(b"\n")]
        if whole and json.loads(whole[0]) != {"question": question}:
            raise Error(f"{path} is the journal of another study: give another file, or remove it")
        for line in whole[1:]:
            entry = json.loads(line)
            self.rows[entry["point"]] = entry["row"]
        if not whole or whole != lines:
            path.write_bytes(b"".join(whole) or json.dumps({"question": question}).encode() + b"\n")

    def add(self, points: List[int], rows: List[Row]) -> None:
        with self._path.open("a", encoding="utf-8") as file:
            file.writelines(json.dumps({"point": k, "row": row}) + "\n" for k, row in zip(points, rows))
