"""Whole optimizations beside CasADi + Ipopt: the same robot, start, problem and machine, in turns.

    python3 benches/peers/run.py [--rounds 3] [--speed 0.6] [--keep DIR]

Needs cargo, a C compiler and Python 3; makes a virtual environment with casadi, numpy and scipy where they are missing.
CasADi evaluates in its virtual machine and as compiled C; the ratio is to the faster of the two. Times are medians of
one cold optimization each, from the same walk, without building or compiling (half an hour for all of the C, kept
with --keep); processor time of one thread, all on one core (where the system can hold a program to one), so that neither other work
on the machine nor differences between its cores matter much (wall time where there is no /proc).
Ours includes the receipt. Costs differ a little: 43 nodes there, constraints between the nodes and exact |power| here.
"""
import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
import venv
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
GAITS, CRITERIA = ("trot", "amble", "curvet"), ("energy", "torque")


def with_packages():
    """Continues in an environment that has the packages."""
    try:
        import casadi, numpy, scipy  # noqa: F401
    except ImportError:
        home = Path(tempfile.gettempdir()) / f"piaffe-peers-{os.getuid()}"
        python = home / "bin" / "python"
        if "PIAFFE_PEERS" in os.environ:
            sys.exit(f"casadi, numpy or scipy cannot be imported from {home}: remove it and try again")
        if not python.exists():
            venv.create(home, with_pip=True)
        subprocess.run([python, "-m", "pip", "install", "--quiet", "casadi", "numpy", "scipy"], check=True)
        os.execve(python, [str(python), *sys.argv], {**os.environ, "PIAFFE_PEERS": "1"})


class Ours:
    """The example `cold`, which answers line by line."""

    def __init__(self):
        build = ["cargo", "build", "--release", "--quiet", "--example", "cold"]
        subprocess.run(build, cwd=ROOT, check=True)
        target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
        self.process = subprocess.Popen([target / "release" / "examples" / "cold"], text=True, stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE)

    def ask(self, gait, criterion, speed):
        """The answer, with its processor time in seconds."""
        before = self.busy()
        print(gait, criterion, speed, file=self.process.stdin, flush=True)
        answer = json.loads(self.process.stdout.readline())
        if "error" in answer:
            sys.exit(answer["error"])
        return answer, answer["seconds"] if before is None else self.busy() - before

    def busy(self):
        try:
            return 1e-9 * int(Path(f"/proc/{self.process.pid}/schedstat").read_text().split()[0])
        except (OSError, IndexError, ValueError):
            return None


def hold_to_one_core(other):
    """This process (with the compilers that it starts) and another."""
    if hasattr(os, "sched_setaffinity"):
        core = max(os.sched_getaffinity(0))
        for pid in (0, other):
            os.sched_setaffinity(pid, {core})


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--speed", type=float, default=0.6)
    parser.add_argument("--keep", help="folder for the C code, kept and used again")
    arguments = parser.parse_args()
    with_packages()
    os.environ["OMP_NUM_THREADS"] = "1"
    from model import Model
    from program import Program

    ours, points = Ours(), []
    hold_to_one_core(ours.process.pid)
    folder = Path(arguments.keep or tempfile.mkdtemp(prefix="piaffe-peers-")).resolve()
    for gait in GAITS:
        for criterion in CRITERIA:
            first, _ = ours.ask(gait, criterion, arguments.speed)
            program = Program(Model(first["description"]), criterion == "energy", arguments.speed)
            print(f"building {gait} {criterion}: {program.size} variables, {len(program.lower)} rows", file=sys.stderr)
            solvers = {"vm": program.solver(None), "C": program.solver(folder / f"{gait}-{criterion}")}
            points.append((gait, criterion, program.arguments(first["start"]), solvers))

    times, costs, failed = {}, {}, set()
    for _ in range(arguments.rounds):
        for gait, criterion, given, solvers in points:
            answer, seconds = ours.ask(gait, criterion, arguments.speed)
            times.setdefault((gait, criterion, "ours"), []).append(seconds)
            costs[gait, criterion, "ours"] = answer["cost"]
            for name, solver in solvers.items():
                started = time.process_time()
                solution = solver(**given)
                times.setdefault((gait, criterion, name), []).append(time.process_time() - started)
                costs[gait, criterion, name] = float(solution["f"])
                if not solver.stats()["success"]:
                    failed.add((gait, criterion, name))

    print(f"one cold optimization at {arguments.speed} m/s, median of {arguments.rounds}, ms of processor time; × no optimum")
    print(f"{'':<15} {'ours':>9} {'VM':>9} {'C':>9} {'ratio':>7} {'cost ours':>11} {'theirs':>11}")
    for gait, criterion, _, _ in points:
        ms = {name: 1e3 * statistics.median(times[gait, criterion, name]) for name in ("ours", "vm", "C")}
        theirs = min(("vm", "C"), key=ms.get)
        cost = costs[gait, criterion, "ours"]
        print(f"{gait + ' ' + criterion:<15} {ms['ours']:9.1f} {ms['vm']:9.0f} {ms['C']:9.0f} {ms[theirs] / ms['ours']:7.0f} "
              f"{'-' if cost is None else format(cost, '.4f'):>11} {costs[gait, criterion, theirs]:11.4f}"
              f"{' ×' if (gait, criterion, theirs) in failed else ''}")


if __name__ == "__main__":
    main()
