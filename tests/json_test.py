"""--json of every command: one document, with the numbers of the text and of the files, and every key
in its manual, designs/json.md; --threads: the same bytes for any number of threads.

    json_test.py REPOSITORY PROGRAM
"""

import csv
import json
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT, PROGRAM = pathlib.Path(sys.argv[1]).resolve(), str(pathlib.Path(sys.argv[2]).resolve())
FANUC = ROOT / "designs/fanuc_r2000ic_165f/campaign.yaml"
CELL = ROOT / "designs/cell_demo/campaign.yaml"
CAMERA = ROOT / "designs/camera/campaign.yaml"
CAMERAS = ROOT / "designs/camera/fixed_pair.yaml"
URDF = """<robot name="arm"><link name="base"/><link name="l1"/><link name="l2"/><link name="tool"/>
<joint name="q1" type="revolute"><parent link="base"/><child link="l1"/><origin xyz="0 0 0.3"/>
<axis xyz="0 0 1"/><limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
<joint name="q2" type="revolute"><parent link="l1"/><child link="l2"/><origin xyz="0.1 0 0.3"/>
<axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
<joint name="flange" type="fixed"><parent link="l2"/><child link="tool"/><origin xyz="0.4 0 0"/></joint>
</robot>"""
ARM = """name: arm
robot: {urdf: arm.urdf, base_link: base, tip_link: tool, errors: geometric}
sensor: {kind: points, sigma_mm: 0.05, targets: {position_mm: [[0, 0, 50], [30, 0, 0], [0, 40, 0]]}}
base: {position_mm: [2000, 0, 0], rpy_deg: [0, 0, 90]}
"""
PAGE_MANUAL = (ROOT / "designs/page.md").read_text()
OTHER_WORDS = {"config", "straight"}  # of CSV files
faults = []


def expect(holds, fault):
    if not holds:
        faults.append(str(fault))


def close(a, b, digits):
    return math.isclose(a, b, rel_tol=10 ** (1 - digits), abs_tol=1e-12)


def run(*arguments, code=0):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True)
    expect(done.returncode == code, f"{arguments}: exit code {done.returncode}, {done.stderr}")
    return done.stdout, done.stderr


def number_behind(text, label):
    """The first number behind a label of the text that people read."""
    found = re.search(re.escape(label) + r"\D*?(-?[0-9.]+(?:e[-+]?\d+)?)", text)
    expect(found, f"no '{label}' in\n{text}")
    return float(found[1]) if found else math.nan


# ---- The manual ----

def read_manual():
    """By section the keys of its tables, each as its steps; those of all documents stand under ''."""
    keys, section = {}, ""
    for line in (ROOT / "designs/json.md").read_text().splitlines():
        if line.startswith("## "):
            section = line[3:]
        cell = re.match(r"\| (`.*?`) \|", line)
        if cell:
            keys.setdefault(section, []).extend(
                key.split(".") for key in re.findall(r"`([^`]+)`", cell[1]))
    keys["page"] = []
    for key in re.findall(r"`([^`]+)`", "".join(re.findall(r"^\| (`.*?`) \|", PAGE_MANUAL, re.MULTILINE))):
        of_part = key.startswith(("scene", "configurations", "residuals", "expected", "error_map"))
        keys["page"].append((["parts[]"] if of_part else []) + key.split("."))
    return keys


def steps_of(value, steps=()):
    """Every key of a document as its steps, and whether nothing is below it that could be."""
    if isinstance(value, dict) and value:
        for key, item in value.items():
            yield from steps_of(item, steps + (key,))
    elif isinstance(value, list) and any(isinstance(item, dict) for item in value):
        for item in value:
            yield from steps_of(item, steps[:-1] + (steps[-1] + "[]",))
    else:
        yield steps, value in ({}, [], None)


def is_named(step, name):
    return re.fullmatch(re.sub(r"<\w+>", ".+", re.escape(name)), step) is not None


def explains(key, steps, is_empty=False):
    """Whether a key of the manual is the one of these steps, or below them where they are empty. A
    last <part> stands for all that is below it, too."""
    if is_empty and len(steps) < len(key):
        key = key[:len(steps) - 1] + [key[len(steps) - 1].removesuffix("[]")]
    if len(steps) < len(key) or (len(steps) > len(key) and key[-1] != "<part>"):
        return False
    return all(map(is_named, steps, key))


