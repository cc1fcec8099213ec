"""The gait problem as a sparse nonlinear program: collocation of β and σ, exact derivatives block by block.

Every node is one small function with its Jacobian and Hessian; constant sparse matrices select its inputs
from the variables (E) and combine its outputs into rows (G): g = G·y(E·x) + C·x. This is what makes CasADi quick here:
left to itself it would colour a Jacobian whose polynomial coefficients occur in every row.
"""
import subprocess

import casadi as ca
import numpy as np
import scipy.sparse as sp

ELEMENTS = 14
NODES = np.array([0, 0.5 - 5**0.5 / 10, 0.5 + 5**0.5 / 10, 1])  # Lobatto, of an element


def integrals():
    """∫ of each Lagrange polynomial from 0 to each node."""
    table = np.zeros((4, 4))
    for k in range(4):
        p = np.poly1d([1.0])
        for m in set(range(4)) - {k}:
            p *= np.poly1d([1, -NODES[m]]) / (NODES[k] - NODES[m])
        table[:, k] = np.polyint(p)(NODES)
    return table


def basis(order, s):
    """Value, first and second derivative at s of the polynomials of (Q(0), T·Q̇(0), interior…, Q(1), T·Q̇(1))."""
    powers = np.arange(order + 1)
    inner = np.arange(1, order - 2) / (order - 2)
    conditions = np.vander(np.r_[0, 0, inner, 1, 1], order + 1, increasing=True)
    conditions[1] = powers == 1
    conditions[-1] = powers
    c = np.linalg.inv(conditions)
    v = np.vander(s, order + 1, increasing=True)
    first = np.hstack([np.zeros((len(s), 1)), v[:, :-1] * powers[1:]])
    second = np.hstack([np.zeros((len(s), 1)), first[:, :-1] * powers[1:]])
    return v @ c, first @ c, second @ c


class Block:
    """A function of some variables at many places: z = E·x at each, y one after another."""

    def __init__(self, z, y, columns):
        mu = ca.SX.sym("mu", y.numel())
        y = ca.cse(y)
        self.count, self.nz, self.ny = len(columns), z.numel(), y.numel()
        self.value = ca.Function("y", [z], [y])
        self.jacobian = ca.Function("j", [z], [ca.cse(ca.densify(ca.jacobian(y, z)))])
        self.hessian = ca.Function("h", [z, mu], [ca.cse(ca.densify(ca.hessian(ca.dot(mu, y), z)[0]))])
        self.columns = columns  # per place and input: list of (variable, factor)

    def selection(self, variables):
        entries = [(k * self.nz + i, v, f) for k, place in enumerate(self.columns) for i, c in enumerate(place) for v, f in c]
        return matrix(entries, (self.count * self.nz, variables))


def matrix(entries, shape):
    rows, columns, values = zip(*entries) if entries else ((), (), ())
    return sp.csc_matrix((values, (rows, columns)), shape=shape)


def constant(m):
    m = sp.csc_matrix(m)
    m.sum_duplicates()
    m.sort_indices()
    return ca.MX(ca.DM(ca.Sparsity(*m.shape, m.indptr.tolist(), m.indices.tolist()), m.data))


