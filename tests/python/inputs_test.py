"""What is wrong is said, with the argument; what is right in another form is taken."""

import numpy as np
import pandas as pd
import pytest
from conftest import designs

import posewise as pw

urdf = """<robot name="two"><link name="a"/><link name="b"/><link name="c"/>
<joint name="q1" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>
<limit lower="-2" upper="2" velocity="1" effort="1"/></joint>
<joint name="q2" type="revolute"><parent link="b"/><child link="c"/><origin xyz="0.5 0 0"/>
<axis xyz="0 1 0"/><limit lower="-1" upper="1" velocity="1" effort="1"/></joint></robot>"""
tracker = {"kind": "points", "sigma_mm": 0.05, "targets": {"count": 2}}


def message(error):
    return str(error.value)


@pytest.mark.parametrize(
    ("change", "field", "words"),
    [
        ({"k": 0}, "k", "k: is 0"),
        ({"k": 3.5}, "k", "whole number"),
        ({"k": "x"}, "k", "whole number"),
        ({"k": 41}, "k", "40"),
        ({"k": 6, "criterion": "z"}, "criterion", "'z'"),
        ({"k": 6, "rows": 2}, "rows", "3 rows"),
        ({"k": 6, "held": np.ones((2, 3, 7))}, "held", "8, as J"),
        ({"k": 6, "held": "text"}, "held", "numbers"),
        ({"k": 6, "held": np.full((2, 3, 8), np.nan)}, "held", "finite"),
        ({"k": 6, "test_poses": np.ones((4, 2, 8))}, "test_poses", "must have 3, as J"),
        ({"k": float("nan")}, "k", "no number"),
        ({"k": 6, "prior": np.ones(7)}, "prior", "8 standard deviations"),
        ({"k": 6, "prior": -np.ones(8)}, "prior", "above 0"),
        ({"k": 6, "prior": -np.eye(8)}, "prior", "positive definite"),
        ({"k": 6, "random": 5}, "random", "campaign"),
        ({"k": 6, "threads": 0}, "threads", "from 1"),
        ({"k": 6, "threads": "2"}, "threads", "whole number"),
        ({"k": 6, "rows": "3"}, "rows", "whole number"),
        ({"k": 6, "time": -1}, "time", "from 0.001"),
        ({"k": 6, "seed": -1}, "seed", "seed"),
        ({"k": 6, "proof": float("nan")}, "proof", "nan"),
        ({"k": 6, "groups": [1, 2], "per_group": 1}, "groups", "40"),
        ({"k": 6, "groups": pd.DataFrame({"a": range(40)}), "per_group": 1}, "groups", "list"),
        ({"k": 6, "groups": [1, None] * 20, "per_group": 1}, "groups", "missing"),
        ({"k": 6, "exclude": "23"}, "exclude", "['23']"),
        ({"k": 6, "exclude": [True]}, "exclude", "True"),
        ({"k": 6, "held": [[1, 2], [3]]}, "held", "numbers"),
        ({"k": 6, "held": np.ones((4, 8)), "rows": None}, "held", "4 rows"),
        ({"k": 6, "threads": 10**9}, "threads", "100000"),
        ({"k": 6, "progress": 2}, "progress", "function"),
        ({"k": 6, "criterion": "\ud800"}, "criterion", "no number or text"),
        ({"k": 6, "estimate": 3}, "estimate", "posewise.Estimate"),
        ({"k": 6, "exclude": [99]}, "exclude", "99"),
        ({"k": 2}, "k", "8"),
    ],
)
def test_wrong_arguments_of_select(blocks, change, field, words):
    with pytest.raises(pw.InputError) as error:
        pw.select(blocks, **change)
    assert words in message(error)
    if field:
        assert error.value.field == field


@pytest.mark.parametrize(
    "J",
    [
        np.ones(5), np.ones((2, 2, 2, 2)), np.zeros((0, 3, 4)), np.zeros((4, 0, 4)), None, "J",
        [[1, 2], [3]], np.array([[1 + 2j]]), np.array([["a"]]), np.array([[object()]]),
        np.full((9, 2), np.nan), np.full((9, 2), np.inf), np.full((9, 2), 1e300),
    ],
)
def test_what_is_no_jacobian(J):
    with pytest.raises(pw.InputError):
        pw.select(J, 3)


