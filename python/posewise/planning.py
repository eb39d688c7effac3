"""Plans: which poses to measure, from nothing."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd

from . import _posewise
from ._calls import InputError, Progress, as_json, call_options, check_kind, made, names
from ._files import FilePath, Files, Input, Places, Table, check_path, given, places, read_table, table
from ._keywords import check_keywords
from ._results import (
    Result,
    as_stated,
    read_result,
    result_input,
    sources_of,
    target_of,
    with_sources,
)
from .calibration import Estimate
from .campaign import Campaign
from .choice import findings


@dataclass(frozen=True)
class Plan(Result):
    """Poses to measure, in visiting order. Data only: it can be pickled.

    Like its DataFrame :attr:`poses`, it has a length and columns.
    """

    campaign: Campaign
    document: dict[str, Any] = field(repr=False)  #: as ``posewise plan --json`` prints it
    text: str = ""
    warnings: list[str] = field(default_factory=list, repr=False)
    _inputs: dict[str, Input] = field(default_factory=dict, repr=False, compare=False)

    @classmethod
    def read(cls, path: FilePath, campaign: Campaign) -> Plan:
        """A plan of that campaign from its file; :meth:`verify` reads the files that it names."""
        check_kind(campaign, Campaign, "campaign", is_needed=True)
        document = json.loads(read_result(path, "plan"))
        with Files():
            _posewise.check_plan(os.fspath(path), campaign._core)
        folder = os.path.dirname(os.path.abspath(path))
        return cls(campaign, document, "", [], sources_of(document, folder))

    @cached_property
    def poses(self) -> pd.DataFrame:
        """The configurations as ``posewise plan --csv`` writes them, with verification poses and
        points to pass on the way."""
        return self._table("csv")

    @cached_property
    def targets(self) -> pd.DataFrame:
        """Where the instrument finds each target at each pose; for sensors of points."""
        return self._table("targets")

    def _table(self, kind: str) -> pd.DataFrame:
        with Files() as files:
            path = files.path(kind, ".csv")
            self._write(files.path("out", ".json"), {}, **{kind: path})
            return read_table(path)

    @property
    def predicted(self) -> pd.Series:
        """Position error to expect over the workspace once calibrated, mm."""
        if "accuracy" in self.document:
            return pd.Series(self.document["accuracy"], name="predicted", dtype=float)
        stated = self.document.get("predicted") or {}  # of a file
        return pd.Series(
            {f"{name}_mm": 1e3 * stated.get(f"position_error_{name}_m", np.nan)
             for name in ("rms", "p95")},
            name="predicted",
        )

    @property
    def value(self) -> float:
        """Value of the criterion; larger is better."""
        return float(-np.inf if self.document["value"] is None else self.document["value"])

    @property
    def other_counts(self) -> pd.DataFrame:
        """What other numbers of poses are expected to reach, mm."""
        rows = self.document.get("other_counts", [])
        return pd.DataFrame(
            [{"poses": row["new_pose_count"], **(row["accuracy"] or {})} for row in rows]
        )

    def verify(self) -> pd.DataFrame:
        """Checks every pose, the value and the predictions again; one row for each finding."""
        with Files() as files:
            stated = with_sources(self.document, files.open(self._inputs))
            plan = json.dumps(stated)
            result = _posewise.verify(plan, self.campaign._core, [])
        return findings(result[0])

    def write(
        self, path: FilePath, *, csv: FilePath | None = None, targets: FilePath | None = None
    ) -> None:
        """Writes the plan file, and its configurations and targets as tables; all or none.

        It names the files that the plan was made from. What was given in memory is written beside
        it first: plan.held.csv for ``held``, plan.campaign.yaml for a campaign that is no file.
        """
        target = target_of(path)
        paths = {name: one.beside(target, name) for name, one in self._inputs.items()}
        paths["campaign"] = self.campaign.beside(target)
        tables = {
            name: check_path(one, name)
            for name, one in (("csv", csv), ("targets", targets))
            if one is not None
        }
        with Files():
            self._write(str(target), paths, **tables)

    def _write(
        self, path: str, paths: dict[str, str], csv: str = "", targets: str = ""
    ) -> None:
        plan = json.dumps(with_sources(self.document, paths))
        _posewise.write_plan(plan, path, self.campaign._core, csv, targets, self.warnings)

    def __len__(self) -> int:
        return len(self.document["poses"])

    def __getitem__(self, column: Any) -> Any:
        return self.poses[column]

    def plot(self, ax: Any = None) -> Any:
        """Draws the flange's places from above; needs matplotlib."""
        from .drawing import axes

        ax = axes(ax)
        frames = self.campaign.flange(self.poses)
        ax.plot(frames[:, 0, 3], frames[:, 1, 3], "o-", markersize=4, linewidth=0.5)
        ax.set_xlabel("x / m")
        ax.set_ylabel("y / m")
        ax.set_aspect("equal")
        return ax


