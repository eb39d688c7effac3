"""No option is ignored: beside each way to use a command it changes what is printed or written, or it is refused.

    options_test.py PROGRAM
"""

import os
import pathlib
import random
import re
import shutil
import subprocess
import sys
import tempfile

os.environ["OMP_NUM_THREADS"] = "1"  # a thousand short runs
PROGRAM = str(pathlib.Path(sys.argv[1]).resolve())
ARM = """name: arm
robot:
  joints: {q1: {limits_deg: [-150, 150]}, q2: {limits_deg: [-80, 80]}, q3: {limits_deg: [-120, 120]}}
  elements: [Rz q1, Tz 300 mm, "Ry q2 [dq2]", "Tz 400 mm [Tz2]", Ry q3, Tx 350 mm]
sensor: {kind: points, sigma_mm: 0.05, targets: {position_mm: [[0, 30, 50], [40, 0, -20], [0, -40, 10]]}}
model_error_mm: 0.1
base: {position_mm: [900, 100, -200], rpy_deg: [0, 0, 30]}
"""
# What it is asked for matters, not whether it is there.
FREE = {"--help", "--json", "--threads", "--time", "--progress", "--no-prior"}
VALUES = {
    "CAMPAIGN": "arm.yaml", "--measurements": "few.csv", "--candidates": "pool.csv", "--random": "9", "--blocks": "blocks.csv",
    "--rows": "3", "--variable": "x", "--repeats": "3", "--poses": "7", "--criterion": "a", "--criteria": "a",
    "--test-poses": "poses.csv", "--focus": "robot", "--augment": "few.csv", "--augment-plan": "plan.json", "--exclude": "5", "--groups": "groups.csv",
    "--per-group": "2", "--repeat-limit": "2", "--least-distance-deg": "500", "--starts": "2", "--proof": "1", "--effort": "quick", "--seed": "99",
    "--out": "out2.json", "--report": "out2.html", "--digits": "12", "--target-mm": "1.5", "--quantity": "max",
    "--assurance": "0.8", "--minutes": "3", "--poses-at-most": "9", "--robust-to": "2", "--plan": "plan.json", "--drop": "p1",
    "--workspace": "pool.csv", "--workspace-poses": "30", "--workspace-box-mm": "-900,-900,-900,900,900,900",
    "--workspace-target": "1", "--pool": "30", "--verify-digits": "1", "--verify-robots": "200", "--csv": "out2.csv",
    "--plot": "out2.svg", "--from": "estimate.json", "--drift-mm": "0.5", "--drift-offset-mrad": "0.5", "--drift-mrad": "0.5",
    "--moved": "base", "--only": "base", "--alpha": "0.5", "--max-iterations": "2", "--length-error-percent": "10",
    "--angle-error-deg": "5", "--search": "cmaes", "--method": "two-step", "--validate": "few.csv", "--predict": "poses.csv",
    "--predict-out": "out3.csv", "--folds": "3", "--loss": "cauchy", "--loss-width": "2", "--refit": "base",
    "--validate-campaign": "arm.yaml", "--dh": "out2.yaml", "--urdf": "out2.urdf", "--ur-kinematics": "out3.yaml", "--mujoco": "out8.xml", "--robodk": "out9.py", "--offsets": "out10.csv",
    "--geometry": "estimate", "--map": "out7.c", "--base": "campaign", "--tool-mm": "10,20,300", "--mm-per-mrad": "2", "--largest-change-deg": "0.001",
    "--largest-change-mm": "1", "--tool-target": "1", "--tool-rpy-deg": "10,0,0", "--frame": "world", "--frame-mm": "0,0,20",
    "--frame-rpy-deg": "0,0,5", "--near": "10,5,5", "--splits": "3", "--holdout": "0.5", "--models": "geometric", "--trials": "3",
    "--precision": "30%", "--truth": "7", "--vary": "sensor.sigma_mm=0.01,0.05", "--points": "2", "--store": "out2.sqlite",
    "--shard": "1/2", "--merge": "part1.sqlite", "--directions": "2", "--campaign": "other.yaml", "--configurations": "poses.csv",
    "--write-campaign": "out4.yaml", "--tip": "x", "--targets": "out5.csv", "--points-unit": "m", "--random-order": "2",
    "--for": "ros2", "--read": "program.csv", "--subset": "own.txt", "--write-blocks": "out6.npy", "--reference": "p1", "--every": "2", "--dwell": "3", "--speed": "30", "--handshake": "pause"}
