#!/usr/bin/env python3
"""Writes the files of tests/golden/measurements, which tests/io/foreign_tables_test.cpp reads: what an instrument sees of a UR10 with
standard DH rows, as other calibration programs write it. Computed from the definition of DH rows alone. Needs python3-numpy.
Run: foreign_tables.py FOLDER"""
import json
import pathlib
import sys

import numpy as np

folder = pathlib.Path(sys.argv[1])
rows = [(127.3, 0, 90), (0, -612, 0), (0, -572.3, 0), (163.941, 0, 90), (115.7, 0, -90), (92.2, 0, 0)]  # d, a (mm), alpha (deg)


def turn(axis, angle):
    matrix = np.eye(4)
    i, j = [(1, 2), (2, 0), (0, 1)][axis]
    matrix[[i, i, j, j], [i, j, i, j]] = np.cos(angle), -np.sin(angle), np.sin(angle), np.cos(angle)
    return matrix


def shift(x, y, z):
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    return matrix


def flange(q):
    pose = np.eye(4)
    for angle, (d, a, alpha) in zip(q, rows):
        pose = pose @ turn(2, angle) @ shift(0, 0, d) @ shift(a, 0, 0) @ turn(0, np.radians(alpha))
    return pose


base = shift(1500, -200, 300) @ turn(2, np.radians(40)) @ turn(1, np.radians(3))
tools = [shift(10, 20, 120), shift(-60, 5, 110), shift(25, -70, 130)]
tool = tools[0] @ turn(2, np.radians(30))
joints = np.round(np.random.default_rng(8).uniform(-90, 90, (6, 6)), 3)
poses = [base @ flange(np.radians(q)) for q in joints]


def rx_ry_rz(matrix):
    """Angles of Rx Ry Rz, rad."""
    r = matrix[:3, :3]
    return [np.arctan2(-r[1, 2], r[2, 2]), np.arcsin(r[0, 2]), np.arctan2(-r[0, 1], r[0, 0])]


def rz_ry_rx(matrix):
    """Angles of Rz Ry Rx about x, y and z, deg."""
    r = matrix[:3, :3]
    return np.degrees([np.arctan2(r[2, 1], r[2, 2]), np.arcsin(-r[2, 0]), np.arctan2(r[1, 0], r[0, 0])])


def write(name, lines):
    (folder / name).write_text("\n".join(lines) + "\n")


def row(*parts):
    return ",".join(f"{number:.6f}" for part in parts for number in part)


header = "J1,J2,J3,J4,J5,J6,X,Y,Z,W,P,R,TX,TY,TZ,TW,TP,TR"
unmeasured = row(joints[0] + 1, np.zeros(6), tool[:3, 3], rx_ry_rz(tool))
lines = [row(q, (p @ tool)[:3, 3], rx_ry_rz(p @ tool), tool[:3, 3], rx_ry_rz(tool)) for q, p in zip(joints, poses)]
write("robodk_poses.csv", [header, *lines[:2], unmeasured, *lines[2:]])
write("robodk_degrees.csv", [header, *(
    row(q, (p @ tool)[:3, 3], rz_ry_rx(p @ tool), tool[:3, 3], rz_ry_rx(tool)) for q, p in zip(joints, poses))])
write("robodk_points.csv", ["J1,J2,J3,J4,J5,J6,X,Y,Z,TX,TY,TZ", *(
    row(q, (p @ t)[:3, 3], t[:3, 3]) for t in (tools[1], tools[0], tools[2]) for q, p in zip(joints, poses))])
write("pybotics.csv", ["# joints[:ndof], pose[-16:]", *(row(q, (p @ tool).ravel()) for q, p in zip(joints, poses))])

names = ["finger", "q6", "q5", "q4", "q3", "q2", "q1"]
messages = []
for number, (q, pose) in enumerate(zip(joints, poses)):
    def features(frame, points):
        return [{"header": {"seq": 0, "stamp": {"secs": 0, "nsecs": 0}, "frame_id": frame},
                 "point": dict(zip("xyz", (float(f"{x / 1000:.9f}") for x in p)))} for p in points]

    seen = [(pose @ t)[:3, 3] for t in tools]
    messages.append({
        "joint_states": {"header": {"seq": number, "frame_id": ""}, "name": names,
                         "position": [0.01, *np.radians(q[::-1]).tolist()], "velocity": [], "effort": []},
        "observations": [{"sensor_name": "arm", "features": features("board", [t[:3, 3] for t in tools])},
                         {"sensor_name": "camera", "features": features("camera_optical_frame", seen)}],
    })
write("calibration_data.json", [json.dumps(messages, indent=1)])


def echo(value, indent):
    """As rostopic echo prints a message."""
    for key, one in value.items():
        if isinstance(one, dict):
            yield f"{indent}{key}:"
            yield from echo(one, indent + "  ")
        elif isinstance(one, list) and one and isinstance(one[0], dict):
            yield f"{indent}{key}:"
            for item in one:
                yield f"{indent}  -"
                yield from echo(item, indent + "    ")
        elif isinstance(one, list):
            yield f"{indent}{key}: [{', '.join(map(str, one))}]"
        else:
            yield f"{indent}{key}: {one if one != '' else repr(one)}"


messages[3]["observations"][1]["features"][1]["point"] = {"x": "nan", "y": "nan", "z": "nan"}
text = []
for message in messages:
    for observation in message["observations"]:
        observation["image"] = {"height": 2, "width": 2, "data": [1, 2, 3, 4]}
    text += [*echo(message, ""), "---"]
write("calibration_data.yaml", text)
