"""Calls of every public function with what people hand over by mistake.

Each call must return what holds no NaN where a number is promised, or raise InputError (or TypeError,
for keywords that there are none of) with a sentence. Run by itself it makes 2000 calls:

    python3 tests/python/fuzz_calls.py [count] [first seed]
"""

import contextlib
import copy
import pathlib
import sys
import tempfile
import traceback
import warnings

import numpy as np
import pandas as pd

import posewise as pw

urdf = """<robot name="two"><link name="a"/><link name="b"/><link name="c"/>
<joint name="q1" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>
<limit lower="-2" upper="2" velocity="1" effort="1"/></joint>
<joint name="q2" type="revolute"><parent link="b"/><child link="c"/><origin xyz="0.5 0 0"/>
<axis xyz="0 1 0"/><limit lower="-1" upper="1" velocity="1" effort="1"/></joint></robot>"""
tracker = {"kind": "points", "sigma_mm": 0.05, "targets": {"count": 3}}
robot = {"errors": "offsets"}


class Rude:
    """Of a class that answers nothing."""

    def __array__(self, *arguments, **keywords):
        raise ZeroDivisionError("rude")

    def __repr__(self):
        raise ZeroDivisionError("rude")


class Setting:
    """Right arguments, to be made wrong."""

    def __init__(self, folder):
        self.folder = folder
        (folder / "two.urdf").write_text(urdf)
        self.urdf = str(folder / "two.urdf")
        base = {"position_mm": [0, 0, 0], "rpy_deg": [0, 0, 0]}
        self.campaign = pw.Campaign.from_urdf(
            urdf, tip="c", sensor=tracker, robot={**robot, "base_link": "a"}, base=base
        )
        rng = np.random.default_rng(7)
        self.q = rng.uniform(-0.9, 0.9, (12, 2))
        self.J = rng.normal(size=(15, 2, 4))
        frames = self.campaign.flange(self.q)
        points = np.array([[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]])
        seen = np.einsum("pij,tj->pti", frames[:, :3, :3], points) + frames[:, None, :3, 3]
        seen += rng.normal(scale=5e-5, size=seen.shape)
        columns = [f"p{t}_{axis}_m" for t in (1, 2, 3) for axis in "xyz"]
        self.table = pd.DataFrame(
            np.hstack([self.q, seen.reshape(12, 9)]), columns=["q1_rad", "q2_rad", *columns]
        )
        self.estimate = pw.calibrate(self.campaign, self.table, force=True, folds=0)
        self.plan = pw.plan(self.campaign, 8, pool=60, workspace_poses=10, starts=1)
        self.choice = pw.select(self.J, 6)
        self.files = [str(folder / name) for name in ("e.json", "p.json", "c.yaml", "m.csv")]
        self.estimate.write(self.files[0])
        self.plan.write(self.files[1])
        self.campaign.write(self.files[2])
        self.table.to_csv(self.files[3])

    def calls(self):
        """Functions, right positional arguments and keywords to draw some of."""
        c, J, q, table = self.campaign, self.J, self.q, self.table
        e, p, _, _ = self.files
        search = {"seed": 3, "time": 5, "threads": 2, "progress": lambda done, total: None, "starts": 2}
        earlier = {"estimate": self.estimate, "as_prior": True, "only": ["robot"], "moved": ["base"]}
        blocks = {"rows": 2, "prior": [1, 2, 3, 4.0], "held": J[:2], "test_poses": J[3:5]}
        choice = {"criterion": "d", "exclude": [3], "groups": [0, 1, 2] * 5, "per_group": 3,
                  "repeat_limit": 2, "proof": 0.1}
        return [
            (pw.select, [J, 6], {**choice, **blocks, **search}),
            (pw.select, [c, 8], {**choice, **search, **earlier, "measurements": table, "random": 30,
                                 "candidates": q, "held": table, "test_poses": q, "prior": True,
                                 "least_distance_deg": 1, "focus": "robot", "repeats": 2, "force": True}),
            (pw.relax, [J, 6], {**blocks, "criterion": "a", "exclude": [3], "repeat_limit": 2,
                                "seed": 3, "time": 5, "threads": 2}),
            (pw.relax, [c, 8], {**earlier, "measurements": table, "random": 30, "candidates": q,
                                "held": table, "test_poses": q, "prior": True, "focus": "robot",
                                "repeats": 2, "force": True, "time": 5}),
            (pw.design, [J[:, 0], 6], {**choice, **search, "prior": True}),
            (pw.indices, [J], {**blocks, "poses": [1, 2, 5]}),
            (pw.plan, [c, 8], {**search, **earlier, "pool": 60, "workspace_poses": 10, "held": table,
                               "workspace": q, "repair": self.plan, "drop": ["p1"], "target_mm": 1,
                               "minutes": 5, "quantity": "p95", "assurance": 0.9, "poses_at_most": 9,
                               "robust_to": 1, "criterion": "v", "prior": True, "focus": "robot",
                               "workspace_target": 1, "verification": 1, "random_order": 2,
                               "workspace_box_mm": [-900, -900, -900, 900, 900, 900], "repeats": 2,
                               "force": False}),
            (pw.calibrate, [c, table], {**earlier, "time": 5, "threads": 1, "plan": self.plan,
                                        "points_unit": "mm", "validate": table, "refit": ["base"],
                                        "limit_mm": 1, "exclude": [2], "free": ["dq2"], "prior": True,
                                        "sizes": "stated", "method": "lm", "loss": "huber",
                                        "loss_width": 2, "folds": 3, "model_selection": True,
                                        "force": True}),
            (pw.study, [J], {**blocks, "poses": [5, 7], "criteria": ["d"], "random": 5, "exclude": [1],
                             "subsets": {"mine": [1, 2, 3, 4]}, "repeat_limit": 1, "proof": 0, "seed": 1}),
            (pw.study, [c], {"measurements": table, "poses": [8], "criteria": "d", "random": 3, "splits": 2,
                             "holdout": 0.3, "trials": 2, "pool": 40, "test_poses": 10, "repeats": 1,
                             "refine": False, "force": True, "seed": 1, "time": 5, "prior": True,
                             "precision": 0.5, "least_distance_deg": 1, "exclude": [1]}),
            (c.jacobian, [q], {"scaled": True, "repeats": 2, "threads": 1}),
            (c.flange, [q], {}),
            (c.configurations, [q], {}),
            (self.estimate.predict, [q], {}),
            (pw.Estimate.read, [e, c], {}),
            (pw.Plan.read, [p, c], {}),
            (pw.Campaign.from_yaml, [self.files[2]], {}),
            (pw.Campaign.from_dict, [{"name": "x", "robot": {**robot, "urdf": self.urdf}, "sensor": tracker}],
             {}),
            (pw.Campaign.from_urdf, [urdf], {"base": "a", "tip": "c", "sensor": tracker, "robot": robot,
                                             "name": "r", "model_error_mm": 0.1}),
            (pw.Campaign.from_dh, [[{"a_mm": 9, "alpha_deg": 90, "d_mm": 300, "theta_deg": 0,
                                     "joint": "q1", "limits_deg": [-90, 90]}]],
             {"sensor": tracker, "robot": robot, "convention": "modified"}),
            (pw.Sensor, [lambda frame, unknowns: frame[:3, 3], ["x_m", "y_m", "z_m"], 1e-4], {}),
            (self.estimate.write, [e], {}),
            (self.plan.write, [p], {"csv": str(self.folder / "p.csv")}),
            (self.choice.write, [str(self.folder / "choice.json")], {}),
        ]


