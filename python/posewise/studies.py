"""Studies: accuracy against number of poses, planned and random."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd

from . import _posewise
from ._calls import Files, InputError, Progress, Table, as_json, call_options, names
from ._results import Result
from .campaign import Campaign
from .choice import Prior, campaign_prior, make_blocks, prior_flag


@dataclass(frozen=True)
class Study(Result):
    """Accuracy against number of poses. Data only: it can be pickled.

    Like its DataFrame :attr:`table`, it has a length and columns.
    """

    document: dict[str, Any] = field(repr=False)  #: as ``posewise study --json`` prints it
    text: str = ""
    warnings: list[str] = field(default_factory=list, repr=False)

    @cached_property
    def table(self) -> pd.DataFrame:
        """A row for each number of poses and criterion: what is left at poses held out, mm; for
        Jacobians value, bound and efficiency of chosen, random and own subsets."""
        if self._is_of_blocks:
            return _blocks_table(self.document)
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

    @property
    def _is_of_blocks(self) -> bool:
        return bool(self.document["kind"] == "posewise blocks study")

    def __len__(self) -> int:
        return len(self.table)

    def __getitem__(self, column: Any) -> Any:
        return self.table[column]

    def plot(self, ax: Any = None) -> Any:
        """Draws the error held out against the number of poses; needs matplotlib."""
        from .drawing import axes

        ax = axes(ax)
        table = self.table
        if self._is_of_blocks:
            for criterion, rows in table.groupby("criterion"):
                [line] = ax.plot(rows["poses"], rows["efficiency"], "o-", label=f"by {criterion}")
                if "random_efficiency_p50" in rows:
                    low, high = (rows[f"random_efficiency_{q}"] for q in ("p5", "p95"))
                    ax.fill_between(rows["poses"], low, high, alpha=0.2, color=line.get_color())
            ax.set_xlabel("poses")
            ax.set_ylabel("efficiency against the bound")
            ax.legend()
            return ax
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


def _blocks_table(document: dict[str, Any]) -> pd.DataFrame:
    rows = []
    for row in document["rows"]:
        one = {"poses": row["pose_count"], "criterion": row["criterion"]}
        one.update({key: row[key] for key in ("value", "bound", "efficiency")})
        one.update({f"random_{key}": value for key, value in row["random"].items()})
        for subset in row["subsets"]:
            one[f"{subset['name']}_value"] = subset["value"]
            one[f"{subset['name']}_efficiency"] = subset["efficiency"]
        one["chosen"] = row["poses"]
        rows.append(one)
    return pd.DataFrame(rows)


def _counts(poses: Iterable[int] | int | None) -> list[int] | None:
    if poses is None:
        return None
    return [int(poses)] if isinstance(poses, (int, np.integer)) else list(poses)


def _study_blocks(
    J: npt.ArrayLike,
    rows: int | None,
    prior: Prior,
    held: Any,
    test_poses: Any,
    subsets: Mapping[str, Sequence[int]],
    keywords: dict[str, Any],
    options: Any,
) -> Study:
    try:
        own = [(str(name), [int(one) for one in poses]) for name, poses in subsets.items()]
    except (AttributeError, TypeError, ValueError):
        raise InputError("`subsets` must be indices by name: {'mine': [0, 7]}") from None
    with Files() as files:
        blocks = make_blocks(J, rows, prior, held, test_poses)
        result = _posewise.study_plain(blocks.core(), as_json("study", keywords), own, options)
        return Study(json.loads(result[0]), result[1], files.warn(result[2]))


def study(
    source: Campaign | npt.ArrayLike,
    measurements: Table | None = None,
    *,
    poses: Iterable[int] | int | None = None,
    criteria: Sequence[str] | str | None = None,
    random: int | None = None,
    splits: int | None = None,
    holdout: float | None = None,
    least_distance_deg: float | None = None,
    exclude: Sequence[Any] = (),
    prior: Prior = None,
    trials: int | None = None,
    precision: float | None = None,
    pool: int | None = None,
    test_poses: Any = None,
    repeats: int | None = None,
    refine: bool | None = None,
    starts: int | None = None,
    seed: int | None = None,
    subsets: Mapping[str, Sequence[int]] | None = None,
    rows: int | None = None,
    held: Any = None,
    repeat_limit: int | None = None,
    proof: float | None = None,
    force: bool = False,
    threads: int | None = None,
    time: float | None = None,
    progress: Progress = None,
) -> Study:
    """How accuracy varies with the number of poses, chosen by criteria and at random.

    Of a campaign with measurements each subset calibrates and is judged on poses held out; without
    them robots are simulated (``trials``, ``precision``, ``pool``, ``test_poses``, ``repeats``,
    ``refine``). Options are those of ``posewise study``.

    Of anybody's Jacobians (see :func:`posewise.select`, also for ``rows``, ``prior``, ``held``,
    ``test_poses``, ``exclude``, ``repeat_limit`` and ``proof``): value, proven bound and efficiency
    of the best subset, of random ones and of your own ``subsets``, which are indices by name.

    >>> J = np.random.default_rng(0).normal(size=(30, 2, 4))
    >>> found = study(J, poses=[3, 5], subsets={"mine": [1, 2, 3]}, random=20)
    >>> bool((found["efficiency"] >= found["random_efficiency_p95"]).all())
    True
    """
    if not isinstance(source, Campaign):
        of_robot = (measurements, splits, holdout, least_distance_deg, trials, precision, pool,
                    repeats, refine)
        if any(one is not None for one in of_robot):
            raise InputError("study(): measurements and simulations are of a campaign")
        return _study_blocks(source, rows, prior, held, test_poses, subsets or {}, {
            "poses": _counts(poses),
            "criteria": [criteria] if isinstance(criteria, str) else criteria,
            "random": random,
            "prior": prior_flag(prior),
            "exclude": names(exclude),
            "repeat_limit": repeat_limit,
            "starts": starts,
            "proof": proof,
            "seed": seed,
        }, call_options(threads, time, progress))
    if any(one is not None for one in (subsets, rows, held, repeat_limit, proof)):
        raise InputError("study(): `subsets`, `rows`, `held`, `repeat_limit` and `proof` are of "
                         "Jacobians, not of a campaign")
    has_prior = campaign_prior(prior)
    shared = {
        "poses": _counts(poses),
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
            result = _posewise.simulate_study(source._core, keywords, has_prior, options)
        else:
            keywords = as_json("study", {**shared, "splits": splits, "holdout": holdout})
            result = _posewise.study(
                source._core,
                files.table(measurements, "measurements"),
                keywords,
                names(exclude),
                has_prior,
                force,
                options,
            )
        return Study(json.loads(result[0]), result[1], files.warn(result[2]))
