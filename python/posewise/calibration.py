"""Calibrations: the robot's errors from measurements, and what to expect of it then."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from . import _posewise
from ._calls import InputError, Progress, as_json, call_options, check_kind, made, names
from ._files import FilePath, Files, Input, Table, given, table, write_file
from ._keywords import check_keywords
from ._results import OneOfSeveral, Result, read_result, result_input, symmetric, target_of
from .campaign import Campaign, Configurations

if TYPE_CHECKING:
    from .planning import Plan


@dataclass(frozen=True)
class Estimate(Result):
    """What a calibration found. Data only: it can be pickled."""

    campaign: Campaign
    json: str = field(repr=False)  #: the estimate file, as ``posewise calibrate --out`` writes it
    text: str = ""  #: what the command prints
    doubts: list[str] = field(default_factory=list)  #: what should be looked at first
    _inputs: dict[str, Input] = field(default_factory=dict, repr=False, compare=False)
    _options: dict[str, Any] = field(default_factory=dict, repr=False, compare=False)

    @classmethod
    def read(cls, path: FilePath, campaign: Campaign) -> Estimate:
        """An estimate of that campaign's robot and instrument from its file."""
        check_kind(campaign, Campaign, "campaign", is_needed=True)
        text = read_result(path, "estimate")
        with Files():
            _posewise.check_estimate(os.fspath(path), campaign._core)
        return cls(campaign, text, "", list(json.loads(text).get("warnings", [])))

    @cached_property
    def document(self) -> dict[str, Any]:
        """The estimate file as a dict; posewise help json explains its keys."""
        found: dict[str, Any] = json.loads(self.json)
        return found

    @cached_property
    def covariance(self) -> pd.DataFrame:
        """Covariance of all parameters, m and rad."""
        stated = self.document["covariance"]
        index = pd.Index(stated["parameters"], name="parameter")
        return pd.DataFrame(symmetric(stated["rows_si"]), index=index, columns=index)

    @cached_property
    def parameters(self) -> pd.DataFrame:
        """Value and standard deviation (sigma) of each parameter, with its unit, m or rad.

        base.x to base.rz are the base's position and rotation vector in the instrument's frame;
        their deviations are those of a small step about it.
        """
        index = self.covariance.index
        values = _values(self.document)
        sigma = pd.Series(np.sqrt(np.diag(self.covariance)), index=index)
        units = {name: unit for name, (_, unit) in values.items()}
        return pd.DataFrame(
            {
                "value": [values.get(name, (np.nan, ""))[0] for name in index],
                "sigma": sigma.to_numpy(),
                "unit": [units.get(name, "") for name in index],
            },
            index=index,
        )

    @property
    def values(self) -> pd.Series:
        """Value of each parameter, m or rad."""
        return self.parameters["value"]

    @property
    def accuracy(self) -> pd.DataFrame:
        """Errors in mm (mrad): nominal (base and targets fitted), fit, fit_means,
        held_out and held_out_means; means are those of each configuration's samples."""
        stated = dict(self.document["accuracy"])
        rows = {
            name: stated[name] for name in ("nominal", "fit", "fit_means") if stated.get(name)
        }
        if stated.get("held_out"):
            rows["held_out"] = stated["held_out"]["samples"]
            rows["held_out_means"] = stated["held_out"]["means"]
        plain = {
            name: {key: number for key, number in row.items() if not isinstance(number, dict)}
            for name, row in rows.items()
        }
        return pd.DataFrame(plain).T

    @property
    def held_out(self) -> pd.Series | None:
        """Errors of means at poses held out in turn, over all folds; None if none were: all RMS but
        the maxima, mm (mrad)."""
        accuracy = self.accuracy
        return accuracy.loc["held_out_means"] if "held_out_means" in accuracy.index else None

    def predict(self, q: Configurations) -> pd.DataFrame:
        """Error to expect of one reading at each configuration, as ``calibrate --predict-out``.

        RMS by the parameters, left over by the model and noise of the instrument, their total, and
        what 95 % keep; over all of them in ``.attrs``.
        """
        with Files() as files:
            estimate = files.text("estimate", self.json)
            configurations = self.campaign.configurations(q)
            if len(configurations) == 0:
                raise InputError("`q` has no configurations; must have some to predict")
            tables = _posewise.predict(self.campaign._core, estimate, configurations)
        index = q.index if isinstance(q, pd.DataFrame) else None
        frames: list[pd.DataFrame] = []
        overall: dict[str, float] = {}
        for is_angle, found in tables:
            unit = "mrad" if is_angle else "mm"
            columns = [f"{part}_{unit}" for part in ("parameters", "left_over", "noise", "total", "p95")]
            frames.append(pd.DataFrame(1000 * found[:-1], index=index, columns=columns))
            overall.update(zip(columns, (1000 * found[-1]).tolist()))
        frame = pd.concat(frames, axis=1)
        frame.attrs.update(overall)
        return frame

    def write(self, path: FilePath) -> None:
        """Writes the estimate file, all or nothing.

        It names the files that it was made from. What was given in memory is written beside it
        first: estimate.measurements.csv, estimate.campaign.yaml for a campaign that is no file.
        """
        target = target_of(path)
        if not self._inputs:  # it was read from a file
            return write_file(target, self.json.encode())
        beside = {
            name: _seen_from(target, one.beside(target, name)) for name, one in self._inputs.items()
        }
        document = dict(self.document)
        beside = _as_lists(beside)
        document["measurements"] = ", ".join(beside["measurements"])
        document["made_from"] = {
            **document["made_from"],
            "campaign_file": _seen_from(target, self.campaign.beside(target)),
            "options": _as_options({**self._options, **beside}),
        }
        write_file(target, json.dumps(document, indent=1, ensure_ascii=False).encode())

    def plot(self, ax: Any = None) -> Any:
        """Draws nominal and calibrated error of held-out poses; needs matplotlib."""
        from .drawing import axes

        ax = axes(ax)
        accuracy = self.accuracy["distance_rms_mm"]
        accuracy.plot.bar(ax=ax, rot=30)
        ax.set_ylabel("RMS distance / mm")
        ax.set_yscale("log")
        return ax


