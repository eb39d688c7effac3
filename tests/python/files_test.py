"""Files that Python writes name files that are there, and the program reads them."""

import json
import os
import subprocess

import numpy as np
import pandas as pd
import pytest
from conftest import designs

import posewise as pw

tracker = {"kind": "points", "sigma_mm": 0.05, "targets": {"count": 2}}


def check(*arguments, cwd):
    """What the program says; it must be content and warn of nothing."""
    done = subprocess.run(
        [os.environ["POSEWISE_PROGRAM"], *map(str, arguments)], cwd=cwd, capture_output=True, text=True
    )
    assert (done.returncode, done.stderr) == (0, ""), done.stdout + done.stderr
    return done.stdout


def named_files(document):
    """Every path that a document states."""
    keys = {"campaign_file", "source", "augment", "test_poses", "groups", "workspace", "file", "measurements"}
    if isinstance(document, dict):
        for key, value in document.items():
            if key in keys and isinstance(value, str):
                yield value
            else:
                yield from named_files(value)
    elif isinstance(document, list):
        for one in document:
            yield from named_files(one)


def assert_all_there(path):
    names = list(named_files(json.loads(path.read_text())))
    assert names
    for name in names:
        assert (path.parent / name).exists(), name


@pytest.fixture(autouse=True)
def far_folder(monkeypatch):
    """Neither above nor beside what tests write: no path leads there by luck."""
    monkeypatch.chdir("/usr/lib")


def some_poses(campaign, count, seed=1):
    """Configurations near the middle of the limits."""
    q = np.random.default_rng(seed).uniform(-0.3, 0.3, (count, len(campaign.joints)))
    return pd.DataFrame(q, columns=campaign._core.columns)


@pytest.fixture
def other_robot():
    return pw.Campaign.from_yaml(designs / "abb_irb120" / "campaign.yaml")


def test_plan_with_held_and_workspace_tables(fanuc, measurements, tmp_path):
    held = measurements[measurements["config"].isin(["1", "2", "3"])]
    workspace = some_poses(fanuc, 30)
    for given in (workspace, workspace.to_numpy()):
        plan = pw.plan(fanuc, 14, pool=100, held=held, workspace=given)
        path = tmp_path / "plan.json"
        plan.write(path, csv=tmp_path / "poses.csv")
        assert_all_there(path)
        check("verify", path, cwd=tmp_path)
        again = pw.Plan.read(path, fanuc)
        assert again.verify()["is_right"].all() and plan.verify()["is_right"].all()
        assert "14 poses" in str(again) and np.isfinite(again.predicted["rms_mm"])


def test_a_plan_moves_with_its_folder(fanuc, measurements, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "here").mkdir()
    campaign = pw.Campaign(fanuc._core.content)
    plan = pw.plan(campaign, 14, pool=100, workspace=some_poses(fanuc, 30))
    plan.write("here/plan.json")
    (tmp_path / "here").rename(tmp_path / "there")
    check("verify", "there/plan.json", cwd=tmp_path)
    check("verify", "plan.json", cwd=tmp_path / "there")
    (tmp_path / "there" / "plan.workspace.csv").unlink()
    with pytest.raises(pw.InputError, match="plan.workspace.csv"):
        pw.Plan.read("there/plan.json", campaign).verify()