def odd_array(rng, array):
    """The same numbers otherwise, other ones, or too many."""
    array = np.asarray(array)
    if array.dtype.kind not in "fiu" or array.ndim == 0:
        return array.tolist()
    poked = array.astype(float)
    poked.flat[rng.integers(poked.size) if poked.size else 0:][:1] = rng.choice(
        [np.nan, np.inf, -np.inf, 1e300, -1e-300, 0, 1e18]
    )
    kinds = rng.choice(["f4", "f2", ">f8", "i8", "u1", "c16", "O", "U8", "g", "?", "M8[s]"])
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        return [
            lambda: poked,
            lambda: poked.tolist(),
            lambda: array.astype(kinds) if kinds != "M8[s]" else array.astype("i8").astype(kinds),
            lambda: np.asfortranarray(array),
            lambda: np.repeat(array, 2, axis=0)[::2],
            lambda: array[::-1],
            lambda: array[:0],
            lambda: array[..., :0],
            lambda: array[:1],
            lambda: array[..., :-1],
            lambda: array.T,
            lambda: array.ravel(),
            lambda: array[None],
            lambda: np.broadcast_to(array, (2, *array.shape)),
            lambda: np.broadcast_to(array.flat[0], array.shape),
            lambda: np.ma.masked_array(array, array > 0.5),
            lambda: np.asmatrix(array) if array.ndim < 3 else np.asmatrix(array[0]),
            lambda: pd.DataFrame(array.reshape(len(array), -1)),
            lambda: pd.Series(array.ravel()),
            lambda: array.tolist()[:-1] + [[1]],
            lambda: array * 1e160,
            lambda: array * 1e-170,
        ][rng.integers(22)]()


