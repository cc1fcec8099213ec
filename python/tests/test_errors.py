"""What cannot be asked is said with its key and a remedy."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

import piaffe



@pytest.mark.parametrize(
    ("question", "said"),
    [
        ({"speed": -0.6}, "`speed` is -0.6: give a positive number of m/s"),
        ({"speed": math.nan}, "`speed` is NaN"),
        ({"speed": math.inf}, "`speed` is inf"),
        ({"criterion": "work"}, '`criterion` is "work": give "energy" or "torque"'),
        ({"starts": 0}, "`starts` is 0: give at least 1"),
        ({"starts": -1}, "`starts` is -1: give at least 1"),
        ({"starts": 10**6}, "`starts` is 1000000: give at most 100000"),
        ({"seed": -1}, "`seed` is -1: give at least 0"),
        ({"seed": 2**64}, "`seed` is 18446744073709551616: give at most 18446744073709551615"),
        ({"threads": 0}, "`threads` is 0: give at least 1"),
        ({"threads": -1}, "`threads` is -1: give at least 1"),
        ({"set": {"links.thigh.mass": math.nan}}, "`links.thigh.mass` cannot be NaN"),
        ({"set": {"links.thigh.mass": -1.0}}, "`links.thigh.mass` must be greater than 0(.|\n)*help"),
        ({"set": {"links.thigh.mas": 1.0, "limits.frictoin": 1.0}}, "`limits.friction`(.|\n)*`links.thigh.mass`"),
    ],
)
def test_questions_that_are_none(trot: piaffe.Gait, question: dict[str, Any], said: str) -> None:
    with pytest.raises(piaffe.Error, match=said) as error:
        piaffe.optimize(trot, **{"speed": 0.6, **question})
    assert isinstance(error.value, ValueError)


@pytest.mark.parametrize("question", [{"speed": "fast"}, {"starts": 1.5}, {"seed": True}, {"threads": "2"}, {"set": {"gravity": "9.81"}}])
def test_values_of_another_kind(trot: piaffe.Gait, question: dict[str, Any]) -> None:
    with pytest.raises(TypeError):
        piaffe.optimize(trot, **{"speed": 0.6, **question})


def test_more_threads_than_cores_are_not_started(trot: piaffe.Gait) -> None:
    """A hundred thousand would wait for each other for minutes."""
    few, many = (piaffe.optimize(trot, 0.6, starts=2, threads=count, examine="none") for count in (1, 100_000))
    assert (few.cost, few.durations) == (many.cost, many.durations)


def test_a_gait_that_the_robot_has_not(quadruped: piaffe.Robot) -> None:
    with pytest.raises(piaffe.Error, match="no gait `gallop`; it has .*trot"):
        quadruped.gait("gallop")


def test_all_mistakes_of_a_specification_at_once(quadruped: piaffe.Robot) -> None:
    files = quadruped.files
    text = files["robot.toml"].replace("mass = 1.6 ", "mass = -1.6 ").replace("gear = 50.0", "geer = 50.0")
    with pytest.raises(piaffe.SpecificationError) as error:
        piaffe.Robot(text, {"trot": files["gaits/trot.toml"]})
    said = str(error.value)
    assert "robot.toml:" in said and "greater than 0" in said and "geer" in said and "`gear`" in said


def test_folders_that_are_none(tmp_path: Path) -> None:
    with pytest.raises(OSError, match="nowhere"):
        piaffe.Robot.from_toml(tmp_path / "nowhere")
    with pytest.raises(piaffe.SpecificationError, match="there is no gait in .*gaits"):
        piaffe.Robot.from_toml(tmp_path)


def test_a_speed_without_motion_is_an_answer(trot: piaffe.Gait) -> None:
    found = piaffe.optimize(trot, 4.0)
    assert found.status is piaffe.Status.INFEASIBLE and found.cost is None and not found.costs
    assert "mean speed" in found.conflicts and found.nearest_speed == pytest.approx(1.086, abs=0.01)
    for ask in (found.walk, found.plot, found.to_mjcf, found.to_html, found.to_csv):
        with pytest.raises(piaffe.NoOptimum, match="no motion .*swing clearance.*nearest speed found to work is 1.0"):
            ask()


def test_limits_that_no_motion_keeps_need_no_search(trot: piaffe.Gait) -> None:
    found = piaffe.optimize(trot.set({"limits.min_vertical_force": 500.0}), 0.6)
    assert found.status is piaffe.Status.INFEASIBLE and "min_vertical_force = 500 N" in found.message
    assert "135.9 N" in found.message and found.nearest_speed is None


def test_texts_that_are_no_results(result: piaffe.Result) -> None:
    for text in ("", "[]", "{}", "{", result.to_json()[:-5]):
        with pytest.raises(piaffe.Error, match="this is no result of piaffe: "):
            piaffe.Result.from_json(text)
    other = piaffe.Result.from_json(result.to_json().replace("mass = 1.6 ", "mass = 1.7 "))
    with pytest.raises(piaffe.Error, match="fingerprint"):
        other.walk()
    with pytest.raises(piaffe.Error, match="`rate` is 0"):
        result.walk(0.0)


def test_arrays_of_other_shapes(trot: piaffe.Gait) -> None:
    dynamics = piaffe.dynamics(trot)
    with pytest.raises(piaffe.Error, match=r"`q` has the shape \(3,\).* 4 numbers \(haunch1, knee1, haunch2, knee2\)"):
        dynamics.inertia([0.0, 0.0, 0.0])
    with pytest.raises(piaffe.Error, match="same states"):
        dynamics.bias([[0.0] * 4] * 2, [[0.0] * 4] * 3)
    with pytest.raises(piaffe.Error, match="the trot has no flight"):
        dynamics.inverse([0.0] * 4, [0.0] * 4, [0.0] * 3, stance=None)
    for leg, bound in ((3, "most 2"), (-1, "least 1"), (2**70, "most 2")):
        with pytest.raises(piaffe.Error, match=f"`leg` is {leg}: give at {bound}"):
            dynamics.foot(leg, [0.0] * 6)
        with pytest.raises(piaffe.Error, match=f"`stance` is {leg}: give at {bound}"):
            dynamics.inverse([0.0] * 4, [0.0] * 4, [0.0] * 3, stance=leg)
