"""Choosing the most informative poses, of a robot or of anybody's Jacobians."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd

from . import _posewise
from ._blocks import Blocks, Prior, campaign_prior, labels_of, make_blocks, pose_indices, prior_flag
from ._calls import Array, InputError, Progress, as_json, call_options, check_kind, made, names, numbers
from ._files import Content, FilePath, Files, Input, Places, Table, given, places, table
from ._keywords import check_keywords
from ._results import Result, Shown, as_stated, result_input, symmetric, target_of, with_sources
from .calibration import Estimate
from .campaign import Campaign


class Judged(Result):
    """A result with a value of the criterion and a bound on it."""

    @property
    def criterion(self: Shown) -> str:
        return str(self.document["criterion"])

    @property
    def value(self: Shown) -> float:
        """Value of the criterion, see :func:`select`; larger is better."""
        return float(-np.inf if self.document["value"] is None else self.document["value"])

    @property
    def bound(self: Shown) -> float:
        """Proven: no choice of as many candidates has a larger value."""
        return float(np.inf if self.document["bound"] is None else self.document["bound"])

    @property
    def efficiency(self: Shown) -> float:
        """Proven share of the best possible value, 0 to 1."""
        return float(self.document["efficiency"])


@dataclass(frozen=True)
class Choice(Judged):
    """Chosen poses, how good they are, and the proof. Data only: it can be pickled."""

    document: dict[str, Any] = field(repr=False)  #: as ``posewise select --json`` prints it
    text: str
    warnings: list[str] = field(repr=False)
    _source: Blocks | Campaign = field(repr=False, compare=False)
    _inputs: dict[str, Input] = field(default_factory=dict, repr=False, compare=False)
    _groups: list[int] = field(default_factory=list, repr=False, compare=False)

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
            stated = with_sources(self.document, files.open(self._inputs))
            plan = json.dumps(stated)
            if isinstance(self._source, Blocks):
                result = _posewise.verify_plain(plan, self._source.core(), self._groups)
            else:
                result = _posewise.verify(plan, self._source._core, self._groups)
        return findings(result[0])

    def write(self, path: FilePath) -> None:
        """Writes the plan file, as ``posewise select --out``; ``posewise verify`` checks it.

        It names the files that the choice was made from. What was given in memory is written beside
        it first: choice.candidates.npy for Jacobians, choice.held.csv for ``held`` and so on.
        """
        target = target_of(path)
        inputs = dict(self._inputs)
        paths: dict[str, str | None] = {}
        if isinstance(self._source, Blocks):
            if len(self._source.prior) > 0 and self.criterion == "o1":
                raise InputError(
                    "a prior that is an array is no pose, which o1 counts and no plan file can say; "
                    "must be prior=True of scaled columns, or another criterion"
                )
            inputs = self._source.inputs()
        else:
            paths["campaign"] = self._source.beside(target)
        if self._groups:
            inputs["groups"] = self._groups_file()
        paths.update({name: one.beside(target, name) for name, one in inputs.items()})
        document = json.dumps(with_sources(self.document, paths))
        with Files():
            _posewise.write_plan(document, str(target), None, "", "", self.warnings)

    def _groups_file(self) -> Content:
        ids: list[str] = [str(i) for i in range(len(self._groups))]
        candidates = self._inputs.get("candidates") or self._inputs.get("measurements")
        if candidates is not None:
            with Files() as files:
                ids = _ids_in(candidates.open(files, "candidates"))
        if len(ids) != len(self._groups):
            raise InputError(
                "`groups` cannot be written: the ids of the candidates are not known; must be of a "
                "table with the column config"
            )
        return Content(
            pd.DataFrame({"config": ids, "group": self._groups}).to_csv(index=False).encode(), ".csv"
        )

    def __len__(self) -> int:
        return len(self.ids)


def findings(document: str) -> pd.DataFrame:
    verification = json.loads(document)
    if verification.get("obstacle"):
        raise InputError(f"plan: {verification['obstacle']}")
    return pd.DataFrame(verification["findings"]).set_index("name")


def _ids_in(path: str) -> list[str]:
    """Ids of the configurations in a table, in order."""
    try:
        frame = pd.read_csv(path, dtype=str, comment="#", sep=None, engine="python")
        return list(dict.fromkeys(frame["config"]))
    except (KeyError, ValueError, OSError):
        return []


def select(
    source: Campaign | npt.ArrayLike,
    k: int | None = None,
    *,
    candidates: Places | None = None,
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
    effort: str | None = None,
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
    each, or a campaign with one of ``candidates`` (configurations, a table or an array (poses,
    joints) in rad and m), ``measurements`` (they register base and targets, too) and ``random`` (as
    many configurations within the limits).

    ``criterion``, larger is better, of the information M = H + sum B^T B with p parameters and K
    poses: d log det M, a 1 / trace M^-1, e the least eigenvalue, o1 det(M)^(1/2p) / sqrt(K), o2 the
    least over the largest singular value, o3 the least, o4 its square over the largest, o5 1 / sum
    of their inverses; g and v 1 / largest and mean variance predicted at ``test_poses``, by default
    the candidates. K counts ``held``, but no prior (designs/README.md#criterion). The default is d
    of Jacobians, else the campaign's, else v.

    ``prior`` (H) says what is known before: True (of scaled columns: each parameter's size is its
    standard deviation), standard deviations, or a covariance. ``held`` is measured already; its
    information counts: Jacobians (in two dimensions stacked rows, as many a pose as J has; so are
    ``test_poses``), of a campaign a table of measurements. ``exclude`` are ids not to
    choose (of Jacobians their numbers), ``groups`` with ``per_group`` the group of each candidate and
    how many of one may be chosen; ``repeat_limit`` (1) how often one may be. ``effort`` is "quick"
    (one start, no proof but the first bound), "usual" or "thorough" (40 starts, up to 20 s of proof).
    Other options, with their defaults, are those of ``posewise select --help``.

    ``time`` ends the search after that many seconds with the best choice so far; Ctrl-C raises
    :class:`posewise.Interrupted`, whose ``result`` it is. ``progress`` is called as ``progress(done,
    total)`` from another thread, one call at a time; what it raises ends the call.

    >>> import numpy as np
    >>> J = np.random.default_rng(1).normal(size=(50, 3, 6))
    >>> choice = select(J, 5, criterion="a")
    >>> len(choice.poses), choice.is_optimal
    (5, True)
    """
    labels = labels_of(groups)
    asked = _Asked(
        "select",
        source,
        {
            "poses": k,
            "criterion": criterion,
            "exclude": exclude,
            "groups": labels,
            "per_group": per_group,
            "repeat_limit": repeat_limit,
            "least_distance_deg": least_distance_deg,
            "focus": focus,
            "repeats": repeats,
            "as_prior": as_prior,
            "only": only,
            "moved": moved,
            "effort": effort,
            "starts": starts,
            "proof": proof,
            "seed": seed,
            "force": force,
            "random": random,
        },
        rows,
        prior,
        {"candidates": candidates, "measurements": measurements, "held": held,
         "test_poses": test_poses, "estimate": estimate},
    )
    options = call_options(threads, time, progress)
    stated, text, doubts = asked.call(_posewise.choose_plain, _posewise.choose, options)
    document = with_sources(json.loads(stated), {**as_stated(asked.files), "campaign": asked.path})
    document.pop("plan_file", None)
    if document["search"]["stop_reason"] in ("interrupted", "time limit"):
        doubts.append("stopped early; the choice is the best so far")
    choice = Choice(document, text, doubts, asked.inputs, asked.files, labels or [])
    return made(choice, doubts, options)


