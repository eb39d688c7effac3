"""How calls reach the compiled library: keywords, messages, interrupts, progress."""

from __future__ import annotations

import json
import re
import sys
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, TypeVar, Union

import numpy as np
import numpy.typing as npt
import pandas as pd

from . import _posewise

Array = npt.NDArray[np.float64]
Progress = Union[bool, Callable[[int, int], object], None]
T = TypeVar("T")


class InputError(ValueError):
    """Something that posewise cannot use; the message says what, and what would be right."""

    @property
    def field(self) -> str | None:
        """The argument that the message is about, where it names one."""
        message = str(self)
        for place in (r"^\w+\(\): `?(\w+)", r"`([\w.]+)`", r"^(\w+):"):
            if named := re.search(place, message):
                return named.group(1)
        return None


class Doubt(UserWarning):
    """Something about data or result that should be looked at first."""


class Interrupted(KeyboardInterrupt):
    """Ctrl-C ended a call that has a result all the same: the best so far, ``.result``."""

    def __init__(self, result: Any) -> None:
        super().__init__("interrupted; .result of this exception is the best so far")
        self.result = result

    def __reduce__(self) -> tuple[Any, ...]:
        return (Interrupted, (self.result,))


# What the library's fields are called in Python.
_keywords = {
    "count": "random",
    "dropped": "drop",
    "earlier": "estimate",
    "earlier.has_new_base": "moved",
    "earlier.is_prior": "as_prior",
    "least_distance": "least_distance_deg",
    "measured": "measurements",
    "pool_count": "pool",
    "pose_count": "poses",
    "spread.is_prior": "prior",
}


# How messages begin about arguments that they do not name.
_beginnings = {
    "pose count is": "`poses` is",
    "excluded candidate": "`exclude`:",
    "test poses are test_poses": "`test_poses` are given",
    "test poses are": "`test_poses` are",
    "groups has": "`groups` has",
}


def with_keywords(message: str, count: str = "poses") -> str:
    """The message with arguments of Python in place of the library's fields; ``count`` is what the
    call names its number of poses."""
    for beginning, words in _beginnings.items():
        message = re.sub(rf"^([^`]*: )?{beginning}", lambda m: (m.group(1) or "") + words, message)
    message = re.sub(r"`([\w.]+)`", lambda m: f"`{_keywords.get(m.group(1), m.group(1))}`", message)
    return message.replace("`poses`", f"`{count}`").replace("(): poses", f"(): {count}")


def warn(sentences: Iterable[str]) -> None:
    """Gives sentences as warnings of the line that called the package."""
    level, frame = 2, sys._getframe(1)
    while frame.f_back is not None and frame.f_globals.get("__package__") == __package__:
        level, frame = level + 1, frame.f_back
    for sentence in sentences:
        warnings.warn(sentence, Doubt, stacklevel=level)


# ---- Arguments ----


def check_kind(value: Any, kind: type[Any], name: str, *, is_needed: bool = False) -> None:
    """Raises InputError for a value that is no such object of the package; None may pass."""
    if isinstance(value, kind) or (value is None and not is_needed):
        return
    raise InputError(f"`{name}` is a {type(value).__name__}; must be a posewise.{kind.__name__}")


def check_number(
    name: str, value: Any, least: float, most: float = np.inf, *, whole: bool = False
) -> None:
    """Raises InputError for what is no number from ``least`` to ``most``; None passes."""
    if value is None:
        return
    kinds = (int, np.integer) if whole else (int, float, np.integer, np.floating)
    if not isinstance(value, kinds) or isinstance(value, bool) or not least <= value <= most:
        kind = "a whole number" if whole else "a number"
        limit = f" to {most:g}" if most < np.inf else ""
        raise InputError(f"`{name}` is {shortened(value)}; must be {kind} from {least:g}{limit}")


def shortened(value: Any) -> str:
    """The value in an error message: one line, however long it is."""
    try:
        words = repr(value)
    except Exception:  # of somebody else's class
        words = f"a {type(value).__name__}"
    words = " ".join(words.encode("utf-8", "backslashreplace").decode().split())
    return words if len(words) <= 60 else words[:57] + "..."


def numbers(value: Any, name: str, rule: str) -> Array:
    """An array of real numbers; ``rule`` says in an error what it must be."""
    try:
        masked = isinstance(value, np.ma.MaskedArray) and bool(np.any(value.mask))
        array = np.asarray(value)
    except Exception:  # of ragged or endless lists, or somebody else's class
        array, masked = np.array(None), False
    if masked:
        raise InputError(f"`{name}` has numbers that are masked; must have them all")
    if array.dtype.kind not in "fiub":
        raise InputError(f"`{name}` must be {rule}")
    return array.astype(float, copy=False)


def names(name: str, ids: Iterable[Any] | None) -> list[str] | None:
    """A list of names, as files have them; whole numbers may be names. None if empty."""
    if ids is None:
        return None
    if isinstance(ids, (str, bytes)):
        raise InputError(f"`{name}` is {shortened(ids)}; must be a list of names: [{shortened(ids)}]")
    try:
        listed = list(ids)
    except TypeError:
        raise InputError(f"`{name}` is {shortened(ids)}; must be a list of names") from None
    for one in listed:
        is_name = isinstance(one, (str, int, np.integer)) and not isinstance(one, bool)
        if not is_name or one == "":
            raise InputError(f"`{name}` has {shortened(one)}; must be names or whole numbers")
    return [str(one) for one in listed] or None


def check_text(text: str, name: str) -> str:
    """The text. Raises InputError if no file can have it."""
    try:
        text.encode()
    except UnicodeEncodeError:
        raise InputError(f"`{name}` has characters that no file can have (lone surrogates)") from None
    return text


def as_json(function: str, keywords: Mapping[str, Any], count: str = "poses") -> str:
    """The keywords that are stated, for the library to read; ``count`` as in with_keywords()."""
    stated = {}
    for key, value in keywords.items():
        if value is None:
            continue
        try:
            stated[key] = _plain(value)
            json.dumps(stated[key], allow_nan=False, ensure_ascii=False).encode()
        except (TypeError, ValueError, RecursionError):
            name = count if key == "poses" else key
            raise InputError(
                f"{function}(): {name} is {shortened(value)}, which is no number or text"
            ) from None
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


# ---- Long calls ----

most_threads = 100_000


def call_options(threads: int | None, time: float | None, progress: Progress) -> Any:
    check_number("threads", threads, 1, most_threads, whole=True)
    check_number("time", time, 1e-3, 1e9)
    if not (progress is None or isinstance(progress, (bool, np.bool_)) or callable(progress)):
        raise InputError(
            f"`progress` is {shortened(progress)}; must be True, False or a function of two "
            "numbers, done and total"
        )
    shown = progress if callable(progress) else _show_progress() if progress else None
    return _posewise.CallOptions(threads=threads, time=time or 0.0, progress=shown)


def made(result: T, doubts: Sequence[str], options: Any) -> T:
    """What a call returns: warns of its doubts, or raises Interrupted with it after Ctrl-C."""
    if options.is_interrupted:
        raise Interrupted(result)
    warn(doubts)
    return result


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
