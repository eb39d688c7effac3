"""Corners of boards in images, by OpenCV."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Union

import numpy as np
import numpy.typing as npt
import pandas as pd

from ._calls import Array, InputError, check_number, shortened, warn
from ._files import as_written, check_path
from .boards import Board, BoardLike, dictionary_of, opencv
from .campaign import Campaign

Image = Union[str, "os.PathLike[str]", npt.NDArray[np.uint8]]
#: Numbers of corners from 0, and where they are seen, (corners, 2) in px.
Found = tuple[npt.NDArray[np.int64], Array]
most_cameras = 17  # of a campaign
least_reach = 2  # px around a corner


def detect(
    images: Sequence[Image],
    board: BoardLike,
    *,
    joints: pd.DataFrame | npt.ArrayLike | None = None,
    camera: int | None = None,
) -> pd.DataFrame:
    """Corners of a board in images: a row for each, with the columns config, those of ``joints``,
    camera, point, u_px, v_px, which :func:`posewise.calibrate` takes.

    ``images`` are paths or arrays of bytes, (height, width) or (height, width, 3) with OpenCV's
    channels. ``board`` is a campaign whose instrument is a camera, or a dict of the keys of its
    board (kind chessboard, charuco or aprilgrid). ``joints`` has a row for each image: a DataFrame
    (q1_deg, ...), or with a campaign an array in rad and m; without it these columns are missing.
    ``camera`` is the number of the one that took the images, where the campaign has several.
    Configurations have the names in ``joints`` (column or index config), else those of the files, else
    numbers from 0.

    Points are numbered as the campaign's board says; pixels are OpenCV's. An image that shows no board
    is left out with a :class:`posewise.Doubt`. Corners that are seen elsewhere than those around them
    say are left out. Needs python3-opencv.
    """
    stated = Board.of(board)
    cv2 = opencv("detect a board", aruco=stated.kind != "chessboard")
    is_list = isinstance(images, (Sequence, np.ndarray, pd.Series))
    if not is_list or isinstance(images, (str, bytes)) or len(images) == 0:
        raise InputError(f"`images` is {shortened(images)}; must be a list of paths or arrays")
    known = stated.cameras if isinstance(board, Campaign) else most_cameras
    check_number("camera", camera, 1, known, whole=True)
    if camera is None and stated.cameras > 1:
        raise InputError(f"detect(): needs `camera`, 1 to {stated.cameras}: the one of these images")
    names = _names(images)
    views = _views(names, joints, board)
    taken = {"point", "u_px", "v_px"} | ({"camera"} if camera is not None else set())
    for column in views.columns:
        if column in taken:
            raise InputError(f"`joints` has a column {column}, which detect() finds; must be left out")
    find = {"chessboard": _chessboard, "charuco": _charuco, "aprilgrid": _aprilgrid}[stated.kind]
    found = []
    for image, name in zip(images, names):
        grey = _grey(cv2, image, name)
        try:
            found.append(find(cv2, grey, stated))
        except cv2.error as error:
            raise InputError(
                f"OpenCV cannot look for the board in image {name}: {error.err}"
            ) from None
    is_seen = any(len(points) > 0 for points, _ in found)
    found = [_agreeing(cv2, stated, one) for one in found]
    if is_seen and not any(len(points) > 0 for points, _ in found):
        raise InputError(
            f"`images` show parts of {stated.keys()}, but not where that board has them; must be "
            "stated as it is printed: columns, rows, sizes"
        )
    missing = [name for name, (points, _) in zip(names, found) if len(points) == 0]
    if len(missing) == len(names):
        raise InputError(
            f"`images` show no board like {stated.keys()}; must have one in at least one of them"
            + (" (a chessboard counts inner corners)" if stated.kind == "chessboard" else "")
        )
    table = views.loc[views.index.repeat([len(points) for points, _ in found])]
    table = table.reset_index(drop=True)
    if camera is not None:
        table["camera"] = camera
    table["point"] = np.concatenate([points for points, _ in found]) + stated.first_point
    table[["u_px", "v_px"]] = np.concatenate([pixels for _, pixels in found])
    if missing:
        warn([f"no board found in {len(missing)} of {len(names)} images: {', '.join(missing)}"])
    if stated.kind == "chessboard" and (stated.columns + stated.rows) % 2 == 0:
        warn([
            f"a chessboard of {stated.columns} x {stated.rows} corners looks the same when turned "
            "by 180 deg: its corners are numbered as if no image showed it upside down; take one "
            "with an odd and an even number"
        ])
    return table


# ---- What is asked for ----


def _names(images: Sequence[Image]) -> list[str]:
    """Of configurations: files without folder and suffix where these differ, else numbers."""
    paths = [image for image in images if not isinstance(image, np.ndarray)]
    stems = [Path(check_path(path, "images")).stem for path in paths]
    if len(set(stems)) == len(images):
        return stems
    return [str(k) for k in range(len(images))]


def _views(names: list[str], joints: Any, board: BoardLike) -> pd.DataFrame:
    """A row for each image: config and joints."""
    if joints is None:
        return pd.DataFrame({"config": names})
    if not isinstance(joints, pd.DataFrame):
        if not isinstance(board, Campaign):
            raise InputError(
                "`joints` is no DataFrame, whose columns would name them; must be, or `board` a "
                "campaign"
            )
        joints = pd.DataFrame(board.configurations(joints), columns=board._core.columns)
    if not joints.columns.is_unique:
        twice = joints.columns[joints.columns.duplicated()][0]
        raise InputError(f"`joints` has the column {twice} twice; must have each once")
    if len(joints) != len(names):
        raise InputError(
            f"`joints` has {len(joints)} rows for {len(names)} images; must have one for each"
        )
    if "config" in joints.columns or joints.index.name == "config":
        return as_written(joints).reset_index(drop=True)
    views = joints.reset_index(drop=True)
    views.insert(0, "config", names)
    return views


def _grey(cv2: Any, image: Image, name: str) -> npt.NDArray[np.uint8]:
    """The image's brightness, (height, width)."""
    if not isinstance(image, np.ndarray):
        path = check_path(image, "images")
        # As the camera took it: intrinsics are of the image that is not turned.
        flags = cv2.IMREAD_GRAYSCALE | cv2.IMREAD_IGNORE_ORIENTATION
        try:
            grey = cv2.imread(path, flags)
        except cv2.error:  # more pixels than OpenCV takes
            grey = None
        if grey is None:
            raise InputError(f"{path}: cannot be read as an image")
        return np.asarray(grey)
    is_plain = image.ndim == 2 or (image.ndim == 3 and image.shape[2] == 3)
    if image.size == 0 or image.dtype != np.uint8 or not is_plain:
        raise InputError(
            f"`images` has an array {image.shape} of {image.dtype}, image {name}; must be uint8, "
            "(height, width) or (height, width, 3)"
        )
    return np.asarray(image if image.ndim == 2 else cv2.cvtColor(image, cv2.COLOR_BGR2GRAY))