def odd_table(rng, table):
    """The table otherwise, or what is nearly one."""
    column = rng.choice(table.columns)
    other = table.copy()
    row = rng.integers(len(table))
    return [
        lambda: other.drop(columns=column),
        lambda: other.rename(columns={column: rng.choice(["q1_deg", "x", "", "q9_rad", "p1_x_um", "config"])}),
        lambda: other.assign(**{column: rng.choice(["a", "", "1,2", '"', "\ud800"])}),
        lambda: other.assign(**{column: other[column] + 1j}),
        lambda: other.assign(**{column: rng.choice([np.nan, np.inf, 1e300, 1e-300])}),
        lambda: other.drop(row).reindex(other.index),
        lambda: other.iloc[:0],
        lambda: other.iloc[:, :0],
        lambda: other.iloc[[row]],
        lambda: pd.concat([other, other], axis=1),
        lambda: pd.concat([other, other]),
        lambda: other.set_axis(pd.MultiIndex.from_product([other.columns, ["a"]]), axis=1),
        lambda: other.set_index([column, other.index]),
        lambda: other.set_index(column),
        lambda: other.astype("Float64"),
        lambda: other.astype(str),
        lambda: other.astype("category"),
        lambda: other.astype("float16"),
        lambda: other.iloc[::-1, ::-1],
        lambda: other.assign(config=rng.choice(["7", 7, None, "a b", "a,b"])),
        lambda: other.T,
        lambda: other.to_dict(),
        lambda: other * 1e6,
    ][rng.integers(23)]()


def deep():
    inner = [1.0]
    for _ in range(2000):
        inner = [inner]
    return inner


def odd_value(rng, value):
    """Something else in place of the value."""
    if rng.random() < 0.6:
        with contextlib.suppress(ValueError, TypeError, OverflowError):  # NumPy has no such array
            if isinstance(value, pd.DataFrame):
                return odd_table(rng, value)
            if isinstance(value, (np.ndarray, list)):
                return odd_array(rng, value)
        if isinstance(value, dict) and value:
            changed = copy.deepcopy(value)
            key = rng.choice(list(changed))
            changed[key] = odd_value(rng, changed[key])
            return changed
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            return rng.choice([value + 1, value * 2, -value, 0, value + 0.5, value * 1e9, np.nan])
    endless = []
    endless.append(endless)
    others = [None, True, False, 0, -1, 2, 10**30, 1e-320, np.nan, np.inf, 1j, "", "23", "x", "\ud800", "a\0b",
              b"23", [], {}, (), [None], [[]], ["x"], [1, 2], ["base"], {"a": 1}, {1, 2}, range(3), object(),
              Rude(), endless, deep(), np.array(3), np.float32(2), np.str_("d"), pd.NA, pd.NaT,
              np.datetime64("2020-01-01"), lambda *a: None, int, self_iterating(), np.zeros((2, 2)),
              pd.DataFrame(), pd.Series(dtype=float), "/", "nowhere.csv"]
    return others[rng.integers(len(others))]


