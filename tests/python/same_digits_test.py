"""Python and the program give the same numbers and the same warnings."""

import json
import os
import subprocess

import numpy as np
import pandas as pd
import pytest
from conftest import designs, real_data

import posewise as pw

# Where a result comes from is another matter: a path, or nothing.
sources = {"campaign_file", "source", "plan_file", "measurements", "measurements_checksum", "made_from"}


def without_sources(document):
    if isinstance(document, dict):
        return {k: without_sources(v) for k, v in document.items() if k not in sources}
    if isinstance(document, list):
        return [without_sources(item) for item in document]
    return document


def assert_same(made, printed):
    made, printed = without_sources(made), without_sources(printed)
    assert made.keys() == printed.keys()
    for key in printed:
        assert made[key] == printed[key], key


def test_calibration(run, fanuc, fanuc_path, measurements, measurements_path, tmp_path):
    printed = run("calibrate", fanuc_path, "-m", measurements_path, cwd=tmp_path)
    estimate = pw.calibrate(fanuc, measurements)
    assert_same(estimate.document, printed)
    by_name = {name: one["value_m"] for name, one in printed["robot"].items() if "value_m" in one}
    assert {name: estimate.values[name] for name in by_name} == by_name
    assert estimate.covariance.loc["dq2", "dq2"] == printed["robot"]["dq2"]["sigma_rad"] ** 2 or (
        np.isclose(estimate.parameters.sigma["dq2"], printed["robot"]["dq2"]["sigma_rad"], 1e-15)
    )
    assert estimate.held_out["distance_rms_mm"] == (
        printed["accuracy"]["held_out"]["means"]["distance_rms_mm"]
    )


def test_conditions(run, fanuc, fanuc_path, measurements, tmp_path):
    """Time and temperature beside the measurements are looked at, as by the program."""
    noted = measurements.assign(
        time_s=60.0 * np.arange(len(measurements)),
        temperature_C=20 + 0.1 * np.arange(len(measurements)),
    )
    noted.to_csv(tmp_path / "noted.csv", index=False)
    printed = run("calibrate", fanuc_path, "-m", "noted.csv", cwd=tmp_path)
    estimate = pw.calibrate(fanuc, noted)
    assert_same(estimate.document, printed)
    trends = estimate.document["accuracy"]["condition_trends"]
    assert [one["name"] for one in trends] == ["time", "temperature"]


def test_several_plans(run, fanuc, fanuc_path, tmp_path):
    """Measurements of two plans, whose poses have the same names, as by the program."""
    plans, tables = [], []
    for number in (1, 2):
        plan = pw.plan(fanuc, 14, criterion="d", pool=300, workspace_poses=50, verification=2,
                       seed=number, effort="quick")
        plan.write(tmp_path / f"plan{number}.json", csv=tmp_path / f"poses{number}.csv")
        run("simulate", fanuc_path, "--configurations", f"poses{number}.csv", "--seed", number,
            "-o", f"m{number}.csv", cwd=tmp_path)
        plans.append(plan)
        tables.append(pd.read_csv(
            tmp_path / f"m{number}.csv", comment="#", dtype={"config": str},
            float_precision="round_trip",
        ))
    pairs = ("-m", "m1.csv", "--plan", "plan1.json", "-m", "m2.csv", "--plan", "plan2.json")
    printed = run("calibrate", fanuc_path, *pairs, "--exclude", "plan2/p3", cwd=tmp_path)
    estimate = pw.calibrate(fanuc, tables, plan=plans, exclude=["plan2/p3"])
    assert_same(estimate.document, printed)
    estimate.write(tmp_path / "e.json")
    options = json.loads((tmp_path / "e.json").read_text())["made_from"]["options"]
    assert len(options["--measurements"]) == len(options["--plan"]) == 2
    shown = subprocess.run(
        [os.environ["POSEWISE_PROGRAM"], "report", "e.json", "-o", "e.html"],
        cwd=tmp_path, capture_output=True, text=True, check=True,
    )
    assert shown.stderr == "" and "residuals" in shown.stdout
    for measured, of, words in [
        (tables, plans[:1], "must be equally many"),
        (tables[0], plans, "must be equally many"),
        (tables, [plans[0], plans[0]], "same one twice"),
        (tables, [plans[0], None], "`plan` is a NoneType"),
        ([tables[0], None], plans, "nothing at place 2"),
        ([tables[0], tables[0]], plans, "measurements2: has the same readings as measurements1"),
        ([], [], "at least one"),
    ]:
        with pytest.raises(pw.InputError, match=words):
            pw.calibrate(fanuc, measured, plan=of)


def test_predictions(run, fanuc, fanuc_path, measurements, measurements_path, tmp_path):
    run("calibrate", fanuc_path, "-m", measurements_path, "--predict", measurements_path,
        "--predict-out", tmp_path / "expected.csv", cwd=tmp_path)
    expected = pd.read_csv(tmp_path / "expected.csv").drop(columns="config")
    once = measurements.drop_duplicates("config")
    found = pw.calibrate(fanuc, measurements).predict(once)
    pd.testing.assert_frame_equal(
        found.reset_index(drop=True), expected.reset_index(drop=True), rtol=0, atol=1e-6
    )


