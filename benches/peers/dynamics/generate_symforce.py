"""C++ code from SymForce: A + H of each gait. Arguments: mechanism.json, folder."""

import os
import re
import sys

import symforce

symforce.set_epsilon_to_number()
import symforce.symbolic as sf
from mechanism import Motion, load
from symforce import codegen
from symforce.values import Values


class Matrix:
    """`@` and `.T` for SymForce's matrices."""

    def __init__(self, m):
        self.m = m

    T = property(lambda self: Matrix(self.m.T))

    def __matmul__(self, other):
        return Matrix(self.m * other.m)

    def __add__(self, other):
        return Matrix(self.m + other.m)

    def __sub__(self, other):
        return Matrix(self.m - other.m)

    def __rmul__(self, factor):
        return Matrix(self.m * factor)

    def __getitem__(self, k):
        return self.m[k, 0]


class Backend:
    sin, cos = staticmethod(sf.sin), staticmethod(sf.cos)

    @staticmethod
    def zeros(rows, columns):
        return Matrix(sf.Matrix.zeros(rows, columns))

    @staticmethod
    def matrix(rows):
        return Matrix(sf.Matrix(rows))

    @staticmethod
    def jacobian(value, by):
        return Matrix(value.m.jacobian(by.m))

    @staticmethod
    def cross(a, b):
        return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def main(description, folder):
    os.makedirs(folder, exist_ok=True)
    includes, calls = "", ""
    for m in load(description):
        motion = Motion(Backend, m)
        n, gait = motion.n, m["gait"]
        al = [sf.Symbol(f"al{k}") for k in range(n)]
        ad = [sf.Symbol(f"ad{k}") for k in range(n)]
        A, H = motion.inertia_and_bias(al, ad)
        vector = getattr(sf, f"V{n}")
        X, Xd = vector.symbolic("x"), vector.symbolic("xd")
        T = sf.Matrix(motion.T)
        A, H = T.T * A.m * T, T.T * H.m
        # Absolute angles as sums, so that 1.0 does not appear as a factor.
        total = lambda v, k: sum((v[j] for j in range(n) if motion.T[k][j]), sf.S.Zero)
        to_x = {al[k]: total(X, k) for k in range(n)} | {ad[k]: total(Xd, k) for k in range(n)}
        A, H = A.subs(to_x), H.subs(to_x)
        maker = codegen.Codegen(
            inputs=Values(x=X, xd=Xd), outputs=Values(A=A, H=H), config=codegen.CppConfig(), name=f"sf_{gait}"
        )
        maker.generate_function(output_dir=folder, skip_directory_nesting=True)
        source = open(f"{folder}/sf_{gait}.h").read()
        function = re.search(r"^void (\w+)\(", source, re.M).group(1)
        includes += f'#include "sf_{gait}.h"\n'
        calls += f'  run<{n}>("{gait}", [](auto& x, auto& v, auto& A, auto& H) {{ sym::{function}<double>(x, v, &A, &H); }});\n'
    with open(f"{folder}/symforce_list.hpp", "w") as out:
        out.write(includes + "static void run_all() {\n" + calls + "}\n")


main(*sys.argv[1:])
