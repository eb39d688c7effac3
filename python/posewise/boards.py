"""Boards that a camera sees: what is printed on them, and files to print them from."""

from __future__ import annotations

import importlib
import os
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from ._calls import Array, InputError, shortened
from ._files import check_path, read_text, write_file
from .campaign import Campaign

#: A campaign whose instrument is a camera, or the keys of its section ``board``.
BoardLike = Union[Campaign, Mapping[str, Any]]
Cells = npt.NDArray[np.bool_]

# Around the board as a key of a campaign file.
_campaign: dict[str, Any] = {
    "name": "board",
    "robot": {"joints": {"q1": {"limits_deg": [-90, 90]}}, "elements": ["Rz q1"]},
}
_camera: dict[str, Any] = {"kind": "camera", "camera": "fixed", "sigma_px": 1, "intrinsics": {"known": False}}
_mm = 1e3


def opencv(purpose: str, *, aruco: bool = True) -> Any:
    """The module cv2. Raises ImportError, which names Debian's package."""
    try:
        cv2 = importlib.import_module("cv2")
    except ImportError:
        raise ImportError(
            f"to {purpose} needs OpenCV (Debian: python3-opencv); it is not installed"
        ) from None
    if aruco and not hasattr(cv2, "aruco"):
        raise ImportError(
            f"to {purpose} needs OpenCV with its module aruco (Debian: python3-opencv); the one "
            f"installed, {cv2.__version__}, is without"
        )
    return cv2


@dataclass(frozen=True)
class Board:
    """A board's pattern; its corners by number from 0 are ``corners``, (corners, 2) in m."""

    kind: str  #: chessboard, charuco or aprilgrid
    columns: int  #: inner corners, squares or tags in a row
    rows: int
    marker: float  #: side of a marker or tag, m
    dictionary: str  #: of these, as OpenCV names it
    is_legacy: bool  #: a ChArUco board whose first square is white
    corners: Array
    first_point: int  #: number of the first corner in measurements
    cameras: int  #: that see it

    @classmethod
    def of(cls, board: BoardLike) -> Board:
        if isinstance(board, Campaign):
            stated = board._core.board
            if stated is None:
                raise InputError("`board` is a campaign without a camera; must have kind: camera")
        elif isinstance(board, Mapping):
            try:
                keys: dict[str, Any] = {**_campaign, "sensor": {**_camera, "board": dict(board)}}
                stated = Campaign.from_dict(keys)._core.board
            except InputError as error:
                raise InputError(
                    re.sub(r"^campaign:\d+:\d+: (sensor\.)?board", "`board`", str(error))
                ) from None
        else:
            raise InputError(
                f"`board` is {shortened(board)}; must be a Campaign, or a dict of the keys of its board"
            )
        assert stated is not None
        if stated["kind"] == "points":
            raise InputError("`board` has points_mm and no pattern; must be of another kind")
        return cls(**{**stated, "corners": stated["corners"][:, :2]})

    @property
    def pitch(self) -> Array:
        """From a square or tag to the next, along x and y, m."""
        if self.kind == "chessboard":
            return np.asarray(self.corners[self.columns + 1] - self.corners[0])
        return np.full(2, self.corners[0 if self.kind == "charuco" else 2, 0])

    def black(self) -> Cells:
        """Which squares are, (rows, columns)."""
        inner = int(self.kind == "chessboard")
        squares = np.indices((self.rows + inner, self.columns + inner))
        return np.asarray(squares.sum(axis=0) % 2 == int(self.is_legacy))

    def markers(self) -> Array:
        """Corners of a ChArUco board's markers by their ids, (markers, 4, 2) in m, in OpenCV's order:
        clockwise from the upper left one."""
        rows, columns = np.nonzero(~self.black())
        middles = self.pitch * (np.column_stack([columns, rows]) + 0.5)
        around = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * self.marker / 2
        return np.asarray(middles[:, None] + around)

    def tag_points(self) -> npt.NDArray[np.int64]:
        """Numbers from 0 of tags' corners, (tags, 4), in OpenCV's order. Its tags are Kalibr's
        turned by 180 degrees."""
        grid = np.arange(4 * self.rows * self.columns).reshape(2 * self.rows, 2 * self.columns)
        lower, upper = grid[::2], grid[1::2]
        corners = [lower[:, 1::2], lower[:, ::2], upper[:, ::2], upper[:, 1::2]]
        return np.stack([one.ravel() for one in corners], axis=1)

    def keys(self) -> str:
        """As a campaign file states it."""
        pitch = _mm * self.pitch
        stated: dict[str, Any] = {"kind": self.kind, "columns": self.columns, "rows": self.rows}
        if self.kind == "aprilgrid":
            stated["tag_mm"] = _mm * self.marker
            stated["spacing"] = self.pitch[0] / self.marker - 1
        else:
            stated["square_mm"] = pitch[0]
        if self.kind == "charuco":
            stated |= {"marker_mm": _mm * self.marker, "dictionary": self.dictionary}
        if self.is_legacy:
            stated["legacy"] = "true"
        stated["first_point"] = self.first_point
        values = {
            key: f"{value:.12g}" if isinstance(value, float) else value
            for key, value in stated.items()
        }
        return "{" + ", ".join(f"{key}: {value}" for key, value in values.items()) + "}"


def dictionary_of(board: Board, cv2: Any, count: int) -> Any:
    """OpenCV's dictionary. Raises InputError if it has none of that name, or fewer markers."""
    number = getattr(cv2.aruco, board.dictionary, None)
    if not isinstance(number, int):
        raise InputError(f"`board`: OpenCV {cv2.__version__} has no dictionary {board.dictionary}")
    dictionary = cv2.aruco.getPredefinedDictionary(number)
    if len(dictionary.bytesList) < count:
        raise InputError(
            f"`board` has {count} markers, {board.dictionary} {len(dictionary.bytesList)}; must be "
            "a dictionary with enough of them"
        )
    return dictionary