class _Asked:
    """What select() or relax() was asked for, checked; ``given_inputs`` are tables, arrays, an estimate."""

    def __init__(
        self,
        function: str,
        source: Campaign | npt.ArrayLike,
        keywords: dict[str, Any],
        rows: int | None,
        prior: Prior,
        given_inputs: dict[str, Any],
    ) -> None:
        check_kind(given_inputs["estimate"], Estimate, "estimate")
        is_robot = isinstance(source, Campaign)
        self.function = function
        self.keywords: dict[str, Any] = {**keywords, "prior": prior_flag(prior)}
        for key in ("exclude", "only", "moved"):
            self.keywords[key] = names(key, keywords[key])
        check_keywords(
            function,
            {**self.keywords, **given_inputs, "rows": rows},
            "a campaign" if is_robot else "Jacobians",
        )
        if keywords["poses"] is None:
            raise InputError(f"{function}(): needs `k`, how many poses to choose")
        self.inputs: Blocks | Campaign  #: candidates as Jacobians, or the robot
        self.files: dict[str, Input] = {}  #: what a robot's call was given beside it
        self.path: str | None = None
        held, test_poses = given_inputs["held"], given_inputs["test_poses"]
        if not isinstance(source, Campaign):
            self.inputs = make_blocks(source, rows, prior, held, test_poses)
            return
        candidates, measurements = given_inputs["candidates"], given_inputs["measurements"]
        if candidates is None and measurements is None and keywords["random"] is None:
            raise InputError(
                f"{function}(): needs one of `candidates`, `measurements` and `random`"
            )
        campaign_prior(prior)
        self.inputs, self.path = source, source._core.path
        self.files = given({
            "candidates": places(candidates, "candidates", source._core.columns),
            "measurements": table(measurements, "measurements"),
            "held": table(held, "held"),
            "test_poses": places(test_poses, "test_poses", source._core.columns),
            "estimate": result_input(given_inputs["estimate"]),
        })

    def call(self, of_blocks: Any, of_campaign: Any, options: Any) -> tuple[str, str, list[str]]:
        """Document, text and warnings, by the one or the other of the library's functions."""
        with Files("k") as files:
            keywords = as_json(self.function, {**self.keywords, **files.open(self.files)}, "k")
            if isinstance(self.inputs, Blocks):
                return files.named(of_blocks(self.inputs.core(), keywords, options))
            return files.named(of_campaign(self.inputs._core, keywords, options))


