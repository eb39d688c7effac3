"""How calls reach the compiled library: tables as files, keywords, messages, progress."""

from __future__ import annotations

import json
import os
import re
import sys
import tempfile
import warnings
from collections.abc import Callable, Iterable, Mapping
from contextlib import AbstractContextManager
from pathlib import Path
from types import TracebackType
from typing import Any, Protocol, Union

import numpy as np
import pandas as pd

from . import _posewise

Table = Union[pd.DataFrame, str, "os.PathLike[str]"]
Progress = Union[bool, Callable[[int, int], object], None]


class InputError(ValueError):
    """Something that posewise cannot use; the message says what, and what would be right."""

    @property
    def field(self) -> str | None:
        """The argument that the message is about, where it names one."""
        named = re.match(r"\w+\(\): (\w+)", str(self)) or re.search(r"`([\w.]+)`", str(self))
        return named.group(1) if named else None


class Doubt(UserWarning):
    """Something about data or result that should be looked at first."""


# What the library's fields are called in Python.
_keywords = {
    "count": "random",
    "dropped": "drop",
    "earlier": "estimate",
    "earlier.has_new_base": "moved",
    "earlier.is_prior": "as_prior",
    "is_focused_on_robot": "focus",
    "least_distance": "least_distance_deg",
    "measured": "measurements",
    "pool_count": "pool",
    "pose_count": "poses",
    "spread.is_prior": "prior",
}


def with_keywords(message: str) -> str:
    """The message with arguments of Python in place of the library's fields."""
    return re.sub(r"`([\w.]+)`", lambda m: f"`{_keywords.get(m.group(1), m.group(1))}`", message)


class Shown(Protocol):
    """A result of the library."""

    @property
    def document(self) -> Mapping[str, Any]: ...
    @property
    def text(self) -> str: ...


class Files(AbstractContextManager["Files"]):
    """Tables and documents as files for one call of the library.

    Messages then name an argument instead of the file that it was written to.
    """

    def __init__(self) -> None:
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        self._names: dict[str, str] = {}

    def path(self, name: str, suffix: str) -> str:
        """A new file for the argument of that name."""
        if self._folder is None:
            self._folder = tempfile.TemporaryDirectory(prefix="posewise")
        path = os.path.join(self._folder.name, name + suffix)
        self._names[path] = name
        return path

    def table(self, value: Table | None, name: str) -> str:
        """A table, or the file that it is in already; "" for None."""
        if value is None:
            return ""
        if isinstance(value, (str, os.PathLike)):
            return os.fspath(value)
        if not isinstance(value, pd.DataFrame):
            raise InputError(
                f"`{name}` is a {type(value).__name__}; must be a DataFrame with the columns of the "
                "CSV file, or the path of one"
            )
        path = self.path(name, ".csv")
        as_written(value).to_csv(path, index=False)
        return path

    def result(self, value: Shown | None, name: str) -> str:
        """The document of a plan or an estimate; "" for None."""
        if value is None:
            return ""
        path = self.path(name, ".json")
        Path(path).write_text(json.dumps(value.document), encoding="utf-8")
        return path

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._folder is not None:
            self._folder.cleanup()
        if isinstance(error, _posewise.InputError):
            raise InputError(self.spoken(str(error))) from None

    def spoken(self, message: str) -> str:
        for path, name in self._names.items():
            message = message.replace(path, name)
        return with_keywords(message)

    def warn(self, sentences: Iterable[str]) -> list[str]:
        """Gives the library's warnings as Python's; returns them."""
        spoken = [self.spoken(sentence) for sentence in sentences]
        level, frame = 2, sys._getframe(1)  # up to the caller of the package
        while frame.f_back is not None and frame.f_globals.get("__package__") == __package__:
            level, frame = level + 1, frame.f_back
        for sentence in spoken:
            warnings.warn(sentence, Doubt, stacklevel=level)
        return spoken


def as_written(table: pd.DataFrame) -> pd.DataFrame:
    """The table with its configurations' names as first column, as CSV files have them."""
    if "config" in table.columns:
        return table
    if {"name", "x", "y", "z"} <= {str(column).split("_")[0] for column in table.columns}:
        return table  # a list of points
    if table.index.name == "config":
        return table.reset_index()
    named = table.copy()
    named.insert(0, "config", table.index.astype(str))
    return named


def read_table(path: str) -> pd.DataFrame:
    return pd.read_csv(path, dtype={"config": str}, float_precision="round_trip")


def names(ids: Iterable[Any]) -> list[str]:
    """Ids of configurations as files have them."""
    return [str(one) for one in ids]


def as_json(function: str, keywords: Mapping[str, Any]) -> str:
    """The keywords that are stated, for the library to read."""
    stated = {key: _plain(value) for key, value in keywords.items() if value is not None}
    for key, value in stated.items():
        try:
            json.dumps(value, allow_nan=False)
        except (TypeError, ValueError):
            raise InputError(f"{function}(): {key} is {value!r}, which is no number or text") from None
    return json.dumps(stated)


def _plain(value: Any) -> Any:
    """Without NumPy's types."""
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, (np.ndarray, pd.Series, pd.Index)):
        return value.tolist()
    if isinstance(value, (list, tuple, range, set)):
        return [_plain(item) for item in value]
    return value


def check_number(name: str, value: Any, least: float, *, whole: bool = False) -> None:
    """Raises InputError for what is no number from ``least`` on; None passes."""
    if value is None:
        return
    kinds = (int, np.integer) if whole else (int, float, np.integer, np.floating)
    if not isinstance(value, kinds) or isinstance(value, bool) or not value >= least:
        kind = "a whole number" if whole else "a number"
        raise InputError(f"`{name}` is {value!r}; must be {kind} from {least:g}")


def call_options(threads: int | None, time: float | None, progress: Progress) -> Any:
    check_number("threads", threads, 1, whole=True)
    check_number("time", time, 1e-3)
    shown = _show_progress() if progress is True else progress or None
    return _posewise.CallOptions(threads=threads, time=time or 0.0, progress=shown)


def _show_progress() -> Callable[[int, int], None]:
    """A bar of tqdm, if that is installed, else a line on standard error."""
    try:
        from tqdm.auto import tqdm
    except ImportError:

        def show(done: int, total: int) -> None:
            end = "\n" if done >= total else ""
            print(f"\r{100 * done // max(total, 1):3d} %", end=end, file=sys.stderr, flush=True)

        return show
    bar = tqdm(total=None)

    def advance(done: int, total: int) -> None:
        bar.total = total
        bar.n = done
        bar.refresh()
        if done >= total:
            bar.close()

    return advance
