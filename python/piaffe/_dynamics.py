"""The dynamics of a gait as functions over arrays of states.

X = [p, q]: `positions` p are the platform's mass centre, m (x forward, y up, and z to the right where the gait leaves its plane),
`coordinates` q the virtual legs' joints and the platform's rotation, rad. A state is a row: arrays of states have the shape
(..., len(q)), whatever comes before, and so have the answers.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Callable, Optional, Sequence, Tuple

from ._given import whole
from ._piaffe import Error, Gait, Kernels

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    Numbers = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class InverseDynamics:
    """What moves the robot as it is prescribed, with n = len(positions) + len(coordinates)."""

    xdd: Numbers
    """(..., n): Ẍ; of the unactuated coordinate what follows (eq. 10), m/s² and rad/s²."""
    torque: Numbers
    """(..., joints): N·m."""
    force: Numbers
    """(..., positions): the reaction at the foot that stands, N; (..., 0) in flight."""


@dataclass(frozen=True, eq=False)
class InverseJacobian:
    """Derivatives in w = (q, q̇, q̈), side by side in the last axis: m = 3 len(coordinates).

    q̈ of the unactuated coordinate is an input of its own here. By `balance`, whose own value is 0, it follows from the others.
    """

    torque: Numbers
    """(..., joints, m)."""
    force: Numbers
    """(..., positions, m); (..., 0, m) in flight."""
    balance: Numbers
    """(..., m): of eq. 10, in flight of dσ/dt."""


def dynamics(gait: Gait) -> Dynamics:
    """The dynamics of a gait."""
    return Dynamics(gait)


class Dynamics:
    """See the module's text for X, p and q."""

    def __init__(self, gait: Gait) -> None:
        self._kernels = Kernels(gait)
        positions, coordinates, unactuated, joints = self._kernels.names()
        self.gait = gait
        self.positions: Tuple[str, ...] = tuple(positions)
        self.coordinates: Tuple[str, ...] = tuple(coordinates)
        self.unactuated: int = unactuated
        """Of the coordinates the one that no actuator drives, β."""
        self.joints: Tuple[str, ...] = tuple(joints)

    @property
    def prescribed(self) -> Tuple[str, ...]:
        """The coordinates without β."""
        return self.coordinates[: self.unactuated] + self.coordinates[self.unactuated + 1 :]

    def inertia(self, q: ArrayLike) -> Numbers:
        """A(q): (..., n, n), in kg, kg·m, kg·m²."""
        n = self._size
        return self._evaluate(self._kernels.inertia, [(n, n)], q=q)[0]

    def bias(self, q: ArrayLike, qd: ArrayLike) -> Numbers:
        """H(q, q̇), of A Ẍ + H = D Γ + forces: (..., n), N and N·m, gravity included."""
        return self._evaluate(self._kernels.bias, [(self._size,)], q=q, qd=qd)[0]

    def energy(self, x: ArrayLike, xd: ArrayLike) -> Tuple[Numbers, Numbers]:
        """Kinetic and potential energy: (...), J."""
        kinetic, potential = self._evaluate(self._kernels.energy, [(), ()], x=x, xd=xd)
        return kinetic, potential

    def centre_of_mass(self, x: ArrayLike, xd: ArrayLike) -> Tuple[Numbers, Numbers]:
        """The robot's mass centre and its velocity: (..., positions), m and m/s."""
        shape = (len(self.positions),)
        position, velocity = self._evaluate(self._kernels.centre_of_mass, [shape, shape], x=x, xd=xd)
        return position, velocity

    def foot(self, leg: int, x: ArrayLike) -> Numbers:
        """The foot of virtual leg 1 or 2: (..., positions), m."""
        leg = whole("leg", leg, most=2)

        def kernel(x: bytes) -> list[bytes]:
            return self._kernels.foot(leg, x)

        return self._evaluate(kernel, [(len(self.positions),)], x=x)[0]

    def foot_jacobian(self, leg: int, q: ArrayLike) -> Numbers:
        """D: (..., n, positions). The foot's velocity is Dᵀ Ẋ, and a force F on it acts on X as D F."""
        leg = whole("leg", leg, most=2)

        def kernel(q: bytes) -> list[bytes]:
            return self._kernels.foot_jacobian(leg, q)

        return self._evaluate(kernel, [(self._size, len(self.positions))], q=q)[0]

    def inverse(self, q: ArrayLike, qd: ArrayLike, qdd: ArrayLike, *, stance: Optional[int] = 1) -> InverseDynamics:
        """What accelerates the prescribed coordinates by `qdd` (..., prescribed) while virtual leg `stance` (1 or 2) stands, or none."""
        stance = whole("stance", stance, most=2)

        def kernel(q: bytes, qd: bytes, qdd: bytes) -> list[bytes]:
            return self._kernels.inverse(stance, q, qd, qdd)

        shapes = [(self._size,), (len(self.joints),), (self._reaction(stance),)]
        return InverseDynamics(*self._evaluate(kernel, shapes, q=q, qd=qd, qdd=qdd))

    def inverse_jacobian(
        self, q: ArrayLike, qd: ArrayLike, qdd: ArrayLike, *, stance: Optional[int] = 1
    ) -> InverseJacobian:
        """Its derivatives, at the same arguments."""
        stance = whole("stance", stance, most=2)

        def kernel(q: bytes, qd: bytes, qdd: bytes) -> list[bytes]:
            return self._kernels.inverse_jacobian(stance, q, qd, qdd)

        m = 3 * len(self.coordinates)
        shapes = [(len(self.joints), m), (self._reaction(stance), m), (m,)]
        return InverseJacobian(*self._evaluate(kernel, shapes, q=q, qd=qd, qdd=qdd))

    @property
    def _size(self) -> int:
        return len(self.positions) + len(self.coordinates)

    def _reaction(self, stance: Optional[int]) -> int:
        return 0 if stance is None else len(self.positions)

    def _evaluate(
        self, kernel: Callable[..., list[bytes]], shapes: Sequence[Tuple[int, ...]], **inputs: ArrayLike
    ) -> list[Numbers]:
        """A kernel at all states of arrays that are broadcast against each other, but for their last axis."""
        import numpy as np

        widths = {
            "q": self.coordinates,
            "qd": self.coordinates,
            "qdd": self.prescribed,
            "x": self.positions + self.coordinates,
            "xd": self.positions + self.coordinates,
        }
        arrays = {name: _real(name, values) for name, values in inputs.items()}
        for name, array in arrays.items():
            names = widths[name]
            if array.ndim == 0 or array.shape[-1] != len(names):
                found = f"has the shape {array.shape}"
                raise Error(f"`{name}` {found}: its last axis must have {len(names)} numbers ({', '.join(names)})")
        try:
            states = np.broadcast_shapes(*(array.shape[:-1] for array in arrays.values()))
        except ValueError as why:
            raise Error(f"these arrays are not of the same states: {why}") from None
        rows = [np.broadcast_to(array, (*states, array.shape[-1])).tobytes() for array in arrays.values()]
        blocks = kernel(*rows)
        return [np.frombuffer(block).reshape(states + shape) for block, shape in zip(blocks, shapes)]


def _real(name: str, values: ArrayLike) -> Numbers:
    """An array of real numbers: what is none is not made one."""
    import numpy as np

    array = np.asarray(values)
    if array.size and not (np.issubdtype(array.dtype, np.integer) or np.issubdtype(array.dtype, np.floating)):
        raise TypeError(f"`{name}` is an array of {array.dtype}: give real numbers")
    return array.astype(np.float64, copy=False)
