"""A gait's equations of motion for any symbolic backend, from the description that piaffe prints.

As a user of such a backend would write them with care: generalized coordinates are p and the absolute angles, where
A = sum m J'J + W'IW is small; then both are taken to X = [p, q] by the constant matrix between the two. A backend is
a module-like object with `sin`, `cos`, `matrix`, `jacobian` and `substitute`.
"""

import json


def load(path):
    return json.load(open(path))


class Motion:
    """Positions, spins and feet of a mechanism as functions of `alpha` = [p, absolute angles]."""

    def __init__(self, backend, mechanism):
        self.b, self.m = backend, mechanism
        self.positions = mechanism["positions"]
        self.angles = []  # of each: the coordinates of q that it sums
        self.turn = {0: ()}  # body -> its absolute angle's coordinates
        theta = mechanism["orientations"] - 1
        self.roll = mechanism["rotation"] == "Roll"
        if mechanism["rotation"] == "Pitch":
            self.turn[0] = (theta,)
        for i, body in enumerate(mechanism["bodies"]):
            if body["parent"] is not None:
                assert body["axis"] == 2, "only joints that pitch"
                self.turn[i] = self.turn[body["parent"]] + (body["coordinate"],)
            if self.turn[i] and self.turn[i] not in self.angles:
                self.angles.append(self.turn[i])
        if self.roll:
            self.angles.append((theta,))
        self.size = self.positions + len(self.angles)
        self.n = self.positions + mechanism["orientations"]
        assert self.size == self.n, "as many absolute angles as coordinates"
        # alpha = T X
        self.T = [[float(i == j) for j in range(self.n)] for i in range(self.n)]
        for k, angle in enumerate(self.angles):
            for j in range(mechanism["orientations"]):
                self.T[self.positions + k][self.positions + j] = float(j in angle)

    def angle(self, alpha, turn):
        return alpha[self.positions + self.angles.index(turn)]

    def in_platform(self, v, alpha):
        """From the axes in which legs swing to the world's."""
        if not self.roll:
            return v
        t = alpha[self.n - 1]
        s, c = self.b.sin(t), self.b.cos(t)
        return [v[0], c * v[1] - s * v[2], s * v[1] + c * v[2]]

    def rotated(self, i, v, alpha):
        """A body's vector in the axes in which legs swing."""
        if not self.turn[i]:
            return list(v)
        a = self.angle(alpha, self.turn[i])
        s, c = self.b.sin(a), self.b.cos(a)
        return [c * v[0] - s * v[1], s * v[0] + c * v[1], v[2]]

    def centres_and_feet(self, alpha):
        joints, centres = {}, []
        plus = lambda a, b: [x + y for x, y in zip(a, b)]
        for i, body in enumerate(self.m["bodies"]):
            joints[i] = (
                [0, 0, 0]
                if body["parent"] is None
                else plus(joints[body["parent"]], self.rotated(body["parent"], body["offset"], alpha))
            )
            centres.append(plus(joints[i], self.rotated(i, body["com"], alpha)))
        feet = [plus(joints[l["body"]], self.rotated(l["body"], l["foot"], alpha)) for l in self.m["legs"]]
        p = list(alpha[: self.positions]) + [0] * (3 - self.positions)
        place = lambda v: plus(p, self.in_platform(v, alpha))[: self.positions]
        return [place(c) for c in centres], [place(f) for f in feet]

    def spins(self, alpha, rate):
        """Angular velocities in the bodies' axes."""
        spins = []
        for i in range(len(self.m["bodies"])):
            turn = self.turn[i]
            about_z = self.angle(rate, turn) if turn else 0
            if not self.roll:
                spins.append([0, 0, about_z])
                continue
            t = rate[self.n - 1]
            a = self.angle(alpha, turn) if turn else None
            spins.append([t, 0, 0] if a is None else [self.b.cos(a) * t, -self.b.sin(a) * t, about_z])
        return spins

    def inertia_and_bias(self, alpha, rate):
        """A and H in alpha."""
        b, n = self.b, self.n
        A, H = b.zeros(n, n), b.zeros(n, 1)
        gravity = b.matrix([0, -self.m["gravity"], 0][: self.positions])
        al, ad = b.matrix(alpha), b.matrix(rate)
        centres, _ = self.centres_and_feet(alpha)
        for body, centre, spin in zip(self.m["bodies"], centres, self.spins(alpha, rate)):
            J = b.jacobian(b.matrix(centre), al)
            A += body["mass"] * (J.T @ J)
            H += body["mass"] * (J.T @ (b.jacobian(J @ ad, al) @ ad - gravity))
            w = b.matrix(spin)
            W, inertia = b.jacobian(w, ad), b.matrix(body["inertia"])
            L = inertia @ w
            A += W.T @ inertia @ W
            H += W.T @ (inertia @ (b.jacobian(w, al) @ ad) + b.matrix(b.cross(spin, [L[k] for k in range(3)])))
        return A, H