def plan(
    campaign: Campaign,
    poses: int | None = None,
    *,
    target_mm: float | None = None,
    minutes: float | None = None,
    quantity: str | None = None,
    assurance: float | None = None,
    poses_at_most: int | None = None,
    robust_to: int | None = None,
    criterion: str | None = None,
    prior: bool | None = None,
    focus: str | None = None,
    held: Table | None = None,
    repair: Plan | None = None,
    drop: Sequence[str] | None = None,
    estimate: Estimate | None = None,
    as_prior: bool | None = None,
    only: Sequence[str] | None = None,
    moved: Sequence[str] | None = None,
    workspace: Places | None = None,
    workspace_poses: int | None = None,
    workspace_box_mm: Sequence[float] | None = None,
    workspace_target: int | None = None,
    verification: int | None = None,
    random_order: float | None = None,
    repeats: float | None = None,
    pool: int | None = None,
    effort: str | None = None,
    starts: int | None = None,
    seed: int | None = None,
    force: bool = False,
    threads: int | None = None,
    time: float | None = None,
    progress: Progress = None,
) -> Plan:
    """Proposes ``poses`` configurations to measure, in the order to visit them.

    Instead of a number, ``target_mm`` asks for as few as keep the position error below it, and
    ``minutes`` for as many as fit. ``criterion`` is v by default (d with ``focus``), see
    :func:`posewise.select`. ``held`` was measured already, a table as measurements; ``repair`` with
    ``drop`` (ids) finds new poses for those of a plan that could not be reached; ``estimate`` plans
    for the robot as an earlier calibration found it, ``as_prior`` as surely as it is known.
    ``workspace`` is where the robot shall be accurate: a table of configurations or an array (poses,
    joints) in rad and m; by default ``workspace_poses`` (500) are drawn. Other options, with their
    defaults, are those of ``posewise plan --help``.

    ``time`` ends the search after that many seconds with the best plan so far; Ctrl-C raises
    :class:`posewise.Interrupted`, whose ``result`` is that plan. ``progress`` is called as
    ``progress(done, total)`` from another thread, one call at a time; what it raises ends the call.
    """
    check_kind(campaign, Campaign, "campaign", is_needed=True)
    check_kind(repair, Plan, "repair")
    check_kind(estimate, Estimate, "estimate")
    if poses is None and target_mm is None and minutes is None and repair is None:
        raise InputError("plan(): needs `poses`, `target_mm`, `minutes` or `repair`")
    keywords = {
        "poses": poses,
        "target_mm": target_mm,
        "minutes": minutes,
        "quantity": quantity,
        "assurance": assurance,
        "poses_at_most": poses_at_most,
        "robust_to": robust_to,
        "criterion": criterion,
        "prior": prior,
        "focus": focus,
        "drop": names("drop", drop),
        "as_prior": as_prior,
        "only": names("only", only),
        "moved": names("moved", moved),
        "workspace_poses": workspace_poses,
        "workspace_box_mm": workspace_box_mm,
        "workspace_target": workspace_target,
        "verification": verification,
        "random_order": random_order,
        "repeats": repeats,
        "pool": pool,
        "effort": effort,
        "starts": starts,
        "seed": seed,
        "force": force,
    }
    inputs = given({
        "held": table(held, "held"),
        "workspace": places(workspace, "workspace", campaign._core.columns),
        "repair": result_input(repair),
        "estimate": result_input(estimate),
    })
    check_keywords("plan", {**keywords, **inputs}, "a campaign")
    options = call_options(threads, time, progress)
    with Files() as files:
        stated = as_json("plan", {**keywords, **files.open(inputs)})
        document, text, doubts = files.named(_posewise.plan(campaign._core, stated, options))
    inputs.pop("repair", None)  # its poses are in the plan
    stated_by: dict[str, str | None] = {**as_stated(inputs), "campaign": campaign._core.path}
    found = with_sources(json.loads(document), stated_by)
    found.pop("plan_file", None)
    return made(Plan(campaign, found, text, doubts, inputs), doubts, options)
