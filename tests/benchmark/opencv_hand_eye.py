"""Compares hand-eye calibration and intrinsics from the same corners: posewise beside OpenCV's
calibrateCamera, calibrateHandEye and calibrateRobotWorldHandEye (all methods). Simulated: an arm as
stated, a camera on its flange, corners with noise in pixels. Usage: opencv_hand_eye.py PROGRAM [RUNS]"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import cv2
import numpy as np

CAMPAIGN = Path(__file__).resolve().parents[2] / "designs/camera/campaign.yaml"
K = np.array([[1216.0, 0, 652], [0, 1209.0, 471], [0, 0, 1]])
LENS = np.array([-0.12, 0.05, 1e-3, -5e-4, 0.01])
BOARD = np.array([[25.0 * (k % 8), 25.0 * (k // 8), 0] for k in range(40)]) / 1e3
PLACE = np.eye(4)
PLACE[:3, :3] = cv2.Rodrigues(np.array([0.05, -0.03, 0.12]))[0]
PLACE[:3, 3] = [0.031, 0.044, 0.058]
SIGMA = 0.3
VIEWS = 25


def transform(turn=(0, 0, 0), move=(0, 0, 0)):
    result = np.eye(4)
    result[:3, :3] = cv2.Rodrigues(np.array(turn, dtype=float))[0]
    result[:3, 3] = move
    return result


def flange(q):
    """Of the elements in the campaign, base_from_flange."""
    z, x = (lambda a: transform((0, 0, a))), (lambda a: transform((a, 0, 0)))
    move = lambda *xyz: transform(move=xyz)
    quarter = np.pi / 2
    return (z(q[0]) @ move(0, 0, 0.0892) @ x(quarter) @ z(q[1]) @ move(-0.425, 0, 0) @ z(q[2])
            @ move(-0.392, 0, 0) @ z(q[3]) @ move(0, 0, 0.1093) @ x(quarter) @ z(q[4])
            @ move(0, 0, 0.09475) @ x(-quarter) @ z(q[5]) @ move(0, 0, 0.0825))


def base_from_board():
    turn = transform((0, 0, quarter := np.pi / 2)) @ transform((np.pi, 0, 0))
    turn[:3, 3] = [0.087, 0.55, 0]
    return np.linalg.inv(turn)


def distance(found, true):
    """mm, mrad"""
    off = np.linalg.inv(true) @ found
    return 1e3 * np.linalg.norm(off[:3, 3]), 1e3 * np.linalg.norm(cv2.Rodrigues(off[:3, :3])[0])


def see(rng, joints):
    """Corners of each view, px."""
    views = []
    for q in joints:
        board = np.linalg.inv(flange(q) @ PLACE) @ base_from_board()
        pixels, _ = cv2.projectPoints(BOARD, cv2.Rodrigues(board[:3, :3])[0], board[:3, 3], K, LENS)
        views.append(pixels.reshape(-1, 2) + SIGMA * rng.standard_normal((len(BOARD), 2)))
    return views


def by_opencv(joints, views):
    points = [BOARD.astype(np.float32)] * len(views)
    corners = [view.astype(np.float32).reshape(-1, 1, 2) for view in views]
    criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 200, 1e-12)
    rms, k, lens, turns, moves = cv2.calibrateCamera(points, corners, (1280, 960), None, None,
                                                     criteria=criteria)
    poses = [transform(t.ravel(), m.ravel()) for t, m in zip(turns, moves)]
    flanges = [flange(q) for q in joints]
    rotations = lambda frames: [f[:3, :3] for f in frames]
    places = lambda frames: [f[:3, 3] for f in frames]
    errors = {}
    for name in ("TSAI", "PARK", "HORAUD", "ANDREFF", "DANIILIDIS"):
        R, t = cv2.calibrateHandEye(rotations(flanges), places(flanges), rotations(poses),
                                    places(poses), method=getattr(cv2, "CALIB_HAND_EYE_" + name))
        found = np.eye(4)
        found[:3, :3], found[:3, 3] = R, t.ravel()
        errors[name] = distance(found, PLACE)
    inverse = [np.linalg.inv(f) for f in flanges]
    for name in ("SHAH", "LI"):
        _, _, R, t = cv2.calibrateRobotWorldHandEye(
            rotations(poses), places(poses), rotations(inverse), places(inverse),
            method=getattr(cv2, "CALIB_ROBOT_WORLD_HAND_EYE_" + name))
        found = np.eye(4)
        found[:3, :3], found[:3, 3] = R, t.ravel()
        errors[name] = distance(np.linalg.inv(found), PLACE)
    return np.array([k[0, 0], k[1, 1], k[0, 2], k[1, 2]]), errors, rms


def by_posewise(program, joints, views, folder):
    lines = ["config," + ",".join(f"q{j}_rad" for j in range(1, 7)) + ",point,u_px,v_px"]
    for i, (q, view) in enumerate(zip(joints, views)):
        for k, (u, v) in enumerate(view):
            lines.append(f"{i}," + ",".join(repr(float(x)) for x in q) + f",{k + 1},{u},{v}")
    (folder / "m.csv").write_text("\n".join(lines) + "\n")
    text = CAMPAIGN.read_text().replace("errors: full", "errors: none").replace("  class: collaborative\n", "")
    start = text.index("    fx_px"), text.index("    known: false")
    text = text[:start[0]] + "    distortion: {model: brown_conrady, coefficients: [0, 0, 0, 0, 0]}\n" + text[start[1]:]
    text = text[:text.index("  # Only to plan")]  # no place, no base: from nothing
    (folder / "c.yaml").write_text(text)
    subprocess.run([program, "calibrate", folder / "c.yaml", "-m", folder / "m.csv", "--out", folder / "e.json"],
                   check=True, stdout=subprocess.DEVNULL)
    unknowns = json.loads((folder / "e.json").read_text())["sensor"]
    value = lambda name: unknowns["camera." + name]
    found = transform([value(f"r{a}_rad") for a in "xyz"], [value(f"{a}_m") for a in "xyz"])
    return 1e3 * np.array([value(n + "_kpx") for n in ("fx", "fy", "cx", "cy")]), distance(found, PLACE)


def draw(rng):
    """Poses that show the whole board."""
    joints = []
    while len(joints) < VIEWS:
        q = rng.uniform([-np.pi, -np.pi, -2.6, -np.pi, -np.pi, -np.pi], [np.pi, 0, 2.6, np.pi, np.pi, np.pi])
        board = np.linalg.inv(flange(q) @ PLACE) @ base_from_board()
        corners = (board[:3, :3] @ BOARD.T).T + board[:3, 3]
        tilt = np.arccos(board[2, 2])
        if corners[:, 2].min() < 0.15 or tilt > 1.0:
            continue
        ab = corners[:, :2] / corners[:, 2:]
        uv = ab * K[[0, 1], [0, 1]] + K[:2, 2]
        if uv.min() > 10 and uv[:, 0].max() < 1270 and uv[:, 1].max() < 950:
            joints.append(q)
    return joints


def main(program, runs):
    rng = np.random.default_rng(1)
    errors, focal = {}, {"OpenCV": [], "posewise": []}
    for _ in range(runs):
        joints = draw(rng)
        views = see(rng, joints)
        intrinsics, of_opencv, rms = by_opencv(joints, views)
        with tempfile.TemporaryDirectory() as folder:
            ours, of_posewise = by_posewise(program, joints, views, Path(folder))
        truth = np.array([K[0, 0], K[1, 1], K[0, 2], K[1, 2]])
        focal["OpenCV"].append(intrinsics - truth)
        focal["posewise"].append(ours - truth)
        for name, value in {**of_opencv, "posewise": of_posewise}.items():
            errors.setdefault(name, []).append(value)
    print(f"hand-eye, {runs} times {VIEWS} views of 40 corners with {SIGMA} px, intrinsics unknown, RMS:")
    for name, values in errors.items():
        mm, mrad = np.sqrt(np.mean(np.square(values), axis=0))
        print(f"  {name:12} {mm:8.4f} mm {mrad:8.4f} mrad")
    print("intrinsics fx, fy, cx, cy, RMS of the error, px:")
    for name, values in focal.items():
        print(f"  {name:12}", np.round(np.sqrt(np.mean(np.square(values), axis=0)), 3))


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 20)
