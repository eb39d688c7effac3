"""The commands of README, "From a URDF to the robot and back", run as they stand there for a robot that the project does
not know: from its URDF to a program, and from an instrument's list of points to a calibrated URDF; and the study that it quotes. Usage:

    readme_test.py PROGRAM README
"""

import csv
import os
import pathlib
import re
import subprocess
import sys
import tempfile

PROGRAM = str(pathlib.Path(sys.argv[1]).resolve())
README = pathlib.Path(sys.argv[2]).read_text()
ROOT = pathlib.Path(sys.argv[2]).resolve().parent
# An arm of nobody: origins and axes of its six joints, and a flange.
JOINTS = [("0 0 0.21", "0 0 1"), ("0.04 0 0.13", "0 1 0"), ("0 0 0.52", "0 1 0"), ("0.11 0 0.06", "1 0 0"), ("0.37 0 0", "0 1 0"),
          ("0.08 0 0", "1 0 0")]
# What a user fills in: where the tracker stands, its noise and the reflectors.
FILLED_IN = """sensor:
  kind: points
  noise: {range_um: 10, angle_urad: 10}
  targets: {position_mm: [[40, 50, 0], [40, -40, 30], [40, 0, -60]]}
base: {position_mm: [2500, 300, -200], rpy_deg: [0, 0, 170]}
"""
# Three commands from the URDF to a program, three from points to a URDF and a page; no more are shown.
NEEDED = ["inspect ur10.urdf", "plan", "program", "calibrate", "export", "report"]
# What its text tells to run besides, with points at hand.
BESIDES = "inspect campaign.yaml -m points.csv --plan plan.as_sent.csv"


def urdf() -> str:
    text = '<robot name="arm"><link name="base_link"/>'
    parent = "base_link"
    for k, (origin, axis) in enumerate(JOINTS, 1):
        text += (f'<link name="link{k}"/><joint name="joint{k}" type="revolute"><parent link="{parent}"/><child link="link{k}"/>'
                 f'<origin xyz="{origin}" rpy="0 0 0"/><axis xyz="{axis}"/><limit lower="-2" upper="2" effort="1" velocity="3"/>'
                 "</joint>")
        parent = f"link{k}"
    return text + (f'<link name="tool0"/><joint name="flange" type="fixed"><parent link="{parent}"/><child link="tool0"/>'
                   '<origin xyz="0.05 0 0" rpy="0 0 0"/></joint></robot>')


def run(*arguments: str) -> str:
    done = subprocess.run([PROGRAM, *arguments], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"posewise {' '.join(arguments)}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def fill_in(path: pathlib.Path) -> None:
    """Replaces what the program marked in the campaign by what the user knows."""
    kept = re.sub(r"^(sensor|base):.*\n(?:[ #].*\n)*", "", path.read_text(), flags=re.M)
    path.write_text(kept + FILLED_IN)


def measure() -> None:
    """What an instrument's program writes: names of the targets, in another order, with one missing."""
    run("simulate", "campaign.yaml", "--configurations", "plan.as_sent.csv", "--truth", "5", "-o", "simulated.csv")
    lines = []
    for row in csv.DictReader(line for line in open("simulated.csv") if not line.startswith("#")):
        name = re.fullmatch(r"([a-z]+)(\d+)", row["config"])
        for target in (1, 2, 3):
            xyz = ",".join(row[f"p{target}_{axis}_mm"] for axis in "xyz")
            lines.append(f"Robot::Calibration::{name[1].upper()}{int(name[2]):03}_T{target},{xyz}")
    header = "// as SpatialAnalyzer names points\nname,x_mm,y_mm,z_mm"
    pathlib.Path("points.csv").write_text("\n".join([header, *reversed(lines[1:])]) + "\n")


def check_answers() -> None:
    """README quotes how the study of scripts/demo begins."""
    quoted = README[README.index("```\nHow many poses") + len("```\n"):].split("```")[0]
    said = run("study", str(ROOT / "designs/fanuc_r2000ic_165f/campaign.yaml"), "--measurements",
               str(ROOT / "data/fanuc_r2000ic_165f_simulated/measurements.csv"), "--criteria", "v", "--poses", "5:10,12,14")
    if not said.startswith(quoted):
        sys.exit(f"README quotes\n{quoted}of the study that begins\n{said}")


def main() -> int:
    check_answers()
    section = README[README.index("## From a URDF to the robot and back"):]
    block = section.split("```")[1]
    commands = [re.sub(r"\s+#.*", "", line)[len("posewise "):] for line in block.splitlines() if line.startswith("posewise ")]
    missing = [command for command in NEEDED if not any(one.startswith(command + " ") for one in commands)]
    if missing:
        sys.exit(f"README lacks {missing}")
    if len(commands) > 6:
        sys.exit(f"README shows {len(commands)} commands from a URDF to the robot and back, not six at most")
    if f"`{BESIDES}`" not in section:
        sys.exit(f"README lacks {BESIDES}")
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        pathlib.Path("ur10.urdf").write_text(urdf())
        for command in commands:
            words = command.split()
            if words[0] == "plan":
                words += ["--pool", "1000", "--starts", "1"]
            if "points.csv" in words and not pathlib.Path("points.csv").exists():
                measure()
                run(*BESIDES.split())
            said = run(*words)
            if command.startswith("inspect ur10.urdf"):
                fill_in(pathlib.Path("campaign.yaml"))
            if words[0] == "program" and "24 poses" not in said and "39 poses" not in said:
                sys.exit(said)
            if words[0] == "calibrate" and not re.search(r"^How accurate", said, re.M):
                sys.exit(said)
        for made in ("cell.script", "targets.csv", "estimate.json", "calibrated.urdf", "page.html"):
            if not pathlib.Path(made).exists():
                sys.exit(f"README's commands do not write {made}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
