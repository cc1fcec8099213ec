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

#: Six designs.
DESIGNS = [
    {"links.thigh.mass": 1.4, "limits.friction": 0.9},
    {"links.thigh.mass": 1.8},
    {"limits.friction": 0.7},
    {"links.thigh.mass": 1.5},
    {"links.thigh.mass": 1.7, "limits.friction": 0.8},
    {},
]

#: Of two gaits that take differently long, 12 points.
QUESTION: dict[str, Any] = {"gait": ["trot", "amble"], "criterion": "torque", "speed": 0.6}


def ask(robot: piaffe.Robot, designs: Any = DESIGNS, **options: Any) -> piaffe.Study:
    return piaffe.study(robot, designs, **{**QUESTION, **options})


@pytest.fixture(scope="module")
def table(quadruped: piaffe.Robot) -> str:
    return ask(quadruped).table().to_csv()


def processes() -> Executor:
    return ProcessPoolExecutor(2, mp_context=get_context("spawn"))


def test_rows_are_what_one_by_one_is_found(quadruped: piaffe.Robot, table: str) -> None:
    rows = ask(quadruped, also=["certificate", "slopes", "stability"]).table()
    assert [row["point"] for row in rows] == list(range(len(rows))) and len(rows) == 12
    gaits = {design: [quadruped.set(numbers).gait(gait) for gait in QUESTION["gait"]] for design, numbers in enumerate(DESIGNS)}
    for row in rows[::5]:
        gait = gaits[row["design"]][QUESTION["gait"].index(row["gait"])]
        alone = piaffe.optimize(gait, row["speed"], row["criterion"])
        assert row["status"] == "optimal" and row["cost"] == pytest.approx(alone.cost, rel=1e-6)
        assert row["duration.1"] == pytest.approx(alone.durations[0], rel=1e-4)
        assert row["slope.speed"] == pytest.approx(alone.sensitivities["speed"].slope, rel=1e-3)
        mass = alone.sensitivities["links.thigh.mass"]
        assert row["links.thigh.mass"] == mass.value
        assert row["slope.links.thigh.mass"] == pytest.approx(mass.slope, rel=1e-3)
        assert row["certificate"] == "certified" and row["max_violation"] <= 1e-6
        pushed = alone.stability
        assert pushed is not None and row["push.by_clock"] == pytest.approx(pushed.by_clock, rel=1e-3)
        assert (row["push.by_phase"] is None) == (pushed.by_phase is None)


def test_the_command_line_writes_the_same_table(
    quadruped: piaffe.Robot, program: Callable[..., str], tmp_path: Path
) -> None:
    masses = ["--vary", "links.thigh.mass=1.4,1.6", "--vary", "limits.friction=0.7"]
    question = ["trot", "--speed", "0.5,4.0", "--criterion", "torque", "--also", "slopes"]
    program("study", *question, *masses, "--out", str(tmp_path))
    designs = {"links.thigh.mass": [1.4, 1.6], "limits.friction": [0.7, 0.7]}
    study = piaffe.study(quadruped, designs, gait="trot", speed=[0.5, 4.0], criterion="torque", also="slopes")
    assert study.table().to_csv() == (tmp_path / "study.csv").read_text(encoding="utf-8")


def test_without_a_gait_walks_are_meant(quadruped: piaffe.Robot) -> None:
    assert quadruped.usual_gaits == ["amble", "curvet", "trot"]
    asked: dict[str, Any] = {"criterion": "torque", "speed": 1.0, "starts": 1}
    rabbit = piaffe.robots["rabbit"]
    assert piaffe.study(rabbit, **asked).table().column("gait") == ["walk"]
    assert len(piaffe.study(rabbit, gait="all", **asked)) == 2
    flying = piaffe.Robot(rabbit.files["robot.toml"], {"run": rabbit.files["gaits/run.toml"]})
    assert flying.usual_gaits == ["run"], "where all fly, all"


def test_limits_at_each_real_leg_are_those_of_one_alone(quadruped: piaffe.Robot) -> None:
    asked: dict[str, Any] = {"gait": "amble", "criterion": "torque", "speed": 0.4}
    (row,) = piaffe.study(quadruped, real_legs=True, **asked).table()
    alone = piaffe.optimize(quadruped.gait("amble"), 0.4, "torque", real_legs=True)
    assert row["cost"] == pytest.approx(alone.cost, rel=1e-6)
    assert row["virtual_cost"] == pytest.approx(alone.entries["virtual_cost"], rel=1e-6)
    assert row["cost"] > 1.01 * row["virtual_cost"]
    (without,) = piaffe.study(quadruped, **asked).table()
    assert "virtual_cost" not in without and without["cost"] == pytest.approx(row["virtual_cost"], rel=1e-6)