def test_choice_of_a_campaign(fanuc, measurements, tmp_path):
    ids = list(dict.fromkeys(measurements["config"]))
    choice = pw.select(fanuc, 12, measurements=measurements, groups=np.arange(len(ids)) // 2, per_group=1)
    choice.write(tmp_path / "choice.json")
    assert_all_there(tmp_path / "choice.json")
    check("verify", "choice.json", cwd=tmp_path)
    array = some_poses(fanuc, 40).to_numpy()
    choice = pw.select(fanuc, 14, candidates=array, test_poses=array[:5], criterion="v")
    choice.write(tmp_path / "other.json")
    check("verify", "other.json", cwd=tmp_path)
    assert choice.verify()["is_right"].all()


@pytest.mark.parametrize("prior", [None, True, np.full(8, 0.5)])
def test_choice_of_jacobians(blocks, prior, tmp_path):
    choice = pw.select(
        blocks, 6, criterion="v", prior=prior, held=blocks[:2] + 1, test_poses=blocks[3:9],
        groups=["a", "b"] * 20, per_group=4,
    )
    choice.write(tmp_path / "choice.json")
    assert_all_there(tmp_path / "choice.json")
    check("verify", "choice.json", cwd=tmp_path)


def test_campaigns_from_elsewhere(tmp_path, monkeypatch):
    urdf = """<robot name="two"><link name="a"/><link name="b"/><link name="c"/>
    <joint name="q1" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" velocity="1" effort="1"/></joint>
    <joint name="q2" type="revolute"><parent link="b"/><child link="c"/><origin xyz="0.5 0 0"/>
    <axis xyz="0 1 0"/><limit lower="-1" upper="1" velocity="1" effort="1"/></joint></robot>"""
    base = {"position_mm": [0, 0, 0], "rpy_deg": [0, 0, 0]}
    rows = [{"a_mm": 0, "alpha_deg": 90, "d_mm": 300, "theta_deg": 0, "joint": "q1", "limits_deg": [-90, 90]},
            {"a_mm": 400, "alpha_deg": 0, "d_mm": 0, "theta_deg": 0, "joint": "q2", "limits_deg": [-60, 60]}]
    stated = {"robot": {"errors": "geometric"}, "base": base}
    for campaign in (
        pw.Campaign.from_urdf(urdf, tip="c", sensor=tracker, robot={"errors": "geometric", "base_link": "a"}, base=base),
        pw.Campaign.from_dh(rows, sensor=tracker, **stated),
    ):
        campaign.write(tmp_path / "campaign.yaml")
        again = pw.Campaign.from_yaml(tmp_path / "campaign.yaml")
        pd.testing.assert_frame_equal(again.parameters, campaign.parameters)
        choice = pw.select(campaign, 9, random=60, criterion="d")
        choice.write(tmp_path / "choice.json")
        assert_all_there(tmp_path / "choice.json")
        check("verify", "choice.json", cwd=tmp_path)


def test_a_function_as_instrument_cannot_be_written(fanuc, tmp_path):
    sensor = pw.Sensor(lambda frame, unknowns: frame[:3, 3], ["x_m", "y_m", "z_m"], 1e-4)
    campaign = fanuc.with_sensor(sensor)
    choice = pw.select(campaign, 12, random=40, prior=True)
    for write in (campaign.write, choice.write):
        with pytest.raises(pw.InputError, match="Python function"):
            write(tmp_path / "out")
    assert list(tmp_path.iterdir()) == []


def test_estimates(fanuc, measurements, measurements_path, tmp_path):
    earlier = pw.calibrate(fanuc, measurements, exclude=[1], folds=0)
    earlier.write(tmp_path / "estimate.json")
    assert_all_there(tmp_path / "estimate.json")
    out = check("report", "estimate.json", "-o", "page.html", cwd=tmp_path)
    assert "residuals" in out
    made_from = json.loads((tmp_path / "estimate.json").read_text())["made_from"]
    assert made_from["options"] == {"--exclude": ["1"], "--folds": ["0"]}
    by_path = pw.calibrate(fanuc, measurements_path, folds=0)
    by_path.write(tmp_path / "other.json")
    assert not (tmp_path / "other.measurements.csv").exists()
    check("report", "other.json", "-o", "other.html", cwd=tmp_path)
    plan = pw.plan(fanuc, 14, pool=100, workspace_poses=30, estimate=earlier, as_prior=True)
    plan.write(tmp_path / "plan.json")
    assert_all_there(tmp_path / "plan.json")
    assert_all_there(tmp_path / "plan.estimate.json")
    check("verify", "plan.json", cwd=tmp_path)
    assert pw.Plan.read(tmp_path / "plan.json", fanuc).verify()["is_right"].all()


def test_what_cannot_be_written_is_told(fanuc, measurements, blocks, tmp_path):
    estimate = pw.calibrate(fanuc, measurements, folds=0)
    plan = pw.plan(fanuc, 14, pool=100, workspace_poses=30)
    for result in (estimate, plan, pw.select(blocks, 5), fanuc):
        for path in (tmp_path / "missing" / "out.json", tmp_path, "", 3):
            with pytest.raises(pw.InputError):
                result.write(path)
    assert list(tmp_path.iterdir()) == []


def test_files_of_another_campaign_and_changed_ones_are_refused(fanuc, other_robot, measurements, tmp_path):
    pw.calibrate(fanuc, measurements, folds=0).write(tmp_path / "estimate.json")
    pw.plan(fanuc, 14, pool=100, workspace_poses=30).write(tmp_path / "plan.json")
    for read, name in ((pw.Estimate.read, "estimate.json"), (pw.Plan.read, "plan.json")):
        assert str(read(tmp_path / name, fanuc))
        with pytest.raises(pw.InputError):
            read(tmp_path / name, other_robot)
        document = json.loads((tmp_path / name).read_text())
        document["chain" if "chain" in document else "poses"] = []
        (tmp_path / "changed.json").write_text(json.dumps(document))
        with pytest.raises(pw.InputError, match="changed.json"):
            read(tmp_path / "changed.json", fanuc)
