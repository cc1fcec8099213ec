"""C code from CasADi: the quantities that piaffe generates, from the same mechanism. Arguments: mechanism.json, folder."""

import json
import os
import sys

import casadi as ca
from mechanism import Motion, load


class Backend:
    sin, cos, zeros = staticmethod(ca.sin), staticmethod(ca.cos), staticmethod(ca.SX.zeros)
    jacobian = staticmethod(ca.jacobian)

    @staticmethod
    def matrix(rows):
        return ca.vertcat(*[ca.horzcat(*r) if isinstance(r, list) else r for r in rows])

    @staticmethod
    def cross(a, b):
        return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def functions(m):
    motion = Motion(Backend, m)
    n, np, nq = motion.n, motion.positions, m["orientations"]
    T = ca.sparsify(ca.DM(motion.T))
    al, ad = ca.SX.sym("al", n), ca.SX.sym("ad", n)
    list_of = lambda v: [v[k] for k in range(n)]
    A, H = motion.inertia_and_bias(list_of(al), list_of(ad))
    A, H = T.T @ ca.SX(A) @ T, T.T @ ca.SX(H)
    X, Xd, Xdd = (ca.SX.sym(k, n) for k in ("x", "xd", "xdd"))
    A, H = ca.substitute([A, H], [al, ad], [T @ X, T @ Xd])
    _, feet = motion.centres_and_feet(list_of(T @ X))
    foot = Backend.matrix(feet[0])
    D = ca.jacobian(foot, X).T
    # eq. 5 with the reaction from the rows of p; the row without torque is the balance.
    force = A @ Xdd + H
    reaction = force[:np]
    rest = (force - D @ reaction)[np:]
    joints = len(m["joints"])
    balance = rest[nq - 1] if nq > joints else sum(rest[j] for j in m["hips"])
    inverse = ca.vertcat(rest[:joints], reaction, balance)
    everything = ca.vertcat(X, Xd, Xdd)
    # eq. 8 and 9 about the foot at rest, by substituting p.
    q, qd = ca.SX.sym("q", nq), ca.SX.sym("qd", nq)
    stand = ca.substitute(foot, X, ca.vertcat(ca.SX.zeros(np, 1), q))
    at = ca.vertcat(-stand, q)
    speed = ca.vertcat(-ca.jacobian(stand, q) @ qd, qd)
    momentum = A @ Xd
    turn = [0, 0, 0]
    if nq > joints:
        sigma = (momentum - D @ momentum[:np])[n - 1]
        moment = -(ca.substitute(H, Xd, ca.SX.zeros(n, 1)) - D @ ca.substitute(H, Xd, ca.SX.zeros(n, 1))[:np])[n - 1]
    else:
        hips = lambda v: sum((v - D @ v[:np])[np + j] for j in m["hips"])
        sigma, moment = hips(momentum), -hips(ca.substitute(H, Xd, ca.SX.zeros(n, 1)))
    sigma, moment = ca.substitute([sigma, moment], [X, Xd], [at, speed])
    beta = m["unactuated"]
    others = [k for k in range(nq) if k != beta]
    f1 = ca.jacobian(sigma, qd[beta])
    f2 = ca.substitute(sigma, qd[beta], 0)
    s = ca.SX.sym("sigma")
    rhs = ca.vertcat((s - f2) / f1, moment)
    Q, Qd = ca.SX.sym("Q", nq - 1), ca.SX.sym("Qd", nq - 1)
    b = ca.SX.sym("beta")
    full, full_rate = ca.SX.zeros(nq, 1), ca.SX.zeros(nq, 1)
    full[beta] = b
    for k, i in enumerate(others):
        full[i], full_rate[i] = Q[k], Qd[k]
    (rhs,) = ca.substitute([rhs], [q, qd], [full, full_rate])
    return {
        "A + H": ([X, Xd], [A, H]),
        "inverse dynamics": ([X, Xd, Xdd], [inverse]),
        "inverse dynamics with Jacobian": ([X, Xd, Xdd], [inverse, ca.jacobian(inverse, everything)]),
        "beta step": ([b, s, Q, Qd], [rhs, ca.jacobian(rhs, ca.vertcat(b, s))]),
        "beta step with all partials": ([b, s, Q, Qd], [rhs, ca.jacobian(rhs, ca.vertcat(b, s, Q, Qd))]),
    }


def operations(f):
    count = lambda codes: sum(f.instruction_id(k) in codes for k in range(f.n_instructions()))
    return count({ca.OP_ADD, ca.OP_SUB, ca.OP_MUL, ca.OP_SQ, ca.OP_TWICE})


def main(description, folder):
    os.makedirs(folder, exist_ok=True)
    rows, counts = [], {}
    for m in load(description):
        generator = ca.CodeGenerator(f"casadi_{m['gait']}.c")
        for k, (what, (inputs, outputs)) in enumerate(functions(m).items()):
            f = ca.Function(f"cs_{m['gait']}_{k}", inputs, ca.cse(outputs))
            generator.add(f)
            counts[f"{m['gait']}/{what}"] = operations(f)
            sizes = ",".join(str(f.nnz_in(i)) for i in range(f.n_in()))
            results = ",".join(str(f.nnz_out(i)) for i in range(f.n_out()))
            rows.append((f.name(), m["gait"], what, sizes, results, f.sz_w(), f.n_in(), f.n_out()))
            if what == "A + H":
                x, xd = m["state"]["x"], m["state"]["xd"]
                a, h = (ca.densify(v).full() for v in f(x, xd))
                found = list(a.flatten()) + list(h.flatten())
                worst = max(abs(u - v) for u, v in zip(found, m["state"]["a_and_h"]))
                assert worst < 1e-9, f"{m['gait']}: A + H differs by {worst}"
        generator.generate(folder + "/")
    with open(f"{folder}/casadi_list.hpp", "w") as out:
        for name, *_ in rows:
            out.write(f'extern "C" int {name}(const double**, double**, long long*, double*, int);\n')
        out.write("static const Function FUNCTIONS[] = {\n")
        for name, gait, what, sizes, results, work, n_in, n_out in rows:
            out.write(f'  {{{name}, "{gait}", "{what}", {n_in}, {{{sizes}}}, {n_out}, {{{results}}}, {work}}},\n')
        out.write("};\n")
    json.dump(counts, open(f"{folder}/casadi_operations.json", "w"))


main(*sys.argv[1:])