def _seen_from(target: Path, path: str) -> str:
    return path if os.path.isabs(path) else os.path.relpath(path, target.parent)


def _as_options(keywords: Mapping[str, Any]) -> dict[str, list[str]]:
    """Keywords as the options of the program that do the same."""
    others = {"estimate": "from"}
    stated: dict[str, list[str]] = {}
    for key, value in keywords.items():
        if value is None or (value is False and key != "prior"):
            continue
        if key == "measurements" and len(value) < 2:
            continue
        option = "no-prior" if value is False else others.get(key, key.replace("_", "-"))
        values = value if isinstance(value, list) else ["true" if isinstance(value, bool) else value]
        stated["--" + option] = [str(one) for one in values]
    return stated


def _values(document: dict[str, Any]) -> dict[str, tuple[float, str]]:
    """Value and unit of every parameter that the file states."""
    values: dict[str, tuple[float, str]] = {}
    base = document.get("base")
    if base:
        for axis, number in zip("xyz", base["position_m"]):
            values[f"base.{axis}"] = (number, "m")
        for axis, number in zip("xyz", _rotation_vector(base["quaternion_wxyz"])):
            values[f"base.r{axis}"] = (number, "rad")
    for name, one in document.get("robot", {}).items():
        for unit in ("m", "rad"):
            if f"value_{unit}" in one:
                values[name] = (one[f"value_{unit}"], unit)
    for name, one in document.get("targets", {}).items():
        if isinstance(one, dict):
            for axis, number in zip("xyz", one["position_m"]):
                values[f"{name}.{axis}"] = (number, "m")
    for key, number in document.get("sensor", {}).items():
        name, _, unit = key.rpartition("_")
        values[name or key] = (number, unit if name else "")  # numbers of a lens have none
    return values


def _rotation_vector(quaternion: Sequence[float]) -> np.ndarray[Any, Any]:
    w, *xyz = quaternion
    vector = np.array(xyz)
    norm = float(np.linalg.norm(vector))
    if norm == 0:
        return np.zeros(3)
    turned: np.ndarray[Any, Any] = vector * (
        2 * np.arctan2(norm, abs(w)) * np.sign(w or 1.0) / norm
    )
    return turned