MANUAL = read_manual()
PRINTED = set()  # sections met


def parse(text, command):
    """The document that is all of the text, its keys held to the manual."""
    try:
        document = json.loads(text, parse_constant=lambda name: faults.append(f"{command}: {name}"))
    except json.JSONDecodeError as error:
        faults.append(f"{command}: {error} in\n{text[:300]}")
        raise SystemExit("\n".join(faults))
    section = document["kind"].removeprefix("posewise ")
    PRINTED.add(section)
    expect(list(document)[:3] == ["kind", "posewise_version", "format"], f"{command}: {list(document)}")
    for part in document.get("parts", []):  # of a page: each has a document
        parse(json.dumps(part["document"]), command)
        part["document"] = None
    for steps, is_empty in set(steps_of(document)):
        expect(any(explains(key, steps, is_empty) for key in MANUAL.get(section, []) + MANUAL[""]),
               f"designs/json.md, {section}: {'.'.join(steps)} is not explained")
    return document


def both(*arguments):
    """The document and the text of one command, which write the same to standard error."""
    text, said = run(*arguments)
    document, said_beside = run(*arguments, "--json")
    expect(said == said_beside, f"{arguments}: {said_beside}")
    return parse(document, arguments[0]), text


# ---- The commands ----

def check_inspect():
    document, text = both("inspect", FANUC)
    expect(document["rank"] == number_behind(text, "stated set: rank"), "inspect: rank")
    expect(document["least_pose_count"] == number_behind(text, "least number of poses:"), "inspect: poses")
    expect(close(document["joints"][1]["limits_deg"][0], number_behind(text, "q2     revolute"), 12),
           "inspect: limits")
    seed, text = both("inspect", ROOT / "designs/fanuc_r2000ic_165f/seed_report.yaml")
    dropped = [one for one in seed["parameters"] if not one["identifiable"]]
    expect([one["name"] for one in dropped] == ["Tx2"], dropped)
    terms = {term["parameter"]: term["coefficient"] for term in dropped[0]["absorbed_by"]}
    expect(close(terms["dq2"], number_behind(text, "1 mm Tx2 ="), 4), terms)
    directions, text = both("inspect", FANUC, "-m", "s.csv")
    expect(directions["joint_directions"][0]["reversed"] == [], "inspect: directions")
    expect(close(directions["joint_directions"][0]["distance_rms_mm"],
                 number_behind(text, "misses the points by"), 4), "inspect: distance")
    both("inspect", "arm.urdf")


def check_simulate():
    document, text = both("simulate", FANUC, "--truth", 7, "--seed", 3, "-k", 16, "--repeats", 3,
                          "-o", "s.csv")
    expect((document["configurations"], document["samples"]) == (16, 48), "simulate: counts")
    expect(close(1e3 * document["truth"]["robot"]["dq2"]["value_rad"], number_behind(text, "dq2 "), 3),
           "simulate: truth")


def check_indices():
    document, text = both("indices", FANUC, "-m", "s.csv")
    for name in ("o1", "d", "v", "condition"):
        expect(close(document["scaled"][name], number_behind(text, f"\n{name} "), 6), f"indices: {name}")
    text, _ = run("indices", FANUC, "-m", "s.csv", "--digits", 12)
    expect(close(document["scaled"]["d"], number_behind(text, "\nd "), 12), "indices: digits")
    run("simulate", FANUC, "-k", 3, "-o", "few.csv")
    document, _ = both("indices", FANUC, "-m", "few.csv")
    expect(document["scaled"]["d"] is None and document["scaled"]["condition"] is None, "-inf is null")
    run("indices", FANUC, "-m", "s.csv", "--write-blocks", "b.npy")
    document, text = both("indices", "--blocks", "b.npy", "--prior")
    expect(text.startswith("16 candidates, "), text)
    expect(close(document["scaled"]["d"], number_behind(text, "\nd "), 6), "indices: of blocks")


