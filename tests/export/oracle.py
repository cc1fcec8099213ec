"""What MuJoCo and numpy make of exported files. Reads a request as JSON, answers as JSON."""

import json
import sys

import mujoco
import numpy

request = json.load(sys.stdin)
model = mujoco.MjModel.from_xml_path(request["model"])
data = mujoco.MjData(model)
mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
mujoco.mj_forward(model, data)
depth = max((-contact.dist for contact in data.contact), default=0.0)
model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
data = mujoco.MjData(model)
moments = []
for moment in request["moments"]:
    data.qpos[:], data.qvel[:], data.qacc[:] = moment["qpos"], moment["qvel"], moment["qacc"]
    mujoco.mj_inverse(model, data)
    forces = data.qfrc_inverse.copy()
    # Column by column: what each acceleration takes beyond none.
    data.qacc[:] = 0
    mujoco.mj_inverse(model, data)
    bias = data.qfrc_inverse.copy()
    mass = []
    for k in range(model.nv):
        data.qacc[:] = 0
        data.qacc[k] = 1
        mujoco.mj_inverse(model, data)
        mass.append((data.qfrc_inverse - bias).tolist())
    feet = {model.site(i).name: data.site_xpos[i].tolist() for i in range(model.nsite)}
    moments.append({"forces": forces.tolist(), "mass": mass, "feet": feet})
arrays = {name: array.tolist() for name, array in numpy.load(request["arrays"]).items()}
from_urdf = mujoco.MjModel.from_xml_path(request["urdf"])
answer = {
    "mass": float(sum(model.body_mass)),
    "mass_urdf": float(sum(from_urdf.body_mass)),
    "start": model.key("start").qpos.tolist(),
    "depth": depth,
    "moments": moments,
    "frictionloss": model.dof_frictionloss.tolist(),
    "arrays": arrays,
}
json.dump(answer, sys.stdout)