PLAN = ["-c", "d", "--pool", "40", "--starts", "1", "--workspace-poses", "10", "-o", "out.json"]
CHOICE = ["-k", "6", "--starts", "1", "-o", "out.json"]
STUDY = ["arm.yaml", "-m", "many.csv", "-k", "6", "--random", "4", "--starts", "1"]
SIMULATED = ["arm.yaml", "--simulate", "-k", "6", "--trials", "2", "--pool", "40", "--test-poses", "5"]
MEASURED = ["arm.yaml", "-m", "many.csv", "--folds", "0", "-o", "out.json"]
WAYS = [
    ["inspect", "arm.yaml", "-m", "many.csv"],
    ["inspect", "arm.yaml", "-m", "points.csv", "--plan", "plan.json"],
    ["indices", "arm.yaml", "-m", "many.csv"],
    ["indices", "--blocks", "blocks.csv", "--rows", "3"],
    ["select", "arm.yaml", "-m", "many.csv", *CHOICE],
    ["select", "arm.yaml", "-m", "points.csv", "--plan", "plan.json", *CHOICE],
    ["select", "arm.yaml", "--random", "40", *CHOICE],
    ["select", "arm.yaml", "--candidates", "pool.csv", *CHOICE],
    ["select", "--blocks", "blocks.csv", "--rows", "3", *CHOICE],
    ["select", "arm.yaml", "-m", "many.csv", "-k", "6", "--relax", "-o", "out.json"],
    ["select", "--blocks", "blocks.csv", "--rows", "3", "-k", "6", "--relax", "-o", "out.json"],
    ["plan", "arm.yaml", "-k", "6", *PLAN],
    ["plan", "arm.yaml", "--target-mm", "2", *PLAN],
    ["plan", "arm.yaml", "--minutes", "0.1", *PLAN],
    ["plan", "arm.yaml", "--plan", "plan.json", "--drop", "p3", *PLAN],
    ["verify", "choice.json"],
    ["verify", "plan.json"],
    ["calibrate", *MEASURED],
    ["calibrate", "arm.yaml", "-m", "points.csv", "--plan", "plan.json", "--folds", "0", "-o", "out.json"],
    ["calibrate", *MEASURED, "--method", "two-step"],
    ["calibrate", *MEASURED, "--method", "global", "--starts", "1"],
    ["calibrate", *MEASURED, "--from", "estimate.json"],
    ["calibrate", "arm.yaml", "-m", "many.csv", "--folds", "2", "--model-selection"],
    ["calibrate", "arm.yaml", "-m", "many.csv", "--folds", "0", "--json"],
    ["export", "arm.yaml", "estimate.json", "--dh", "out.yaml"],
    ["correct", "arm.yaml", "estimate.json", "--poses", "poses.csv", "-o", "out.csv", "--force"],
    ["program", "plan.json", "--for", "ros2", "-o", "out.yaml"],
    ["program", "plan.json", "--for", "csv", "--read", "program.csv", "-o", "out.csv"],
    ["study", *STUDY, "--splits", "2"],
    ["study", *STUDY, "--splits", "0"],
    ["study", *STUDY, "--splits", "2", "--from", "estimate.json"],
    ["study", *STUDY, "--splits", "2", "--models", "stated,geometric"],
    ["study", *SIMULATED],
    ["study", "--blocks", "blocks.csv", "--rows", "3", "-k", "4:6", "--random", "4"],
    ["study", "--merge", "part2.sqlite", "--store", "whole.sqlite"],
    ["study", "--from", "part1.sqlite"],
    ["simulate", "arm.yaml", "-k", "9", "-o", "out.csv"],
    ["simulate", "arm.yaml", "--configurations", "poses.csv", "-o", "out.csv"],
]
# Looked at, but without an effect where there is nothing for it to do: no fault to overlook, no blocked
# way, no sliding joint, few parameters, no error that depends on the configuration, one choice that all starts end at.
KNOWN = {("calibrate", "--force"), ("export", "--force"), ("correct", "--force"), ("study", "--force"),
         ("correct", "--largest-change-mm"), ("calibrate", "--all-parameters"), ("export", "--geometry"),
         ("export", "--workspace"), ("study", "--starts"), ("study", "--effort"), ("plan", "--strict"), ("select", "--force"),
         ("program", "--campaign")}