def check_select():
    document, text = both("select", FANUC, "-m", "s.csv", "-k", 8, "-c", "v")
    file = json.loads(pathlib.Path("s.plan.json").read_text())
    expect({key: document[key] for key in file} == file, "select: not what the plan file holds")
    expect(document["plan_file"] == "s.plan.json", "select: plan_file")
    expect(close(document["value"], number_behind(text, "value:"), 8), "select: value")
    expect(close(document["accuracy"]["total_rms_mm"], number_behind(text, "by the parameters, "), 4),
           "select: accuracy")
    text, _ = run("select", FANUC, "-m", "s.csv", "-k", 8, "-c", "v", "--digits", 13)
    expect(close(document["bound"], number_behind(text, "bound:"), 13), "select: digits")
    pathlib.Path("printed.json").write_text(json.dumps(document))
    both("verify", "printed.json")
    pathlib.Path("blocks.csv").write_text("1,0\n0,1\n1,1\n1,2\n3,1\n")
    both("select", "--blocks", "blocks.csv", "--rows", 1, "-k", 3)
    both("select", "--blocks", "blocks.csv", "--rows", 1, "-k", 3, "--relax")


def check_relax():
    for options in (["-m", "s.csv"], ["--random", 60], ["--candidates", "s.csv", "-c", "e"]):
        command = ["select", FANUC, *options, "-k", 8, "--relax", "--prior"]
        document, text = both(*command)
        weights = [one["weight"] for one in document["weights"]]
        expect(weights == sorted(weights, reverse=True) and 0 < weights[-1] and weights[0] <= 1 + 1e-12,
               f"weights: {weights}")
        expect(close(sum(weights), 8, 9), f"weights sum to {sum(weights)}")
        expect(document["value"] <= document["bound"] and document["efficiency"] > 0.99, "weights: bound")
        expect(close(document["bound"], number_behind(text, "bound:"), 8), "weights: text")
        plan, _ = run("select", *command[1:-2], "--prior", "--json", "-o", "p.json")
        expect(json.loads(plan)["value"] <= document["bound"], "weights: a choice is above the bound")
        run(*command, "-o", "w.csv")
        run(*command, "-o", "w.json")
        expect(parse(pathlib.Path("w.json").read_text(), "w.json") == document, "w.json")
        rows = [(row["config"], float(row["weight"])) for row in csv.DictReader(open("w.csv"))]
        expect(rows == [(one["id"], one["weight"]) for one in document["weights"]], "w.csv")


def check_plan():
    document, text = both("plan", CELL, "-k", 12, "--pool", 400, "--starts", 2, "--verification", 3)
    file = json.loads(pathlib.Path("campaign.poses.json").read_text())
    expect({key: document[key] for key in file} == file, "plan: not what the plan file holds")
    expect(close(document["accuracy"]["rms_mm"], number_behind(text, "position error"), 4), "plan: rms")
    expect(document["pool"]["feasible"] == number_behind(text, "pool:"), "plan: pool")
    expect(close(document["other_counts"][2]["accuracy"]["total_upper_mm"],
                 number_behind(text.split("planned  ")[1], ".."), 3), "plan: other counts")
    expect(close(document["drop_outs"][0]["rms_mm"], number_behind(text, "by the parameters is"), 4), "plan: missing")
    worst = max(document["pose_values"], key=lambda pose: pose["value_mm"])
    expect(worst["id"] == document["drop_outs"][0]["id"], "plan: pose values")
    parts = [document["budget"][part] for part in ("parameters_mm", "left_over_mm", "repeatability_mm")]
    expect(close(math.hypot(*parts), document["accuracy"]["total_rms_mm"], 9), "plan: budget")
    document, text = both("plan", FANUC, "--target-mm", 1.5, "--pool", 200, "--workspace-poses", 20, "--starts", 1,
                          "--verify", "--verify-robots", 100)
    expect(close(document["target"]["error"]["assured_mm"], number_behind(text, "new poses, "), 4), "plan: target")
    expect(document["target"]["error"]["assured_mm"] <= 1.2, "plan: target is missed")
    found = document["monte_carlo"]
    expect(close(found["expected"]["predicted_mm"], number_behind(text, "\nexpected "), 4), "plan: closed form")
    expect(found["assured"]["predicted_mm"] == document["target"]["error"]["assured_mm"], "plan: assured")
    expect(found["limit"] == "kept" and "verified:    the limit is kept" in text, "plan: verified")