# ---- What is found ----

_nothing: Found = np.empty(0, np.int64), np.empty((0, 2))


def _refined(
    cv2: Any, grey: npt.NDArray[np.uint8], points: Any, pixels: Array, reach: float
) -> Found:
    """Corners to parts of a pixel, by the gradients around each: in a square of that half side, px,
    which no other edge must cross. Without those whose square is not in the image."""
    half = int(np.clip(reach, least_reach, 15))
    last = np.array(grey.shape[::-1]) - 1
    is_inside = ((pixels > half + 1) & (pixels < last - half - 1)).all(axis=1)
    if not is_inside.any():
        return _nothing
    stop = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_COUNT, 50, 1e-4)
    guess = pixels[is_inside].astype(np.float32).reshape(-1, 1, 2)
    refined = cv2.cornerSubPix(grey, guess, (half, half), (-1, -1), stop)
    return np.asarray(points)[is_inside], np.asarray(refined, float)[:, 0]


def _chessboard(cv2: Any, grey: npt.NDArray[np.uint8], board: Board) -> Found:
    # A large image takes minutes; where the corners are in it is found afterwards.
    shrink = min(1.0, float(np.sqrt(2e6 / grey.size)))
    small = cv2.resize(grey, None, fx=shrink, fy=shrink, interpolation=cv2.INTER_AREA)
    flags = cv2.CALIB_CB_NORMALIZE_IMAGE | cv2.CALIB_CB_EXHAUSTIVE
    is_found, pixels = cv2.findChessboardCornersSB(small, (board.columns, board.rows), flags=flags)
    if not is_found:
        return _nothing
    scale = np.array(grey.shape[::-1]) / small.shape[::-1]
    seen = (np.asarray(pixels, float) + 0.5) * scale - 0.5  # 0 is the middle of the first pixel
    grid = _upright(grey, seen.reshape(board.rows, board.columns, 2))
    if _is_of_larger(grey, grid):
        return _nothing
    steps = [np.linalg.norm(np.diff(grid, axis=axis), axis=2).min() for axis in (0, 1)]
    points = np.arange(len(board.corners))
    return _refined(cv2, grey, points, grid.reshape(-1, 2), 0.4 * float(min(steps)))


