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
from ._blocks import Prior, campaign_prior, make_blocks, pose_indices, prior_flag
from ._calls import InputError, Progress, as_json, call_options, check_text, made, names, shortened
from ._files import Files, Table, given, table
from ._keywords import check_keywords
from ._results import Result
from .campaign import Campaign



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
        return (_blocks_table if self._is_of_blocks else _campaign_table)(self.document)

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
        unit = self.document["unit"]
        if f"random_held_out_rms_p50_{unit}" in table:
            low, high = (
                random[f"random_held_out_rms_{q}_{unit}"].astype(float) for q in ("p10", "p90")
            )
            ax.fill_between(random["poses"], low, high, alpha=0.2, label="random, 10 to 90 %")
            ax.plot(random["poses"], random[f"random_held_out_rms_p50_{unit}"], label="random, median")
        if "criterion" in table:
            for criterion, rows in table.groupby("criterion"):
                ax.plot(rows["poses"], rows[f"held_out_rms_{unit}"], "o-", label=f"by {criterion}")
        ax.set_xlabel("poses")
        ax.set_ylabel(f"RMS distance held out / {unit}")
        ax.set_yscale("log")
        ax.legend()
        return ax


def _numeric(table: pd.DataFrame, *others: str) -> pd.DataFrame:
    """With what is unknown as NaN in all but these columns."""
    for column in table.columns.difference(others):
        table[column] = pd.to_numeric(table[column])
    return table


def _campaign_table(document: Mapping[str, Any]) -> pd.DataFrame:
    rows = []
    for row in document["models"][0]["rows"]:
        shared = {f"random_{key}": value for key, value in row["random"].items()}
        for planned in row["planned"]:
            one = {key: value for key, value in planned.items() if key != "against_random"}
            against = planned.get("against_random") or {}
            for key in ("ratio", "lower", "upper", "left_out", "verdict"):
                one[f"against_random_{key}"] = against.get(key)
            rows.append({"poses": row["pose_count"], "criterion": one.pop("criterion"), **shared, **one})
    return _numeric(pd.DataFrame(rows), "criterion", "against_random_verdict")


def _blocks_table(document: Mapping[str, Any]) -> pd.DataFrame:
    rows = []
    own = dict.fromkeys(subset["name"] for row in document["rows"] for subset in row["subsets"])
    for row in document["rows"]:
        one = {"poses": row["pose_count"], "criterion": row["criterion"]}
        one.update({key: row[key] for key in ("value", "bound", "efficiency")})
        for key in ("subsets", "unidentified"):
            one[f"random_{key}"] = row["random"][key]
        for kind in ("value", "efficiency"):
            for quantile in ("p5", "p50", "p95"):
                one[f"random_{kind}_{quantile}"] = row["random"].get(f"{kind}_{quantile}")
        found = {subset["name"]: subset for subset in row["subsets"]}
        for name in own:
            for kind in ("value", "efficiency"):
                one[f"{name}_{kind}"] = found.get(name, {}).get(kind)
        one["chosen"] = row["poses"]
        rows.append(one)
    return _numeric(pd.DataFrame(rows), "criterion", "chosen")


def _counts(poses: Iterable[int] | int | None) -> Any:
    if poses is None or isinstance(poses, (str, bytes, Mapping)):
        return poses
    if isinstance(poses, (int, np.integer)):
        return [poses]
    try:
        return list(poses)
    except TypeError:
        raise InputError(f"`poses` is {shortened(poses)}; must be numbers of poses") from None


def _own_subsets(subsets: Mapping[str, Any] | None) -> list[tuple[str, list[int]]]:
    if subsets is None:
        return []
    if not isinstance(subsets, Mapping):
        raise InputError("`subsets` must be indices by name: {'mine': [0, 7]}")
    return [(check_text(str(name), "subsets"), pose_indices(poses, None, "subsets")) for name, poses in subsets.items()]


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
    effort: str | None = None,
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
    ``refine``). ``criteria`` are the campaign's by default, else v; ``random`` subsets 100 for each
    number of poses, one for each simulated robot. Options, with their defaults, are those of
    ``posewise study --help``. ``time`` ends it after that many seconds with what is finished, which
    a Doubt says, Ctrl-C by :class:`posewise.Interrupted` with that as ``result``; where nothing is,
    that is an error, or KeyboardInterrupt. ``progress`` is called as ``progress(done, total)``, see
    :func:`posewise.plan`.

    Of anybody's Jacobians (see :func:`posewise.select`, also for ``rows``, ``prior``, ``held``,
    ``test_poses``, ``exclude``, ``repeat_limit`` and ``proof``): value, proven bound and efficiency
    of the best subset, of random ones and of your own ``subsets``, which are indices (or masks) by
    name.

    >>> J = np.random.default_rng(0).normal(size=(30, 2, 4))
    >>> found = study(J, poses=[3, 5], subsets={"mine": [1, 2, 3]}, random=20)
    >>> bool((found["efficiency"] >= found["random_efficiency_p95"]).all())
    True
    """
    keywords: dict[str, Any] = {
        "poses": _counts(poses),
        "criteria": [criteria] if isinstance(criteria, str) else criteria,
        "random": random,
        "splits": splits,
        "holdout": holdout,
        "least_distance_deg": least_distance_deg,
        "exclude": names("exclude", exclude),
        "prior": prior_flag(prior),
        "trials": trials,
        "precision": precision,
        "pool": pool,
        "repeats": repeats,
        "refine": refine,
        "effort": effort,
        "starts": starts,
        "seed": seed,
        "repeat_limit": repeat_limit,
        "proof": proof,
        "force": force,
    }
    if not isinstance(source, Campaign):
        kind = "Jacobians"
    else:
        kind = "a campaign" if measurements is not None else "a simulation"
    of_kind = {"measurements": measurements, "test_poses": test_poses, "subsets": subsets,
               "rows": rows, "held": held}
    check_keywords("study", {**keywords, **of_kind}, kind)
    options = call_options(threads, time, progress)
    with Files() as files:
        if not isinstance(source, Campaign):
            blocks = make_blocks(source, rows, prior, held, test_poses)
            own = _own_subsets(subsets)
            result = _posewise.study_plain(blocks.core(), as_json("study", keywords), own, options)
        else:
            campaign_prior(prior)
            inputs = given({"measurements": table(measurements, "measurements")})
            stated = {**keywords, "test_poses": test_poses, **files.open(inputs)}
            result = _posewise.study(source._core, as_json("study", stated), options)
        document, text, doubts = files.named(result)
    return made(Study(json.loads(document), text, doubts), doubts, options)
