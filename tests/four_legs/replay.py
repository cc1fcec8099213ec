"""One step of a lifted gait, simulated by MuJoCo: the exported robot with its own motors, driven by the lifted torques and a
stated gain on joint errors, on ideal feet (`connect` constraints between foot and footprint, switched from phase to phase; none in
flight).

An impact is MuJoCo's own: from the time of touchdown on, other feet are held, and the constraint brings them to rest
within a few of its time constants of two time steps. Reads a request as JSON (paths, gains, time step), answers with errors.
"""

import json
import sys

import mujoco
import numpy as np

# In multiples of the time step: time constant of the constraints, and how long an impact may take.
TIME_CONSTANT = 2
SETTLED = 100

request = json.load(sys.stdin)
lift = json.load(open(request["lift"]))
step, kp, kd = request["timestep"], request["kp"], request["kd"]


def upright(v):
    """From axes with y up to axes with z up."""
    v = np.asarray(v)
    return np.stack([v[..., 0], -v[..., 2], v[..., 1]], axis=-1)


moments = lift["moments"]
phases = np.array([m["phase"] for m in moments]) - 1
column = {k: np.array([m[k] for m in moments], float) for k in ("t", "q", "qd", "torque")}
vectors = {k: upright([m[k] for m in moments]) for k in ("position", "velocity", "omega", "force")}
quaternions = np.array([m["quaternion"] for m in moments])
quaternions[:, 1:] = upright(quaternions[:, 1:])
ends = np.cumsum(lift["durations"])
number = len(ends)
standing = [np.abs(vectors["force"][phases == p]).max(axis=(0, 2)) > 0 for p in range(number)]
# Phases that begin with an impact; the last of all is the first phase again, a step ahead.
landings = [p for p in range(1, number + 1) if (standing[p % number] & ~standing[p - 1]).any()]


def at(name, phase, t):
    """A lifted quantity at a time of a phase; the moments are close together."""
    series = column.get(name, vectors.get(name))
    rows = np.flatnonzero(phases == phase)
    times = column["t"][rows]
    k = int(np.clip(np.searchsorted(times, t) - 1, 0, len(rows) - 2))
    share = (t - times[k]) / (times[k + 1] - times[k])
    return (1 - share) * series[rows[k]] + share * series[rows[k + 1]]


spec = mujoco.MjSpec.from_file(request["model"])
spec.option.timestep = step
spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_LIMIT
spec.option.solver, spec.option.iterations, spec.option.tolerance = mujoco.mjtSolver.mjSOL_NEWTON, 50, 1e-14

# Footprints are where the feet stand in a phase; those after the step lie ahead by its travel.
start = mujoco.MjData(spec.compile())
first = spec.compile()
mujoco.mj_resetDataKeyframe(first, start, first.key("start").id)
mujoco.mj_forward(first, start)
holds = []


def hold(phase, leg, at_point):
    name = f"{leg}_{phase}"
    spec.worldbody.add_site(name=name, pos=at_point)
    spec.add_equality(
        name=name,
        type=mujoco.mjtEq.mjEQ_CONNECT,
        objtype=mujoco.mjtObj.mjOBJ_SITE,
        name1=f"{leg}_foot",
        name2=name,
        active=phase == 0,
        solref=[TIME_CONSTANT * step, 1],
        solimp=[0.9999, 0.9999, 0.001, 0.5, 2],
    )
    holds.append((phase, leg, name))


def pose(model, data, k):
    """Puts the robot where it is in the k-th moment."""
    data.qpos[:3], data.qpos[3:7] = vectors["position"][k], quaternions[k]
    for j, name in enumerate(lift["joints"]):
        data.qpos[model.joint(name).qposadr[0]] = column["q"][k][j]
    mujoco.mj_forward(model, data)