def _upright(grey: npt.NDArray[np.uint8], grid: Array) -> Array:
    """Corners, (rows, columns, 2), in the order in which the first square between them is black; of
    boards that look the same when turned, as least turned in the image."""
    along, down = grid[0, -1] - grid[0, 0], grid[-1, 0] - grid[0, 0]
    if along[0] * down[1] < along[1] * down[0]:
        grid = grid[:, ::-1]  # is numbered as in a mirror
    turns = range(4 if len(grid) == len(grid[0]) else 2)
    step = 1 if len(turns) == 4 else 2
    turned = [np.rot90(grid, step * k) for k in turns]
    fitting = [one for one in turned if _begins_black(grey, one)] or turned
    return max(fitting, key=lambda one: float(one[0, -1, 0] - one[0, 0, 0]))


def _begins_black(grey: npt.NDArray[np.uint8], grid: Array) -> bool:
    """Whether squares between corners that have the first one's colour are darker than the others."""
    middles = (grid[:-1, :-1] + grid[1:, :-1] + grid[:-1, 1:] + grid[1:, 1:]) / 4
    u, v = np.rint(middles).astype(int).T
    is_even = np.indices(u.shape).sum(axis=0) % 2 == 0
    shades = grey[v, u].astype(float)
    return bool(is_even.all()) or bool(shades[is_even].mean() < shades[~is_even].mean())


def _is_of_larger(grey: npt.NDArray[np.uint8], grid: Array) -> bool:
    """Whether squares alternate beyond the outer corners, or between corners: these are some of a
    larger board's."""
    across = grid.transpose(1, 0, 2)
    return any(_alternates(grey, one) for one in (grid, grid[::-1], across, across[::-1]))


def _alternates(grey: npt.NDArray[np.uint8], grid: Array) -> bool:
    """Whether squares alternate around most places that are one step before the first row, or half a
    step behind it."""
    last = np.array(grey.shape[::-1]) - 1
    edge, step = grid[0], grid[1] - grid[0]
    along = np.gradient(edge, axis=0)

    def contrast(places: Array, reach: float) -> Array:
        """Of two squares that touch at a corner with the other two; none outside the image."""
        signs = [(a, b) for a in (-reach, reach) for b in (-0.3, 0.3)]
        around = np.stack([places + a * step + b * along for a, b in signs])
        u, v = np.moveaxis(np.rint(np.clip(around, 0, last)).astype(int), 2, 0)
        shades = grey[v, u].astype(float)
        is_inside = ((around >= 0) & (around <= last)).all(axis=(0, 2))
        return np.asarray(np.abs(shades[0] - shades[1] - shades[2] + shades[3]) * is_inside)

    # Where the board ends two of the four are alike, which is half of the contrast.
    least = 0.75 * np.median(contrast(edge, 0.3))
    beyond, between = contrast(edge - step, 0.3), contrast(edge + step / 2, 0.15)
    return any(np.sum(one > least) > len(edge) / 2 for one in (beyond, between))


def _markers(
    cv2: Any, grey: npt.NDArray[np.uint8], board: Board, count: int, border: int
) -> tuple[npt.NDArray[np.int64], Array]:
    """Ids below ``count`` that are seen once, and corners, (markers, 4, 2) in px."""
    dictionary = dictionary_of(board, cv2, count)
    if hasattr(cv2.aruco, "ArucoDetector"):  # since OpenCV 4.7
        parameters = cv2.aruco.DetectorParameters()
        parameters.markerBorderBits = border
        corners, ids, _ = cv2.aruco.ArucoDetector(dictionary, parameters).detectMarkers(grey)
    else:
        parameters = cv2.aruco.DetectorParameters_create()
        parameters.markerBorderBits = border
        corners, ids, _ = cv2.aruco.detectMarkers(grey, dictionary, parameters=parameters)
    if ids is None:
        return np.empty(0, np.int64), np.empty((0, 4, 2))
    ids = np.ravel(ids).astype(np.int64)
    is_good = (ids < count) & np.array([np.sum(ids == one) == 1 for one in ids])
    return ids[is_good], np.reshape(corners, (-1, 4, 2)).astype(float)[is_good]


def _aprilgrid(cv2: Any, grey: npt.NDArray[np.uint8], board: Board) -> Found:
    points = board.tag_points()
    # Kalibr's tags have a border of two cells, others one.
    seen = [(*_markers(cv2, grey, board, len(points), border), border) for border in (2, 1)]
    ids, corners, border = max(seen, key=lambda one: len(one[0]))
    border_width = board.marker * border / (6 + 2 * border)
    clear = min(border_width, float(board.pitch[0]) - board.marker)
    return _near_markers(
        cv2, grey, board, (board.corners[points[ids]], corners), points[ids].ravel(), clear, least=1
    )