class Program:
    def __init__(self, model, energy, speed):
        d, self.model, self.energy, self.speed = model.d, model, energy, speed
        self.nodes = 3 * ELEMENTS + 1
        self.s = np.unique(np.r_[[(k + NODES) / ELEMENTS for k in range(ELEMENTS)]].round(12))
        self.weights = np.zeros(self.nodes)
        for k in range(ELEMENTS):
            self.weights[3 * k:3 * k + 4] += integrals()[-1] / ELEMENTS
        self.per_joint, self.nt = d["order"] + 1, model.nq - 1
        self.bases = basis(d["order"], self.s)
        self.size, self.place = 0, {}
        for phase in range(d["phases"]):
            for name, length in [("B", self.nt * self.per_joint), ("T", 1), ("beta", self.nodes), ("sigma", self.nodes),
                                 ("after", model.nq), ("impulse", model.np), ("work", model.nj * self.nodes if energy else 0)]:
                self.place[name, phase] = np.arange(self.size, self.size + length)
                self.size += length
        self.blocks, self.outputs, self.rows, self.linear, self.lower, self.upper = [], 0, [], [], [], []
        self.objective = []
        for phase in range(d["phases"]):
            self.stance(phase)
            self.impact(phase)
        travel = [e for phase in range(d["phases"]) for e in ((self.at(phase, self.nodes - 1, "x"), 1), (self.at(phase, 0, "x"), -1))]
        self.row(travel, [(self.place["T", p][0], -speed) for p in range(d["phases"])])

    def row(self, outputs=(), variables=(), lower=0.0, upper=0.0):
        number = len(self.lower)
        self.rows += [(number, y, f) for y, f in outputs]
        self.linear += [(number, x, f) for x, f in variables]
        self.lower.append(lower)
        self.upper.append(upper)

    def q_at(self, phase, coordinate, node):
        """Coordinate of q at the first or last node, as (variable, factor)."""
        b = self.model.d["unactuated"]
        if coordinate == b:
            return [(self.place["beta", phase][node], 1.0)]
        j = coordinate - (coordinate > b)
        return [(self.place["B", phase][j * self.per_joint + (0 if node == 0 else self.per_joint - 2)], 1.0)]

    def polynomial(self, phase, node, derivative):
        row = self.bases[derivative][node]
        return [[(self.place["B", phase][j * self.per_joint + i], f) for i, f in enumerate(row) if abs(f) > 1e-14]
                for j in range(self.nt)]

    def at(self, phase, node, name, index=0):
        start, names, size = self.layout[phase]
        return start + node * size + names[name] + index

    def stance(self, phase):
        model, d, nt = self.model, self.model.d, self.nt
        z = ca.SX.sym("z", 3 * nt + 3)
        Q, Q1, Q2, beta, sigma, T = ca.vertsplit(z, [0, nt, 2 * nt, 3 * nt, 3 * nt + 1, 3 * nt + 2, 3 * nt + 3])
        q, b = model.complete(Q, beta), ca.SX.sym("b")
        momentum, moment = model.sigmas[phase](q, model.complete(Q1 / T, b))
        rate = (sigma - ca.substitute(momentum, b, 0)) / ca.jacobian(momentum, b)
        qd = model.complete(Q1 / T, rate)

        def inverse(acceleration):
            x, xd, xdd, swing, swing_rate = model.stands[phase](q, qd, model.complete(Q2 / T**2, acceleration))
            force = model.force(x, xd, xdd)
            reaction = force[:model.np]
            torques = force[model.np:] - model.jacobians(x)[phase][:, model.np:].T @ reaction
            return torques, reaction, x, swing[1], swing_rate[1]

        balance = ca.dot(inverse(b)[0], ca.DM(model.whole))
        acceleration = -ca.substitute(balance, b, 0) / ca.jacobian(balance, b)
        torques, reaction, x, swing, swing_rate = inverse(acceleration)
        torques = torques[:model.nj]
        side = ca.sumsqr(reaction[2]) if d["spatial"] else 0
        parts = {"beta": T * rate, "sigma": T * moment, "torque": torques / [j["max_torque"] for j in d["joints"]],
                 "push": reaction[1] / 100, "friction": (d["friction"]**2 * reaction[1]**2 - reaction[0]**2 - side) / 1e4,
                 "swing": 10 * swing, "slope": 10 * T * swing_rate,
                 "x": x[0], "y": 10 * x[1], "power": T * torques * qd[:model.nj], "square": T * ca.sumsqr(torques)}
        falls = [(j["unloaded_speed"] - j["loaded_speed"]) for j in d["joints"]]
        parts["over"] = (qd[:model.nj] + falls * parts["torque"]) / 10
        parts["under"] = (qd[:model.nj] - falls * parts["torque"]) / 10
        names, size = {}, 0
        for name, part in parts.items():
            names[name], size = size, size + part.numel()
        place = self.place
        columns = [self.polynomial(phase, k, 0) + self.polynomial(phase, k, 1) + self.polynomial(phase, k, 2)
                   + [[(place["beta", phase][k], 1.0)], [(place["sigma", phase][k], 1.0)], [(place["T", phase][0], 1.0)]]
                   for k in range(self.nodes)]
        self.layout = getattr(self, "layout", {})
        self.layout[phase] = (self.outputs, names, size)
        self.blocks.append(Block(z, ca.densify(ca.vertcat(*parts.values())), columns))
        self.outputs += size * self.nodes
        self.path(phase)

    def path(self, phase):
        d, place, last, inf = self.model.d, self.place, self.nodes - 1, np.inf
        at = lambda node, name, index=0: [(self.at(phase, node, name, index), 1.0)]
        table = integrals()
        for name in ("beta", "sigma"):
            for k in range(ELEMENTS):
                for j in range(1, 4):
                    self.row([(self.at(phase, 3 * k + l, name), -table[j, l] / ELEMENTS) for l in range(4)],
                             [(place[name, phase][3 * k + j], 1.0), (place[name, phase][3 * k], -1.0)])
        self.row(at(last, "swing"))
        h = 4 * d["swing_clearance"]
        self.row(at(0, "slope"), (), 10 * h, inf)
        self.row(at(last, "slope"), (), -inf, -10 * h)
        for k in range(self.nodes):
            for j, joint in enumerate(d["joints"]):
                self.row(at(k, "torque", j), (), -1, 1)
                fastest = joint["unloaded_speed"] / 10
                self.row(at(k, "over", j), (), -fastest, fastest)
                self.row(at(k, "under", j), (), -fastest, fastest)
                b = d["unactuated"]
                angle = [(place["beta", phase][k], 1.0)] if j == b else self.polynomial(phase, k, 0)[j - (j > b)]
                self.row((), angle, *joint["range"])
                if self.energy:
                    for sign in (1.0, -1.0):
                        self.row([(self.at(phase, k, "power", j), sign)], [(place["work", phase][k * self.model.nj + j], 1.0)], 0, inf)
                        if sign > 0:
                            self.objective.append((place["work", phase][k * self.model.nj + j], None, self.weights[k]))
            if not self.energy:
                self.objective.append((None, self.at(phase, k, "square"), self.weights[k]))
            self.row(at(k, "push"), (), d["min_vertical_force"] / 100, inf)
            self.row(at(k, "friction"), (), 0, inf)
            self.row(at(k, "y"), (), 10 * d["min_height"], inf)
            if 0 < k < last:
                self.row(at(k, "swing"), (), 10 * h * self.s[k] * (1 - self.s[k]), inf)

    def impact(self, phase):
        """The end of a phase: eq. 12 on the landing foot, and the start of the next."""
        model, d, nt, nq = self.model, self.model.d, self.nt, self.model.nq
        landing, following = 1 - phase, (phase + 1) % d["phases"]
        sizes = np.cumsum([0, nt, nt, 1, 1, 1, nq, model.np, nt, 1, 1])
        z = ca.SX.sym("z", int(sizes[-1]))
        Q, Q1, beta, sigma, T, after, impulse, next1, next_sigma, next_T = ca.vertsplit(z, sizes.tolist())
        q, b, zero = model.complete(Q, beta), ca.SX.sym("b"), ca.SX.zeros(nq)
        momentum, _ = model.sigmas[phase](q, model.complete(Q1 / T, b))
        rate = (sigma - ca.substitute(momentum, b, 0)) / ca.jacobian(momentum, b)
        x, before, *_ = model.stands[phase](q, model.complete(Q1 / T, rate), zero)
        there, then, *_ = model.stands[landing](q, after, zero)
        leaving = model.jacobians(x)[phase][1, :] @ then
        jump = model.momentum(x, then) - model.momentum(x, before) - model.jacobians(x)[landing].T @ impulse
        stance, q0, qd0 = (0, model.swap(q), model.swap(after)) if d["phases"] == 1 else (landing, q, after)
        rates = ca.vertcat(*[qd0[k] for k in range(nq) if k != d["unactuated"]])
        equal = ca.vertcat(jump, next1 - next_T * rates, next_sigma - model.sigmas[stance](q0, qd0)[0])
        side = ca.sumsqr(impulse[2]) if d["spatial"] else 0
        above = ca.vertcat(impulse[1], d["friction"]**2 * impulse[1]**2 - impulse[0]**2 - side, 10 * leaving)
        one = lambda indices: [[(int(i), 1.0)] for i in indices]
        place, last = self.place, self.nodes - 1
        columns = [self.polynomial(phase, last, 0) + self.polynomial(phase, last, 1) + one(place["beta", phase][-1:])
                   + one(place["sigma", phase][-1:]) + one(place["T", phase]) + one(place["after", phase])
                   + one(place["impulse", phase]) + self.polynomial(following, 0, 1) + one(place["sigma", following][:1])
                   + one(place["T", following])]
        y = ca.densify(ca.vertcat(equal, above))
        self.blocks.append(Block(z, y, columns))
        for i in range(y.numel()):
            self.row([(self.outputs + i, 1.0)], (), 0, 0 if i < equal.numel() else np.inf)
        self.outputs += y.numel()
        for k in range(nq):
            source, sign = d["swapped"][k] if d["phases"] == 1 else (k, 1.0)
            then = [(v, -sign * f) for v, f in self.q_at(phase, source, last)]
            self.row((), self.q_at(following, k, 0) + then)

    def solver(self, folder):
        """An Ipopt solver with these derivatives, compiled from C in a folder or, without one, in CasADi's virtual machine."""
        n, m = self.size, len(self.lower)
        x, lam_f, lam = ca.MX.sym("x", n), ca.MX.sym("lf"), ca.MX.sym("lg", m)
        p = ca.MX.sym("p", 0)
        G, C = matrix(self.rows, (m, self.outputs)), constant(matrix(self.linear, (m, n)))
        of_y = matrix([(0, y, w) for v, y, w in self.objective if y is not None], (1, self.outputs))
        of_x = matrix([(0, v, w) for v, y, w in self.objective if v is not None], (1, n))
        times = constant(matrix([(0, int(self.place["T", k][0]), self.speed) for k in range(self.model.d["phases"])], (1, n)))
        g, jac, hess, first = C @ x, C, 0, 0
        parts = []
        travel = times @ x
        # The objective is (Σ work) / travel; its curvature is that of the quotient.
        for block in self.blocks:
            E, span = block.selection(n), slice(first, first + block.count * block.ny)
            first = span.stop
            Z = ca.reshape(constant(E) @ x, block.nz, block.count)
            many = (lambda fn: fn.map(block.count)) if block.count > 1 else (lambda fn: fn)
            y = ca.vec(many(block.value)(Z))
            J = self.diagonal(many(block.jacobian)(Z), block.count, block.ny, block.nz) @ constant(E)
            g += constant(G[:, span]) @ y
            jac += constant(G[:, span]) @ J
            parts.append((E, Z, many, block, span, y, J))
        work = constant(of_x) @ x + sum(constant(of_y[:, s]) @ y for *_, s, y, _ in parts)
        slope = constant(of_x) + sum(constant(of_y[:, s]) @ J for *_, s, _, J in parts)
        gradient = (slope / travel - work / travel**2 * times).T
        for E, Z, many, block, span, y, _ in parts:
            weight = constant(G[:, span].T) @ lam + constant(of_y[:, span].T) * (lam_f / travel)
            H = many(block.hessian)(Z, ca.reshape(weight, block.ny, block.count))
            hess += constant(E.T) @ self.diagonal(H, block.count, block.nz, block.nz) @ constant(E)
        mixed = slope.T @ times
        hess += lam_f * (-(mixed + mixed.T) / travel**2 + 2 * work / travel**3 * (times.T @ times))
        functions = {
            "nlp": ca.Function("nlp", [x, p], [work / travel, g], ["x", "p"], ["f", "g"]),
            "grad_f": ca.Function("nlp_grad_f", [x, p], [work / travel, ca.densify(gradient)], ["x", "p"], ["f", "grad_f_x"]),
            "jac_g": ca.Function("nlp_jac_g", [x, p], [g, jac], ["x", "p"], ["g", "jac_g_x"]),
            "hess_lag": ca.Function("nlp_hess_l", [x, p, lam_f, lam], [ca.triu(hess)], ["x", "p", "lam_f", "lam_g"],
                                    ["triu_hess_gamma_x_x"]),
        }
        if folder:
            functions = self.compile(functions, folder)
        out = functions["nlp"](x, p)
        options = {"print_time": False, "error_on_fail": False, "calc_lam_p": False, "no_nlp_grad": True,
                   "ipopt.print_level": 0, "ipopt.sb": "yes", "ipopt.tol": 1e-7, "ipopt.constr_viol_tol": 1e-8,
                   "ipopt.mu_strategy": "adaptive", "ipopt.max_iter": 500,
                   **{key: f for key, f in functions.items() if key != "nlp"}}
        return ca.nlpsol("solver", "ipopt", {"x": x, "p": p, "f": out[0], "g": out[1]}, options)

    @staticmethod
    def diagonal(values, count, rows, columns):
        pattern = sp.block_diag([np.ones((rows, columns))] * count, format="csc")
        sparsity = ca.Sparsity(*pattern.shape, pattern.indptr.tolist(), pattern.indices.tolist())
        return ca.MX(sparsity, ca.vec(values))

    @staticmethod
    def compile(functions, folder):
        """The same functions from one C file, where what they share stands once."""
        folder.mkdir(parents=True, exist_ok=True)
        source = ca.CodeGenerator("nlp.c")
        for function in functions.values():
            source.add(function)
        text, code, library = source.dump(), folder / "nlp.c", folder / "nlp.so"
        if not library.exists() or code.read_text() != text:
            code.write_text(text)
            subprocess.run(["cc", "-O1", "-march=native", "-fPIC", "-shared", code, "-o", library, "-lm"], check=True)
        return {key: ca.external(function.name(), str(library)) for key, function in functions.items()}

    def start(self, motion):
        """Variables of a motion; β is interpolated, σ follows from it."""
        x, model = np.zeros(self.size), self.model
        b = model.d["unactuated"]
        for phase, h in enumerate(motion["phases"]):
            T = h["duration"]
            values = np.array([h["q_initial"], np.multiply(T, h["qd_initial"]), *h["q_interior"], h["q_final"], np.multiply(T, h["qd_final"])])
            x[self.place["B", phase]] = values.T.ravel()
            x[self.place["T", phase]] = T
            x[self.place["beta", phase]] = h["beta_initial"] + self.s * (h["beta_final"] - h["beta_initial"])
            sigma = lambda q, qd: model.sigmas[phase](q, qd)[0]
            Q, Q1 = self.bases[0] @ values, self.bases[1] @ values / T
            rate = (h["beta_final"] - h["beta_initial"]) / T
            x[self.place["sigma", phase]] = [float(sigma(np.insert(Q[k], b, x[self.place["beta", phase][k]]), np.insert(Q1[k], b, rate)))
                                             for k in range(self.nodes)]
            x[self.place["after", phase]] = np.insert(h["qd_final"], b, h["betad_final"])
            x[self.place["impulse", phase]][1] = 1
            if self.energy:
                x[self.place["work", phase]] = 1
        return x

    def arguments(self, motion):
        lower, upper = np.full(self.size, -np.inf), np.full(self.size, np.inf)
        for phase in range(self.model.d["phases"]):
            lower[self.place["T", phase]], upper[self.place["T", phase]] = self.model.d["durations"][phase]
        return dict(x0=self.start(motion), lbx=lower, ubx=upper, lbg=self.lower, ubg=self.upper)
