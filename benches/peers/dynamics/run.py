#!/usr/bin/env python3
"""Times piaffe's generated dynamics beside CasADi, SymForce, Pinocchio and MuJoCo, and prints a table.

    python3 benches/peers/dynamics/run.py [ROUNDS]

Needs g++, Eigen (libeigen3-dev) and network for pip; everything else lands in target/peers/dynamics. All programs are compiled
for this machine and take turns, ROUNDS times (default 5), on one core; the table has the least time of each.
"""

import json
import os
import subprocess
import sys
import venv
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent.parent
OUT = ROOT / "target" / "peers" / "dynamics"
PACKAGES = ["casadi==3.8.*", "pin==4.1.*", "mujoco==4.0.*", "symforce==0.12.*"]
NATIVE = ["-O3", "-march=native"]


def run(*command, **options):
    return subprocess.run([str(c) for c in command], check=True, text=True, **options)


def python():
    executable = OUT / "venv" / "bin" / "python"
    if not executable.exists():
        venv.create(OUT / "venv", with_pip=True)
        run(executable, "-m", "pip", "install", "-q", *PACKAGES)
    return executable


def piaffe():
    """The benchmark's executable."""
    environment = os.environ | {"RUSTFLAGS": "-C target-cpu=native", "CARGO_TARGET_DIR": str(OUT / "cargo")}
    built = run(
        "cargo", "build", "-q", "--profile", "bench", "--bench", "peers", "--message-format", "json",
        cwd=ROOT, env=environment, stdout=subprocess.PIPE,
    )
    messages = [json.loads(line) for line in built.stdout.splitlines()]
    return next(m["executable"] for m in messages if m.get("target", {}).get("name") == "peers" and m["executable"])


def compile_cpp(name, output, *flags):
    """Compiles unless the result is newer than all that it is made of."""
    parts = [HERE / f"{name}.cpp", HERE / "timing.hpp", *OUT.glob("*.hpp")]
    if not output.exists() or output.stat().st_mtime < max(p.stat().st_mtime for p in parts):
        run("g++", "-std=c++17", *NATIVE, "-DNDEBUG", "-w", f"-I{HERE}", f"-I{OUT}", "-I/usr/include/eigen3",
            HERE / f"{name}.cpp", "-o", output, *flags)
    return output


def mujoco_xml(m):
    """The mechanism for MuJoCo; axial moments that are zero get a value too small to matter."""
    vector = lambda v: " ".join(repr(float(x)) for x in v)

    def body(i):
        b = m["bodies"][i]
        assert all(b["inertia"][r][c] == 0 for r in range(3) for c in range(3) if r != c)
        joints = f'<joint type="hinge" axis="0 0 1"/>'
        if b["parent"] is None:
            axes = ["1 0 0", "0 1 0", "0 0 1"][: m["positions"]]
            joints = "".join(f'<joint type="slide" axis="{a}"/>' for a in axes)
            turn = {"Pitch": "0 0 1", "Roll": "1 0 0"}.get(m["rotation"])
            joints += f'<joint type="hinge" axis="{turn}"/>' if turn else ""
        moments = vector(max(b["inertia"][k][k], 1e-12) for k in range(3))
        inertial = f'<inertial pos="{vector(b["com"])}" mass="{b["mass"]!r}" diaginertia="{moments}"/>'
        children = "".join(body(j) for j, c in enumerate(m["bodies"]) if c["parent"] == i)
        return f'<body pos="{vector(b["offset"])}">{joints}{inertial}{children}</body>'

    options = f'<compiler angle="radian" balanceinertia="true"/><option gravity="0 {-m["gravity"]!r} 0"/>'
    return f"<mujoco>{options}<worldbody>{body(0)}</worldbody></mujoco>"


def pinocchio_header(mechanisms):
    numbers = lambda v: "{" + ", ".join(repr(x) for x in v) + "}"
    number = lambda x: -1 if x is None else x

    def body(b):
        inertia = [x for row in b["inertia"] for x in row]
        return (f'{{{number(b["parent"])}, {number(b["coordinate"])}, {b["axis"]}, {numbers(b["offset"])}, '
                f'{b["mass"]!r}, {numbers(b["com"])}, {numbers(inertia)}}}')

    rows = []
    for m in mechanisms:
        rotation = {"None": 0, "Roll": 1, "Pitch": 2}[m["rotation"]]
        bodies = ", ".join(body(b) for b in m["bodies"])
        rows.append(f'  {{"{m["gait"]}", {m["gravity"]!r}, {m["positions"]}, {rotation}, {{{bodies}}}}},\n')
    return "static const std::vector<Mechanism> MECHANISMS = {\n" + "".join(rows) + "};\n"


def write(path, text):
    if not path.exists() or path.read_text() != text:
        path.write_text(text)