def _charuco(cv2: Any, grey: npt.NDArray[np.uint8], board: Board) -> Found:
    markers = board.markers()
    ids, corners = _markers(cv2, grey, board, len(markers), 1)
    if len(ids) < 2:  # of which a corner needs both beside it
        return _nothing
    if board.rows % 2 == 0:
        other = replace(board, is_legacy=not board.is_legacy)
        misfits = [_misfit(cv2, one.markers()[ids], corners) for one in (board, other)]
        if misfits[0] > 2 * misfits[1]:
            raise InputError(
                f"`board` has its markers where one with legacy: {str(other.is_legacy).lower()} has "
                "them; must be stated as it is"
            )
    clear = (float(board.pitch[0]) - board.marker) / 2
    points = np.arange(len(board.corners))
    return _near_markers(cv2, grey, board, (markers[ids], corners), points, clear, least=2)


def _near_markers(
    cv2: Any,
    grey: npt.NDArray[np.uint8],
    board: Board,
    markers: tuple[Array, Array],
    points: npt.NDArray[np.int64],
    clear: float,
    *,
    least: int,
) -> Found:
    """These points where the markers around them say, and then as the image has them. Markers are
    places on the board and in the image, (markers, 4, 2) in m and px; at least so many must be near.
    No edge but a corner's own is within ``clear``, m, of it."""
    places, seen = markers
    found, pixels = [], []
    for point in points:
        distances = np.linalg.norm(places.mean(axis=1) - board.corners[point], axis=1)
        near = distances < board.pitch[0]
        if near.sum() < least:
            continue
        # Of a marker that touches something dark a corner may be many pixels off.
        H, _ = cv2.findHomography(
            places[near].reshape(-1, 2), seen[near].reshape(-1, 2), cv2.RANSAC, 2.0
        )
        if H is not None:
            found.append(point)
            pixels.append(_mapped(cv2, board.corners[point], H)[0])
    if not found:
        return _nothing
    side = float(np.linalg.norm(np.diff(seen, axis=1), axis=2).min())
    reach = 0.7 * clear * side / board.marker
    if reach < least_reach:
        warn([
            "in some images markers are so close to the corners beside them that these may be off by "
            "pixels: markers of at most 0.9 of their squares, or nearer images, are better"
        ])
    return _refined(cv2, grey, found, np.array(pixels), reach)


def _agreeing(cv2: Any, board: Board, found: Found) -> Found:
    """The corners that are seen where those around them say, on a plane; none where too few are, so
    that the board is another one."""
    points, pixels = found
    # Of a chessboard all are found together, of markers each by itself.
    fewest = (0.9 if board.kind == "chessboard" else 0.5) * len(points)
    places = board.corners[points]
    kept = list(range(len(points)))
    while len(kept) >= fewest:
        worst = _out_of_line(cv2, board, places[kept], pixels[kept])
        if worst is None:
            return points[kept], pixels[kept]
        del kept[worst]
    return _nothing


def _out_of_line(cv2: Any, board: Board, places: Array, pixels: Array) -> int | None:
    """The corner that is farthest from where those around it say, if that is too far."""
    most, least = 20, 8  # of those around; fewer do not tell
    if len(places) <= least:
        return None
    steps = np.array([[0, 0], [board.pitch[0], 0], [0, board.pitch[1]]])
    off = np.zeros(len(places))
    for k, place in enumerate(places):
        order = np.argsort(np.linalg.norm(places - place, axis=1), kind="stable")
        near = order[1 : most + 1]
        H, _ = cv2.findHomography(places[near], pixels[near])
        if H is None:
            continue
        here, along, down = _mapped(cv2, place + steps, H)
        step = float(np.linalg.norm(along - here) + np.linalg.norm(down - here)) / 2
        # A lens bends so small a part of the board by less.
        off[k] = float(np.linalg.norm(pixels[k] - here)) / max(1.0, 0.03 * step)
    worst = int(np.argmax(off))
    return worst if off[worst] > 1 else None


def _mapped(cv2: Any, places: Array, homography: Array) -> Array:
    return np.asarray(cv2.perspectiveTransform(places.reshape(-1, 1, 2), homography))[:, 0]


def _misfit(cv2: Any, places: Array, seen: Array) -> float:
    """How far markers of a plane board with these places are from where they are seen, px RMS."""
    pixels = seen.reshape(-1, 2)
    H, _ = cv2.findHomography(places.reshape(-1, 2), pixels)
    if H is None:
        return float("inf")
    return float(np.sqrt(np.mean((_mapped(cv2, places, H) - pixels) ** 2)))
