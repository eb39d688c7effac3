"""A camera's calibration judged by a laser tracker: the right arm of the public Motoman campaign
`motoman_camera` (ctu-vras/multirobot-calibration), calibrated by the corners that one or two fixed
cameras see of it, with views chosen by V and at random, and judged at the reflector's 146 places
with base and reflector fitted anew. Beside what is found stands what was expected of the robot
between the joint values of these places, of which the campaign makes its limits. V, too, looks at
poses between them: most views are elsewhere.

POSEWISE_REAL_DATA=FOLDER python3 tests/benchmark/motoman_camera.py PROGRAM [counts [seconds]]
"""

import csv
import json
import math
import os
import random
import subprocess
import sys
import tempfile

import yaml

DATA = os.path.join(os.environ["POSEWISE_REAL_DATA"], "motoman_camera")


def judged_rows():
    with open(os.path.join(DATA, "leica.csv"), encoding="utf-8") as rows:
        return [row for row in csv.DictReader(rows) if row["set"] == "leica_right_hand_6x6x6"]


def robot_of(cameras):
    elements = []
    for number, row in enumerate(cameras["arms"]["right"][1:7], 1):
        parts = [(f"Rz q{number}", 1), (f"Rz {row['offset_deg']} deg", row["offset_deg"]),
                 (f"Tz {row['d_mm']} mm", row["d_mm"]), (f"Tx {row['a_mm']} mm", row["a_mm"]),
                 (f"Rx {row['alpha_deg']} deg", row["alpha_deg"])]
        elements += [text for text, size in parts if size]
    joints = {}
    for j in range(1, 7):
        values = [math.degrees(float(row[f"rq{j}_rad"])) for row in judged_rows()]
        joints[f"q{j}"] = {"limits_deg": [min(values) - 1, max(values) + 1]}
    return {"class": "industrial", "joints": joints, "elements": elements}


def lens_of(camera, known):
    lens = camera["intrinsics_turned"]
    return {"fx_px": lens["fx_px"], "fy_px": lens["fy_px"], "cx_px": lens["cx_px"],
            "cy_px": lens["cy_px"], "known": known,
            "distortion": {"model": "brown_conrady",
                           "coefficients": [lens[k] for k in ("k1", "k2", "p1", "p2", "k3")]}}


def write_campaigns(folder, cameras, count):
    sensor = {"kind": "camera", "camera": "fixed", "sigma_px": 1, "image_px": [6000, 4000],
              "intrinsics": lens_of(cameras["cameras"][0], False),
              "board": {"points_mm": [m["position_mm"] for m in cameras["markers"]],
                        "sigma_mm": 0.3}}
    if count == 2:
        sensor["other_cameras"] = [{"intrinsics": lens_of(cameras["cameras"][1], False)}]
    write_yaml(folder, "pixels.yaml", {"name": "pixels", "robot": robot_of(cameras), "sensor": sensor})
    tracker = {"kind": "points", "sigma_mm": 0.02, "targets": {"count": 1}}
    write_yaml(folder, "leica.yaml", {"name": "leica", "robot": robot_of(cameras), "sensor": tracker})


def write_yaml(folder, name, document):
    with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
        yaml.safe_dump(document, file, sort_keys=False)


def write_tables(folder, count):
    """Returns the ids of the views."""
    joints = [f"rq{j}_rad" for j in range(1, 7)]
    names = ",".join(f"q{j}_rad" for j in range(1, 7))
    ids = []
    with open(os.path.join(DATA, "pixels.csv"), encoding="utf-8") as rows, \
            open(os.path.join(folder, "pixels.csv"), "w", encoding="utf-8") as out:
        out.write(f"config,{names},camera,point,u_px,v_px\n")
        for row in csv.DictReader(rows):
            if row["arm"] != "1" or int(row["camera"]) > count:
                continue
            view = f"{row['config']}_{row['sample']}"
            if not ids or ids[-1] != view:
                ids.append(view)
            cells = [view, *(row[j] for j in joints), row["camera"], row["marker"], row["u_px"], row["v_px"]]
            out.write(",".join(cells) + "\n")
    with open(os.path.join(folder, "leica.csv"), "w", encoding="utf-8") as out:
        out.write(f"config,sample,{names},p1_x_mm,p1_y_mm,p1_z_mm\n")
        for row in judged_rows():
            cells = [row["config"], row["sample"], *(row[j] for j in joints), row["x_mm"], row["y_mm"], row["z_mm"]]
            out.write(",".join(cells) + "\n")
    return list(dict.fromkeys(ids))


