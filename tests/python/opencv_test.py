"""Views of a board beside OpenCV's calibrateCamera, by the same corners."""

import numpy as np
import pandas as pd
import pytest

import posewise as pw

focal, centre = (1500.0, 1490.0), (655.0, 470.0)
K = np.array([[focal[0], 0, centre[0]], [0, focal[1], centre[1]], [0, 0, 1]])
lenses = {
    "none": [],
    "five": [-0.1, 0.05, 1e-3, -5e-4, 0.01],
    "eight": [-0.1, 0.05, 1e-3, -5e-4, 0.01, 0.02, -0.01, 0.005],
}
views = [((0.5, -0.4, 0.2), (-80, -50, 500)), ((-0.6, 0.3, 2.9), (70, 40, 420))]
# OpenCV takes points and corners as float, whose digits both are given.
board = np.array([[25.0 * (k % 8), 25.0 * (k // 8), 0] for k in range(40)], dtype=np.float32)


@pytest.fixture(scope="module")
def cv2():
    return pytest.importorskip("cv2")


def corners_of(cv2, lens, view, seed):
    turn, move = (np.array(part, dtype=float) for part in view)
    corners, _ = cv2.projectPoints(board, turn, move, K, np.array(lens) if lens else None)
    noise = np.random.default_rng(seed).normal(0, 0.3, (len(board), 2))
    return (corners[:, 0] + noise).astype(np.float32)


def found_here(corners, lens, known):
    """By a robot that does not move: what is found is where the board is."""
    intrinsics = {
        **dict(zip(("fx_px", "fy_px", "cx_px", "cy_px"), (*focal, *centre), strict=True)),
        "known": known,
    }
    if lens:
        intrinsics["distortion"] = {"model": "brown_conrady", "coefficients": lens}
    campaign = pw.Campaign.from_dict(
        {
            "name": "one view",
            "model_error_mm": 0,
            "model_error_orientation_mrad": 0,
            "robot": {
                "errors": "none",
                "joints": {"q1": {"limits_deg": [-180, 180]}},
                "elements": ["Rz q1"],
            },
            "sensor": {
                "kind": "camera",
                "camera": "fixed",
                "sigma_px": 0.3,
                "intrinsics": intrinsics,
                "board": {"columns": 8, "rows": 5, "square_mm": 25},
                "place": {"position_mm": [0, 0, 0], "rpy_deg": [0, 0, 0], "known": True},
            },
        }
    )
    measured = pd.DataFrame(corners.astype(float), columns=["u_px", "v_px"])
    measured.insert(0, "point", range(1, len(board) + 1))
    measured.insert(0, "q1_deg", 0.0)
    measured.insert(0, "config", "1")
    return pw.calibrate(campaign, measured, folds=0)


def found_by_opencv(cv2, corners, lens, free):
    keep = [
        cv2.CALIB_USE_INTRINSIC_GUESS,
        cv2.CALIB_FIX_PRINCIPAL_POINT,
        *(getattr(cv2, f"CALIB_FIX_K{k}") for k in range(1, 7)),
        cv2.CALIB_FIX_TANGENT_DIST,
        0 if free else cv2.CALIB_FIX_FOCAL_LENGTH,
        cv2.CALIB_RATIONAL_MODEL if len(lens) == 8 else 0,
    ]
    ends = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 1000, 1e-15)
    rms, found, _, turns, moves = cv2.calibrateCamera(
        [board],
        [corners],
        (1280, 960),
        K.copy(),
        np.array(lens) if lens else np.zeros(5),
        flags=sum(keep),
        criteria=ends,
    )
    return rms, found, cv2.Rodrigues(turns[0])[0], moves[0][:, 0]


def rotation(wxyz):
    w, x, y, z = wxyz
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


@pytest.mark.parametrize("free", [False, True])
@pytest.mark.parametrize("view", range(len(views)))
@pytest.mark.parametrize("lens", lenses)
def test_one_view_is_as_opencv_finds_it(cv2, lens, view, free):
    coefficients = lenses[lens]
    corners = corners_of(cv2, coefficients, views[view], seed=view)
    known = ["cx", "cy", *("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6")[: len(coefficients)]]
    ours = found_here(corners, coefficients, known if free else True)
    rms, intrinsics, turn, move = found_by_opencv(cv2, corners, coefficients, free)
    fit = ours.document["accuracy"]["fit"]
    assert fit["reprojection_rms_px"] == pytest.approx(rms, abs=1e-6)
    base = ours.document["base"]
    assert np.array(base["position_m"]) * 1e3 == pytest.approx(move, rel=1e-5)
    assert rotation(base["quaternion_wxyz"]) == pytest.approx(turn, abs=1e-5)
    if free:
        for k, name in enumerate(("camera.fx_kpx", "camera.fy_kpx")):
            assert 1e3 * ours.document["sensor"][name] == pytest.approx(intrinsics[k, k], rel=1e-5)
