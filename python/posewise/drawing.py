"""Axes to draw in; matplotlib need not be installed before something is drawn."""

from __future__ import annotations

from typing import Any


def axes(given: Any) -> Any:
    if given is not None:
        return given
    try:
        from matplotlib import pyplot
    except ImportError:
        raise ImportError(
            "to draw needs matplotlib (Debian: python3-matplotlib); it is not installed"
        ) from None
    return pyplot.subplots()[1]
