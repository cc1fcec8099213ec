"""Mass matrices of specifications beside those that Pinocchio makes of the files they were imported from.

Reads lines "FILE<tab>ROBOT.TOML", writes "FILE<tab>greatest difference as a share of the greatest entry". Joints that the
specification does not have are held at the angle nearest to zero. Both float freely, at random angles.
"""

import re
import sys
import tomllib

import numpy as np
import pinocchio as pin

# From the file's axes (x forward, y left, z up) to the specification's.
AXES = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])
JOINTS = {"roll": pin.JointModelRX, "yaw": pin.JointModelRY, "pitch": pin.JointModelRZ}


def inertia(link, keys):
    moments = np.diag([link["inertia"][k] for k in keys])
    yz, zx, xy = link["inertia"]["products"]
    moments[1, 2] = moments[2, 1] = -yz
    moments[0, 2] = moments[2, 0] = -zx
    moments[0, 1] = moments[1, 0] = -xy
    return pin.Inertia(link["mass"], np.array(link["com"], float), moments)


def described(spec):
    model = pin.Model()
    root = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root")
    children = {joint["child"] for joint in spec["joints"].values()}
    platform = next(name for name in spec["links"] if name not in children)
    model.appendBodyToJoint(root, inertia(spec["links"][platform], ["roll", "yaw", "pitch"]), pin.SE3.Identity())
    for leg in spec["legs"].values():
        name, parent, at = leg["first_joint"], root, np.array(leg["mount"], float)
        while name:
            joint = spec["joints"][name]
            link = spec["links"][joint["child"]]
            parent = model.addJoint(parent, JOINTS[joint["axis"]](), pin.SE3(np.eye(3), at), name)
            model.appendBodyToJoint(parent, inertia(link, ["lateral", "axial", "swing"]), pin.SE3.Identity())
            at = np.array(link["length"], float)
            name = next((n for n, j in spec["joints"].items() if j["parent"] == joint["child"]), None)
    return model


def symmetric(upper):
    return np.triu(upper) + np.triu(upper, 1).T


def difference(file, toml):
    text = open(toml).read()
    spec = tomllib.loads(text)
    turned, joint = set(), None
    for line in text.splitlines():
        if named := re.match(r"\[joints\.(.*)\]", line):
            joint = named.group(1)
        if line.startswith("axis") and "turned round" in line:
            turned.add(joint)
    full = pin.buildModelFromUrdf(file, pin.JointModelFreeFlyer())
    names, held, rest = {}, [], pin.neutral(full)
    for j in range(2, full.njoints):
        name = re.sub(r"[^A-Za-z0-9]", "_", full.names[j])
        name = name if name[:1].isalpha() else f"a_{name}"
        if name in spec["joints"]:
            names[name] = full.names[j]
            continue
        held.append(j)
        low, high = (limits[full.idx_qs[j]] for limits in (full.lowerPositionLimit, full.upperPositionLimit))
        if full.nqs[j] == 1 and low <= high:
            rest[full.idx_qs[j]] = min(max(0.0, low), high)
    theirs, ours = pin.buildReducedModel(full, held, rest), described(spec)
    random, worst = np.random.default_rng(1), 0.0
    for _ in range(4):
        q, p = pin.neutral(theirs), pin.neutral(ours)
        change = np.zeros((theirs.nv, ours.nv))
        change[:3, :3] = change[3:6, 3:6] = AXES.T
        for k in range(2, ours.njoints):
            name = ours.names[k]
            sign, angle = -1 if name in turned else 1, random.uniform(-1.5, 1.5)
            p[ours.idx_qs[k]] = angle
            j = theirs.getJointId(names[name])
            at = theirs.idx_qs[j]
            if theirs.nqs[j] == 2:
                q[at : at + 2] = np.cos(sign * angle), np.sin(sign * angle)
            else:
                q[at] = sign * angle
            change[theirs.idx_vs[j], ours.idx_vs[k]] = sign
        a = symmetric(pin.crba(theirs, theirs.createData(), q)) - np.diag(theirs.armature)
        b = symmetric(pin.crba(ours, ours.createData(), p))
        a = change.T @ a @ change
        worst = max(worst, np.abs(a - b).max() / np.abs(a).max())
    return worst


for line in sys.stdin:
    file, toml = line.rstrip("\n").split("\t")
    try:
        print(f"{file}\t{difference(file, toml):.3e}", flush=True)
    except (ValueError, RuntimeError) as error:
        # A file that Pinocchio does not take.
        print(f"{file}\tnot read: {str(error).splitlines()[0]}", flush=True)