def test_choice_and_its_verification(
    run, fanuc, fanuc_path, measurements, measurements_path, tmp_path
):
    printed = run("select", fanuc_path, "-m", measurements_path, "-k", 14, cwd=tmp_path)
    choice = pw.select(fanuc, 14, measurements=measurements)
    assert_same(choice.document, printed)
    verified = run("verify", "measurements.plan.json", cwd=tmp_path)
    found = choice.verify()
    assert found["is_right"].all()
    assert list(found["actual"].dropna()) == [
        one["actual"] for one in verified["findings"] if one.get("actual") is not None
    ]


def test_choice_from_blocks(run, blocks, tmp_path):
    np.savetxt(tmp_path / "J.csv", blocks.reshape(-1, 8), delimiter=",", fmt="%.17g")
    for criterion in ("d", "v", "e"):
        printed = run("select", "--blocks", "J.csv", "--rows", 3, "-k", 6, "-c", criterion,
                      cwd=tmp_path)
        choice = pw.select(blocks, 6, criterion=criterion)
        assert_same(choice.document, printed)
        assert choice.value == pytest.approx(pw.indices(blocks, choice.poses)[criterion], rel=1e-13)


def test_weights(run, fanuc, fanuc_path, measurements, measurements_path, blocks, tmp_path):
    np.savetxt(tmp_path / "J.csv", blocks.reshape(-1, 8), delimiter=",", fmt="%.17g")
    printed = run("select", "--blocks", "J.csv", "--rows", 3, "-k", 6, "--relax", cwd=tmp_path)
    found = pw.relax(blocks, 6)
    assert_same(found.document, printed)
    assert found.weights.sum() == pytest.approx(6, rel=1e-12) and found.weights.max() <= 1
    M = np.einsum("n,nri,nrj->ij", found.weights, *2 * [blocks[found.weights.index]])
    assert found.value == pytest.approx(np.linalg.slogdet(M)[1], rel=1e-12)
    assert pw.select(blocks, 6).value <= found.bound
    printed = run("select", fanuc_path, "-m", measurements_path, "-k", 14, "--relax", cwd=tmp_path)
    found = pw.relax(fanuc, 14, measurements=measurements)
    assert_same(found.document, printed)
    assert set(found.weights.index) <= set(measurements["config"])


def test_plan(run, fanuc, fanuc_path, tmp_path):
    printed = run("plan", fanuc_path, "-k", 14, "-c", "d", "--pool", 300, "--workspace-poses", 50,
                  "--verification", 3, "--csv", "poses.csv", cwd=tmp_path)
    plan = pw.plan(fanuc, 14, criterion="d", pool=300, workspace_poses=50, verification=3)
    assert_same(plan.document, printed)
    assert (plan.poses["purpose"] == "verify").sum() == 3
    written = pd.read_csv(tmp_path / "poses.csv", dtype={"config": str}, float_precision="round_trip")
    pd.testing.assert_frame_equal(plan.poses, written)
    assert plan.verify()["is_right"].all()
    assert len(plan) == 14 and plan.predicted["total_rms_mm"] > 0


def test_study(run, fanuc, fanuc_path, measurements, measurements_path, tmp_path):
    printed = run("study", fanuc_path, "-m", measurements_path, "--poses", "10,14", "--splits", 2,
                  "--random", 4, cwd=tmp_path)
    study = pw.study(fanuc, measurements, poses=[10, 14], splits=2, random=4)
    assert_same(study.document, printed)
    assert list(study["poses"]) == [10, 14]
    simulated = run("study", fanuc_path, "--simulate", "--poses", "12", "--trials", 3, "--pool", 60,
                    cwd=tmp_path)
    assert_same(pw.study(fanuc, poses=12, trials=3, pool=60).document, simulated)


def test_warnings_are_those_of_the_program(
    run, fanuc, fanuc_path, measurements, measurements_path, tmp_path
):
    bad = measurements.copy()
    bad["note_of_the_day"] = 1
    bad.loc[bad["config"] == "7", "p1_x_mm"] += 3
    bad.to_csv(tmp_path / "bad.csv", index=False)
    printed = run("calibrate", fanuc_path, "-m", "bad.csv", cwd=tmp_path)
    with pytest.warns(pw.Doubt):
        estimate = pw.calibrate(fanuc, bad)
    assert printed["warnings"]
    spoken = [one.removeprefix("bad.csv: ") for one in printed["warnings"]]
    assert [one.replace("`exclude`", "--exclude") for one in estimate.doubts] == spoken


@pytest.mark.skipif(not real_data.is_dir(), reason="real campaigns are not here")
@pytest.mark.filterwarnings("ignore::posewise.Doubt")
def test_a_real_campaign(run, tmp_path):
    path = designs / "abb_irb120" / "campaign.yaml"
    data = real_data / "abb_irb120" / "measurements.csv"
    printed = run("calibrate", path, "-m", data, cwd=tmp_path)
    assert_same(pw.calibrate(pw.Campaign.from_yaml(path), data).document, printed)