def check_program():
    document, text = both("program", "campaign.poses.json", "--for", "csv", "-o", "program.csv")
    count = len(json.loads(pathlib.Path("campaign.poses.json").read_text())["poses"])
    expect(document["measured"] == count and f"{count} poses in {document['moves']} moves" in text, "program: moves")
    expect(close(document["rounding"]["sent"]["value"], float(re.search(r"planned, (\S+) as sent", text)[1]), 7),
           "program: value")
    content, text = both("program", "campaign.poses.json", "--for", "csv", "--read", "program.csv", "-o", "back.csv")
    row, one = next(csv.DictReader(open("back.csv"))), content["configurations"][0]
    expect(row["config"] == one["id"] and close(float(row["q1_deg"]), one["joints"]["q1_deg"], 11), "program: read")


def check_verify():
    document, text = both("verify", "s.plan.json")
    values = {one["name"]: one for one in document["findings"]}
    expect(document["is_right"] and close(values["value"]["stated"], number_behind(text, "value:"), 8),
           "verify: value")
    wrong = json.loads(pathlib.Path("s.plan.json").read_text())
    wrong["value"] += 1
    pathlib.Path("wrong.json").write_text(json.dumps(wrong))
    out, said = run("verify", "wrong.json", "--json", code=1)
    found = {one["name"]: one["is_right"] for one in parse(out, "verify")["findings"]}
    expect(not found["value"] and found["poses"], found)
    expect(said == run("verify", "wrong.json", code=1)[1], said)


def check_calibrate():
    options = ["--loss", "cauchy", "--plan", "s.plan.json", "--predict", "s.csv", "--folds", 4]
    run("simulate", FANUC, "--truth", 7, "--seed", 9, "-k", 9, "-o", "v.csv")
    document, text = both("calibrate", FANUC, "-m", "s.csv", "-o", "e.json", "--validate", "v.csv", "--limit-mm", 0.2,
                          *options)
    expect(json.loads(pathlib.Path("e.json").read_text()) == document, "calibrate: not what --out wrote")
    expect(close(document["accuracy"]["nominal"]["distance_rms_mm"],
                 number_behind(text, "distance RMS"), 4), "calibrate: nominal")
    expect(close(document["accuracy"]["expected"]["at_left_out"]["total_mm"],
                 number_behind(text, "expected not in plan:"), 4), "calibrate: expected")
    judged = document["accuracy"]["judged"]
    expect(sum(group["configuration_count"] for group in judged if group["poses"] == "validation") == 9,
           "calibrate: judged")
    for group in judged:
        expect(group["lower_mm"] < group["rms_mm"] < group["upper_mm"] and group["limit"] in text, "calibrate: limit")
        count, name = group["configuration_count"], group["poses"].replace("_", " ").replace("left out", "not in plan")
        kind = {"new": f"{count} new pose", "beyond": f"{count} pose", "repeated": f"{count} pose"}[group["group"]]
        line = next((line for line in text.splitlines() if line.startswith(f"{name}, {kind}")), "")
        expect(close(group["rms_mm"], number_behind(line, "RMS"), 4), f"calibrate: {group}: {line}")
    both("calibrate", FANUC, "-m", "s.csv", "--model-selection", "--folds", 4)
    both("calibrate", FANUC, "-m", "s.csv", "--prior")
    run("calibrate", FANUC, "-m", "s.csv", "--folds", 0, "-o", "f.json")
    document, _ = both("select", FANUC, "--random", 60, "-k", 6, "--from", "f.json", "--as-prior",
                       "--moved", "base", "-o", "p.json")
    expect(document["problem"]["estimate"]["moved"] == ["base"], "select: estimate")
    both("verify", "p.json")
    off = pathlib.Path(FANUC).read_text().replace("1075 mm", "1095 mm")
    expect(off != pathlib.Path(FANUC).read_text(), "the campaign has another upper arm now")
    pathlib.Path("off.yaml").write_text(off)
    document, _ = both("calibrate", "off.yaml", "-m", "s.csv", "--prior")
    expect(document["doubts"], "calibrate: no doubts about a robot that is 20 mm off")


