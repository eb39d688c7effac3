"""Studies: accuracy against number of poses, planned and random."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd

from . import _posewise
from ._calls import Files, Progress, Table, answers_html, as_json, call_options
from .campaign import Campaign


@dataclass(frozen=True)
class Study:
    """Accuracy against number of poses. Data only: it can be pickled.

    Like its DataFrame :attr:`table`, it has a length and columns.
    """

    document: dict[str, Any] = field(repr=False)  #: as ``posewise study --json`` prints it
    text: str = ""
    warnings: list[str] = field(default_factory=list, repr=False)

    @cached_property
    def table(self) -> pd.DataFrame:
        """A row for each number of poses and criterion: what is left at poses held out, mm."""
        rows = []
        for row in self.document["models"][0]["rows"]:
            random = row["random"] or {}
            shared = {
                "poses": row["pose_count"],
                **{f"random_{key}": value for key, value in random.items()},
            }
            for planned in row["planned"] or [{}]:
                one = {key: value for key, value in planned.items() if key != "against_random"}
                against = planned.get("against_random") or {}
                one.update({f"against_random_{key}": value for key, value in against.items()})
                rows.append({**shared, **one})
        table = pd.DataFrame(rows)
        first = [column for column in ("poses", "criterion") if column in table.columns]
        return table[first + [column for column in table.columns if column not in first]]

    def __len__(self) -> int:
        return len(self.table)

    def __getitem__(self, column: Any) -> Any:
        return self.table[column]

    def __str__(self) -> str:
        return self.text

    def _repr_html_(self) -> str:
        return answers_html(self.document)

    def plot(self, ax: Any = None) -> Any:
        """Draws the error held out against the number of poses; needs matplotlib."""
        from .drawing import axes

        ax = axes(ax)
        table = self.table
        random = table.drop_duplicates("poses")
        if "random_held_out_rms_p50_mm" in table:
            low, high = (
                random[f"random_held_out_rms_{q}_mm"].astype(float) for q in ("p10", "p90")
            )
            ax.fill_between(random["poses"], low, high, alpha=0.2, label="random, 10 to 90 %")
            ax.plot(random["poses"], random["random_held_out_rms_p50_mm"], label="random, median")
        if "criterion" in table:
            for criterion, rows in table.groupby("criterion"):
                ax.plot(rows["poses"], rows["held_out_rms_mm"], "o-", label=f"by {criterion}")
        ax.set_xlabel("poses")
        ax.set_ylabel("RMS distance held out / mm")
        ax.set_yscale("log")
        ax.legend()
        return ax


def study(
    campaign: Campaign,
    measurements: Table | None = None,
    *,
    poses: Iterable[int] | int | None = None,
    criteria: Sequence[str] | str | None = None,
    random: int | None = None,
    splits: int | None = None,
    holdout: float | None = None,
    least_distance_deg: float | None = None,
    exclude: Sequence[Any] = (),
    prior: bool | None = None,
    trials: int | None = None,
    precision: float | None = None,
    pool: int | None = None,
    test_poses: int | None = None,
    repeats: int | None = None,
    refine: bool | None = None,
    starts: int | None = None,
    seed: int | None = None,
    force: bool = False,
    threads: int | None = None,
    time: float | None = None,
    progress: Progress = None,
) -> Study:
    """How accuracy varies with the number of poses, chosen by criteria and at random.

    With measurements each subset calibrates and is judged on poses held out; without them robots
    are simulated (``trials``, ``precision``, ``pool``, ``test_poses``, ``repeats``, ``refine``).
    Options are those of ``posewise study``.
    """
    counts = [poses] if isinstance(poses, (int, np.integer)) else poses
    shared = {
        "poses": None if counts is None else list(counts),
        "criteria": [criteria] if isinstance(criteria, str) else criteria,
        "random": random,
        "least_distance_deg": least_distance_deg,
        "starts": starts,
        "seed": seed,
    }
    options = call_options(threads, time, progress)
    with Files() as files:
        if measurements is None:
            simulated = {
                "trials": trials,
                "precision": precision,
                "pool": pool,
                "test_poses": test_poses,
                "repeats": repeats,
                "refine": refine,
            }
            keywords = as_json("study", {**shared, **simulated})
            result = _posewise.simulate_study(campaign._core, keywords, prior, options)
        else:
            keywords = as_json("study", {**shared, "splits": splits, "holdout": holdout})
            result = _posewise.study(
                campaign._core,
                files.table(measurements, "measurements"),
                keywords,
                [str(one) for one in exclude],
                prior,
                force,
                options,
            )
        return Study(json.loads(result[0]), result[1], files.warn(result[2]))
