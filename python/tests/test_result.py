"""Results are the program's, and keep what they say."""

from __future__ import annotations

import json
import pickle
import xml.etree.ElementTree as xml
from concurrent.futures import ProcessPoolExecutor
from dataclasses import FrozenInstanceError
from multiprocessing import get_context
from pathlib import Path
from typing import Callable

import numpy as np
import pytest

import piaffe


def test_an_optimum_is_the_programs_to_the_bit(
    result: piaffe.Result, program: Callable[..., str], tmp_path: Path
) -> None:
    file = tmp_path / "trot.json"
    program("optimize", "trot", "--speed", "0.6", "--json", str(file))
    other = piaffe.Result.load(file)
    assert other == result and hash(other) == hash(result)
    assert list(other.entries) == list(result.entries)
    # The program reads what is saved here, and confirms it.
    result.save(file)
    assert "trot-energy-0.6, confirmed" in program("verify", str(file))


def test_numbers_that_are_set_are_those_of_the_command_line(quadruped: piaffe.Robot, program: Callable[..., str]) -> None:
    words = ["--set", "links.thigh.mass=1.2", "--set", "limits.friction=0.8", "--criterion", "torque", "--starts", "2"]
    stated = program("optimize", "trot", "--speed", "0.5", *words, "--json", "-")
    numbers = {"links.thigh.mass": 1.2, "limits.friction": 0.8}
    found = piaffe.optimize(quadruped.gait("trot"), 0.5, "torque", set=numbers, starts=2)
    assert found == piaffe.Result.from_json(stated)
    assert found != piaffe.optimize(quadruped.gait("trot"), 0.5, "torque", starts=2)


def test_threads_and_processes_change_nothing(trot: piaffe.Gait, result: piaffe.Result) -> None:
    assert piaffe.optimize(trot, 0.6, threads=1) == result
    # A child that is forked has none of the parent's threads.
    for method in ("fork", "spawn"):
        with ProcessPoolExecutor(1, mp_context=get_context(method)) as pool:
            assert pool.submit(piaffe.optimize, trot, 0.6).result(60) == result


def test_a_result_is_frozen_and_pickles(result: piaffe.Result) -> None:
    with pytest.raises(FrozenInstanceError):
        result.speed = 1.0  # type: ignore[misc]
    result.entries["cost"] = 0.0
    assert result.cost is not None and result.cost > 15.0
    again = pickle.loads(pickle.dumps(result))
    assert again == result and again.to_json() == result.to_json()
    assert {result: 1}[again] == 1
    slower = json.loads(result.to_json())
    slower["seconds"] += 1.0
    assert piaffe.Result.from_json(json.dumps(slower)) == result, "wall times are no content"


def test_what_a_result_says(result: piaffe.Result) -> None:
    assert result.optimal and result.status is piaffe.Status.OPTIMAL
    assert result.cost == pytest.approx(15.5982, abs=1e-4) and result.unit == "N"
    receipt, proof, stability = result.receipt, result.certificate, result.stability
    assert receipt is not None and receipt.max_violation <= 1e-6 and receipt.cycle_error <= 1e-6
    assert [finding.constraint for finding in receipt.findings] == ["swing clearance"]
    assert proof is not None and proof.certified and not proof.gaps
    assert stability is not None and stability.by_clock > 1.0 > (stability.by_phase or 2.0)
    (course,) = result.phases
    assert (course.duration,) == result.durations
    assert not result.not_examined


def test_slopes_predict_a_changed_robot(trot: piaffe.Gait, result: piaffe.Result) -> None:
    slope = result.sensitivities["links.shin.length"]
    small = 1e-4 * slope.value
    costs = [piaffe.optimize(trot, 0.6, set={"links.shin.length": slope.value + d}).cost for d in (-small, small)]
    assert costs[0] is not None and costs[1] is not None
    assert (costs[1] - costs[0]) / (2 * small) == pytest.approx(slope.slope, rel=1e-3)