def check_cameras():
    hand_eye = CAMERA.read_text().replace("errors: full", "errors: none").replace("known: false", "known: true")
    pathlib.Path("eye.yaml").write_text(hand_eye)
    document, text = both("plan", "eye.yaml", "-k", 4, "--pool", 400, "--starts", 1, "--workspace-poses", 20, "-o", "eye.json")
    image, = document["images"]
    expect(f"expected to cover {round(100 * image['covered'])} % of the image" in " ".join(text.split()), f"plan: {text}")
    shown, _ = both("report", "eye.json", "-o", "eye.html")
    counts = shown["parts"][0]["expected"]["images"][0]["counts"]
    expect(close(image["covered"], sum(count > 0 for count in counts) / len(counts), 9), "report: cells of a plan")
    run("simulate", CAMERAS, "-k", 24, "--truth", 3, "-o", "views.csv")
    document, text = both("calibrate", CAMERAS, "-m", "views.csv", "-o", "views.json", "--folds", 0)
    images = document["measured"]["images"]
    expect([image["camera"] for image in images] == [1, 2], f"calibrate: {images}")
    for image in images:
        percent = round(100 * image["covered"])
        expect(f"{percent} % of camera {image['camera']}'s" in text, f"calibrate: {image}: {text}")
    places, sigma = document["hand_eye"], document["sigma"]
    expect([places["board"]["in"], places["camera"]["in"]] == ["flange", "base"], f"calibrate: {places}")
    for k, axis in enumerate("xyz"):  # the board's place is a parameter itself
        deviation = places["board"]["deviations"][0]["position_mm"][k]
        expect(close(deviation, 1e3 * sigma[f"board.{axis}_m"], 9), f"calibrate: board.{axis}: {deviation}")
    for place in places.values():
        half_axes = [one["half_axis_mm"] for one in place["ellipsoid"]]
        squares = sum(value ** 2 for value in place["deviations"][1]["position_mm"])
        expect(half_axes == sorted(half_axes), f"calibrate: {half_axes}")
        expect(close(sum(value ** 2 for value in half_axes), 7.814727903251179 * squares, 9), f"calibrate: {place}")
    document, _ = both("report", "views.json", "-o", "views.html")
    expect(document["parts"][0]["scene"]["views"]["on_flange"] == "board", "report: views")
    residuals = document["parts"][0]["residuals"]
    for image, cells in zip(images, residuals["images"]):
        counts = cells["counts"]
        expect(cells["size_px"] == image["size_px"], "report: size of an image")
        expect(close(image["covered"], sum(count > 0 for count in counts) / len(counts), 9), "report: covered")
        expect(sum(counts) == residuals["readings"]["camera"].count(image["camera"] - 1), "report: counts")


def check_study():
    options = ["-c", "d,v", "--random", 6, "--splits", 2, "-k", "6,8"]
    document, text = both("study", FANUC, "-m", "s.csv", *options)
    row = document["models"][0]["rows"][0]
    line = next(line for line in text.splitlines() if line.startswith("    6")).split()
    expect(close(row["planned"][0]["held_out_rms_mm"], float(line[1]), 4), "study: planned")
    expect(close(row["planned"][1]["against_random"]["ratio"], float(line[7]), 2), "study: ratio")
    expect(close(row["random"]["held_out_rms_p50_mm"], float(line[10]), 4), "study: random")
    for criterion, planned in enumerate(row["planned"]):
        verdict = planned["against_random"]["verdict"]
        expect(re.search(rf"{planned['criterion']}, planned against random: .*{verdict} at ", text), text)
    document, _ = both("study", FANUC, "-m", "s.csv", *options, "--models", "stated,full")
    second = document["models"][1]["rows"][0]["planned"][0]
    expect("against_random_of_first_model" in second, second)


def check_blocks_study():
    document, text = both("study", "--blocks", "b.npy", "-c", "d,v", "-k", "9..10", "--prior", "--random", 20)
    row = document["rows"][-1]
    line = next(line for line in text.splitlines() if line.startswith("   10  v")).split()
    expect(close(row["value"], float(line[2]), 6) and close(row["bound"], float(line[3]), 6), line)
    expect(close(100 * row["efficiency"], float(line[4]), 4), line)
    expect(close(row["random"]["value_p50"], float(line[6]), 6), line)
    pathlib.Path("own.txt").write_text(" ".join(map(str, row["poses"])))
    document, _ = both("study", "--blocks", "b.npy", "-c", "v", "--prior", "--subset", "own.txt", "--random", 0)
    expect(document["rows"][0]["subsets"][0]["value"] == row["value"], "study: own subset")