def test_a_number_that_a_design_does_not_name_stays(quadruped: piaffe.Robot) -> None:
    rows = piaffe.study(quadruped, DESIGNS[:3], gait="trot", speed=0.5).table()
    assert rows.column("links.thigh.mass") == [1.4, 1.8, quadruped.numbers["links.thigh.mass"]]
    assert rows.column("limits.friction") == [0.9, quadruped.numbers["limits.friction"], 0.7]
    (alone,) = piaffe.study(quadruped, gait="trot", speed=0.5).table()
    assert alone["cost"] == pytest.approx(piaffe.optimize(quadruped.gait("trot"), 0.5).cost, rel=1e-6)


def test_a_number_that_differs_among_gaits_does_not_stay_as_one(quadruped: piaffe.Robot) -> None:
    clearance = "limits.swing_clearance"
    texts = {name: quadruped.files[f"gaits/{name}.toml"] for name in ("trot", "amble")}
    trot = texts["trot"].replace("swing_clearance = 0.005", "swing_clearance = 0.006")
    robot = piaffe.Robot(quadruped.files["robot.toml"], {**texts, "trot": trot})
    designs = [{clearance: 0.004}, {"links.thigh.mass": 1.5}]
    with pytest.raises(piaffe.Error, match="design 1: `limits.swing_clearance` .*0.005 in amble, 0.006 in trot"):
        piaffe.study(robot, designs, gait="all", speed=0.5)
    assert piaffe.study(robot, designs, gait="trot", speed=0.5).table().column(clearance) == [0.004, 0.006]


def test_tables_of_all_kinds_are_designs(quadruped: piaffe.Robot) -> None:
    pandas, pyarrow = pytest.importorskip("pandas"), pytest.importorskip("pyarrow")
    designs = [{"links.thigh.mass": 1.5, "gravity": 9.8}, {"links.thigh.mass": 1.7, "gravity": 9.7}]
    columns = {"links.thigh.mass": [1.5, 1.7], "gravity": [9.8, 9.7]}
    tables = [designs, iter(designs), columns, pandas.DataFrame(columns), pyarrow.table(columns)]
    texts = {piaffe.study(quadruped, of, gait="trot", speed=0.5).table().to_csv() for of in tables}
    assert len(texts) == 1 and texts.pop().count("\n") == 3


def test_tables_go_elsewhere(quadruped: piaffe.Robot, tmp_path: Path) -> None:
    pandas = pytest.importorskip("pandas")
    pytest.importorskip("pyarrow")
    # One of them has no motion at 4 m/s, and an empty cost.
    rows = piaffe.study(quadruped, DESIGNS[:1], gait="trot", speed=[0.5, 4.0]).table()
    rows.to_parquet(tmp_path / "rows.parquet")
    rows.to_csv(tmp_path / "rows.csv")
    back = pandas.read_parquet(tmp_path / "rows.parquet")
    text = pandas.read_csv(tmp_path / "rows.csv")
    assert list(back.columns) == list(text.columns) == rows.columns
    for found in (back, text, rows.to_pandas()):
        assert [None if cost != cost else cost for cost in found["cost"]] == rows.column("cost")
    assert rows[1]["status"] == "infeasible" and "mean speed" in rows[1]["conflict"]
    assert [row["point"] for row in rows[::-1]] == [1, 0]


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
    assert sorted(seen) == list(range(len(study))) and len(pools) > 1
    assert study.table().to_csv() == table


def test_a_broken_pool_keeps_what_is_finished(quadruped: piaffe.Robot, table: str, tmp_path: Path) -> None:
    journal = tmp_path / "journal"
    with processes() as pool:
        study = ask(quadruped, executor=pool, chunk=(0.01, 0.2), journal=journal)
        with pytest.raises(piaffe.Interrupted, match="executor=lambda"):
            for row in study.as_completed():
                if study.done >= 3:
                    kill_one(pool)
    assert 3 <= study.done < len(study)
    again = ask(quadruped, journal=journal)
    assert again.done == study.done
    assert again.table().to_csv() == table


