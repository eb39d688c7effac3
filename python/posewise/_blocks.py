"""Anybody's Jacobians, and what goes with them, as the library takes them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Union

import numpy as np
import numpy.typing as npt
import pandas as pd

from . import _posewise
from ._calls import Array, InputError, check_number, numbers, shortened
from ._files import Content, Input, array_file

Prior = Union[bool, npt.ArrayLike, None]


@dataclass(frozen=True)
class Blocks:
    """Jacobians as the library takes them: stacked rows."""

    matrix: Array
    rows: int
    held: Array
    held_count: int
    prior: Array
    test_poses: Array

    def core(self) -> Any:
        return _posewise.PlainBlocks(
            candidates=self.matrix,
            rows=self.rows,
            held=self.held,
            held_count=self.held_count,
            prior=self.prior,
            test_poses=self.test_poses,
        )

    def inputs(self) -> dict[str, Input]:
        """As files that the program reads. Rows of a prior follow those of poses held."""
        found: dict[str, Input] = {"candidates": self._file(self.matrix)}
        if len(self.held) + len(self.prior) > 0:
            found["held"] = self._file(np.vstack([self.held, self.prior]))
        if len(self.test_poses) > 0:
            found["test_poses"] = self._file(self.test_poses)
        return found

    def _file(self, stacked: Array) -> Content:
        padding = np.zeros((-len(stacked) % self.rows, stacked.shape[1]))
        return array_file(np.vstack([stacked, padding]).reshape(-1, self.rows, stacked.shape[1]))


def as_blocks(J: npt.ArrayLike, name: str, rows: int | None = None) -> tuple[Array, int]:
    """Stacked rows of Jacobians (poses, rows, parameters) or (poses, parameters), and rows of each."""
    check_number("rows", rows, 1, 1e6, whole=True)
    array = numbers(J, name, "an array of numbers, (poses, rows, parameters)")
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
    return np.ascontiguousarray(array.reshape(-1, array.shape[-1])), int(rows)


def _prior_rows(prior: Prior, columns: int) -> Array:
    """Rows R with the prior's information R^T R, from deviations or a covariance."""
    rule = (
        f"True, {columns} standard deviations above 0, or a covariance ({columns}, {columns}), in the "
        "square of the parameters' units"
    )
    spread = numbers(prior, "prior", rule)
    if spread.shape == (columns,) and np.isfinite(spread).all() and (spread > 0).all():
        return np.diag(1 / spread)
    if spread.shape == (columns, columns) and np.isfinite(spread).all():
        try:
            return np.linalg.inv(np.linalg.cholesky((spread + spread.T) / 2))
        except np.linalg.LinAlgError:
            raise InputError("`prior` is not positive definite; must be a covariance") from None
    raise InputError(f"`prior` has the shape {spread.shape}; must be {rule}")


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
    known = prior_rows = tests = np.zeros((0, columns))
    held_count = 0
    if held is not None:
        known, held_rows = _beside(held, "held", rows)
        held_count = len(known) // held_rows
    if prior is not None and prior_flag(prior) is None:
        prior_rows = _prior_rows(prior, columns)
    if test_poses is not None:
        tests, test_rows = _beside(test_poses, "test_poses", rows)
        if test_rows != rows:
            raise InputError(
                f"`test_poses` has {test_rows} rows for each pose; must have {rows}, as J"
            )
    for name, array in (("held", known), ("test_poses", tests)):
        if array.shape[1] != columns:
            raise InputError(f"`{name}` has {array.shape[1]} parameters; must have {columns}, as J")
    return Blocks(matrix, rows, known, held_count, prior_rows, tests)


def _beside(value: Any, name: str, rows: int) -> tuple[Array, int]:
    """Jacobians beside others that have so many rows each."""
    array = numbers(value, name, "an array of numbers, (poses, rows, parameters)")
    stacked, own = as_blocks(array, name, rows if array.ndim == 2 else None)
    if len(stacked) % own != 0:
        raise InputError(f"`{name}` has {len(stacked)} rows; must have {own} for each pose")
    if not np.isfinite(stacked).all():
        raise InputError(f"`{name}` has a value that is no finite number; must have none")
    return stacked, own


def labels_of(groups: Any) -> list[int] | None:
    """A number for each candidate's group."""
    if groups is None:
        return None
    rule = f"`groups` is {shortened(groups)}; must be a list with the group of each candidate"
    if isinstance(groups, (str, bytes, dict, pd.DataFrame)):
        raise InputError(rule)
    try:
        labels = pd.factorize(np.asarray(groups, dtype=object))[0]
    except Exception:  # of values that cannot be compared
        raise InputError(rule) from None
    if (labels < 0).any():
        raise InputError("`groups` has missing values; must have the group of each candidate")
    return [int(one) for one in labels]


def pose_indices(poses: Any, count: int | None, name: str) -> list[int]:
    """Indices of poses, or where a mask of them is true."""
    try:
        taken = np.asarray(poses)
    except Exception:  # of ragged lists, or somebody else's class
        taken = np.array(None)
    if taken.dtype.kind == "b" and taken.ndim == 1 and count in (None, len(taken)):
        taken = np.flatnonzero(taken)
    if taken.size == 0 and taken.ndim == 1:
        taken = taken.astype(int)
    is_within = taken.dtype.kind in "iu" and (count is None or ((taken >= 0) & (taken < count)).all())
    if taken.ndim != 1 or not is_within:
        limit = "" if count is None else f" from 0 to {count - 1}"
        raise InputError(f"`{name}` is {shortened(poses)}; must be indices{limit}, or a mask")
    return [int(one) for one in taken]