def test_every_layout_gives_the_same(blocks):
    expected = pw.select(blocks, 6)
    strided = np.repeat(blocks, 2, axis=0)[::2]
    read_only = blocks.copy()
    read_only.flags.writeable = False
    swapped = blocks.astype(">f8")
    for same in (np.asfortranarray(blocks), strided, read_only, swapped, blocks.tolist()):
        assert pw.select(same, 6) == expected
    assert pw.select(blocks.reshape(-1, 8), 6, rows=3) == expected
    assert pw.select(blocks.astype(np.float32), 6).value == pytest.approx(expected.value, rel=1e-5)
    assert pw.select(np.rint(10 * blocks).astype(int), 6).value == pytest.approx(
        pw.select(np.rint(10 * blocks), 6).value, rel=0
    )


def test_masked_numbers_are_refused(blocks, fanuc):
    masked = np.ma.masked_array(blocks, mask=np.arange(40)[:, None, None] + np.zeros((1, 3, 8)) == 7)
    with pytest.raises(pw.InputError, match="masked"):
        pw.select(masked, 6)
    with pytest.raises(pw.InputError, match="masked"):
        fanuc.jacobian(np.ma.masked_less(np.zeros((2, 6)), 1))
    assert pw.select(np.ma.masked_array(blocks), 6) == pw.select(blocks, 6)


def test_a_prior_is_no_pose(blocks):
    for prior in (True, np.ones(8), np.eye(8)):
        for held in (None, blocks[30:33]):
            choice = pw.select(blocks, 6, criterion="o1", prior=prior, held=held)
            rated = pw.indices(blocks, choice.poses, prior=prior, held=held)
            assert choice.value == pytest.approx(rated["o1"], rel=1e-12)
            assert choice.verify()["is_right"].all()
            poses = 6 if held is None else 9
            stacked = blocks[choice.poses].reshape(-1, 8)
            known = np.eye(8) if held is None else np.eye(8) + information(held)
            expected = np.linalg.det(stacked.T @ stacked + known) ** (1 / 16) / np.sqrt(poses)
            assert choice.value == pytest.approx(expected, rel=1e-9)


def test_masks_of_poses(blocks):
    mask = np.arange(40) % 4 == 0
    pd.testing.assert_series_equal(pw.indices(blocks, mask), pw.indices(blocks, np.flatnonzero(mask)))
    with pytest.raises(pw.InputError, match="mask"):
        pw.indices(blocks, mask[:5])
    with pytest.raises(pw.InputError, match="poses"):
        pw.indices(blocks, [-1])


needless = [
    ("select", {"groups": [1]}, "per_group"),
    ("select", {"per_group": 2}, "groups"),
    ("select", {"as_prior": True}, "estimate"),
    ("select", {"only": ["base"]}, "estimate"),
    ("select", {"moved": ["base"]}, "estimate"),
    ("select", {"repeats": 3}, "campaign"),
    ("select", {"focus": "robot"}, "campaign"),
    ("select", {"force": True}, "estimate"),
    ("select", {"effort": "quick", "starts": 3}, "starts"),
    ("plan", {"effort": "quick", "starts": 3}, "starts"),
    ("relax", {"repeats": 3}, "campaign"),
    ("relax", {"force": True}, "estimate"),
    ("relax", {"seed": 1}, "random"),
    ("plan", {"quantity": "p95"}, "target_mm"),
    ("plan", {"assurance": 0.9}, "target_mm"),
    ("plan", {"robust_to": 1}, "minutes"),
    ("plan", {"poses_at_most": 9}, "minutes"),
    ("plan", {"drop": ["p1"]}, "repair"),
    ("plan", {"target_mm": 1}, "poses"),
    ("plan", {"workspace": np.zeros((1, 6)), "workspace_box_mm": [0] * 6}, "workspace_box_mm"),
    ("calibrate", {"points_unit": "mm"}, "plan"),
    ("calibrate", {"refit": ["base"]}, "validate"),
    ("calibrate", {"loss_width": 2}, "loss"),
    ("calibrate", {"limit_mm": 1}, "validate"),
    ("calibrate", {"loss": "huber", "method": "global"}, "method"),
    ("study", {"splits": 3}, "measurements"),
    ("study", {"exclude": [1]}, "measurements"),
    ("study", {"rows": 3}, "Jacobians"),
]


@pytest.mark.parametrize(("function", "keywords", "other"), needless)
def test_keywords_without_effect(fanuc, measurements, blocks, function, keywords, other):
    source = {"select": (blocks, 5), "relax": (blocks, 5), "plan": (fanuc, 14),
              "calibrate": (fanuc, measurements), "study": (fanuc,)}[function]
    with pytest.raises(pw.InputError) as error:
        getattr(pw, function)(*source, **keywords)
    assert error.value.field in keywords or error.value.field == "poses"
    assert all(f"`{name}" in message(error) for name in list(keywords)[:1]) and other in message(error)