@dataclass(frozen=True)
class Weights(Judged):
    """Weights of candidates, and the bound that they prove. Data only: it can be pickled."""

    document: dict[str, Any] = field(repr=False)  #: as ``posewise select --relax --json`` prints it
    text: str
    warnings: list[str] = field(repr=False)

    @property
    def weights(self) -> pd.Series:
        """By candidate, the heaviest first; those of weight 0 are left out. Of Jacobians by index."""
        listed = self.document["weights"]
        ids = [one["id"] for one in listed]
        labels = ids if self.document["campaign"] else [int(one) for one in ids]
        values = np.array([one["weight"] for one in listed], dtype=float)
        return pd.Series(values, index=pd.Index(labels, name="config"), name="weight")


def relax(
    source: Campaign | npt.ArrayLike,
    k: int | None = None,
    *,
    candidates: Places | None = None,
    measurements: Table | None = None,
    random: int | None = None,
    rows: int | None = None,
    criterion: str | None = None,
    prior: Prior = None,
    held: Any = None,
    test_poses: Any = None,
    exclude: Sequence[Any] = (),
    repeat_limit: int | None = None,
    focus: str | None = None,
    repeats: float | None = None,
    estimate: Estimate | None = None,
    as_prior: bool | None = None,
    only: Sequence[str] | None = None,
    moved: Sequence[str] | None = None,
    seed: int | None = None,
    force: bool = False,
    threads: int | None = None,
    time: float | None = None,
) -> Weights:
    """Weights the candidates, 0 to ``repeat_limit`` (1) each and ``k`` in all, instead of choosing.

    This is the approximate design that :func:`select` proves its bound with: the continuous problem
    whose largest weights are often taken as a choice. Arguments are as those of :func:`select`, as
    far as weights have them. o2 and o4 are not concave: their weights may be a local optimum.

    >>> import numpy as np
    >>> J = np.random.default_rng(1).normal(size=(50, 3, 6))
    >>> found = relax(J, 5)
    >>> round(float(found.weights.sum()), 9), bool(select(J, 5).value <= found.bound)
    (5.0, True)
    """
    asked = _Asked(
        "relax",
        source,
        {
            "poses": k,
            "criterion": criterion,
            "exclude": exclude,
            "repeat_limit": repeat_limit,
            "focus": focus,
            "repeats": repeats,
            "as_prior": as_prior,
            "only": only,
            "moved": moved,
            "seed": seed,
            "force": force,
            "random": random,
        },
        rows,
        prior,
        {"candidates": candidates, "measurements": measurements, "held": held,
         "test_poses": test_poses, "estimate": estimate},
    )
    options = call_options(threads, time, None)
    stated, text, doubts = asked.call(_posewise.relax_plain, _posewise.relax, options)
    document = json.loads(stated)
    if document["ending"] in ("interrupted", "time limit"):
        doubts.append("stopped early; the weights are the best so far")
    return made(Weights(document, text, doubts), doubts, options)


