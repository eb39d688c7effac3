"""A Python function as instrument does what the library's own of the same kind does."""

import pickle

import numpy as np
import pandas as pd
import pytest

import posewise as pw


def points(frame, unknowns):
    """Three points in the instrument's frame, m."""
    return (frame[:3, :3] @ unknowns.reshape(3, 3).T + frame[:3, 3:]).T.ravel()


def make_sensor(predict=points, **changes):
    stated = {
        "names": [f"p{i}_{axis}_m" for i in (1, 2, 3) for axis in "xyz"],
        "sigma": 52e-6,
        "targets": [None] * 3,
        "unknowns": {f"target{i}.{axis}_m": 0.05 * i for i in (1, 2, 3) for axis in "xyz"},
    }
    return pw.Sensor(predict, **{**stated, **changes})


def test_jacobian_and_names(fanuc, measurements):
    own = fanuc.with_sensor(make_sensor())
    pd.testing.assert_index_equal(own.parameters.index, fanuc.parameters.index)
    q = measurements.iloc[:12:3]
    J = own.jacobian(q, scaled=False)
    # The library's own sensor has other nominal targets, which rotations of the robot depend on.
    columns = [name.startswith(("base.x", "base.y", "base.z", "T", "target")) for name in
               fanuc.parameters.index]
    np.testing.assert_allclose(J[:, :, columns], fanuc.jacobian(q, scaled=False)[:, :, columns],
                               atol=1e-9)


def test_study_and_choice(fanuc):
    own = fanuc.with_sensor(make_sensor())
    study = pw.study(own, poses=12, trials=2, pool=30, test_poses=20)
    assert 0.05 < study["held_out_rms_mm"][0] < 1
    choice = pw.select(own, 12, random=40)
    assert choice.verify()["is_right"].all()
    copy = pickle.loads(pickle.dumps(own))
    assert pw.select(copy, 12, random=40).ids == choice.ids


def directions(frame, unknowns):
    """A camera at the origin, looking along z: the direction of one target."""
    x, y, z = frame[:3, 3] + frame[:3, :3] @ unknowns
    return [np.arctan2(x, z), np.arctan2(y, z)]


def test_an_instrument_of_angles_with_a_robot_from_elsewhere():
    rows = [
        {"a_mm": 0, "alpha_deg": 90, "d_mm": 300, "theta_deg": 0, "joint": "q1", "limits_deg": [-90, 90]},
        {"a_mm": 400, "alpha_deg": 0, "d_mm": 0, "theta_deg": 0, "joint": "q2", "limits_deg": [-60, 60]},
        {"a_mm": 300, "alpha_deg": 0, "d_mm": 0, "theta_deg": 0, "joint": "q3", "limits_deg": [-90, 90]},
    ]
    sensor = pw.Sensor(directions, ["right_rad", "down_rad"], 1e-4, targets=[None],
                       unknowns={"target1.x_m": 0.0, "target1.y_m": 0.0, "target1.z_m": 0.1})
    campaign = pw.Campaign.from_dh(rows, sensor=sensor, robot={"errors": "offsets"},
                                   base={"position_mm": [0, 0, 3000], "rpy_deg": [0, 0, 0]})
    q = np.random.default_rng(1).uniform(-0.5, 0.5, (30, 3))
    J = campaign.jacobian(q)
    assert J.shape[:2] == (30, 2) and np.isfinite(J).all()
    assert len(pw.select(campaign, 10, candidates=pd.DataFrame(q, columns=["q1_rad", "q2_rad", "q3_rad"]))) == 10


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"names": ["a_mm"] * 9}, "_m or _rad"),
        ({"names": ["a_m"] * 8}, "8 numbers for 3 targets"),
        ({"sigma": -1}, "above 0"),
        ({"sigma": [1, 2]}, "sigma"),
        ({"targets": [(1, 2)] * 3}, "points"),
        ({"unknowns": {}}, "unknowns"),
        ({"unknowns": {"f": 1}}, "_m or _rad"),
    ],
)
def test_wrong_parts(fanuc, changes, words):
    with pytest.raises(pw.InputError, match=words):
        fanuc.with_sensor(make_sensor(**changes))


def test_a_wrong_function_is_told(fanuc):
    q = np.zeros((3, 6))
    for wrong in (lambda f, u: [1, 2], lambda f, u: np.full(9, np.nan), lambda f, u: "text"):
        with pytest.raises(pw.InputError, match="sensor.predict"):
            fanuc.with_sensor(make_sensor(wrong)).jacobian(q)

    def raising(frame, unknowns):
        raise ZeroDivisionError("mine")

    for count in (3, 300):
        with pytest.raises(ZeroDivisionError, match="mine"):
            fanuc.with_sensor(make_sensor(raising)).jacobian(np.zeros((count, 6)), threads=2)


def test_threads_wait_for_each_other_while_a_campaign_is_made():
    rows = [
        {"a_mm": 0, "alpha_deg": 90, "d_mm": 300, "theta_deg": 0, "joint": "q1", "limits_deg": [-90, 90]},
        {"a_mm": 400, "alpha_deg": 0, "d_mm": 0, "theta_deg": 0, "joint": "q2", "limits_deg": [-60, 60]},
    ]
    sensor = pw.Sensor(directions, ["right_rad", "down_rad"], 1e-4, targets=[None],
                       unknowns={"target1.x_m": 0.0, "target1.y_m": 0.0, "target1.z_m": 0.1})
    base = {"position_mm": [0, 0, 3000], "rpy_deg": [0, 0, 0]}
    for _ in range(20):
        pw.Campaign.from_dh(rows, sensor=sensor, robot={"errors": "offsets"}, base=base)
