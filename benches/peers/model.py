"""Dynamics of a gait from its numbers, by Lagrange's method in CasADi. Frames and units as everywhere here."""
import casadi as ca
import numpy as np


def turn(axis, angle):
    c, s = ca.cos(angle), ca.sin(angle)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    r = ca.SX.eye(3)
    r[i, i], r[i, j], r[j, i], r[j, j] = c, -s, s, c
    return r


class Model:
    """X = [p, q]; kinetic and potential energy, feet, and A(q) Ẍ + H as functions of SX."""

    def __init__(self, d):
        self.d = d
        self.np = 3 if d["spatial"] else 2
        self.nj = len(d["joints"])
        self.nq = self.nj + (d["rotation"] is not None)
        n = self.np + self.nq
        x, xd, xdd = (ca.SX.sym(name, n) for name in ("x", "xd", "xdd"))
        q, qd = x[self.np:], xd[self.np:]
        kinetic = potential = 0
        frames = []
        for body in d["bodies"]:
            if body["parent"] is None:
                at = ca.vertcat(x[:self.np], ca.SX.zeros(3 - self.np))
                rotation, spin = ca.SX.eye(3), ca.SX.zeros(3)
                if d["rotation"] is not None:
                    rotation = turn(d["rotation"], q[-1])
                    spin[d["rotation"]] = qd[-1]
            else:
                up_at, up_rotation, up_spin = frames[body["parent"]]
                c, unit = body["coordinate"], ca.SX.zeros(3)
                unit[body["axis"]] = 1
                at = up_at + up_rotation @ ca.DM(body["offset"])
                rotation = up_rotation @ turn(body["axis"], q[c])
                spin = up_spin + up_rotation @ unit * qd[c]
            frames.append((at, rotation, spin))
            centre = at + rotation @ ca.DM(body["com"])
            v, w = ca.jtimes(centre, x, xd), rotation.T @ spin
            kinetic += body["mass"] / 2 * ca.sumsqr(v) + ca.bilin(ca.DM(body["inertia"]), w, w) / 2
            potential += body["mass"] * d["gravity"] * centre[1]
        for j, joint in enumerate(d["joints"]):
            kinetic += joint["rotor"] / 2 * qd[j] ** 2
        feet = [frames[leg["body"]][0] + frames[leg["body"]][1] @ ca.DM(leg["foot"]) for leg in d["legs"]]
        feet = [f[:self.np] for f in feet]
        momentum = ca.gradient(kinetic, xd)
        force = ca.jtimes(momentum, x, xd) + ca.jtimes(momentum, xd, xdd) - ca.gradient(kinetic - potential, x)
        self.force = ca.Function("force", [x, xd, xdd], [force])
        self.momentum = ca.Function("momentum", [x, xd], [momentum])
        self.feet = ca.Function("feet", [x], feet)
        self.jacobians = ca.Function("jacobians", [x], [ca.jacobian(f, x) for f in feet])
        self.potential = ca.Function("potential", [x], [potential])
        # The whole robot's rotation about the stance foot: θ, or all haunches together.
        self.whole = np.array([float(d["rotation"] is None and joint["hangs"]) for joint in d["joints"]]
                              + [1.0] * (self.nq - self.nj))

        self.stands, self.sigmas = zip(*[self.stance(leg) for leg in range(2)])

    def stance(self, leg):
        """With the foot of `leg` at rest in the origin: X, Ẋ, Ẍ and the swing foot with its velocity; then the
        angular momentum about that foot and the moment of gravity."""
        q, qd, qdd = (ca.SX.sym(name, self.nq) for name in ("q", "qd", "qdd"))
        foot = self.feet(ca.vertcat(ca.SX.zeros(self.np), q))[leg]
        x = ca.vertcat(-foot, q)
        xd = ca.jtimes(x, q, qd)
        xdd = ca.jtimes(xd, q, qd) + ca.jtimes(xd, qd, qdd)
        swing = self.feet(x)[1 - leg]
        reduced = ca.jtimes(x, q, ca.DM(self.whole))
        sigma = ca.dot(self.momentum(x, xd), reduced)
        moment = -ca.jtimes(self.potential(x), q, ca.DM(self.whole))
        return (ca.Function("stand", [q, qd, qdd], [x, xd, xdd, swing, ca.jtimes(swing, q, qd)]),
                ca.Function("sigma", [q, qd], [sigma, moment]))

    def complete(self, values, beta):
        """q from Q and β."""
        parts = list(ca.vertsplit(values))
        parts.insert(self.d["unactuated"], beta)
        return ca.vertcat(*parts)

    def swap(self, q):
        return ca.vertcat(*[sign * q[k] for k, sign in self.d["swapped"]]) if self.d["phases"] == 1 else q