for phase in range(number + 1):
    ahead = lift["travel"] if phase == number else 0.0
    # In the middle of a phase the lifted feet have stood for a while.
    rows = np.flatnonzero(phases == phase % number)
    pose(first, start, rows[len(rows) // 2])
    for leg, stands in zip(lift["legs"], standing[phase % number]):
        if stands:
            hold(phase, leg, start.site(f"{leg}_foot").xpos + [ahead, 0, 0])

model = spec.compile()
data = mujoco.MjData(model)
mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
position = [model.joint(name).qposadr[0] for name in lift["joints"]]
rate = [model.joint(name).dofadr[0] for name in lift["joints"]]
motor = [model.actuator(name).id for name in lift["joints"]]
most = model.actuator_ctrlrange[:, 1]

worst = {k: 0.0 for k in ("position", "turn", "velocity", "spin", "joint", "rate", "reaction", "feedback", "saturated")}
impulses = np.zeros((len(landings), len(lift["legs"]), 3))
settled = 0.0


def note(name, error):
    worst[name] = max(worst[name], float(np.max(np.abs(error))))


# The last steps, after the step's own end, are the last impact.
count = round((ends[-1] + SETTLED * step) / step)
for n in range(count):
    t = n * step
    phase = int(np.searchsorted(ends, t, side="right"))
    own, time, ahead = (phase, t, 0.0) if phase < number else (0, t - ends[-1], lift["travel"])
    for p, _, name in holds:
        data.eq_active[model.equality(name).id] = p == phase
    q, qd = data.qpos[position], data.qvel[rate]
    feedback = kp * (at("q", own, time) - q) + kd * (at("qd", own, time) - qd)
    ahead = np.array([ahead, 0, 0])
    since = t - (ends[phase - 1] if phase else 0.0)
    after_impact = phase in landings and since < SETTLED * step
    if after_impact:
        # Torques that are finite do nothing in an impact, but joints that jump must not call for enormous ones.
        feedback[:] = 0
    torque = at("torque", own, time) + feedback
    data.ctrl[motor] = torque
    note("saturated", np.maximum(np.abs(torque) - most[motor], 0))
    if not after_impact:
        note("feedback", feedback)
        note("joint", at("q", own, time) - q)
        note("rate", at("qd", own, time) - qd)
        note("position", data.qpos[:3] - at("position", own, time) - ahead)
        note("velocity", data.qvel[:3] - at("velocity", own, time))
        note("spin", data.qvel[3:6] - at("omega", own, time))
        k = int(np.argmin(np.abs(column["t"] - time) + 10 * (phases != own)))
        if abs(column["t"][k] - time) < step:
            turn = np.zeros(3)
            mujoco.mju_subQuat(turn, data.qpos[3:7], quaternions[k])
            note("turn", turn)
    mujoco.mj_step(model, data)
    forces = np.zeros((len(lift["legs"]), 3))
    for p, leg, name in holds:
        if p == phase:
            rows = np.flatnonzero((data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY) & (data.efc_id == model.equality(name).id))
            forces[lift["legs"].index(leg)] = data.efc_force[rows]
    if after_impact:
        impulses[landings.index(phase)] += forces * step
    elif since > SETTLED * step:
        note("reaction", forces - at("force", own, time))

expected = np.array([upright(i["impulse"]) for i in lift["impacts"]])
# During an impact the reactions of the support that begins act too.
window = SETTLED * step
begins = [(p, ends[p - 1]) if p < number else (0, 0.0) for p in landings]
support = np.array([at("force", p, begin + window / 2) for p, begin in begins]) * window
answer = {
    **worst,
    "weight": float(sum(model.body_mass) * np.linalg.norm(model.opt.gravity)),
    "mass": float(sum(model.body_mass)),
    "impulse": float(np.abs(impulses - support - expected).max()),
    "largest_impulse": float(np.abs(expected).max()),
    "after": float(np.abs(data.qvel[rate] - at("qd", 0, count * step - ends[-1])).max()),
    "steps": count,
}
json.dump(answer, sys.stdout)