def check_correct():
    document, text = both("correct", FANUC, "e.json", "--poses", "s.csv", "-o", "c.csv")
    expect(close(document["uncorrected"]["position_rms_mm"], number_behind(text, "position RMS/mm"), 4),
           "correct: rms")
    row, one = next(csv.DictReader(open("c.csv"))), document["configurations"][0]
    expect(row["config"] == one["id"] and close(float(row["q1_deg"]), one["joints"]["q1_deg"], 12)
           and close(float(row["uncorrected_mm"]), one["uncorrected_mm"], 5), "correct: c.csv")
    expect(document["lines_not_corrected"] == [], "correct: a table has no other lines")
    pathlib.Path("weld.script").write_text("movej([0, 0, 0, 0, -1, 0])\nmovel(p[1, 0, 1, 0, 0, 0])\n")
    document, _ = both("correct", FANUC, "e.json", "--poses", "weld.script", "--for", "ur")
    expect(document["lines_not_corrected"] == [2], "correct: lines of a program")


def check_export():
    run("simulate", "arm.yaml", "-k", 12, "-o", "arm.csv")
    run("calibrate", "arm.yaml", "-m", "arm.csv", "-o", "arm.json")
    document, text = both("export", "arm.yaml", "arm.json", "--urdf", "out.urdf", "--dh", "out.yaml")
    expect(len(document["urdf"]["joints"]) == number_behind(text, "with the origins of"), "export: joints")
    expect({joint["name"] for joint in document["urdf"]["joints"]} <= {"q1", "q2", "flange"},
           document["urdf"])
    table = pathlib.Path("out.yaml").read_text()
    expect(all(close(row["a_mm"], float(a), 12) for row, a in
               zip(document["dh"], re.findall(r"a_mm: ([-+.e\d]+)", table), strict=True)), "export: dh")
    expect(document["geometry"] == "estimate" and document["lost"]["estimate"]["rms_mm"] == 0, document["lost"])
    expect([file["path"] for file in document["read_back"]] == ["out.urdf", "out.yaml"], document["read_back"])

    campaign = (ROOT / "designs/ur10/campaign.yaml").read_text()
    campaign = campaign.replace("  elements:", "  gravity: true\n  elements:").replace(
        "  kind: poses\n", "  kind: poses\n  tool: {position_mm: [0, 0, 50], rpy_deg: [0, 0, 0]}\n")
    pathlib.Path("ur.yaml").write_text(campaign + "base: {position_mm: [2000, 0, 0], rpy_deg: [0, 0, 90]}\n")
    run("simulate", "ur.yaml", "-k", 30, "-o", "ur.csv")
    run("calibrate", "ur.yaml", "-m", "ur.csv", "-o", "ur.json")
    document, text = both("export", "ur.yaml", "ur.json", "--ur-kinematics", "k.yaml")
    expect(document["geometry"] == "nearest", document["geometry"])
    expect(close(document["lost"]["nearest"]["rms_mm"], number_behind(text, "nearest"), 3), "export: lost")
    expect(close(document["ur_kinematics"][2]["position_m"][0],
                 number_behind(pathlib.Path("k.yaml").read_text(), "forearm:\n    x: "), 12), "export: frames")


def check_conditions():
    pathlib.Path("noted.yaml").write_text(ARM.replace("geometric", "full") + "record: {operator: me}\n")
    run("simulate", "noted.yaml", "-k", 20, "-o", "plain.csv")
    rows = [row for row in pathlib.Path("plain.csv").read_text().splitlines() if not row.startswith("#")]
    noted = [rows[0] + ",time,temperature_C"] + [f"{row},{60 * k},{20 + k % 3}" for k, row in enumerate(rows[1:])]
    pathlib.Path("noted.csv").write_text("\n".join(noted) + "\n")
    document, text = both("calibrate", "noted.yaml", "-m", "noted.csv", "-o", "noted.json")
    trends = document["accuracy"]["condition_trends"]
    expect([(trend["name"], trend["unit"]) for trend in trends] == [("time", "h"), ("temperature", "C")], trends)
    expect(trends[1]["range"] == 2 and document["record"] == {"operator": "me"} and "operator: me" in text, trends)
    document, text = both("export", "noted.yaml", "noted.json", "--map", "map.csv")
    expect(close(document["map"]["geometry_alone"]["rms_mm"], number_behind(text, "as the geometry has them"), 3),
           "export: map")


