"""Choosing the most informative poses, of a robot or of anybody's Jacobians."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Union

import numpy as np
import numpy.typing as npt
import pandas as pd

from . import _posewise
from ._calls import (
    Files,
    InputError,
    Progress,
    Table,
    as_json,
    call_options,
    check_number,
    names,
)
from ._results import Result, symmetric
from .calibration import Estimate
from .campaign import Array, Campaign

Prior = Union[bool, npt.ArrayLike, None]


@dataclass(frozen=True)
class Blocks:
    """Jacobians as the library takes them: stacked rows."""

    matrix: Array
    rows: int
    held: Array
    held_count: int
    test_poses: Array

    def core(self) -> Any:
        return _posewise.PlainBlocks(
            candidates=self.matrix,
            rows=self.rows,
            held=self.held,
            held_count=self.held_count,
            test_poses=self.test_poses,
        )


@dataclass(frozen=True)
class Choice(Result):
    """Chosen poses, how good they are, and the proof. Data only: it can be pickled."""

    document: dict[str, Any] = field(repr=False)  #: as ``posewise select --json`` prints it
    text: str
    warnings: list[str] = field(repr=False)
    _source: Any = field(repr=False, compare=False)
    _groups: list[int] = field(repr=False, compare=False, default_factory=list)

    @property
    def ids(self) -> list[str]:
        """Names of the poses chosen; one measured twice stands twice."""
        return [
            pose["id"] for pose in self.document["poses"] for _ in range(int(pose.get("times", 1)))
        ]

    @property
    def poses(self) -> Any:
        """For Jacobians their indices, ascending; for a robot a DataFrame with the joint values."""
        if isinstance(self._source, Blocks):
            return np.array([int(one) for one in self.ids])
        rows = [pose["joints"] for pose in self.document["poses"]]
        index = pd.Index([pose["id"] for pose in self.document["poses"]], name="config")
        return pd.DataFrame(rows, index=index)

    @property
    def criterion(self) -> str:
        return str(self.document["criterion"])

    @property
    def value(self) -> float:
        """Value of the criterion; larger is better."""
        return float(self.document["value"])

    @property
    def bound(self) -> float:
        """Proven: no choice of as many candidates has a larger value."""
        return float(np.inf if self.document["bound"] is None else self.document["bound"])

    @property
    def efficiency(self) -> float:
        """Proven share of the best possible value, 0 to 1."""
        return float(self.document["efficiency"])

    @property
    def is_optimal(self) -> bool:
        """Proven by branch and bound: no choice is better."""
        return bool(self.document["search"]["stop_reason"] == "optimal")

    @property
    def M(self) -> Array:
        """The matrix that proves the bound, (parameters, parameters)."""
        return symmetric(self.document["certificate"]["M_lower"])

    def verify(self) -> pd.DataFrame:
        """Computes value, bound and efficiency again from the inputs and the certificate.

        One row for each finding; all ``is_right`` unless something is not as stated.
        """
        with Files() as files:
            plan = files.result(self, "plan")
            options = call_options(None, None, None)
            if isinstance(self._source, Blocks):
                result = _posewise.verify_plain(plan, self._source.core(), self._groups, options)
            else:
                result = self._source.verify(files, plan, self._groups, options)
        return findings(result[0])

    def write(self, path: str | os.PathLike[str]) -> None:
        """Writes the plan file, as ``posewise select --out``."""
        with Files() as files:
            document = files.result(self, "plan")
            _posewise.write_plan(document, os.fspath(path), None, "", "")

    def __len__(self) -> int:
        return len(self.ids)


def findings(document: str) -> pd.DataFrame:
    verification = json.loads(document)
    if verification.get("obstacle"):
        raise InputError(f"plan: {verification['obstacle']}")
    return pd.DataFrame(verification["findings"]).set_index("name")


@dataclass(frozen=True)
class _Robot:
    """Candidates of a robot."""

    campaign: Campaign
    kind: Any
    candidates: Table | None
    random: int
    held: Table | None
    test_poses: Table | None
    estimate: Estimate | None

    def tables(self, files: Files) -> Any:
        return _posewise.ChoiceTables(
            kind=getattr(_posewise.CandidateKind, self.kind),
            candidates=files.table(self.candidates, self.kind),
            random_count=self.random,
            held=files.table(self.held, "held"),
            test_poses=files.table(self.test_poses, "test_poses"),
        )

    def verify(self, files: Files, plan: str, groups: list[int], options: Any) -> Any:
        return _posewise.verify(
            plan,
            self.campaign._core,
            self.tables(files),
            files.result(self.estimate, "estimate"),
            groups,
            options,
        )


def as_blocks(J: npt.ArrayLike, name: str, rows: int | None = None) -> tuple[Array, int]:
    """Stacked rows of Jacobians (poses, rows, parameters) or (poses, parameters), and rows of each."""
    check_number("rows", rows, 1, whole=True)
    try:
        array = np.asarray(J)
        if array.dtype.kind not in "fiub":
            raise TypeError
        array = array.astype(float, copy=False)
    except (TypeError, ValueError):
        raise InputError(f"`{name}` must be an array of numbers, (poses, rows, parameters)") from None
    if array.ndim == 3:
        if rows is not None and rows != array.shape[1]:
            raise InputError(f"`rows` is {rows}, but `{name}` has {array.shape[1]} rows for each pose")
        rows = array.shape[1]
    elif array.ndim == 2:
        rows = 1 if rows is None else rows
    else:
        raise InputError(
            f"`{name}` has the shape {array.shape}; must be (poses, rows, parameters), or (poses, "
            "parameters) for one row each"
        )
    if rows < 1 or array.size == 0:
        raise InputError(f"`{name}` has the shape {array.shape}: no numbers; must have some")
    return np.ascontiguousarray(array.reshape(-1, array.shape[-1])), rows


def _prior_rows(prior: Prior, columns: int) -> Array:
    """Rows R with the prior's information R^T R, from deviations or a covariance."""
    try:
        spread = np.asarray(prior, dtype=float)
    except (TypeError, ValueError):
        raise InputError("`prior` must be True, standard deviations or a covariance") from None
    if spread.shape == (columns,) and np.isfinite(spread).all() and (spread > 0).all():
        return np.diag(1 / spread)
    if spread.shape == (columns, columns) and np.isfinite(spread).all():
        try:
            return np.linalg.inv(np.linalg.cholesky((spread + spread.T) / 2))
        except np.linalg.LinAlgError:
            raise InputError("`prior` is not positive definite; must be a covariance") from None
    raise InputError(
        f"`prior` has the shape {spread.shape}; must be True, {columns} standard deviations above "
        f"0, or a covariance ({columns}, {columns})"
    )


