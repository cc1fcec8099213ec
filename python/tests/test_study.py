"""Studies: the same table whoever answers, and whatever becomes of them."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
from collections.abc import Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any, Callable

import pytest

import piaffe

#: Two gaits that take differently long, two criteria, three designs, and a speed at which there is no motion.
POINTS: list[dict[str, Any]] = [
    {"gait": gait, "criterion": criterion, "speed": speed, "links.thigh.mass": mass}
    for mass in (1.4, 1.6, 1.8)
    for gait, speed in (("trot", 0.5), ("amble", 0.5), ("trot", 4.0))
    for criterion in ("energy", "torque")
]


def ask(robot: piaffe.Robot, points: Any = POINTS, **options: Any) -> piaffe.Study:
    return piaffe.study(points, robot, starts=2, **options)


@pytest.fixture(scope="module")
def table(quadruped: piaffe.Robot) -> str:
    return ask(quadruped).table().to_csv()


def processes() -> Executor:
    return ProcessPoolExecutor(2, mp_context=get_context("spawn"))


def test_rows_are_what_one_by_one_is_found(quadruped: piaffe.Robot, table: str) -> None:
    rows = ask(quadruped, POINTS[:6]).table()
    for point, row in zip(POINTS, rows):
        numbers = {"links.thigh.mass": point["links.thigh.mass"]}
        gait = quadruped.gait(point["gait"])
        alone = piaffe.optimize(gait, point["speed"], point["criterion"], set=numbers, starts=2)
        assert {name: row[name] for name in point} == point
        assert (row["status"], row["cost"]) == (alone.status.value, alone.cost)
        assert row["durations"] == list(alone.durations)
        if alone.optimal:
            assert row["slope.speed"] == pytest.approx(alone.sensitivities["speed"].slope)
            assert row["slope.links.thigh.mass"] == pytest.approx(alone.sensitivities["links.thigh.mass"].slope)
            assert row["certified"] is True and row["violation"] <= 1e-6 and not row["reason"]
        else:
            assert row["cost"] is None and "mean speed" in row["reason"]
    assert "\n".join(table.split("\n")[:7]) + "\n" == rows.to_csv()


def test_tables_of_all_kinds_are_questions(quadruped: piaffe.Robot) -> None:
    pandas, pyarrow = pytest.importorskip("pandas"), pytest.importorskip("pyarrow")
    points = [{"speed": 0.5, "links.thigh.mass": 1.5}, {"speed": 0.6, "links.thigh.mass": 1.7}]
    columns = {"speed": [0.5, 0.6], "links.thigh.mass": [1.5, 1.7]}
    tables = [points, columns, pandas.DataFrame(columns), pyarrow.table(columns)]
    texts = {ask(quadruped, of, gait="trot").table().to_csv() for of in tables}
    assert len(texts) == 1 and texts.pop().count("\n") == 3


def test_tables_go_elsewhere(quadruped: piaffe.Robot, tmp_path: Path) -> None:
    pandas = pytest.importorskip("pandas")
    pytest.importorskip("pyarrow")
    rows = ask(quadruped, POINTS[:6]).table()
    rows.to_parquet(tmp_path / "rows.parquet")
    rows.to_csv(tmp_path / "rows.csv")
    back = pandas.read_parquet(tmp_path / "rows.parquet")
    text = pandas.read_csv(tmp_path / "rows.csv")
    assert list(back.columns) == list(text.columns) == rows.columns
    for found in (back, text, rows.to_pandas()):
        assert [None if cost != cost else cost for cost in found["cost"]] == [row["cost"] for row in rows]


def test_processes_give_the_same_bytes(quadruped: piaffe.Robot, table: str) -> None:
    assert ask(quadruped, executor=processes).table().to_csv() == table
    with processes() as pool:
        assert ask(quadruped, executor=pool, chunk=(0.01, 0.1)).table().to_csv() == table


def kill_one(pool: Any) -> None:
    os.kill(next(iter(pool._processes)), signal.SIGKILL)


def test_a_killed_process_loses_and_changes_nothing(quadruped: piaffe.Robot, table: str) -> None:
    pools: list[Executor] = []

    def make() -> Executor:
        pools.append(processes())
        return pools[-1]

    study = ask(quadruped, executor=make, chunk=(0.01, 0.2))
    seen = []
    for row in study.as_completed():
        seen.append(row["point"])
        if len(seen) == 3:
            kill_one(pools[0])
    assert sorted(seen) == list(range(len(POINTS))) and len(pools) > 1
    assert study.table().to_csv() == table


def test_a_broken_pool_keeps_what_is_finished(quadruped: piaffe.Robot, table: str, tmp_path: Path) -> None:
    journal = tmp_path / "journal"
    with processes() as pool:
        study = ask(quadruped, executor=pool, chunk=(0.01, 0.2), journal=journal)
        with pytest.raises(piaffe.Interrupted, match="executor=lambda"):
            for row in study.as_completed():
                if study.done >= 3:
                    kill_one(pool)
    assert 3 <= study.done < len(POINTS)
    again = ask(quadruped, journal=journal)
    assert again.done == study.done
    assert again.table().to_csv() == table


def test_a_torn_journal_goes_on(quadruped: piaffe.Robot, table: str, tmp_path: Path) -> None:
    journal = tmp_path / "journal"
    assert ask(quadruped, journal=journal).table().to_csv() == table
    whole = journal.read_bytes()
    journal.write_bytes(whole[: len(whole) * 2 // 3])
    study = ask(quadruped, journal=journal)
    assert 0 < study.done < len(POINTS)
    assert study.table().to_csv() == table
    assert ask(quadruped, journal=journal).done == len(POINTS)
    with pytest.raises(piaffe.Error, match="journal of another study"):
        piaffe.study(POINTS, quadruped, starts=3, journal=journal)


class Unreliable(Executor):
    """Every other chunk is lost on its way; futures that only know whether they are done."""

    def __init__(self, every: int) -> None:
        self.every, self.count = every, 0

    def submit(self, work: Callable[..., Any], /, *task: Any, **named: Any) -> Any:
        self.count += 1
        inner: Future[Any] = Future()
        if self.count % self.every == 0:
            inner.set_exception(OSError("the node went away"))
        else:
            inner.set_result(work(*task, **named))

        class Job:
            done, result, cancel = staticmethod(inner.done), staticmethod(inner.result), staticmethod(inner.cancel)

        return Job()


def test_chunks_that_are_lost_are_sent_again_but_not_for_ever(quadruped: piaffe.Robot, table: str) -> None:
    assert ask(quadruped, executor=Unreliable(2), in_flight=1).table().to_csv() == table
    with pytest.raises(piaffe.Interrupted, match="failed 4 times") as error:
        ask(quadruped, executor=Unreliable(1)).table()
    assert isinstance(error.value.__cause__, OSError)


def test_chunks_are_as_long_as_was_asked(quadruped: piaffe.Robot) -> None:
    from piaffe._schedule import Chunks

    sent: list[list[int]] = []

    class Here(Executor):
        _max_workers = 1

        def submit(self, work: Any, /, chunk: Any, **_: Any) -> Any:
            sent.append(chunk)
            future: Future[Any] = Future()
            future.set_result(([None] * len(chunk), [work(task) for task in chunk]))
            return future

    # Tasks of one kind take 0.1 s, of the other 1 s.
    kinds = ["short" if k < 200 else "long" for k in range(240)]
    took = {"short": 0.1, "long": 1.0}
    chunks: Chunks[None] = Chunks(
        kinds, Here(), lambda pool, chunk: pool.submit(lambda task: took[kinds[task]], chunk), (1.0, 5.0), 0, 1
    )
    assert sorted(task for chunk, _ in chunks.run(range(240)) for task in chunk) == list(range(240))
    lengths = [sum(took[kinds[task]] for task in chunk) for chunk in sent]
    assert len(sent[0]) == 1 and max(lengths) <= 5.0 + 1e-9
    assert len(sent) < 40, "a chunk is worth its way"
    assert lengths[-1] <= 1.0 + 1e-9, "all end together"


def test_points_that_are_none_are_told_before_anything_is_computed(quadruped: piaffe.Robot) -> None:
    points = [{"speed": "fast", "links.thigh.mas": 1.0}, {"gait": "gallop", "speed": float("nan")}, {"criterion": "work"}]
    with pytest.raises(piaffe.Error) as error:
        ask(quadruped, points, gait="trot")
    said = str(error.value)
    for what in ("point 0: `speed` is 'fast'", "point 1: `gait` is 'gallop'", "point 1: `speed` is nan"):
        assert what in said
    assert "point 2: `criterion` is 'work'" in said and "point 2: `speed` is None" in said
    assert "did you mean `links.thigh.mass`?" in said
    with pytest.raises(piaffe.Error, match="no points"):
        ask(quadruped, [])
    with pytest.raises(piaffe.Error, match="different lengths"):
        ask(quadruped, {"speed": [0.5, 0.6], "links.thigh.mass": [1.0]}, gait="trot")


def test_a_design_that_is_none_is_a_row(quadruped: piaffe.Robot) -> None:
    (bad, slow, good) = ask(
        quadruped, [{"speed": 0.5, "links.thigh.mass": -1.0}, {"speed": -0.5}, {"speed": 0.5}], gait="trot"
    ).table()
    assert bad["status"] == slow["status"] == "no-question" and "greater than 0" in bad["reason"]
    assert "positive number" in slow["reason"] and good["status"] == "optimal"


@pytest.fixture(scope="module")
def cluster() -> Iterator[Any]:
    distributed = pytest.importorskip("distributed")
    options = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None, "memory_limit": 0}
    with distributed.LocalCluster(**options) as cluster, distributed.Client(cluster) as client:
        yield client


def test_a_dask_cluster_gives_the_same_bytes_also_when_a_worker_is_killed(
    cluster: Any, quadruped: piaffe.Robot, table: str
) -> None:
    assert ask(quadruped, executor=cluster.get_executor()).table().to_csv() == table
    study = ask(quadruped, executor=cluster.get_executor(), chunk=(0.01, 0.2))
    killed = []
    for _ in study.as_completed():
        if study.done >= 3 and not killed:
            killed.append(next(iter(cluster.run(os.getpid).values())))
            os.kill(killed[0], signal.SIGKILL)
    assert killed and killed[0] not in cluster.run(os.getpid).values()
    assert study.table().to_csv() == table


def interrupted(program: str) -> tuple[float, str]:
    """Seconds from Ctrl-C to the end of a program that says when it begins, and what it said."""
    # Elsewhere: beside the sources it would find those, without what is compiled.
    process = subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(program)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=Path(__file__).parent,
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "begins\n"
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    started = time.monotonic()
    out, err = process.communicate(timeout=30)
    return time.monotonic() - started, out + err


@pytest.mark.skipif(os.name == "nt", reason="signals are others there")
@pytest.mark.parametrize(
    "work",
    [
        "piaffe.optimize(robot.gait('curvet'), 0.6, starts=100_000)",
        "piaffe.study([{'speed': 0.2 + 1e-5 * k} for k in range(10_000)], robot, gait='curvet').table()",
    ],
)
def test_ctrl_c_ends_what_takes_long(work: str) -> None:
    seconds, said = interrupted(
        f"""
        import piaffe
        robot = piaffe.robots["quadruped"]
        print("begins", flush=True)
        try:
            {work}
        except KeyboardInterrupt:
            print("interrupted")
        """
    )
    assert said == "interrupted\n" and seconds < 5.0


def test_others_run_while_a_search_does(trot: piaffe.Gait) -> None:
    counts = [0]
    done = threading.Event()

    def count() -> None:
        while not done.is_set():
            counts[0] += 1
            time.sleep(1e-3)

    other = threading.Thread(target=count)
    other.start()
    piaffe.optimize(trot, 0.6, starts=40)
    done.set()
    other.join()
    assert counts[0] >= 20, "Python's lock was held"


@pytest.mark.slow
def test_ten_thousand_points(quadruped: piaffe.Robot) -> None:
    """What a point costs, and what of that is the scheduler's."""
    points = [{"speed": 0.3 + 6e-5 * k, "criterion": "torque"} for k in range(10_000)]
    started = time.monotonic()
    rows = piaffe.study(points, quadruped, gait="trot", starts=1, executor=processes).table()
    seconds = time.monotonic() - started
    assert all(row["status"] == "optimal" for row in rows)
    print(json.dumps({"points": len(rows), "seconds": seconds, "per point": seconds / len(rows)}))
