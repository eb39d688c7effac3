"""No product of matrices is compiled where the compiler does not optimise (posewise_computes_nothing):
of the copies of a template that objects bring along a linker takes the first, for all. Usage:
products_test.py NM OBJECT..."""

import subprocess
import sys


def main(nm: str, objects: list[str]) -> int:
    failures = 0
    for path in (path for path in objects if not path.endswith(".gch")):
        symbols = subprocess.run([nm, path], capture_output=True, text=True, check=True).stdout
        for kernel in ("gebp_kernel", "general_matrix_vector_product", "triangular_solve"):
            if kernel in symbols:
                print(f"{path}: compiles {kernel} without optimisation")
                failures += 1
    if not objects:
        print("no objects given")
    return 1 if failures or not objects else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2:]))