def prior_flag(prior: Prior) -> bool | None:
    """A prior that only says whether the sizes are it; None for others."""
    return bool(prior) if isinstance(prior, (bool, np.bool_)) else None


def campaign_prior(prior: Prior) -> bool | None:
    flag = prior_flag(prior)
    if flag is None and prior is not None:
        raise InputError("`prior` must be True or False; the campaign states the sizes")
    return flag


def make_blocks(
    J: npt.ArrayLike, rows: int | None, prior: Prior, held: Any, test_poses: Any
) -> Blocks:
    matrix, rows = as_blocks(J, "J", rows)
    columns = matrix.shape[1]
    known = np.zeros((0, columns))
    held_count = 0
    if held is not None:
        known, held_rows = as_blocks(held, "held", rows if np.ndim(held) == 2 else None)
        held_count = len(known) // max(held_rows, 1)
    if prior is not None and prior_flag(prior) is None:
        known = np.vstack([known, _prior_rows(prior, columns)])
        held_count = 0  # rows of no pose
    tests = np.zeros((0, columns))
    if test_poses is not None:
        tests, _ = as_blocks(test_poses, "test_poses", rows if np.ndim(test_poses) == 2 else None)
    for name, array in (("held", known), ("test_poses", tests)):
        if array.shape[1] != columns:
            raise InputError(f"`{name}` has {array.shape[1]} parameters; must have {columns}, as J")
    return Blocks(matrix, rows, np.ascontiguousarray(known), held_count, tests)


def _labels(groups: Any) -> list[int]:
    return [] if groups is None else [int(one) for one in pd.factorize(np.asarray(groups))[0]]


