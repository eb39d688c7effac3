"""CPU seconds of `posewise select` on one core against the number of candidates and of poses:
no step to the next size should cost more than the sizes say.

python3 tests/benchmark/select_times.py build/release/src/cli/posewise [criterion] [campaign]
"""

import os
import subprocess
import sys
import tempfile

CANDIDATES = [24, 32, 48, 60, 64, 65, 80, 120, 250, 500, 1000, 2000, 4000]
POSES = [8, 12, 20, 40]


def cpu_seconds(program, campaign, criterion, candidates, poses, folder):
    before = os.times()
    subprocess.run(
        [program, "select", campaign, "--random", str(candidates), "-k", str(poses),
         "--criterion", criterion, "--out", os.path.join(folder, "plan.json")],
        check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        env={**os.environ, "OMP_NUM_THREADS": "1"})
    after = os.times()
    return (after.children_user - before.children_user
            + after.children_system - before.children_system)


def main():
    program = sys.argv[1]
    criterion = sys.argv[2] if len(sys.argv) > 2 else "d"
    source = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
    design = os.path.join(source, "designs", "fanuc_r2000ic_165f", "campaign.yaml")
    campaign = sys.argv[3] if len(sys.argv) > 3 else design
    print("candidates" + "".join(f"{'K = ' + str(k):>10}" for k in POSES))
    with tempfile.TemporaryDirectory() as folder:
        for n in CANDIDATES:
            times = [cpu_seconds(program, campaign, criterion, n, k, folder) if k < n else None
                     for k in POSES]
            print(f"{n:10}" + "".join(f"{'':>10}" if t is None else f"{t:10.2f}" for t in times),
                  flush=True)


if __name__ == "__main__":
    main()