def build():
    """name → command of every program."""
    interpreter, own = python(), piaffe()
    description = OUT / "mechanisms.json"
    write(description, run(own, "--describe", stdout=subprocess.PIPE).stdout)
    mechanisms = json.loads(description.read_text())
    run(interpreter, HERE / "generate_casadi.py", description, OUT)
    run(interpreter, HERE / "generate_symforce.py", description, OUT)
    write(OUT / "mechanisms.hpp", pinocchio_header(mechanisms))
    for m in mechanisms:
        write(OUT / f"{m['gait']}.xml", mujoco_xml(m))
    site = next((OUT / "venv" / "lib").glob("python3*/site-packages"))
    programs = {"piaffe": [own]}
    for label, flags in [("", []), (" -ffast-math", ["-ffast-math"])]:
        objects = []
        for m in mechanisms:
            objects.append(OUT / f"casadi_{m['gait']}{label.strip()}.o")
            run("gcc", *NATIVE, *flags, "-c", OUT / f"casadi_{m['gait']}.c", "-o", objects[-1])
        programs["CasADi" + label] = [compile_cpp("casadi", OUT / f"casadi{label.strip()}", *objects, "-lm")]
        programs["SymForce" + label] = [compile_cpp("symforce", OUT / f"symforce{label.strip()}", *flags)]
    cmeel, mujoco = site / "cmeel.prefix", site / "mujoco"
    limits = ["-DBOOST_MPL_LIMIT_LIST_SIZE=30", "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30",
              "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS", "-DBOOST_FUSION_INVOKE_MAX_ARITY=12"]
    programs["Pinocchio"] = [
        compile_cpp("pinocchio", OUT / "pinocchio", *limits, f"-I{cmeel}/include", f"-L{cmeel}/lib",
                    "-lpinocchio_default", "-lboost_serialization", f"-Wl,-rpath,{cmeel}/lib")
    ]
    library = next(mujoco.glob("libmujoco.so.*"))
    gaits = [m["gait"] for m in mechanisms]
    programs["MuJoCo"] = [
        compile_cpp("mujoco", OUT / "mujoco", f"-I{mujoco}/include", library, f"-Wl,-rpath,{mujoco}"), *gaits
    ]
    return programs, mechanisms


def measure(programs, rounds):
    """(program, gait, quantity) → least ns."""
    core = str(max(os.sched_getaffinity(0)))
    best = {}
    for _ in range(rounds):
        for name, command in programs.items():
            for line in run("taskset", "-c", core, *command, cwd=OUT, stdout=subprocess.PIPE).stdout.splitlines():
                row = json.loads(line)
                key = (name, row["gait"], row["what"])
                best[key] = min(best.get(key, float("inf")), row["ns"])
    return best


def table(best, mechanisms):
    """Markdown: times in ns and, in brackets, how many times piaffe's."""
    peers = ["CasADi", "CasADi -ffast-math", "SymForce", "SymForce -ffast-math", "Pinocchio", "MuJoCo"]
    # Quantity of piaffe, what it is compared with.
    rows = [
        ("A + H", "A + H"),
        ("A + H, batch", "A + H"),
        ("inverse dynamics", "inverse dynamics"),
        ("inverse dynamics, batch", "inverse dynamics"),
        ("inverse dynamics with Jacobian", "inverse dynamics with Jacobian"),
        ("beta step", "beta step"),
        ("beta step with all partials", "beta step with all partials"),
        ("beta step, early values included", "beta step"),
    ]
    lines = ["| ns per state | gait | piaffe | " + " | ".join(peers) + " |", "|---|---|" + "---:|" * (len(peers) + 1)]
    for own, other in rows:
        for m in mechanisms:
            mine = best["piaffe", m["gait"], own]
            cells = []
            for peer in peers:
                theirs = best.get((peer, m["gait"], other))
                cells.append("" if theirs is None else f"{theirs:.0f} ({theirs / mine:.1f})")
            lines.append(f"| {own} | {m['gait']} | {mine:.1f} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def main():
    OUT.mkdir(parents=True, exist_ok=True)
    programs, mechanisms = build()
    print(table(measure(programs, int(sys.argv[1]) if len(sys.argv) > 1 else 5), mechanisms))
    counts = json.loads((OUT / "casadi_operations.json").read_text())
    kernels = {"A + H": "inertia_and_bias", "inverse dynamics": "inverse1",
               "inverse dynamics with Jacobian": "inverse_jacobian1"}
    print("\n| additions and multiplications | gait | piaffe | CasADi |\n|---|---|---:|---:|")
    for what, kernel in kernels.items():
        for m in mechanisms:
            print(f"| {what} | {m['gait']} | {m['operations'][kernel]} | {counts[m['gait'] + '/' + what]} |")


if __name__ == "__main__":
    main()
