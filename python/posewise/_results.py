"""What results have in common: how they show themselves, and how they become files."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from ._calls import Array, InputError
from ._files import FilePath, Files, GivenFile, Input, check_path, read_text


class Shown(Protocol):
    """A result of the library."""

    @property
    def document(self) -> Mapping[str, Any]: ...
    @property
    def text(self) -> str: ...


class Written(Shown, Protocol):
    """A result that can be a file."""

    def write(self, path: FilePath) -> None: ...


class Result:
    """A result with a ``document`` and the ``text`` that the program prints of it."""

    def __str__(self: Shown) -> str:
        if self.text:
            return self.text
        kind = str(self.document["kind"]).removeprefix("posewise ")
        answers = [f"{a['question']} {a['text']}" for a in self.document.get("answers", [])]
        poses = f", {len(self.document['poses'])} poses" if "poses" in self.document else ""
        return "\n".join([f"{kind} of {self.document['campaign']}{poses}", *answers])

    def _repr_html_(self: Shown) -> str:
        """What people ask of a result first, as a page shows it; else its text."""
        if not self.document.get("answers"):
            return f"<pre>{escape(str(self))}</pre>"
        rows = "".join(
            f"<tr><th style='text-align:left'>{escape(a['question'])}</th>"
            f"<td style='text-align:left'>{escape(a['text'])}</td></tr>"
            for a in self.document["answers"]
        )
        return f"<table>{rows}</table>"


@dataclass(frozen=True)
class GivenResult:
    """A plan or an estimate that something was built on."""

    result: Written

    def open(self, files: Files, name: str) -> str:
        return files.text(name, json.dumps(self.result.document))

    def beside(self, path: Path, name: str) -> str:
        target = path.with_name(f"{path.stem}.{name}.json")
        self.result.write(target)
        return os.path.relpath(target)


@dataclass(frozen=True)
class OneOfSeveral(GivenResult):
    """One of several plans, whose file's name stands before its poses' ids: plan1/p3."""

    def beside(self, path: Path, name: str) -> str:
        folder = path.with_name(f"{path.stem}.plans")
        folder.mkdir(exist_ok=True)
        self.result.write(folder / f"{name}.json")
        return os.path.relpath(folder / f"{name}.json")


def result_input(result: Written | None) -> Input | None:
    return None if result is None else GivenResult(result)


def read_result(path: FilePath, kind: str) -> str:
    """The text of a file that holds such a result: "plan", "estimate"."""
    text = read_text(path, f"a file of posewise, a {kind}")
    try:
        if json.loads(text).get("kind") == f"posewise {kind}":
            return text
    except (ValueError, AttributeError, RecursionError):
        pass
    raise InputError(f"{os.fspath(path)}: is no {kind} of posewise")


# Where a plan's file says what it was made from, by argument.
_places = {
    "campaign": ("candidates", "campaign_file"),
    "candidates": ("candidates", "source"),
    "held": ("problem", "augment"),
    "test_poses": ("problem", "test_poses"),
    "groups": ("problem", "groups"),
    "workspace": ("problem", "workspace"),
    "repair": ("problem", "repaired_plan"),
}


def with_sources(document: Mapping[str, Any], paths: Mapping[str, str | None]) -> dict[str, Any]:
    """A plan's document that names these files, and no other."""
    changed = dict(document)
    for section in ("candidates", "problem"):
        changed[section] = dict(document[section])
    for name, (section, key) in _places.items():
        if key in changed[section]:
            changed[section][key] = paths.get(name)
    if "measurements" in paths:
        changed["candidates"]["source"] = paths["measurements"]
    if changed["problem"].get("estimate"):
        changed["problem"]["estimate"] = {
            **changed["problem"]["estimate"],
            "file": paths.get("estimate"),
        }
    return changed


def sources_of(document: Mapping[str, Any], folder: str) -> dict[str, Input]:
    """The files, besides the campaign's, that a plan's document names, seen from that folder."""
    stated = {name: document[section].get(key) for name, (section, key) in _places.items()}
    stated["estimate"] = (document["problem"].get("estimate") or {}).get("file")
    del stated["campaign"]
    found: dict[str, Input] = {}
    for name, path in stated.items():
        if path:
            beside = os.path.join(folder, path)
            found[name] = GivenFile(beside if os.path.exists(beside) else path, os.getcwd())
    return found


def as_stated(inputs: Mapping[str, Input]) -> dict[str, str | None]:
    """What documents name: files as their paths were stated, nothing else."""
    return {
        name: one.path if isinstance(one, GivenFile) else None for name, one in inputs.items()
    }


def target_of(path: FilePath) -> Path:
    """Where a result is to be written."""
    target = Path(check_path(path, "path"))
    if target.is_dir():
        raise InputError(f"{target}: is a folder; must be the path of a file")
    return target


def symmetric(lower: Sequence[Sequence[float]]) -> Array:
    """The matrix with these rows up to its diagonal."""
    matrix = np.zeros((len(lower), len(lower)))
    for i, row in enumerate(lower):
        matrix[i, : i + 1] = matrix[: i + 1, i] = row
    return matrix
