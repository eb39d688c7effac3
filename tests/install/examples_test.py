"""Programs of README and of its kind, built by a stranger's project, print what the command line
prints, with a criterion stated in the campaign and without.

But for rounding: a program that does not fix the cache sizes sums in the order that suits its CPU.

    examples_test.py REPOSITORY FOLDER_OF_THE_PROGRAMS POSEWISE
"""

import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

MOST_LINES = 12
CRITERION = re.compile(r"^criterion: .*\n", re.MULTILINE)
NUMBER = re.compile(r"[+-]?\d+(?:\.\d+)?(?:e[+-]?\d+)?")
COMMANDS = {
    "example": ["select campaign.yaml -m measurements.csv -k 12",
                "calibrate campaign.yaml -m measurements.csv"],
    "plan": ["plan campaign.yaml -k 12"],
}


def is_like(line, other):
    """Whether the words are the same and the numbers within 2 % (searches may end elsewhere)."""
    if NUMBER.sub("#", line) != NUMBER.sub("#", other):
        return False
    pairs = zip(map(float, NUMBER.findall(line)), map(float, NUMBER.findall(other)))
    return all(abs(a - b) <= 0.02 * max(abs(a), abs(b)) + 1e-3 for a, b in pairs)


def check(repository, programs, posewise, name, commands, campaign):
    source = (repository / "tests/install/stranger" / f"{name}.cpp").read_text()
    if name == "example" and source not in (repository / "README.md").read_text():
        return f"{name}.cpp: stands in README.md with other words"
    if len(source.splitlines()) > MOST_LINES:
        return f"{name}.cpp: has more than {MOST_LINES} lines"

    def run(command):
        return subprocess.run(command, check=True, capture_output=True, text=True, cwd=folder).stdout

    with tempfile.TemporaryDirectory() as folder:
        (pathlib.Path(folder) / "campaign.yaml").write_text(campaign)
        shutil.copy(repository / "data/fanuc_r2000ic_165f_simulated/measurements.csv", folder)
        printed = run([programs / name])
        expected = [run([posewise, *command.split()]) for command in commands]
    wanted = [line for line in printed.splitlines() if line]
    there = [line for text in expected for line in text.splitlines()]
    missing = [line for line in wanted if not any(is_like(line, other) for other in there)]
    if missing or len(wanted) < MOST_LINES:
        return f"{name}.cpp: prints what {' and '.join(commands)} do not: {missing[:3]}"
    return ""


if __name__ == "__main__":
    root, folder_of_programs, program = (pathlib.Path(argument) for argument in sys.argv[1:4])
    stated = (root / "designs/fanuc_r2000ic_165f/campaign.yaml").read_text()
    unstated, count = CRITERION.subn("", stated)
    assert count == 1, "the campaign states a criterion"
    results = [check(root, folder_of_programs, program, name, COMMANDS[name], campaign)
               for name, campaign in (("example", stated), ("example", unstated), ("plan", stated))]
    print("\n".join(result for result in results if result) or "the examples print the same")
    sys.exit(1 if any(results) else 0)