def test_a_prior_beside_no_prior(fanuc, measurements):
    estimate = pw.calibrate(fanuc, measurements, folds=0)
    with pytest.raises(pw.InputError, match="`as_prior` excludes `prior=False`"):
        pw.plan(fanuc, 14, estimate=estimate, as_prior=True, prior=False)
    with pytest.raises(pw.InputError, match="trials"):
        pw.study(fanuc, measurements, trials=3)


@pytest.mark.parametrize("name", ["exclude", "free", "refit", "only", "moved"])
def test_a_text_is_no_list_of_names(fanuc, measurements, name):
    with pytest.raises(pw.InputError, match=r"list of names: \['23'\]") as error:
        pw.calibrate(fanuc, measurements, **{name: "23"})
    assert error.value.field == name


@pytest.mark.parametrize("criterion", ["o2", "o4"])
def test_weights_are_no_worse_than_a_choice(criterion):
    J = np.random.default_rng(0).normal(size=(40, 2, 5))
    J[0] *= 100  # the ascent alone ends at 1.03, the best choice has 2.41 of o4
    found = pw.relax(J, 6, criterion=criterion)
    assert pw.select(J, 6, criterion=criterion).value <= found.value <= found.bound
    assert found.weights.sum() == pytest.approx(6, rel=1e-12)


def test_weights_show_themselves_in_a_notebook(blocks):
    assert "bound:" in pw.relax(blocks, 6)._repr_html_()
    with pytest.raises(pw.InputError, match="at least 3"):
        pw.relax(blocks, 2)  # no choice of two identifies eight parameters by three rows each


def test_the_names_of_criteria_are_nobodys(blocks):
    names = pw.indices(blocks).index
    names.name = "mine"
    with pytest.raises(ValueError):
        names.values[0] = "mine"
    assert pw.indices(blocks).index.name is None


def test_effort_stands_for_starts_and_proof(blocks):
    quick = pw.select(blocks, 6, criterion="v", effort="quick")
    assert quick == pw.select(blocks, 6, criterion="v", starts=1, proof=0)
    with pytest.raises(pw.InputError, match="quick"):
        pw.select(blocks, 6, effort="hard")


def test_priors(blocks):
    alone = pw.select(blocks, 2, criterion="a", prior=np.full(8, 0.5))
    assert alone.value == pytest.approx(
        1 / np.trace(np.linalg.inv(information(blocks[alone.poses]) + 4 * np.eye(8))), rel=1e-12
    )
    covariance = np.diag(np.full(8, 0.25))
    assert pw.select(blocks, 2, criterion="a", prior=covariance).value == pytest.approx(alone.value)
    scaled = pw.select(blocks * 0.5, 2, criterion="d", prior=True)
    assert scaled.value == pytest.approx(
        np.linalg.slogdet(information(0.5 * blocks[scaled.poses]) + np.eye(8))[1], rel=1e-12
    )


def information(blocks):
    stacked = blocks.reshape(-1, blocks.shape[-1])
    return stacked.T @ stacked


def test_tables_with_wrong_columns(fanuc, measurements):
    with pytest.raises(pw.InputError, match="measurements"):
        pw.calibrate(fanuc, measurements.drop(columns="q3_rad"))
    with pytest.raises(pw.InputError, match="measurements"):
        pw.calibrate(fanuc, measurements.iloc[:0])
    with pytest.raises(pw.InputError, match="DataFrame"):
        pw.calibrate(fanuc, measurements.to_numpy())
    with pytest.raises(pw.InputError, match="nowhere.csv"):
        pw.calibrate(fanuc, "nowhere.csv")
    with pytest.raises(pw.InputError, match="measurements"):
        pw.calibrate(fanuc, measurements.assign(q1_rad="x"))
    with pytest.raises(pw.InputError, match="q3"):
        fanuc.jacobian(measurements.drop(columns="q3_rad"))


def test_tables_that_are_none(fanuc, measurements):
    levels = measurements.set_axis(pd.MultiIndex.from_product([measurements.columns, ["a"]]), axis=1)
    with pytest.raises(pw.InputError, match="levels"):
        pw.calibrate(fanuc, levels)
    with pytest.raises(pw.InputError, match="complex numbers in q1_rad"):
        pw.calibrate(fanuc, measurements.assign(q1_rad=measurements["q1_rad"] + 1j))
    with pytest.raises(pw.InputError, match="q1_rad"):
        fanuc.jacobian(measurements.assign(q1_rad=measurements["q1_rad"] + 1j))
    with pytest.raises(pw.InputError, match="surrogates"):
        pw.calibrate(fanuc, measurements.assign(config="\ud800"))
    for wrong in ("x", 3, None, object()):
        for call in (lambda: pw.plan(wrong, 14), lambda: pw.calibrate(wrong, measurements),
                     lambda: pw.Plan.read("x", wrong), lambda: pw.select(wrong, 5)):
            with pytest.raises(pw.InputError):
                call()