def select(
    source: Campaign | npt.ArrayLike,
    k: int | None = None,
    *,
    candidates: Table | None = None,
    measurements: Table | None = None,
    random: int | None = None,
    rows: int | None = None,
    criterion: str | None = None,
    prior: Prior = None,
    held: Any = None,
    test_poses: Any = None,
    exclude: Sequence[Any] = (),
    groups: Any = None,
    per_group: int | None = None,
    repeat_limit: int | None = None,
    least_distance_deg: float | None = None,
    focus: str | None = None,
    repeats: float | None = None,
    estimate: Estimate | None = None,
    as_prior: bool | None = None,
    only: Sequence[str] | None = None,
    moved: Sequence[str] | None = None,
    starts: int | None = None,
    proof: float | None = None,
    seed: int | None = None,
    force: bool = False,
    threads: int | None = None,
    time: float | None = None,
    progress: Progress = None,
) -> Choice:
    """Chooses the ``k`` candidates that tell most about the parameters, with a proven bound.

    ``source`` is anybody's Jacobians, (poses, rows, parameters) or (poses, parameters) for one row
    each, or a campaign with one of ``candidates`` (configurations), ``measurements`` (they register
    base and targets, too) and ``random`` (as many configurations within the limits).

    ``criterion`` is o1 to o5, a, d, e, g or v. ``prior`` says what is known before: True (of scaled
    columns: each parameter's size is its standard deviation), standard deviations, or a covariance.
    ``held`` is measured already; its information counts. ``test_poses`` are predicted by g and v.
    ``time`` ends the search after that many seconds, Ctrl-C at once, with the best choice so far.

    >>> import numpy as np
    >>> J = np.random.default_rng(1).normal(size=(50, 3, 6))
    >>> choice = select(J, 5, criterion="a")
    >>> len(choice.poses), choice.is_optimal
    (5, True)
    """
    keywords = {
        "poses": k,
        "criterion": criterion,
        "prior": prior_flag(prior),
        "exclude": names(exclude),
        "per_group": per_group,
        "repeat_limit": repeat_limit,
        "least_distance_deg": least_distance_deg,
        "focus": focus,
        "repeats": repeats,
        "as_prior": as_prior,
        "only": only,
        "moved": moved,
        "starts": starts,
        "proof": proof,
        "seed": seed,
    }
    check_number("random", random, 1, whole=True)
    options = call_options(threads, time, progress)
    labels = _labels(groups)
    with Files() as files:
        if isinstance(source, Campaign):
            kinds = {"configurations": candidates, "measurements": measurements, "random": random}
            stated = [kind for kind, value in kinds.items() if value is not None]
            if len(stated) != 1 or rows is not None:
                raise InputError(
                    "select(): needs one of `candidates`, `measurements` and `random`, and no `rows`"
                )
            has_prior = campaign_prior(prior)
            table = kinds[stated[0]] if stated[0] != "random" else None
            robot = _Robot(source, stated[0], table, random or 0, held, test_poses, estimate)
            result = _posewise.choose(
                source._core,
                robot.tables(files),
                as_json("select", keywords),
                has_prior,
                files.result(estimate, "estimate"),
                force,
                labels,
                options,
            )
            return _made(files, result, robot, labels)
        of_robot = [candidates, measurements, random, estimate]
        if any(one is not None for one in of_robot):
            raise InputError(
                "select(): `candidates`, `measurements`, `random` and `estimate` go with a campaign"
            )
        blocks = make_blocks(source, rows, prior, held, test_poses)
        result = _posewise.choose_plain(
            blocks.core(), as_json("select", keywords), labels, options
        )
        return _made(files, result, blocks, labels)


def _made(files: Files, result: Any, source: Any, labels: list[int]) -> Choice:
    document = json.loads(result[0])
    document.pop("plan_file", None)
    sentences = list(result[2])
    if document["search"]["stop_reason"] in ("interrupted", "time limit"):
        sentences.append("stopped early; the choice is the best so far")
    return Choice(document, result[1], files.warn(sentences), source, labels)


def design(X: npt.ArrayLike, k: int, **keywords: Any) -> Choice:
    """The best ``k`` of the rows of a model matrix (candidates, parameters): an exact design.

    Takes the keywords of :func:`select`; by default D-optimal.

    >>> import numpy as np, itertools
    >>> X = np.array([[1, a, b, a * b] for a, b in itertools.product([-1, 0, 1], repeat=2)])
    >>> design(X, 4).ids
    ['0', '2', '6', '8']
    """
    if np.ndim(X) != 2:
        raise InputError(f"`X` has the shape {np.shape(X)}; must be (candidates, parameters)")
    return select(X, k, rows=1, **keywords)


def indices(
    J: npt.ArrayLike,
    poses: Sequence[int] | None = None,
    *,
    rows: int | None = None,
    prior: Prior = None,
    held: Any = None,
    test_poses: Any = None,
) -> pd.Series:
    """Values of every criterion for some poses of Jacobians (by default all), by name.

    g and v predict ``test_poses``, by default all of J. Minus infinity: these poses do not identify
    all parameters.

    >>> import numpy as np
    >>> round(indices(np.eye(3)[:, None, :])["a"], 3)
    0.333
    """
    blocks = make_blocks(J, rows, prior, held, test_poses)
    count = len(blocks.matrix) // blocks.rows
    taken = np.arange(count) if poses is None else np.asarray(poses)
    if taken.dtype.kind not in "iu" or taken.ndim != 1 or ((taken < 0) | (taken >= count)).any():
        raise InputError(f"`poses` must be indices from 0 to {count - 1}")
    parts = [blocks.matrix.reshape(count, blocks.rows, -1)[taken].reshape(-1, blocks.matrix.shape[1])]
    parts.append(blocks.held)
    if prior_flag(prior):
        parts.append(np.eye(blocks.matrix.shape[1]))
    with Files():
        values = _posewise.rate_blocks(
            np.vstack(parts), len(taken) + blocks.held_count, blocks.core()
        )
    return pd.Series(dict(values), name="value")

