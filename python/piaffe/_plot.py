"""The paper's figures of a motion, by matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ._result import Result

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Robots in the stick diagram.
STICKS = 12
#: Moments in the phases that define the gait.
MOMENTS = 400


def figure(result: Result) -> Figure:
    import numpy as np
    from matplotlib.figure import Figure

    # Of a result without a motion there are no durations, and the walk says so.
    walk = result.walk(float(np.clip(MOMENTS / (sum(result.durations) or 1.0), 1.0, 1e6)))
    page = Figure(figsize=(10.0, 8.0), layout="constrained")
    page.suptitle(f"{result.gait} of {result.robot}, least {result.criterion} at {result.speed:g} m/s")
    areas = page.subplot_mosaic([["sticks", "sticks"], ["angles", "torques"], ["rates", "forces"]])

    sticks = areas["sticks"]
    for moment in np.linspace(0, len(walk) - 1, STICKS).astype(int):
        for k, leg in enumerate(walk.legs):
            chain = walk.chains[leg][moment]
            sticks.plot(chain[:, 0], chain[:, 1], color=f"C{k}", linewidth=1, label=leg if moment == 0 else None)
        mounts = np.array([chain[moment, 0] for chain in walk.chains.values()])
        sticks.plot(mounts[:, 0], mounts[:, 1], color="0.4", linewidth=2)
    sticks.axhline(0.0, color="0.8", linewidth=1, zorder=0)
    sticks.set(xlabel="forward, m", ylabel="up, m", aspect="equal")
    sticks.legend(fontsize="small", loc="upper left")

    for name, columns, names, unit in [
        ("angles", walk.q, walk.coordinates, "angle, rad"),
        ("rates", walk.qd, walk.coordinates, "speed, rad/s"),
        ("torques", walk.torque, walk.joints, "torque, N·m"),
        ("forces", walk.force, ("forward", "up", "right"), "reaction, N"),
    ]:
        area = areas[name]
        area.plot(walk.t, columns, label=names)
        for end in walk.t[:-1][np.diff(walk.phase) != 0]:
            area.axvline(end, color="0.8", linewidth=1, zorder=0)
        area.set(xlabel="time, s", ylabel=unit)
        area.legend(fontsize="small")
    return page