# ---- To print ----


@dataclass(frozen=True)
class _Piece:
    """Black cells, (rows, columns), from the upper left one down, in mm."""

    cells: Cells
    place: Array  #: of its upper left corner, x to the right and y down
    size: Array  #: of a cell

    def rectangles(self) -> Iterator[Array]:
        """x, y, width and height of each run of black cells in a row."""
        for row, cells in enumerate(self.cells):
            ends = np.flatnonzero(np.diff(np.r_[0, cells, 0]))
            for first, last in ends.reshape(-1, 2):
                corner = self.place + self.size * (first, row)
                yield np.r_[corner, self.size * (last - first, 1)]


def _marker_cells(board: Board, count: int, border: int) -> Iterator[Cells]:
    """The first markers with a border of that many cells."""
    cv2 = opencv(f"draw a board of kind {board.kind}")
    dictionary = dictionary_of(board, cv2, count)
    draw = getattr(cv2.aruco, "generateImageMarker", None) or cv2.aruco.drawMarker
    side = dictionary.markerSize + 2 * border
    for marker in range(count):
        yield draw(dictionary, marker, side, None, border) == 0


def _pieces(board: Board) -> Iterator[_Piece]:
    pitch, side = _mm * board.pitch, _mm * board.marker
    if board.kind != "aprilgrid":
        yield _Piece(board.black(), np.zeros(2), pitch)
    if board.kind == "charuco":
        markers = board.markers()
        for cells, corners in zip(_marker_cells(board, len(markers), 1), markers):
            yield _Piece(cells, _mm * corners[0], np.full(2, side / len(cells)))
    if board.kind == "aprilgrid":
        gap = pitch - side
        # Squares in the gaps' crossings, so that two edges go on through a tag's corner.
        for row, column in np.ndindex(board.rows + 1, board.columns + 1):
            yield _Piece(np.ones((1, 1), bool), pitch * (column, row), gap)
        tags = _marker_cells(board, board.rows * board.columns, 2)
        for (row, column), cells in zip(np.ndindex(board.rows, board.columns), tags):
            place = gap + pitch * (column, board.rows - 1 - row)
            yield _Piece(np.rot90(cells, 2), place, np.full(2, side / len(cells)))


def _rectangle(numbers: Array) -> str:
    x, y, width, height = (f"{number:.6g}" for number in numbers)
    return f'<rect x="{x}" y="{y}" width="{width}" height="{height}"/>'


def draw_board(board: BoardLike, path: str | os.PathLike[str]) -> None:
    """Writes a board as an SVG file in true scale, and beside it a YAML file that describes it.

    ``board`` is a campaign whose instrument is a camera, or a dict of the keys of its board
    (``{"kind": "charuco", "columns": 5, "rows": 7, "square_mm": 30, "marker_mm": 22}``; chessboard,
    charuco or aprilgrid). board.yaml, beside board.svg, is what a campaign names:
    ``board: {file: board.yaml}``. Print without fitting to the page; the bar below the board must
    be 100 mm long. Markers come from python3-opencv. A board.yaml that is another file's is not
    replaced.
    """
    stated = Board.of(board)
    if abs(np.diff(stated.pitch)[0]) > 1e-9:
        raise InputError("`board` has squares of two sides; must have one to be drawn")
    target = Path(check_path(path, "path"))
    if target.suffix != ".svg":
        raise InputError(f"`path` is {shortened(str(path))}; must end in .svg")
    description = target.with_suffix(".yaml")
    _check_may_be_replaced(description)
    black = np.array([one for piece in _pieces(stated) for one in piece.rectangles()])
    bar = 100.0
    margin = max(10.0, _mm * float(stated.pitch[0] - (stated.kind == "aprilgrid") * stated.marker))
    size = (black[:, :2] + black[:, 2:]).max(axis=0)
    width, height = max(size[0], bar) + 2 * margin, size[1] + 2 * margin + 12
    black[:, :2] += margin
    below = size[1] + 2 * margin
    words = [stated.keys(), "The bar is 100 mm long in a print at 100 %, not fitted to the page."]
    font = min(3, (width - 2 * margin) / (0.6 * max(map(len, words))))
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.6g}mm" height="{height:.6g}mm" '
        f'viewBox="0 0 {width:.6g} {height:.6g}" shape-rendering="crispEdges">',
        '<rect width="100%" height="100%" fill="white"/>',
        '<g id="board">',
        *map(_rectangle, black),
        "</g>",
        '<g id="bar">',
        _rectangle(np.array([margin, below, bar, 1])),
        "</g>",
        *(
            f'<text x="{margin:.6g}" y="{below + 5 + 4 * k:.6g}" font-size="{font:.3g}">{line}</text>'
            for k, line in enumerate(words)
        ),
        "</svg>\n",
    ]
    write_file(target, "\n".join(lines).encode())
    write_file(description, f"{_remark}\nboard: {stated.keys()}\n".encode())


_remark = "# Printed at 100 %: the bar below the board is 100 mm long."


def _check_may_be_replaced(description: Path) -> None:
    """Whether nothing is there, or what draw_board() wrote."""
    if os.path.exists(description):  # of a name that is too long nothing is
        lines = read_text(description, "a board's description").splitlines()
        if len(lines) != 2 or lines[0] != _remark or not lines[1].startswith("board: {"):
            raise InputError(
                f"{description}: is not what draw_board() writes beside {description.stem}.svg; must "
                "be elsewhere, or the drawing have another name"
            )
