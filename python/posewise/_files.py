"""What calls are given as files: tables, documents, and files that refer to them."""

from __future__ import annotations

import io
import os
import tempfile
from contextlib import AbstractContextManager, suppress
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, Protocol, Union

import numpy as np
import numpy.typing as npt
import pandas as pd

from . import _posewise
from ._calls import InputError, check_text, numbers, shortened, with_keywords

FilePath = Union[str, "os.PathLike[str]"]
Table = Union[pd.DataFrame, str, "os.PathLike[str]"]
#: A table of configurations, or these as an array in rad and m.
Places = Union[pd.DataFrame, str, "os.PathLike[str]", npt.ArrayLike]


class Input(Protocol):
    """Something that a call was given, for files of its result to refer to."""

    def open(self, files: Files, name: str) -> str:
        """The path of a file with it."""

    def beside(self, path: Path, name: str) -> str:
        """The path to refer to in the file at ``path``; what was no file is written beside it."""


@dataclass(frozen=True)
class GivenFile:
    """A file, by its path as it was stated."""

    path: str
    folder: str

    def open(self, files: Files, name: str) -> str:
        return os.path.join(self.folder, self.path) if self.folder != os.getcwd() else self.path

    def beside(self, path: Path, name: str) -> str:
        there = os.path.join(self.folder, self.path)
        if not os.path.exists(there):
            raise InputError(
                f"`{name}` was read from {self.path}, which is not there any more; must be, for "
                f"{path.name} to refer to it"
            )
        return there if os.path.isabs(self.path) else os.path.relpath(there)


@dataclass(frozen=True)
class Content:
    """What was given in memory, as the content of a file."""

    content: bytes
    suffix: str

    def open(self, files: Files, name: str) -> str:
        path = files.path(name, self.suffix)
        Path(path).write_bytes(self.content)
        return path

    def beside(self, path: Path, name: str) -> str:
        return write_beside(path, name, self.suffix, self.content)


def write_beside(path: Path, name: str, suffix: str, content: bytes) -> str:
    """Writes plan.held.csv beside plan.json; its path from here."""
    target = path.with_name(f"{path.stem}.{name}{suffix}")
    write_file(target, content)
    return os.path.relpath(target)


def write_file(path: FilePath, content: bytes) -> None:
    """Writes a file, all or nothing."""
    target = Path(check_path(path, "path"))
    part = target.with_name(target.name + ".part")
    try:
        part.write_bytes(content)
        part.replace(target)
    except OSError as error:
        with suppress(OSError):
            part.unlink(missing_ok=True)
        raise InputError(f"{target}: cannot be written: {error.strerror}") from None


def check_path(path: Any, name: str) -> str:
    """The path as text. Raises InputError for what is none."""
    try:
        text = os.fspath(path)
        if isinstance(text, str) and text and "\0" not in text:
            text.encode()
            return text
    except (TypeError, UnicodeEncodeError):
        pass
    raise InputError(f"`{name}` is {shortened(path)}; must be the path of a file")


def read_text(path: FilePath, what: str) -> str:
    path = check_path(path, "path")
    try:
        return Path(path).read_text(encoding="utf-8")
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: is no text; must be {what}") from None


class Files(AbstractContextManager["Files"]):
    """Tables and documents as files for one call of the library.

    Messages then name an argument instead of the file that it was written to; ``count`` is what the
    call names its number of poses.
    """

    def __init__(self, count: str = "poses") -> None:
        self._count = count
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        self._names: dict[str, str] = {}

    def path(self, name: str, suffix: str) -> str:
        """A new file for the argument of that name."""
        if self._folder is None:
            self._folder = tempfile.TemporaryDirectory(prefix="posewise")
        path = os.path.join(self._folder.name, name + suffix)
        self._names[path] = name
        return path

    def open(self, inputs: dict[str, Input]) -> dict[str, str]:
        """The path of each, for the library to read."""
        return {name: one.open(self, name) for name, one in inputs.items()}

    def text(self, name: str, content: str) -> str:
        return Content(content.encode(), ".json").open(self, name)

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._folder is not None:
            self._folder.cleanup()
        if isinstance(error, _posewise.InputError):
            message = str(error)
            for path, name in self._names.items():
                message = message.replace(path, name)
            raise InputError(with_keywords(message, self._count)) from None

    def named(self, result: tuple[str, str, list[str]]) -> tuple[str, str, list[str]]:
        """Document, text and warnings of a call, which name arguments, too."""
        document, text, sentences = result
        for path, name in self._names.items():
            document = document.replace(path, name)
            text = text.replace(path, name)
            sentences = [one.replace(path, name) for one in sentences]
        return document, text, [with_keywords(one, self._count) for one in sentences]


# ---- Tables ----


def given(values: dict[str, Input | None]) -> dict[str, Input]:
    """Without those that are None."""
    return {name: one for name, one in values.items() if one is not None}


def table(value: Table | None, name: str) -> Input | None:
    """A table, or the file that it is in already."""
    if value is None:
        return None
    if isinstance(value, (str, bytes, os.PathLike)):
        return GivenFile(check_path(value, name), os.getcwd())
    if not isinstance(value, pd.DataFrame):
        raise InputError(
            f"`{name}` is a {type(value).__name__}; must be a DataFrame with the columns of the "
            "CSV file, or the path of one"
        )
    if value.columns.nlevels > 1 or value.index.nlevels > 1:
        raise InputError(f"`{name}` has several levels of columns or of rows; must have one")
    for column, kind in value.dtypes.items():
        if getattr(kind, "kind", "") == "c":
            raise InputError(f"`{name}` has complex numbers in {column}; must have real ones")
    return Content(check_text(as_written(value).to_csv(index=False), name).encode(), ".csv")


def places(value: Places | None, name: str, columns: list[str]) -> Input | None:
    """A table of configurations, which may be an array of them with these columns."""
    if value is None or isinstance(value, (str, bytes, os.PathLike, pd.DataFrame)):
        return table(value, name)
    rule = f"a DataFrame with the columns of the CSV file, the path of one, or an array (poses, {len(columns)})"
    array = numbers(value, name, rule)
    if array.ndim != 2 or array.shape[1] != len(columns):
        raise InputError(f"`{name}` has the shape {array.shape}; must be {rule}")
    return table(pd.DataFrame(array, columns=columns), name)


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


def array_file(array: npt.NDArray[np.float64]) -> Content:
    """An array as a file of NumPy."""
    buffer = io.BytesIO()
    np.save(buffer, array)
    return Content(buffer.getvalue(), ".npy")
