"""Whole optimizations beside CasADi + Ipopt: the same robot, starts, problem and machine, in turns.

    python3 benches/peers/run.py [--starts 8] [--rounds 3] [--speed 0.6] [--keep DIR] [--vm]

Needs cargo, a C compiler and Python 3; makes a virtual environment with casadi, numpy and scipy where they are missing.
CasADi evaluates as compiled C (half an hour for all of it, kept with --keep), with --vm in its virtual machine, which is slower.
Each start is a walk drawn from geometry and a seed, the same for both. A time is the median of `rounds` cold optimizations,
processor time of one thread, all on one core (where the system can hold a program to one), so that neither other work
on the machine nor differences between its cores matter much (wall time where there is no /proc).
Ours includes the receipt. Costs differ a little: 43 nodes there, constraints between the nodes and exact |power| here.
"""
import argparse
import functools
import itertools
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
# Costs that differ by less than this share are of one optimum.
SAME = 1e-2
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

    def ask(self, gait, criterion, speed, start):
        """The answer, with its processor time in seconds."""
        before = self.busy()
        print(gait, criterion, speed, start, file=self.process.stdin, flush=True)
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


def table(tries, starts):
    """Lines of a Markdown table. `tries`: of each problem and start ((seconds, cost) of ours, of theirs), cost None without optimum."""
    side = f"ms | least | found from, of {starts}"
    yield f"| | piaffe, {side} | CasADi, {side} | ratio, median (range) | ms per start that leads to the least |"
    yield "|---|" + "---:|" * 8
    for name, runs in tries.items():
        cells, per_optimum = [], []
        for side in zip(*runs):
            seconds, costs = zip(*side)
            least = min((cost for cost in costs if cost is not None), default=None)
            count = sum(cost is not None and cost <= (1 + SAME) * least for cost in costs)
            cells += [f"{1e3 * statistics.median(seconds):.3g}", f"{least:.4f}" if count else "–", str(count)]
            per_optimum.append(f"{1e3 * sum(seconds) / count:.0f}" if count else "–")
        ratios = sorted(theirs / ours for (ours, _), (theirs, _) in runs)
        ratio = f"{statistics.median(ratios):.0f} ({ratios[0]:.0f} to {ratios[-1]:.0f})"
        yield f"| {' | '.join([name, *cells, ratio, ' and '.join(per_optimum)])} |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--starts", type=int, default=8)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--speed", type=float, default=0.6)
    parser.add_argument("--keep", help="folder for the C code, kept and used again")
    parser.add_argument("--vm", action="store_true", help="no C: CasADi's virtual machine")
    arguments = parser.parse_args()
    with_packages()
    os.environ["OMP_NUM_THREADS"] = "1"
    from model import Model
    from program import Program

    ours = Ours()
    hold_to_one_core(ours.process.pid)
    folder = Path(arguments.keep or tempfile.mkdtemp(prefix="piaffe-peers-")).resolve()
    tries = {}
    for gait, criterion in itertools.product(GAITS, CRITERIA):
        ask = functools.partial(ours.ask, gait, criterion, arguments.speed)
        program = Program(Model(ask(0)[0]["description"]), criterion == "energy", arguments.speed)
        print(f"building {gait} {criterion}: {program.size} variables, {len(program.lower)} rows", file=sys.stderr)
        solver = program.solver(None if arguments.vm else folder / f"{gait}-{criterion}")
        for start in range(arguments.starts):
            given, own, their = program.arguments(ask(start)[0]["start"]), [], []
            for _ in range(arguments.rounds):
                answer, seconds = ask(start)
                own.append(seconds)
                started = time.process_time()
                solution = solver(**given)
                their.append(time.process_time() - started)
            theirs = float(solution["f"]) if solver.stats()["success"] else None
            pair = ((statistics.median(own), answer["cost"]), (statistics.median(their), theirs))
            tries.setdefault(f"{gait}, {criterion}", []).append(pair)
            print(f"  start {start}: {pair}", file=sys.stderr)

    print(f"Cold optimizations at {arguments.speed} m/s from {arguments.starts} starts, processor time, "
          f"each the median of {arguments.rounds}\n")
    print("\n".join(table(tries, arguments.starts)))


if __name__ == "__main__":
    main()
