"""Every bundled campaign is what the command in its second line makes.

    data_test.py REPOSITORY PROGRAM
"""

import csv
import pathlib
import shlex
import subprocess
import sys
import tempfile

TOLERANCE = 1e-9  # mm and rad: mathematical libraries differ in the last digits


def read(path):
    """The command, the column names, the numbers."""
    lines = path.read_text().splitlines()
    command = lines[1].removeprefix("# ")
    header, *rows = csv.reader(line for line in lines if not line.startswith("#"))
    return command, header, [[float(cell) for cell in row] for row in rows]


def differs(first, second):
    return len(first) != len(second) or any(
        len(a) != len(b) or any(abs(x - y) > TOLERANCE for x, y in zip(a, b))
        for a, b in zip(first, second))


def check(repository, program, path):
    command, header, rows = read(path)
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "again.csv"
        arguments = shlex.split(command)[1:] + ["--out", str(out)]
        subprocess.run([program, *arguments], cwd=repository, check=True, stdout=subprocess.DEVNULL)
        _, header_again, rows_again = read(out)
    if header != header_again or differs(rows, rows_again):
        return f"{path}: '{command}' makes other numbers now; make it again"
    return f"{path}: as its command makes it"


if __name__ == "__main__":
    root, posewise = pathlib.Path(sys.argv[1]), sys.argv[2]
    campaigns = sorted(root.glob("data/*/measurements.csv"))
    results = [check(root, posewise, path) for path in campaigns]
    print("\n".join(results))
    sys.exit(0 if results and all(r.endswith("makes it") for r in results) else 1)
