"""Robots: from files, from texts, from others, with other numbers."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
from pathlib import Path

import pytest

import piaffe

ROOT = Path(__file__).parents[2]

URDF = """<robot name="biped">
  <link name="base"><inertial><mass value="8"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  {legs}
</robot>"""

LEG = """
  <link name="{side}_thigh"><inertial><origin xyz="0 0 -0.1"/><mass value="1.5"/>
    <inertia ixx="0.01" iyy="0.01" izz="0.001" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="{side}_shin"><inertial><origin xyz="0 0 -0.1"/><mass value="0.7"/>
    <inertia ixx="0.005" iyy="0.005" izz="0.0005" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><origin xyz="0 0 -0.25"/><geometry><sphere radius="0.01"/></geometry></collision></link>
  <joint name="{side}_hip" type="revolute"><parent link="base"/><child link="{side}_thigh"/><origin xyz="0 {y} 0"/>
    <axis xyz="0 1 0"/><limit lower="-1.5" upper="1.5" effort="{effort}" velocity="15"/></joint>
  <joint name="{side}_knee" type="revolute"><parent link="{side}_thigh"/><child link="{side}_shin"/><origin xyz="0 0 -0.25"/>
    <axis xyz="0 1 0"/><limit lower="0" upper="2.5" effort="{effort}" velocity="15"/></joint>"""


def urdf(folder: Path, effort: float) -> Path:
    legs = "".join(LEG.format(side=side, y=y, effort=effort) for side, y in (("left", 0.1), ("right", -0.1)))
    file = folder / "biped.urdf"
    file.write_text(URDF.format(legs=legs))
    return file


def test_all_shipped_robots_are_there() -> None:
    found = {(name, gait) for name, robot in piaffe.robots.items() for gait in robot.gaits}
    folders = {"quadruped": ROOT / "model-spec", "rabbit": ROOT / "model-spec/rabbit", "a1": ROOT / "model-spec/a1"}
    shipped = {(name, file.stem) for name, folder in folders.items() for file in (folder / "gaits").glob("*.toml")}
    assert found == shipped
    nested = {folder.parent.name for folder in (ROOT / "model-spec").glob("*/robot.toml")}
    assert nested | {"quadruped"} == set(piaffe.robots)


def test_a_folder_and_its_texts_are_one_robot() -> None:
    robot = piaffe.Robot.from_toml(ROOT / "model-spec/rabbit")
    texts = robot.files
    gaits = {name: texts[f"gaits/{name}.toml"] for name in ("run", "walk")}
    assert piaffe.Robot(texts["robot.toml"], gaits) == robot
    assert robot.name == "RABBIT" and robot.gaits == ["run", "walk"]


def test_robots_and_gaits_travel(quadruped: piaffe.Robot, trot: piaffe.Gait) -> None:
    changed = quadruped.set({"links.thigh.mass": 1.2})
    assert pickle.loads(pickle.dumps(changed)) == changed != quadruped
    assert hash(pickle.loads(pickle.dumps(changed))) == hash(changed)
    again = pickle.loads(pickle.dumps(trot.set({"links.thigh.mass": 1.2})))
    assert again == changed.gait("trot") != trot
    assert again.parameters["links.thigh.mass"] == (1.2, "kg")


def test_numbers_are_set_together(quadruped: piaffe.Robot) -> None:
    # Neither of the two makes a robot by itself.
    low, high = "joints.knee.range.lower", "joints.knee.range.upper"
    both = quadruped.set({low: 0.5, high: 1.5})
    assert "range = [0.5, 1.5]" in both.files["robot.toml"]
    with pytest.raises(piaffe.SpecificationError, match="joints.knee.range"):
        quadruped.set({low: 3.0, high: 2.0})


def test_a_number_that_is_not_the_same_in_all_gaits_is_none_of_the_robot(quadruped: piaffe.Robot) -> None:
    clearance, height = "limits.swing_clearance", "limits.min_platform_height"
    texts = {name: quadruped.files[f"gaits/{name}.toml"] for name in ("trot", "amble")}
    high = texts["amble"].replace("swing_clearance = 0.005", "swing_clearance = 0.006\nmin_platform_height = 0.1")
    robot = piaffe.Robot(quadruped.files["robot.toml"], {**texts, "amble": high})
    # What a gait leaves out it means.
    assert robot.differing == {clearance: {"amble": 0.006, "trot": 0.005}, height: {"amble": 0.1, "trot": 0.0}}
    assert clearance not in robot.numbers and robot.numbers["limits.friction"] == 1.0
    assert [robot.gait(name).numbers[clearance] for name in ("amble", "trot")] == [0.006, 0.005]
    one = robot.set({clearance: 0.004, height: 0.05})
    assert not one.differing and one.numbers[clearance] == 0.004
    assert one.numbers["gravity"] == one.gait("trot").numbers["gravity"]


def test_a_load_is_a_part_of_the_platform(quadruped: piaffe.Robot) -> None:
    loaded = quadruped.loaded(1.0, (0.0, 0.0, 0.0))
    assert loaded.numbers["links.platform.mass"] == pytest.approx(quadruped.numbers["links.platform.mass"] + 1.0)
    aside = quadruped.loaded(1.0, (0.1, 0.0, 0.0))
    assert aside.numbers["links.platform.com.x"] == pytest.approx(0.1 / 7.65)
    with pytest.raises(piaffe.Error, match="positive mass"):
        quadruped.loaded(-1.0, (0.0, 0.0, 0.0))
    # What a file leaves out can be set all the same.
    high = quadruped.set({"limits.min_platform_height": 0.2})
    assert "min_platform_height = 0.2" in high.files["gaits/trot.toml"]


def test_a_robot_of_another_format_walks(tmp_path: Path) -> None:
    robot = piaffe.Robot.from_urdf(urdf(tmp_path, 60.0))
    assert robot.name == "biped" and any("assumed" in note for note in robot.notes)
    assert pickle.loads(pickle.dumps(robot)).notes == robot.notes
    result = piaffe.optimize(robot.gait(robot.gaits[0]), 0.4)
    assert result.optimal and result.verify()
    assert any("Least torque that a short search found" in text for text in robot.files.values())
    untried = piaffe.Robot.from_urdf(urdf(tmp_path, 60.0), tried=False)
    assert untried.gaits == ["walk"] and untried.files["robot.toml"] == robot.files["robot.toml"]


def test_options_of_an_import_are_the_robots(tmp_path: Path) -> None:
    file = urdf(tmp_path, 0.0)
    with pytest.raises(piaffe.SpecificationError, match="biped.urdf.*\n(.*\n)*.*effort"):
        piaffe.Robot.from_urdf(file)
    robot = piaffe.Robot.from_urdf(file, effort={"*_hip": 41.0, "*_knee": 43.0}, rotor=1e-5)
    text = robot.files["robot.toml"]
    assert "41" in text and "43" in text and "1e-5" in text.replace("0.00001", "1e-5")
    with pytest.raises(piaffe.Error, match="`effort` is -1"):
        piaffe.Robot.from_urdf(file, effort=-1.0)
    with pytest.raises(piaffe.Error, match="`gear` is 0: give a positive number"):
        piaffe.Robot.from_urdf(file, gear=0.0)
    with pytest.raises(piaffe.Error, match="`forward` is \"w\""):
        piaffe.Robot.from_urdf(file, forward="w")
    with pytest.raises(piaffe.Error, match="`range` of left_hip"):
        piaffe.Robot.from_urdf(file, range={"left_hip": (1.0, float("nan"))})
    with pytest.raises(OSError, match="nowhere.urdf"):
        piaffe.Robot.from_urdf(tmp_path / "nowhere.urdf")


def test_what_is_derived_serves_the_next_process(tmp_path: Path) -> None:
    program = "import piaffe; print(piaffe.optimize(piaffe.robots['rabbit'].gait('walk'), 0.6, 'torque', starts=1).cost)"

    def run(cache: str) -> str:
        # Elsewhere: beside the sources it would find those, without what is compiled.
        here, variables = Path(__file__).parent, {**os.environ, "PIAFFE_CACHE": cache}
        done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=here, env=variables)
        assert done.returncode == 0, done.stderr
        return done.stdout

    without = run("off")
    assert run(str(tmp_path)) == without
    kept = sorted(tmp_path.iterdir())
    assert kept
    assert run(str(tmp_path)) == without and sorted(tmp_path.iterdir()) == kept
