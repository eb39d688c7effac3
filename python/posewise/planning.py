"""Plans: which poses to measure, from nothing."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import pandas as pd

from . import _posewise
from ._calls import (
    Files,
    InputError,
    Progress,
    Table,
    as_json,
    call_options,
    read_table,
)
from ._results import Result, read_result
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
    _held: Table | None = field(default=None, repr=False, compare=False)
    _workspace: Table | None = field(default=None, repr=False, compare=False)
    _estimate: Estimate | None = field(default=None, repr=False, compare=False)

    @classmethod
    def read(cls, path: str | os.PathLike[str], campaign: Campaign) -> Plan:
        """A plan from its file."""
        return cls(campaign, json.loads(read_result(path, "plan")))

    @cached_property
    def poses(self) -> pd.DataFrame:
        """The configurations as ``posewise plan --csv`` writes them, with verification poses and
        points to pass on the way."""
        with Files() as files:
            table = files.path("poses", ".csv")
            self._write(files, files.path("out", ".json"), table, "")
            return read_table(table)

    @cached_property
    def targets(self) -> pd.DataFrame:
        """Where the instrument finds each target at each pose; for sensors of points."""
        with Files() as files:
            table = files.path("targets", ".csv")
            self._write(files, files.path("out", ".json"), "", table)
            return read_table(table)

    @property
    def predicted(self) -> pd.Series:
        """Position error to expect over the workspace once calibrated, mm."""
        return pd.Series(self.document["accuracy"], name="predicted")

    @property
    def value(self) -> float:
        """Value of the criterion; larger is better."""
        return float(self.document["value"])

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
            result = _posewise.verify(
                files.result(self, "plan"),
                self.campaign._core,
                _posewise.ChoiceTables(
                    kind=_posewise.CandidateKind.configurations,
                    candidates="",
                    random_count=0,
                    held=files.table(self._held, "held"),
                    test_poses=files.table(self._workspace, "workspace"),
                ),
                files.result(self._estimate, "estimate"),
                [],
                call_options(None, None, None),
            )
        return findings(result[0])

    def write(
        self,
        path: str | os.PathLike[str],
        *,
        csv: str | os.PathLike[str] = "",
        targets: str | os.PathLike[str] = "",
    ) -> None:
        """Writes the plan file, and its configurations and targets as tables; all or none."""
        with Files() as files:
            self._write(files, os.fspath(path), os.fspath(csv), os.fspath(targets))

    def _write(self, files: Files, path: str, csv: str, targets: str) -> None:
        document = files.result(self, "plan")
        _posewise.write_plan(document, path, self.campaign._core, csv, targets)

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
    workspace: Table | None = None,
    workspace_poses: int | None = None,
    workspace_box_mm: Sequence[float] | None = None,
    workspace_target: int | None = None,
    verification: int | None = None,
    random_order: float | None = None,
    repeats: float | None = None,
    pool: int | None = None,
    starts: int | None = None,
    seed: int | None = None,
    force: bool = False,
    threads: int | None = None,
    time: float | None = None,
    progress: Progress = None,
) -> Plan:
    """Proposes ``poses`` configurations to measure, in the order to visit them.

    Instead of a number, ``target_mm`` asks for as few as keep the position error below it, and
    ``minutes`` for as many as fit. ``held`` was measured already; ``repair`` with ``drop`` finds new
    poses for those of a plan that could not be reached; ``estimate`` plans for the robot as an
    earlier calibration found it. Options are those of ``posewise plan``. Ctrl-C and ``time`` end
    the search with the best plan so far.
    """
    if sum(one is not None for one in (poses, target_mm or minutes, repair)) == 0:
        raise InputError("plan(): needs `poses`, `target_mm`, `minutes` or `repair`")
    if poses is not None and (target_mm is not None or minutes is not None):
        raise InputError("plan(): `poses` excludes `target_mm` and `minutes`")
    keywords = {
        "poses": poses,
        "target_mm": target_mm,
        "minutes": minutes,
        "quantity": quantity,
        "assurance": assurance,
        "poses_at_most": poses_at_most,
        "robust_to": robust_to,
        "criterion": criterion,
        "focus": focus,
        "drop": drop,
        "as_prior": as_prior,
        "only": only,
        "moved": moved,
        "workspace_poses": workspace_poses,
        "workspace_box_mm": workspace_box_mm,
        "workspace_target": workspace_target,
        "verification": verification,
        "random_order": random_order,
        "repeats": repeats,
        "pool": pool,
        "starts": starts,
        "seed": seed,
    }
    with Files() as files:
        result = _posewise.plan(
            campaign._core,
            as_json("plan", keywords),
            prior,
            files.result(estimate, "estimate"),
            force,
            files.table(held, "held"),
            files.table(workspace, "workspace"),
            files.result(repair, "repair"),
            call_options(threads, time, progress),
        )
        document = json.loads(result[0])
        document.pop("plan_file", None)
        return Plan(
            campaign, document, result[1], files.warn(result[2]), held, workspace, estimate
        )