def calibrate(
    campaign: Campaign,
    measurements: Table | Sequence[Table],
    *,
    plan: Plan | Sequence[Plan] | None = None,
    points_unit: str | None = None,
    validate: Table | None = None,
    refit: Sequence[str] | None = None,
    limit_mm: float | None = None,
    exclude: Sequence[Any] = (),
    free: Sequence[str] | None = None,
    prior: bool | None = None,
    sizes: str | None = None,
    method: str | None = None,
    loss: str | None = None,
    loss_width: float | None = None,
    folds: int | None = None,
    model_selection: bool | None = None,
    estimate: Estimate | None = None,
    as_prior: bool | None = None,
    only: Sequence[str] | None = None,
    moved: Sequence[str] | None = None,
    force: bool = False,
    threads: int | None = None,
    time: float | None = None,
    progress: Progress = None,
) -> Estimate:
    """Finds base, targets and the robot's errors from measurements, and judges them.

    ``measurements`` is a DataFrame with the columns of the CSV file (config, q1_deg, ..., p1_x_mm,
    ...; without config the index names the configurations), or the path of a file. With ``plan`` it
    may be an instrument's list of points (name, x, y, z), and only the plan's poses calibrate;
    others judge. Lists of measurements and of the plans that they are of, in the same order, are
    calibrated together; their ids are then plan1/p3, plan2/p3 and so on. ``validate`` is measured elsewhere, only to judge. ``exclude`` are ids to leave out
    ([7, "9-12"]). By default every configuration is held out in turn up to 100 of them, else 10
    ``folds``; 0 holds none out. Other options, with their defaults, are those of ``posewise
    calibrate --help``.

    What is doubtful is warned of as :class:`posewise.Doubt`. What must not be used raises InputError;
    ``force=True`` takes it all the same. ``time`` ends it after that many seconds with what there is
    by then, which a Doubt says; Ctrl-C raises :class:`posewise.Interrupted` with that as ``result``,
    or KeyboardInterrupt where there is nothing yet. ``progress`` is called as ``progress(done,
    total)``, see :func:`posewise.plan`.
    """
    check_kind(campaign, Campaign, "campaign", is_needed=True)
    check_kind(estimate, Estimate, "estimate")
    if measurements is None:
        raise InputError("calibrate(): needs `measurements`")
    measured = _measured_inputs(measurements, plan)
    keywords = {
        "points_unit": points_unit,
        "refit": names("refit", refit),
        "limit_mm": limit_mm,
        "exclude": names("exclude", exclude),
        "free": names("free", free),
        "prior": prior,
        "sizes": sizes,
        "method": method,
        "loss": loss,
        "loss_width": loss_width,
        "folds": folds,
        "model_selection": model_selection,
        "as_prior": as_prior,
        "only": names("only", only),
        "moved": names("moved", moved),
        "force": force,
    }
    inputs = given({
        "validate": table(validate, "validate"),
        "estimate": result_input(estimate),
    })
    check_keywords("calibrate", {**keywords, **inputs, **_as_lists(measured)}, "a campaign")
    inputs = {**measured, **inputs}
    options = call_options(threads, time, progress)
    with Files() as files:
        stated = as_json("calibrate", {**keywords, **_as_lists(files.open(inputs))})
        document, text, doubts = files.named(_posewise.calibrate(campaign._core, stated, options))
    found = Estimate(campaign, document, text, doubts, inputs, keywords)
    return made(found, doubts, options)


def _measured_inputs(
    measurements: Table | Sequence[Table], plan: Plan | Sequence[Plan] | None
) -> dict[str, Input]:
    """Measurements and plan; of several plans measurements1, plan1, measurements2 and so on."""
    from .planning import Plan

    if not isinstance(measurements, (list, tuple)) and not isinstance(plan, (list, tuple)):
        check_kind(plan, Plan, "plan")
        single = plan if isinstance(plan, Plan) else None
        return given({
            "measurements": table(measurements, "measurements"), "plan": result_input(single)
        })
    tables = list(measurements) if isinstance(measurements, (list, tuple)) else [measurements]
    plans = list(plan) if isinstance(plan, (list, tuple)) else [plan]
    if len(tables) != len(plans) or not plans:
        raise InputError(
            f"`measurements` is a list of {len(tables)}, `plan` of {len(plans)}; must be equally "
            "many, at least one, so that each has the plan whose poses it is of"
        )
    inputs: dict[str, Input | None] = {}
    for number, (one, own) in enumerate(zip(tables, plans), 1):
        check_kind(own, Plan, "plan", is_needed=True)
        if one is None:
            raise InputError(f"`measurements` has nothing at place {number}; must have a table")
        if any(own is other for other in plans[: number - 1]):
            raise InputError("`plan` has the same one twice; must have different ones")
        ending = str(number) if len(plans) > 1 else ""
        inputs["measurements" + ending] = table(one, "measurements")
        inputs["plan" + ending] = OneOfSeveral(own) if ending else result_input(own)
    return given(inputs)


def _as_lists(values: Mapping[str, Any]) -> dict[str, Any]:
    """Measurements and plans in lists, as they are stated to the library; the rest unchanged."""
    lists: dict[str, Any] = {}
    for key, value in values.items():
        name = key.rstrip("0123456789")
        if name in ("measurements", "plan"):
            lists.setdefault(name, []).append(value)
        else:
            lists[key] = value
    return lists
