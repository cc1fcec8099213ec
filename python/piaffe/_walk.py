"""A motion in the world, as arrays over time."""

from __future__ import annotations

from dataclasses import dataclass
from io import BytesIO
from typing import TYPE_CHECKING, Any, Tuple

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Numbers = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Walk:
    """One whole step, moment by moment: n moments at equal distances in time.

    World axes: x forward, y up, z to the right. Two moments at one time are before and after a landing.
    """

    t: Numbers
    """n: from the beginning of the step, s."""
    phase: NDArray[np.int64]
    """n: which phase, from 1."""
    stance: NDArray[np.int64]
    """n: the virtual leg that stands, 1 or 2; 0 in flight."""
    p: Numbers
    """n × 3: the platform's mass centre, m."""
    pd: Numbers
    """n × 3: its velocity, m/s."""
    pdd: Numbers
    """n × 3: its acceleration, m/s²."""
    q: Numbers
    """n × coordinates: angles, rad."""
    qd: Numbers
    """n × coordinates: rad/s."""
    qdd: Numbers
    """n × coordinates: rad/s²."""
    torque: Numbers
    """n × joints: of the virtual legs' joints, N·m."""
    force: Numbers
    """n × 3: the reaction on the virtual leg that stands, N; in flight 0."""
    feet: Numbers
    """n × legs × 3: of the real legs, m."""
    chains: dict[str, Numbers]
    """By real leg, n × points × 3: its joints from the platform down, and its foot, m."""
    coordinates: Tuple[str, ...]
    """Names of the columns of `q`, `qd`, `qdd`: the virtual legs' joints, then the platform's rotation if it has one."""
    joints: Tuple[str, ...]
    """Names of the columns of `torque`."""
    legs: Tuple[str, ...]
    """Names of the real legs, in the order of `feet`."""
    real_joints: dict[str, int]
    """The column of `q` that each joint of the real robot follows."""

    @classmethod
    def _read(cls, archive: bytes) -> Walk:
        import numpy as np

        with np.load(BytesIO(archive)) as arrays:
            named: dict[str, Any] = {name: arrays[name] for name in arrays.files}

        def words(name: str) -> Tuple[str, ...]:
            return tuple(str(word) for word in named[name])

        plain = ["t", "p", "pd", "pdd", "q", "qd", "qdd", "torque", "force", "feet"]
        return cls(
            **{name: named[name] for name in plain},
            phase=named["phase"].astype(np.int64),
            stance=named["stance"].astype(np.int64),
            chains={leg: named[f"chain_{leg}"] for leg in words("legs")},
            coordinates=words("coordinates"),
            joints=words("joints"),
            legs=words("legs"),
            real_joints={name: int(k) for name, k in zip(words("real_joints"), named["real_joint_of"])},
        )

    def __len__(self) -> int:
        return len(self.t)