def test_configurations_may_be_arrays(fanuc):
    q = np.random.default_rng(2).uniform(-0.3, 0.3, (30, 6))
    table = pd.DataFrame(q, columns=[f"{joint}_rad" for joint in fanuc.joints])
    chosen = pw.select(fanuc, 12, candidates=q)
    assert chosen.ids == pw.select(fanuc, 12, candidates=table).ids
    with pytest.raises(pw.InputError, match=r"\(poses, 6\)"):
        pw.select(fanuc, 12, candidates=q[:, :5])


def test_a_study_has_the_same_columns_whatever_is_known(blocks, fanuc):
    with_random = pw.study(blocks, poses=[4, 6], random=5, subsets={"mine": [0, 1, 2, 3]})
    without = pw.study(blocks, poses=[4, 6], random=0, subsets={"mine": [0, 1, 2, 3]})
    assert list(with_random.table.columns) == list(without.table.columns)
    assert without.table["random_value_p50"].isna().all()
    of_robot = [pw.study(fanuc, poses=12, trials=2, pool=40, random=n) for n in (0, 2)]
    assert list(of_robot[0].table.columns) == list(of_robot[1].table.columns)


def test_other_units_and_indices_give_the_same(fanuc, measurements):
    degrees = measurements.copy()
    for joint in fanuc.joints:
        degrees[f"{joint}_deg"] = np.degrees(degrees.pop(f"{joint}_rad"))
    expected = pw.calibrate(fanuc, measurements)
    found = pw.calibrate(fanuc, degrees)
    pd.testing.assert_series_equal(found.values, expected.values, rtol=1e-9)
    by_index = pw.calibrate(fanuc, measurements.set_index("config"))
    pd.testing.assert_series_equal(by_index.values, expected.values, rtol=0)
    np.testing.assert_allclose(
        fanuc.jacobian(degrees), fanuc.jacobian(measurements), rtol=1e-9, atol=1e-9
    )


@pytest.mark.parametrize("repeats", ["2", 0, float("nan"), True])
def test_what_is_no_number_of_repeats(fanuc, repeats):
    with pytest.raises(pw.InputError, match="repeats"):
        fanuc.jacobian(np.zeros((1, 6)), repeats=repeats)


@pytest.mark.parametrize("q", [np.zeros(5), np.zeros((2, 7)), np.full((1, 6), np.nan), "q", None])
def test_what_is_no_configuration(fanuc, q):
    with pytest.raises(pw.InputError, match="`q`"):
        fanuc.jacobian(q)


def test_jacobian_is_the_derivative_of_where_the_flange_is(fanuc, measurements):
    # A target at the flange would move as the base does; the base's first three columns are that.
    J = fanuc.jacobian(measurements.iloc[:4], scaled=False)
    assert J.shape == (4, 9, len(fanuc.parameters))
    np.testing.assert_allclose(J[:, :3, :3], np.broadcast_to(np.eye(3), (4, 3, 3)), atol=1e-12)
    frames = fanuc.flange(measurements.iloc[:4])
    np.testing.assert_allclose(J[:, :3, -9:-6], frames[:, :3, :3], atol=1e-12)


def test_campaigns_from_elsewhere(tmp_path):
    (tmp_path / "two.urdf").write_text(urdf)
    by_text = pw.Campaign.from_urdf(urdf, base="a", tip="c", sensor=tracker)
    by_path = pw.Campaign.from_urdf(tmp_path / "two.urdf", base="a", tip="c", sensor=tracker)
    assert by_text.joints == by_path.joints == ["q1", "q2"]
    pd.testing.assert_frame_equal(by_text.parameters, by_path.parameters)
    with pytest.raises(pw.InputError, match="urdf: has no link 'z'"):
        pw.Campaign.from_urdf(urdf, base="a", tip="z", sensor=tracker)
    rows = pd.DataFrame(
        {"a_mm": [0.0, 400.0], "alpha_deg": [90.0, 0.0], "d_mm": [300.0, 0.0], "theta_deg": 0.0,
         "joint": ["q1", "q2"], "limits_deg": [[-90, 90], [-60, 60]]}
    )
    assert pw.Campaign.from_dh(rows, sensor=tracker).joints == ["q1", "q2"]
    with pytest.raises(pw.InputError, match="robot has no key"):
        pw.Campaign.from_dict({"name": "x", "robot": {}})
    with pytest.raises(pw.InputError):
        pw.Campaign.from_dict({"name": object()})
    with pytest.raises(pw.InputError, match="nowhere"):
        pw.Campaign.from_yaml("nowhere.yaml")


