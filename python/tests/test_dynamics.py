"""The kernels over arrays: the program's numbers, and the physics between them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, Callable

import numpy as np
import pytest

import piaffe

RANDOM = np.random.default_rng(1)


def gaits() -> list[piaffe.Gait]:
    names = [("quadruped", "amble"), ("quadruped", "trot"), ("rabbit", "walk"), ("quadruped", "bound")]
    return [piaffe.robots[robot].gait(gait) for robot, gait in names]


def test_kernels_are_the_programs(trot: piaffe.Gait, program: Callable[..., str], tmp_path: Path) -> None:
    x, xd, xdd = RANDOM.normal(size=(3, 7, 6))
    states = [{"X": list(a), "Xdot": list(b), "Xddot": list(c)} for a, b, c in zip(x, xd, xdd)]
    file = tmp_path / "states.json"
    file.write_text(json.dumps({"states": states}))
    stated = json.loads(program("dynamics", "trot", str(file)))["states"]
    dynamics = piaffe.dynamics(trot)
    q, qd, qdd = x[:, 2:], xd[:, 2:], xdd[:, 2:]
    kinetic, potential = dynamics.energy(x, xd)
    pairs: list[tuple[Any, Callable[[Any], Any]]] = [
        (dynamics.inertia(q), lambda state: state["A"]),
        (dynamics.bias(q, qd), lambda state: state["H"]),
        (kinetic, lambda state: state["kinetic_energy"]),
        (potential, lambda state: state["potential_energy"]),
        (dynamics.foot(2, x), lambda state: state["d2"]),
        (dynamics.foot_jacobian(2, q), lambda state: state["D2"]),
        (dynamics.inverse(q, qd, qdd[:, 1:], stance=2).force, lambda state: state["ss2"]["inverse"]["F"]),
    ]
    for found, of in pairs:
        np.testing.assert_array_equal(found, np.array([of(state) for state in stated]))


@pytest.mark.parametrize("gait", gaits(), ids=lambda gait: gait.name)
def test_jacobians_are_those_of_differences(gait: piaffe.Gait) -> None:
    dynamics = piaffe.dynamics(gait)
    n, beta = len(dynamics.coordinates), dynamics.unactuated
    kept = [k for k in range(n) if k != beta]
    w = RANDOM.normal(scale=0.4, size=3 * n)
    for stance in [1, 2, None] if gait.name == "bound" else [1, 2]:

        def inverse(w: np.ndarray) -> piaffe.InverseDynamics:
            q, qd, qdd = w.reshape(3, n)
            return dynamics.inverse(q, qd, qdd[..., kept], stance=stance)

        base = inverse(w)
        jacobian = dynamics.inverse_jacobian(w[:n], w[n : 2 * n], w[2 * n :][kept], stance=stance)
        # β̈ follows from the others by the balance: what depends on it does so too.
        by_beta = jacobian.balance[2 * n + beta]
        step = 1e-6
        for k in [k for k in range(3 * n) if k != 2 * n + beta]:
            ahead, behind = (inverse(w + sign * step * np.eye(3 * n)[k]) for sign in (1.0, -1.0))
            through = -jacobian.balance[k] / by_beta
            for name in ("torque", "force"):
                found = (getattr(ahead, name) - getattr(behind, name)) / (2 * step)
                matrix = getattr(jacobian, name)
                stated = matrix[:, k] + matrix[:, 2 * n + beta] * through
                np.testing.assert_allclose(stated, found, rtol=1e-4, atol=1e-4 * (1 + np.abs(getattr(base, name)).max(initial=0)))


@pytest.mark.parametrize("values", [[1j, 0, 0, 0], [True] * 4, ["0"] * 4, [None] * 4, np.zeros(4, complex), np.zeros(4, object)])
def test_arrays_of_no_real_numbers_are_refused(trot: piaffe.Gait, values: Any) -> None:
    with pytest.raises(TypeError, match="`q` is an array of .*: give real numbers"):
        piaffe.dynamics(trot).inertia(values)


def test_arrays_are_broadcast(trot: piaffe.Gait) -> None:
    dynamics = piaffe.dynamics(trot)
    q, qd = RANDOM.normal(size=(5, 1, 4)), RANDOM.normal(size=(3, 4))
    found = dynamics.bias(q, qd)
    assert found.shape == (5, 3, 6)
    np.testing.assert_array_equal(found[4, 2], dynamics.bias(q[4, 0], qd[2]))
    assert dynamics.inertia(np.zeros((0, 4))).shape == (0, 6, 6)
    # An array that is not laid out row by row.
    np.testing.assert_array_equal(dynamics.inertia(np.asfortranarray(q[:, 0])), dynamics.inertia(q[:, 0]))
