"""CPU seconds of `posewise plan` on one core and the value of what it finds, of two builds beside
each other: what a change gains in time must not be lost in value.

python3 tests/benchmark/plan_times.py BEFORE/posewise AFTER/posewise [seeds]
"""

import json
import os
import subprocess
import sys
import tempfile

SOURCE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
WORK = [
    ("IRB 120, 20 poses", "abb_irb120/planning.yaml", ["--poses", "20"]),
    ("FANUC, 24 poses, D", "fanuc_r2000ic_165f/campaign.yaml", ["--poses", "24", "--criterion", "d"]),
    ("cell, 30 poses", "cell_demo/campaign.yaml", ["--poses", "30"]),
]


def run(program, command, campaign, arguments, seed, out):
    before = os.times()
    subprocess.run(
        [program, command, campaign, *arguments, "--seed", str(seed), "--out", out],
        check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        env={**os.environ, "OMP_NUM_THREADS": "1"})
    after = os.times()
    with open(out, encoding="utf-8") as file:
        value = json.load(file)["value"]
    return (after.children_user - before.children_user
            + after.children_system - before.children_system, value)


def main():
    programs = sys.argv[1:3]
    seeds = int(sys.argv[3]) if len(sys.argv) > 3 else 4
    print(f"{'':22}{'seed':>5}{'before/s':>10}{'after/s':>10}{'before':>15}{'after':>15}")
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "plan.json")
        for name, design, arguments in WORK:
            campaign = os.path.join(SOURCE, "designs", design)
            for seed in range(1, seeds + 1):
                found = [run(program, "plan", campaign, arguments, seed, out)
                         for program in programs]
                print(f"{name:22}{seed:5}" + "".join(f"{seconds:10.1f}" for seconds, _ in found)
                      + "".join(f"{value:15.8g}" for _, value in found), flush=True)


if __name__ == "__main__":
    main()