def self_iterating():
    return iter([1, 2])


def draw(setting, seed):
    """A function and arguments, some of them wrong."""
    rng = np.random.default_rng(seed)
    calls = setting.calls()
    function, arguments, keywords = calls[seed % len(calls)]
    taken = {key: value for key, value in keywords.items() if rng.random() < 1.5 / max(len(keywords), 2)}
    needed = {
        pw.plan: {"pool": 60, "workspace_poses": 10, "starts": 1},
        pw.study: {"random": 2, "poses": [8]},
        pw.calibrate: {"force": True},
        pw.Campaign.from_urdf: {"sensor": tracker, "tip": "c"},
        pw.Campaign.from_dh: {"sensor": tracker},
    }.get(function, {})
    if function is pw.select and not {"random", "measurements", "candidates"} & set(taken):
        needed = {"random": 30} if isinstance(arguments[0], pw.Campaign) else {}
    if "workspace" in taken or "workspace_box_mm" in taken:
        needed = {"pool": 60, "starts": 1}
    taken = {**needed, **taken}
    places = [*range(len(arguments)), *taken]
    wrong = rng.permutation(len(places))[: rng.choice([0, 1, 1, 1, 2])]
    for place in [places[i] for i in wrong]:
        if isinstance(place, int):
            arguments[place] = odd_value(rng, arguments[place])
        else:
            taken[place] = odd_value(rng, taken[place])
    if rng.random() < 0.03:
        taken[rng.choice(["polo", "posess", "J"])] = 1
    if function is pw.plan and not isinstance(taken.get("minutes"), type(None)):
        taken.setdefault("poses_at_most", 9)
    if function in (pw.plan, pw.study, pw.select, pw.calibrate) and taken.get("time") is None:
        taken["time"] = 5
    return function, arguments, taken


def has_nan(result):
    """Whether a promised number is none."""
    if isinstance(result, (pw.Choice, pw.Plan)):
        return np.isnan(result.value) or np.isnan(result.document["search"]["starts"])
    if isinstance(result, pw.Estimate):
        return bool(result.parameters[["value", "sigma"]].isna().any(axis=None))
    if isinstance(result, pw.Study):
        return bool(result.table["poses"].isna().any())
    if isinstance(result, (np.ndarray, pd.DataFrame, pd.Series)):
        return bool(np.isnan(np.asarray(result, dtype=float)).any())
    return False


def failure_of(setting, seed):
    """What is wrong with a call, or "" if nothing is."""
    function, arguments, keywords = draw(setting, seed)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            result = function(*arguments, **keywords)
    except pw.InputError as error:
        words = str(error)
        is_sentence = len(words) > 15 and " " in words and len(words) < 2000
        return "" if is_sentence else f"no sentence: {words[:300]!r}"
    except TypeError as error:
        is_ours = any(
            words in str(error) for words in ("unexpected keyword", "multiple values", "missing 1 required")
        )
        return "" if is_ours else "".join(traceback.format_exception(error))
    except Exception as error:
        return "".join(traceback.format_exception(error))
    return "a NaN in the result" if has_nan(result) else ""


def run(count, first=0, say=None):
    """Failures of so many calls, by seed."""
    failures = {}
    with (
        tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder), warnings.catch_warnings()
    ):
        warnings.simplefilter("ignore")
        setting = Setting(pathlib.Path(folder))
        for seed in range(first, first + count):
            if say:
                say(seed)
            if words := failure_of(setting, seed):
                failures[seed] = words
    return failures


if __name__ == "__main__":
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 2000
    first = int(sys.argv[2]) if len(sys.argv) > 2 else 0
    found = run(count, first, lambda seed: print(seed, end="\r", file=sys.stderr, flush=True))
    for seed, words in found.items():
        print(f"---- {seed}\n{words}")
    print(f"{count} calls, {len(found)} wrong")
    sys.exit(1 if found else 0)
