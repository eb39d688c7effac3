"""What results have in common: how they show themselves, and how they become files."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from html import escape
from pathlib import Path

import numpy as np
import numpy.typing as npt

from ._calls import InputError, Shown


class Result:
    """A result with a ``document`` and the ``text`` that the program prints of it."""

    def __str__(self: Shown) -> str:
        return self.text

    def _repr_html_(self: Shown) -> str:
        """What people ask of a result first, as a page shows it."""
        rows = "".join(
            f"<tr><th style='text-align:left'>{escape(a['question'])}</th>"
            f"<td style='text-align:left'>{escape(a['text'])}</td></tr>"
            for a in self.document.get("answers", [])
        )
        return f"<table>{rows}</table>"


def read_result(path: str | os.PathLike[str], kind: str) -> str:
    """The text of a file that holds such a result: "plan", "estimate"."""
    try:
        text = Path(path).read_text(encoding="utf-8")
        if json.loads(text).get("kind") != f"posewise {kind}":
            raise ValueError
    except OSError as error:
        raise InputError(f"{os.fspath(path)}: cannot be read: {error.strerror}") from None
    except (ValueError, AttributeError):
        raise InputError(f"{os.fspath(path)}: is no {kind} of posewise") from None
    return text


def symmetric(lower: Sequence[Sequence[float]]) -> npt.NDArray[np.float64]:
    """The matrix with these rows up to its diagonal."""
    matrix = np.zeros((len(lower), len(lower)))
    for i, row in enumerate(lower):
        matrix[i, : i + 1] = matrix[: i + 1, i] = row
    return matrix