def test_a_torn_journal_goes_on(quadruped: piaffe.Robot, table: str, tmp_path: Path) -> None:
    journal = tmp_path / "journal"
    assert ask(quadruped, journal=journal).table().to_csv() == table
    whole = journal.read_bytes()
    journal.write_bytes(whole[: len(whole) * 2 // 3])
    study = ask(quadruped, journal=journal)
    assert 0 < study.done < len(study)
    assert study.table().to_csv() == table
    assert ask(quadruped, journal=journal).done == len(study)
    lines = journal.read_text().splitlines()
    journal.write_text("\n".join([*lines[:-1], lines[-1].replace("optimal", "infeasible")]) + "\n")
    study = ask(quadruped, journal=journal)
    assert study.done == len(study) - 1, "a row that was changed was believed"
    assert study.table().to_csv() == table
    with pytest.raises(piaffe.Error, match="journal of another study"):
        ask(quadruped, starts=3, journal=journal)


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

        def submit(self, work: Any, /, *chunk: Any, **_: Any) -> Any:
            sent.append(list(chunk))
            future: Future[Any] = Future()
            future.set_result(([None] * len(chunk), [work(task) for task in chunk]))
            return future

    # Tasks of one kind take 0.1 s, of the other 1 s.
    kinds = ["short" if k < 200 else "long" for k in range(240)]
    took = {"short": 0.1, "long": 1.0}

    def seconds(*tasks: int) -> float:
        return took[kinds[tasks[0]]]

    chunks: Chunks[None] = Chunks(
        lambda task: kinds[task], Here(), lambda pool, chunk: pool.submit(seconds, *chunk), (1.0, 5.0), 0, 1
    )
    assert sorted(task for chunk, _ in chunks.run(range(240)) for task in chunk) == list(range(240))
    lengths = [sum(took[kinds[task]] for task in chunk) for chunk in sent]
    assert len(sent[0]) == 1 and max(lengths) <= 5.0 + 1e-9
    assert len(sent) < 40, "a chunk is worth its way"
    assert lengths[-1] <= 1.0 + 1e-9, "all end together"


def test_what_cannot_be_asked_is_told_before_anything_is_computed(quadruped: piaffe.Robot) -> None:
    with pytest.raises(piaffe.Error) as error:
        ask(quadruped, [{"links.thigh.mass": "heavy", "links.thigh.mas": 1.0}, {"limits.friction": float("nan")}])
    said = str(error.value)
    assert "design 0: `links.thigh.mass` is 'heavy': give a number" in said
    assert "design 1: `limits.friction` is nan" in said and "did you mean `links.thigh.mass`?" in said
    with pytest.raises(piaffe.Error, match="no gait `gallop`(.|\n)*speed of -1 m/s"):
        ask(quadruped, gait="gallop", speed=-1.0)
    with pytest.raises(piaffe.Error, match='`criterion` is "work"'):
        ask(quadruped, criterion="work")
    with pytest.raises(piaffe.Error, match='`also` has "proof": give some of "certificate"'):
        ask(quadruped, also="proof")
    with pytest.raises(piaffe.Error, match="there is no design"):
        ask(quadruped, [])
    for none in (3, "threads", [1]):
        with pytest.raises(TypeError, match="`executor` is .*: give one with `submit"):
            ask(quadruped, executor=none)
    refused: list[tuple[dict[str, Any], str]] = [
        ({"in_flight": 0}, "`in_flight` is 0: give at least 1"),
        ({"in_flight": -1}, "`in_flight` is -1: give at least 1"),
        ({"retries": -1}, "`retries` is -1: give at least 0"),
        ({"starts": 0}, "`starts` is 0: give at least 1"),
        ({"seed": -1}, "`seed` is -1"),
        ({"chunk": (10.0, 1.0)}, "`chunk` is .*: give the shortest first"),
    ]
    for options, said in refused:
        with pytest.raises(piaffe.Error, match=said):
            ask(quadruped, **options)
    of_another_kind: list[tuple[dict[str, Any], str]] = [
        ({"retries": "x"}, "`retries` is 'x': give a whole number"),
        ({"chunk": 5}, "`chunk` is 5: give the shortest and the longest"),
        ({"designs": 5}, "`designs` is 5: give mappings"),
        ({"designs": [5]}, "design 0 is 5: give a mapping"),
        ({"gait": quadruped.gait("trot")}, "`gait` is .*: give a name"),
        ({"designs": {"gravity": 9.81}}, "`gravity` is 9.81: give a list"),
    ]
    for options, said in of_another_kind:
        with pytest.raises(TypeError, match=said):
            ask(quadruped, **options)
    for robot in ("quadruped", [quadruped]):
        with pytest.raises(TypeError, match="`robot` is .*: give a piaffe.Robot"):
            ask(robot)  # type: ignore[arg-type]
    with pytest.raises(piaffe.Error, match=r"design 1: `links.\{thigh,shin\}.mass` is no single number"):
        ask(quadruped, [{"links.{thigh,shin}.mass": 1.0}, {"limits.friction": 0.7}])
    with pytest.raises(piaffe.Error, match="different lengths"):
        ask(quadruped, {"gravity": [9.8, 9.7], "links.thigh.mass": [1.0]})


def test_a_design_that_is_none_is_a_row(quadruped: piaffe.Robot) -> None:
    (bad, good) = piaffe.study(quadruped, {"links.thigh.mass": [-1.0, 1.5]}, gait="trot", speed=0.5).table()
    assert bad["status"] == "no-robot" and "greater than 0" in bad["reason"] and bad["cost"] is None
    assert good["status"] == "optimal"


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
    killed: list[int] = []
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
        "piaffe.study(robot, {'links.thigh.mass': [1.5 + 1e-5 * k for k in range(10_000)]}, gait='curvet', speed=0.6).table()",
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
    designs = {"links.thigh.mass": [1.3 + 1e-4 * k for k in range(5_000)]}
    study = piaffe.study(quadruped, designs, gait="trot", speed=0.6, criterion=["energy", "torque"], executor=processes)
    started, clock = time.monotonic(), time.process_time()
    rows = study.table()
    clock = time.process_time() - clock
    seconds = time.monotonic() - started
    assert all(row["status"] == "optimal" for row in rows)
    print(json.dumps({"points": len(rows), "seconds": seconds, "scheduler, s per point": clock / len(rows)}))