def write_test_poses(folder, count=200):
    """Random configurations within the campaign's limits, which V is to predict."""
    with open(os.path.join(folder, "pixels.yaml"), encoding="utf-8") as file:
        joints = yaml.safe_load(file)["robot"]["joints"]
    draw = random.Random(0)
    with open(os.path.join(folder, "tests.csv"), "w", encoding="utf-8") as out:
        out.write("config," + ",".join(f"{name}_deg" for name in joints) + "\n")
        for k in range(count):
            q = [draw.uniform(*joint["limits_deg"]) for joint in joints.values()]
            out.write(f"t{k}," + ",".join(map(repr, q)) + "\n")


def write_views(folder, name, ids):
    wanted = set(ids)
    with open(os.path.join(folder, "pixels.csv"), encoding="utf-8") as rows, \
            open(os.path.join(folder, name), "w", encoding="utf-8") as out:
        out.write(next(rows))
        out.writelines(line for line in rows if line.split(",", 1)[0] in wanted)


def run(program, folder, *arguments):
    return subprocess.run([program, *arguments], cwd=folder, capture_output=True, text=True,
                          check=False)


def judge(program, folder, table):
    """Expected of the robot and found, mm, or why there is none."""
    done = run(program, folder, "calibrate", "pixels.yaml", "-m", table, "--folds", "0",
               "--validate", "leica.csv", "--validate-campaign", "leica.yaml",
               "--refit", "base,targets", "--force", "-o", "e.json")
    if not os.path.exists(os.path.join(folder, "e.json")):
        return done.stderr.strip().splitlines()[-1][:90]
    with open(os.path.join(folder, "e.json"), encoding="utf-8") as file:
        accuracy = json.load(file)["accuracy"]
    os.remove(os.path.join(folder, "e.json"))
    of_robot = accuracy["expected"].get("of_robot", {})
    found = accuracy["validation"]["distance_rms_mm"]
    return f"{of_robot.get('nominal_mm', float('nan')):9.3f}{of_robot.get('calibrated_mm', float('nan')):9.3f}{found:9.3f}"


def choose(program, folder, count, seconds):
    done = run(program, folder, "select", "pixels.yaml", "-m", "pixels.csv", "-k", str(count),
               "--criterion", "v", "--test-poses", "tests.csv", "--effort", "quick", "--time", str(seconds), "-o", "plan.json")
    if not os.path.exists(os.path.join(folder, "plan.json")):
        raise SystemExit(done.stderr)
    with open(os.path.join(folder, "plan.json"), encoding="utf-8") as file:
        return [pose["id"] for pose in json.load(file)["poses"]]


def main():
    program = os.path.abspath(sys.argv[1])
    counts = [int(k) for k in sys.argv[2].split(",")] if len(sys.argv) > 2 else [20, 50, 105]
    seconds = int(sys.argv[3]) if len(sys.argv) > 3 else 120
    with open(os.path.join(DATA, "cameras.yaml"), encoding="utf-8") as file:
        cameras = yaml.safe_load(file)
    print("cameras views chosen        nominal expected    found  (mm, by the tracker)")
    for number in (1, 2):
        with tempfile.TemporaryDirectory() as folder:
            write_campaigns(folder, cameras, number)
            ids = write_tables(folder, number)
            write_test_poses(folder)
            for count in counts:
                write_views(folder, "some.csv", choose(program, folder, count, seconds))
                print(f"{number:7}{count:6} by V       {judge(program, folder, 'some.csv')}", flush=True)
                for seed in range(3):
                    write_views(folder, "some.csv", random.Random(seed).sample(ids, count))
                    print(f"{number:7}{count:6} at random  {judge(program, folder, 'some.csv')}", flush=True)
            print(f"{number:7}{len(ids):6} all        {judge(program, folder, 'pixels.csv')}", flush=True)


if __name__ == "__main__":
    main()