def test_verifying_derives_all_anew(result: piaffe.Result) -> None:
    audit = result.verify()
    assert audit and {"cost", "receipt", "certificate"} <= {statement.entry for statement in audit.statements}
    cheaper = json.loads(result.to_json())
    cheaper["cost"] *= 0.99
    audit = piaffe.Result.from_json(json.dumps(cheaper)).verify()
    assert not audit.confirmed
    (wrong,) = [statement for statement in audit.statements if statement.verdict == "not-confirmed"]
    assert wrong.entry == "cost" and wrong.differences


def test_a_walk_obeys_newton(result: piaffe.Result, trot: piaffe.Gait) -> None:
    walk = result.walk(2000.0)
    assert walk.q.shape == (len(walk), len(walk.coordinates)) and walk.feet.shape == (len(walk), len(walk.legs), 3)
    assert walk.torque.shape == (len(walk), len(walk.joints))
    dynamics = piaffe.dynamics(trot)
    first = walk.phase == 1
    # Of what is prescribed follow the torques and the reaction that the walk has.
    prescribed = [walk.coordinates.index(name) for name in dynamics.prescribed]
    inverse = dynamics.inverse(walk.q[first], walk.qd[first], walk.qdd[first][:, prescribed])
    np.testing.assert_allclose(inverse.torque, walk.torque[first], atol=1e-9)
    np.testing.assert_allclose(inverse.force, walk.force[first][:, :2], atol=1e-9)
    # What accelerates the robot's mass centre is the reaction and its weight.
    state = [np.concatenate([p[first][:, :2], q[first]], axis=1) for p, q in ((walk.p, walk.q), (walk.pd, walk.qd))]
    velocity = dynamics.centre_of_mass(*state)[1]
    mass = dynamics.inertia(walk.q[0])[0, 0]
    weight = dynamics.bias(walk.q[0], 0.0 * walk.q[0])[1]
    force = mass * np.gradient(velocity, walk.t[first], axis=0) + [0.0, weight]
    np.testing.assert_allclose(force[1:-1], walk.force[first][1:-1, :2], atol=0.05 * weight)
    # The last point of a leg is its foot.
    for k, leg in enumerate(walk.legs):
        np.testing.assert_array_equal(walk.chains[leg][:, -1], walk.feet[:, k])


def test_a_run_flies(quadruped: piaffe.Robot) -> None:
    run = piaffe.optimize(quadruped.gait("running_trot"), 1.0, "torque")
    assert run.optimal and len(run.durations) == 2
    walk = run.walk()
    flight = walk.stance == 0
    assert flight.any() and not walk.force[flight].any()
    assert run.verify()


def test_other_software_gets_it(result: piaffe.Result, program: Callable[..., str], tmp_path: Path) -> None:
    file = tmp_path / "trot.json"
    result.save(file)
    assert result.to_mjcf() == program("export", str(file), "--format", "mjcf")
    assert result.to_csv(100.0) == program("export", str(file), "--format", "csv", "--rate", "100")
    assert xml.fromstring(result.to_mjcf()).get("model") == "quadruped"


def test_a_notebook_shows_the_page(result: piaffe.Result, trot: piaffe.Gait) -> None:
    shown = result._repr_html_()
    assert shown is not None
    frame = xml.fromstring(shown.replace("<iframe", "<iframe", 1))
    page = frame.get("srcdoc")
    assert page is not None and page.startswith("<!DOCTYPE html>") and "15.598" in page
    assert piaffe.optimize(trot, 4.0)._repr_html_() is None


def test_figures_are_drawn(result: piaffe.Result, tmp_path: Path) -> None:
    figure = result.plot()
    assert {area.get_ylabel() for area in figure.axes} >= {"angle, rad", "torque, N·m", "reaction, N"}
    figure.savefig(tmp_path / "trot.png")