def test_a_calibration_that_must_not_be_used_is_refused(fanuc, measurements):
    wrong = measurements.copy()
    wrong[["p1_x_mm", "p1_y_mm"]] = wrong[["p1_y_mm", "p1_x_mm"]].to_numpy()
    with pytest.raises(pw.InputError):
        pw.calibrate(fanuc, wrong)


def test_plans_say_what_is_missing(fanuc):
    for arguments in ({}, {"poses": 8, "target_mm": 1}):
        with pytest.raises(pw.InputError, match="poses"):
            pw.plan(fanuc, **arguments)
    with pytest.raises(pw.InputError, match="poses"):
        pw.plan(fanuc, 2, pool=100)
    with pytest.raises(pw.InputError, match="workspace_box_mm"):
        pw.plan(fanuc, 14, pool=100, workspace_box_mm=[1, 2])
    with pytest.raises(TypeError):
        pw.plan(fanuc, 14, polo=100)


def test_files_are_read_again(fanuc, measurements, tmp_path):
    estimate = pw.calibrate(fanuc, measurements)
    estimate.write(tmp_path / "estimate.json")
    again = pw.Estimate.read(tmp_path / "estimate.json", fanuc)
    pd.testing.assert_frame_equal(again.parameters, estimate.parameters)
    with pytest.raises(pw.InputError, match="is no plan"):
        pw.Plan.read(tmp_path / "estimate.json", fanuc)
    plan = pw.plan(fanuc, 14, pool=100, workspace_poses=30, estimate=estimate, as_prior=True)
    plan.write(tmp_path / "plan.json", csv=tmp_path / "poses.csv")
    assert len(pw.Plan.read(tmp_path / "plan.json", fanuc)) == 14
    assert (tmp_path / "poses.csv").exists()


def test_a_calibration_from_points_and_a_plan(tmp_path):
    campaign = pw.Campaign.from_yaml(designs / "cell_demo" / "campaign.yaml")
    plan = pw.plan(campaign, 16, criterion="d", pool=400, workspace_poses=50, effort="quick")
    targets = plan.targets
    points = targets.loc[targets["visible"] == "yes", ["name", "x_mm", "y_mm", "z_mm"]]
    estimate = pw.calibrate(campaign, points.sample(frac=1, random_state=1), plan=plan, force=True)
    assert estimate.accuracy.loc["fit", "distance_rms_mm"] < 1e-3


def test_study_of_blocks(blocks):
    study = pw.study(blocks, poses=[4, 6], criteria=["d", "v"], random=30,
                     subsets={"mine": [0, 1, 2, 3]})
    assert list(study["poses"]) == [4, 4, 6, 6]
    row = study.table.iloc[0]
    assert row["value"] == pytest.approx(pw.select(blocks, 4).value)
    assert row["mine_value"] == pytest.approx(pw.indices(blocks, [0, 1, 2, 3])["d"])
    assert row["random_efficiency_p95"] <= row["efficiency"] <= 1
    for wrong, words in [
        ({"poses": []}, ""),
        ({"poses": [0]}, "poses"),
        ({"poses": [4], "criteria": "z"}, "criteria"),
        ({"poses": [4], "trials": 3}, "campaign"),
        ({"poses": [4], "subsets": [1, 2]}, "subsets"),
        ({"poses": [4], "subsets": {"mine": [99]}}, "99"),
    ]:
        with pytest.raises(pw.InputError, match=words):
            pw.study(blocks, **wrong)


def test_warnings_point_at_the_caller(fanuc, measurements, recwarn):
    pw.calibrate(fanuc, measurements.assign(note=1), folds=0)
    pw.select(fanuc, 12, measurements=measurements.assign(note=1), starts=1)
    assert len(recwarn) >= 2 and {one.filename for one in recwarn} == {__file__}


def test_a_repaired_plan_says_what_was_kept(fanuc):
    plan = pw.plan(fanuc, 14, pool=100, workspace_poses=30)
    dropped = plan.document["poses"][0]["id"]
    repaired = pw.plan(fanuc, repair=plan, drop=[dropped], pool=100, workspace_poses=30)
    assert len(repaired) == 14 and "13 kept" in str(repaired)
    assert not any("/posewise" in one for one in (str(repaired), str(repaired.document)))
    with pytest.raises(pw.InputError, match="kept of repair"):
        pw.plan(fanuc, 5, repair=plan, pool=100, workspace_poses=30)