# What makes an option without a value quick.
WITH = {"--verify": ["--verify-robots", "200"]}
SHORT = {"-m": "--measurements", "-k": "--poses", "-o": "--out", "-c": "--criterion"}
faults = []


def run(*arguments):
    return subprocess.run([PROGRAM, *arguments], capture_output=True, text=True)


def run_well(*arguments):
    done = run(*arguments)
    if done.returncode != 0:
        raise SystemExit(f"{arguments}: exit code {done.returncode}, {done.stderr}")


def prepare():
    pathlib.Path("arm.yaml").write_text(ARM)
    pathlib.Path("other.yaml").write_text(ARM.replace("sigma_mm: 0.05", "sigma_mm: 0.2"))
    number = random.Random(3)
    pathlib.Path("blocks.csv").write_text("".join(
        ",".join(str(number.gauss(0, 1)) for _ in range(6)) + "\n" for _ in range(45)))
    pathlib.Path("own.txt").write_text("1 3 4 5 7\n")
    run_well("simulate", "arm.yaml", "--truth", "11", "--seed", "21", "-k", "20", "--repeats", "2", "-o", "many.csv")
    run_well("simulate", "arm.yaml", "--truth", "11", "--seed", "5", "-k", "8", "--repeats", "1", "-o", "few.csv")
    pathlib.Path("groups.csv").write_text("config,group\n" + "".join(f"{k},{k % 5}\n" for k in range(20)))
    run_well("calibrate", "arm.yaml", "-m", "many.csv", "--folds", "0", "-o", "estimate.json")
    run_well("select", "arm.yaml", "-m", "many.csv", "-k", "6", "-o", "choice.json")
    run_well("plan", "arm.yaml", "-k", "6", *PLAN[:-1], "plan.json", "--csv", "poses.csv")
    run_well("simulate", "arm.yaml", "--truth", "11", "--seed", "6", "--configurations", "poses.csv", "-o", "planned.csv")
    rows = [line.split(",") for line in pathlib.Path("planned.csv").read_text().splitlines() if line.startswith("p")]
    pathlib.Path("points.csv").write_text("name,x_mm,y_mm,z_mm\n" + "".join(
        ",".join([f"{row[0]}_t{k + 1}", *row[5 + 3 * k:8 + 3 * k]]) + "\n" for row in rows for k in range(3)))
    run_well("plan", "arm.yaml", "-k", "25", *PLAN[:-1], "out.json", "--csv", "pool.csv")
    run_well("program", "plan.json", "--for", "csv", "-o", "program.csv")
    for shard in ("1", "2"):
        run_well("study", *SIMULATED, "--store", f"part{shard}.sqlite", "--shard", f"{shard}/2")


def options_of(command):
    """All that help names, but for positional ones and those that FREE names."""
    text = run("help", command).stdout
    names = re.findall(r"^  (?:-\w, )?(--[\w-]+)", text, re.MULTILINE)
    if re.search(r"^  CAMPAIGN", text, re.MULTILINE):
        names.append("CAMPAIGN")
    return [name for name in names if name not in FREE]


def result_of(arguments):
    """Exit code, standard error, and all that was said and written, but for times of day and command lines."""
    for path in pathlib.Path().glob("out*"):
        path.unlink()
    shutil.copy("part1.sqlite", "whole.sqlite")
    done = run(*arguments)
    files = {path.name: re.sub(rb'"(made_at|command)":"[^"]*"', b"", path.read_bytes())
             for path in pathlib.Path().glob("out*")}
    return done.returncode, done.stderr, (done.stdout, done.stderr, files)


def check(way):
    code, said, made = result_of(way)
    if code != 0:
        faults.append(f"{' '.join(way)}: exit code {code}: {said}")
        return
    given = {SHORT.get(word, word) for word in way}
    for option in options_of(way[0]):
        if option in given or (option == "CAMPAIGN" and "arm.yaml" in way):
            continue
        value = [VALUES[option]] if option in VALUES else WITH.get(option, [])
        added = value if option == "CAMPAIGN" else [option, *value]
        code, said, changed = result_of([*way, *added])
        if code not in (0, 1, 2, 3) or (code == 0 and changed == made and (way[0], option) not in KNOWN):
            faults.append(f"{' '.join([*way, *added])}: exit code {code}, ignored: {said}")


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    prepare()
    for one in WAYS:
        check(one)
print("\n".join(faults) or "every option is used or refused")
sys.exit(1 if faults else 0)
