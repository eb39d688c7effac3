"""CPU seconds of `posewise select` on one core and the value of what it finds where there are many
parameters, of two builds beside each other: 20 of 1000 poses, 86, 134 and 158 parameters with
priors. What a change gains in time must not be lost in value.

python3 tests/benchmark/many_parameters_times.py BEFORE/posewise AFTER/posewise [seeds] [poses]
"""

import os
import sys
import tempfile

from plan_times import SOURCE, run

CAMPAIGN = os.path.join(SOURCE, "designs", "abb_irb120", "planning.yaml")
MORE_ERRORS = {
    86: "",
    134: "  axis_tilt: {orders: [1, 2]}\n",
    158: "  axis_tilt: {orders: [1, 2]}\n  harmonics: {orders: [3, 4]}\n",
}


def main():
    programs = sys.argv[1:3]
    seeds = int(sys.argv[3]) if len(sys.argv) > 3 else 5
    poses = sys.argv[4] if len(sys.argv) > 4 else "20"
    with open(CAMPAIGN, encoding="utf-8") as file:
        text = file.read()
    print(f"{'parameters':10}{'seed':>5}{'before/s':>10}{'after/s':>10}{'before':>15}{'after':>15}")
    with tempfile.TemporaryDirectory() as folder:
        campaign = os.path.join(folder, "campaign.yaml")
        out = os.path.join(folder, "plan.json")
        for parameters, errors in MORE_ERRORS.items():
            with open(campaign, "w", encoding="utf-8") as file:
                file.write(text.replace("\nsensor:", errors + "\nsensor:", 1))
            for seed in range(1, seeds + 1):
                found = [run(program, "select", campaign, ["--random", "1000", "--poses", poses],
                             seed, out) for program in programs]
                print(f"{parameters:10}{seed:5}"
                      + "".join(f"{seconds:10.1f}" for seconds, _ in found)
                      + "".join(f"{value:15.8g}" for _, value in found), flush=True)


if __name__ == "__main__":
    main()