def check_report():
    run("simulate", CELL, "-k", 12, "--truth", 5, "-o", "cell.csv")
    run("calibrate", CELL, "-m", "cell.csv", "-o", "cell.json", "--folds", 3, "--prior")
    files = ["cell.json", "campaign.poses.json", "s.plan.json"]
    document, text = both("report", *files, "-o", "page.html")
    expect([part["title"] for part in document["parts"]] == files, "report: titles")
    expect(text.endswith("\npage: page.html\n") and text.startswith("cell.json: estimate, "), text)
    page = pathlib.Path("page.html").read_text()
    shown = json.loads(page.split('<script type="application/json" id="posewise">')[1].split("</script>")[0])
    for part in shown["parts"]:
        file = json.loads(pathlib.Path(part["title"]).read_text())
        expect({key: part["document"][key] for key in file} == file, part["title"])
        part["document"] = None
    expect(shown == document, "report: page.html has another document")


def check_writers():
    """Each word that those who write documents know is in the manual, and each key of the manual theirs:
    those of cases that are not met here, too."""
    sources = "".join(path.read_text() for path in sorted((ROOT / "src/io").rglob("*.cpp")) if path.stem in (
        "json", "json_reports", "plan_json", "plan_document", "estimate_file", "estimate_fields", "parameters_json", "doubts_json", "residual_look_json", "judgement_json",
        "program_json", "robot_statement", "weights_file", "page_file", "blocks_json"))
    sources = re.sub(r"#include.*", "", sources)
    manual = (ROOT / "designs/json.md").read_text() + PAGE_MANUAL
    for word in sorted(set(re.findall(r'"([a-z][A-Za-z0-9_]*)"', sources)) - OTHER_WORDS):
        expect(word in manual, f"designs/json.md: {word} is not explained")
    for key in (key for keys in MANUAL.values() for key in keys if "<" not in key[-1]):
        stem = re.sub(r"_(mm|deg|mrad|px|m|rad)$", "", key[-1].removesuffix("[]"))
        expect(f'"{stem}' in sources, f"designs/json.md: no writer has {key[-1]}")


def check_errors():
    for arguments in (["select", FANUC, "-m", "s.csv", "-k", 99], ["calibrate", FANUC, "-m", "absent.csv"],
                      ["inspect", "absent.yaml"], ["verify", "absent.json"]):
        out, said = run(*arguments, "--json", code=1)
        expect(out == "" and said == run(*arguments, code=1)[1], f"{arguments}: {out}{said}")
    out, said = run("select", FANUC, "-m", "s.csv", "-k", 8, "--json", "-o", "/dev/stdout", code=1)
    expect(out == "" and "must be a file" in said, said)
    out, said = run("select", FANUC, "-m", "s.csv", "-k", 8, "--json", "--digits", 9, code=2)
    expect("--digits excludes --json" in said, said)


def check_threads():
    """The same bytes on standard output and in files."""
    for arguments, file in (
            (["select", FANUC, "--random", 300, "-k", 9, "-o", "t.json"], "t.json"),
            (["select", FANUC, "--random", 300, "-k", 9, "--relax", "-o", "t.json"], "t.json"),
            (["plan", CELL, "-k", 12, "--pool", 300, "--starts", 3, "-o", "t.json"], "t.json"),
            (["study", FANUC, "-m", "s.csv", "-k", "6", "--random", 5, "--csv", "t.csv"], "t.csv"),
            (["calibrate", FANUC, "-m", "s.csv", "-o", "t.json"], "t.json"),
            (["inspect", FANUC, "-m", "s.csv"], None),
            (["simulate", FANUC, "-k", 30, "-o", "t.csv"], "t.csv")):
        results = set()
        for count in (1, 2, 5):
            out, _ = run(*arguments, "--threads", count)
            results.add((out, pathlib.Path(file).read_text() if file else ""))
        expect(len(results) == 1, f"{arguments}: --threads matters")


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    pathlib.Path("arm.urdf").write_text(URDF)
    pathlib.Path("arm.yaml").write_text(ARM)
    for check in (check_simulate, check_inspect, check_indices, check_select, check_relax, check_verify,
                  check_calibrate, check_cameras, check_study, check_blocks_study, check_plan, check_program, check_correct, check_export,
                  check_conditions, check_report, check_writers,
                  check_errors, check_threads):
        check()
    expect(PRINTED | {""} == set(MANUAL), f"sections {sorted(MANUAL)}, printed {sorted(PRINTED)}")
print("\n".join(faults) or "every document is as its manual says")
sys.exit(1 if faults else 0)