def design(X: npt.ArrayLike, k: int, **keywords: Any) -> Choice:
    """The best ``k`` of the rows of a model matrix (candidates, parameters): an exact design.

    Takes the keywords of :func:`select`; by default D-optimal.

    >>> import numpy as np, itertools
    >>> X = np.array([[1, a, b, a * b] for a, b in itertools.product([-1, 0, 1], repeat=2)])
    >>> design(X, 4).ids
    ['0', '2', '6', '8']
    """
    if "rows" in keywords:
        raise InputError("design(): `rows` is always 1; leave it out")
    matrix = numbers(X, "X", "an array of numbers, (candidates, parameters)")
    if matrix.ndim != 2:
        raise InputError(f"`X` has the shape {matrix.shape}; must be (candidates, parameters)")
    return select(matrix, k, rows=1, **keywords)


def indices(
    J: npt.ArrayLike,
    poses: Sequence[int] | npt.ArrayLike | None = None,
    *,
    rows: int | None = None,
    prior: Prior = None,
    held: Any = None,
    test_poses: Any = None,
) -> pd.Series:
    """Values of every criterion for some poses of Jacobians, by name, see :func:`select`.

    ``poses`` are indices or a mask (by default all). g and v predict ``test_poses``, by default all
    of J. Minus infinity: these poses do not identify
    all parameters.

    >>> import numpy as np
    >>> round(indices(np.eye(3)[:, None, :])["a"], 3)
    0.333
    """
    blocks = make_blocks(J, rows, prior, held, test_poses)
    if len(blocks.matrix) % blocks.rows != 0:
        raise InputError(f"`rows` is {blocks.rows}; must divide the {len(blocks.matrix)} rows of J")
    count = len(blocks.matrix) // blocks.rows
    taken = list(range(count)) if poses is None else pose_indices(poses, count, "poses")
    if not taken:
        raise InputError("`poses` names none; must name some")
    chosen = blocks.matrix.reshape(count, blocks.rows, -1)[taken].reshape(-1, blocks.matrix.shape[1])
    sizes = np.eye(blocks.matrix.shape[1] if prior_flag(prior) else 0, blocks.matrix.shape[1])
    with Files():
        rated = _posewise.rate_blocks(
            np.vstack([chosen, blocks.held, blocks.prior, sizes]),
            len(taken) + blocks.held_count,
            blocks.core(),
        )
    criteria, values = zip(*rated)
    return pd.Series(np.array(values), index=_index(criteria).view(), name="value")


@lru_cache(maxsize=1)
def _index(labels: tuple[str, ...]) -> pd.Index:
    """Made once: to make one takes longer than to rate a few poses."""
    shared = np.array(labels, dtype=object)
    shared.flags.writeable = False
    return pd.Index(shared)
