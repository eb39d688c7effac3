"""Boards as they are printed, and their corners in images of which it is known where they are."""

import re
import sys
import xml.etree.ElementTree as ElementTree

import numpy as np
import pandas as pd
import pytest
from conftest import designs

import posewise as pw

chessboard = {"columns": 8, "rows": 5, "square_mm": 25}
charuco = {"kind": "charuco", "columns": 5, "rows": 7, "square_mm": 30, "marker_mm": 22}
aprilgrid = {"kind": "aprilgrid", "columns": 4, "rows": 3, "tag_mm": 50, "spacing": 0.3}
K = np.array([[1500.0, 0, 655], [0, 1490, 470], [0, 0, 1]])
width, height = 1280, 960


@pytest.fixture(scope="module")
def cv2():
    return pytest.importorskip("cv2")


def turn(axis, degrees):
    """A rotation about x, y or z."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    rotation = np.eye(3)
    i, j = [(1, 2), (2, 0), (0, 1)]["xyz".index(axis)]
    rotation[[i, j, i, j], [i, j, j, i]] = c, c, -s, s
    return rotation


class Printed:
    """A board as its SVG file has it, with corners by number in mm from the page's upper left."""

    def __init__(self, board, folder, change=lambda cells: cells):
        pw.draw_board(board, folder / "board.svg")
        self.root = ElementTree.parse(folder / "board.svg").getroot()
        self.description = (folder / "board.yaml").read_text()
        self.rects = change(self.of_group("board"))
        columns, rows = board["columns"], board["rows"]
        x, y = self.rects[:, :2].min(axis=0)
        if board.get("kind") == "aprilgrid":
            tag, gap = board["tag_mm"], board["tag_mm"] * board["spacing"]
            bottom = (self.rects[:, 1] + self.rects[:, 3]).max() - gap
            across = [x + gap + k * (tag + gap) + e for k in range(columns) for e in (0, tag)]
            along = [bottom - k * (tag + gap) - e for k in range(rows) for e in (0, tag)]
            self.middle, self.flip = (across[-1] / 2, bottom / 2), -1
        else:
            inner = 0 if board.get("kind") == "charuco" else 1
            side = board["square_mm"]
            across = [x + side * (k + 1) for k in range(columns - 1 + inner)]
            along = [y + side * (k + 1) for k in range(rows - 1 + inner)]
            self.middle, self.flip = (np.mean(across), np.mean(along)), 1
        self.corners = np.array([[a, b] for b in along for a in across])

    def of_group(self, name):
        space = "{http://www.w3.org/2000/svg}"
        [group] = [one for one in self.root.iter(f"{space}g") if one.get("id") == name]
        keys = ("x", "y", "width", "height")
        return np.array([[float(one.get(key)) for key in keys] for one in group])

    def image(self, per_mm=8):
        """The page, white 255, each pixel by the share that is black."""
        across = round(float(self.root.get("width")[:-2]) * per_mm)
        down = round(float(self.root.get("height")[:-2]) * per_mm)
        white = np.ones((down, across), np.float32)
        for x, y, w, h in self.rects * per_mm:
            shares = [
                np.clip(np.minimum(b, np.arange(n) + 1) - np.maximum(a, np.arange(n)), 0, 1)
                for a, b, n in ((y, y + h, down), (x, x + w, across))
            ]
            i, j = (np.flatnonzero(one) for one in shares)
            white[i[0] : i[-1] + 1, j[0] : j[-1] + 1] -= np.outer(shares[0][i], shares[1][j])
        return np.clip(255 * white, 0, 255)

    def seen(self, cv2, H, per_mm=8, finer=3):
        """The image of a camera that sees (x, y) mm of the page at H (x, y, 1)."""
        # Pixel 0 has its middle at 0, its left edge at -0.5.
        page = np.array([[1 / per_mm, 0, 0.5 / per_mm], [0, 1 / per_mm, 0.5 / per_mm], [0, 0, 1]])
        fine = np.array([[finer, 0, (finer - 1) / 2], [0, finer, (finer - 1) / 2], [0, 0, 1]])
        size = (finer * width, finer * height)
        page_image = cv2.GaussianBlur(self.image(per_mm), (0, 0), 1.5)
        large = cv2.warpPerspective(page_image, fine @ H @ page, size, borderValue=190)
        small = cv2.resize(large, (width, height), interpolation=cv2.INTER_AREA)
        noise = np.random.default_rng(1).normal(0, 1.5, small.shape)
        return np.clip(small * 0.8 + 20 + noise, 0, 255).astype(np.uint8)


def view(printed, tilt_x, tilt_y, roll, distance=520.0):
    """From mm of the page to the image of a camera before its middle."""
    rotation = turn("z", roll) @ turn("x", tilt_x) @ turn("y", tilt_y)
    middle = np.array([*printed.middle, 0])
    place = np.array([0, 0, distance]) - rotation @ middle
    return K @ np.column_stack([rotation[:, :2], place])


def mapped(H, places):
    seen = np.column_stack([places, np.ones(len(places))]) @ H.T
    return seen[:, :2] / seen[:, 2:]


views = [(0, 0, 0), (30, 0, 12), (-20, 25, 95), (10, -40, 178), (0, 30, -120)]


def check(printed, found, H, first_point, least):
    """Each corner is where the one with its number is: to 0.1 px, RMS half of it."""
    numbers = found["point"].to_numpy() - first_point
    assert len(set(numbers)) == len(numbers) >= least
    errors = found[["u_px", "v_px"]].to_numpy() - mapped(H, printed.corners)[numbers]
    distances = np.linalg.norm(errors, axis=1)
    assert distances.max() < 0.1, distances.max()
    assert np.sqrt(np.mean(distances**2)) < 0.05


@pytest.mark.parametrize("turned", views, ids=str)
@pytest.mark.parametrize(
    ("board", "first", "distance"),
    [(chessboard, 1, 430.0), (charuco, 0, 520.0), (aprilgrid, 0, 620.0)],
    ids=["chessboard", "charuco", "aprilgrid"],
)
def test_corners_are_where_they_are(cv2, tmp_path, board, first, distance, turned):
    printed = Printed(board, tmp_path)
    H = view(printed, *turned, distance)
    found = pw.detect([printed.seen(cv2, H)], board)
    assert list(found.columns) == ["config", "point", "u_px", "v_px"]
    check(printed, found, H, first, len(printed.corners))


def test_a_large_image_is_of_use_as_a_whole(cv2, tmp_path):
    printed = Printed(chessboard, tmp_path)
    H = view(printed, 20, 10, 30, 430)
    large = cv2.resize(printed.seen(cv2, H), (3 * width, 3 * height), interpolation=cv2.INTER_CUBIC)
    found = pw.detect([large], chessboard)
    found[["u_px", "v_px"]] = (found[["u_px", "v_px"]] + 0.5) / 3 - 0.5
    check(printed, found, H, 1, 40)


def test_a_hidden_part_leaves_the_other_corners(cv2, tmp_path):
    printed = Printed(charuco, tmp_path)
    H = view(printed, 15, 10, 100)
    image = printed.seen(cv2, H)
    image[:, :620] = 90
    found = pw.detect([cv2.cvtColor(image, cv2.COLOR_GRAY2BGR)], charuco)
    check(printed, found, H, 0, 6)
    assert len(found) < len(printed.corners)


def test_a_corner_outside_the_image_is_none(cv2, tmp_path):
    printed = Printed(aprilgrid, tmp_path)
    H = view(printed, 0, 30, -120, 560)
    outside = mapped(H, printed.corners)[:, 1] < 0
    assert 0 < outside.sum() < 5
    found = pw.detect([printed.seen(cv2, H)], aprilgrid)
    check(printed, found, H, 0, 40)
    assert not outside[found["point"]].any()


def test_boards_of_old_opencv_are_told_apart(cv2, tmp_path):
    board = {"kind": "charuco", "columns": 6, "rows": 8, "square_mm": 20, "marker_mm": 14}
    legacy = {**board, "legacy": True}
    for stated, other in ((board, legacy), (legacy, board)):
        printed = Printed(stated, tmp_path)
        H = view(printed, 10, -20, 30, 420)
        image = printed.seen(cv2, H)
        check(printed, pw.detect([image], stated), H, 0, 35)
        with pytest.raises(pw.InputError, match="where one with legacy: "):
            pw.detect([image], other)
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
    if not hasattr(cv2.aruco, "CharucoBoard_create"):
        return
    # OpenCV 4.6 draws the same board.
    drawn = cv2.aruco.CharucoBoard_create(6, 8, 0.02, 0.014, dictionary).draw((480, 640), None, 0, 1)
    own = Printed(board, tmp_path).image(4)[80:720, 80:560]
    assert np.mean(np.abs(own - drawn) > 128) < 0.02


def test_charuco_corners_have_the_ids_of_opencv(cv2, tmp_path):
    if not hasattr(cv2.aruco, "interpolateCornersCharuco"):
        pytest.skip("of OpenCV before 4.7")
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
    board = cv2.aruco.CharucoBoard_create(5, 7, 0.03, 0.022, dictionary)
    drawn = cv2.GaussianBlur(board.draw((500, 700), None, 40, 1), (0, 0), 1)
    corners, ids, _ = cv2.aruco.detectMarkers(drawn, dictionary)
    _, pixels, numbers = cv2.aruco.interpolateCornersCharuco(corners, ids, drawn, board)
    found = pw.detect([drawn], charuco)
    assert found["point"].tolist() == numbers.ravel().tolist() == list(range(24))
    assert np.abs(found[["u_px", "v_px"]].to_numpy() - pixels[:, 0]).max() < 0.6  # it is half a pixel off
    places = pw.boards.Board.of(charuco).corners
    assert np.allclose(places, np.array(board.chessboardCorners)[:, :2], atol=1e-7)


def test_tags_are_those_that_kalibr_prints(cv2, tmp_path):
    printed = Printed(aprilgrid, tmp_path)
    # Tag 0 at the lower left. Code 0 of 36h11, the first bit at the upper left; 1 is white.
    left, bottom = printed.corners[0]
    cell = 5
    image = printed.image(2)
    middles = np.arange(10) * cell + cell / 2
    cells = image[np.ix_(
        np.round(2 * (bottom - 50 + middles)).astype(int), np.round(2 * (left + middles)).astype(int)
    )]
    bits = [int(bit) for bit in f"{0xD5D628584:036b}"]
    assert np.array_equal(cells[2:8, 2:8] > 128, np.reshape(bits, (6, 6)))
    assert cells.sum() == cells[2:8, 2:8].sum()  # a black border of two cells


def test_tags_with_a_narrow_border_are_found(cv2, tmp_path, monkeypatch):
    cells = pw.boards._marker_cells
    monkeypatch.setattr(pw.boards, "_marker_cells", lambda board, count, _: cells(board, count, 1))
    printed = Printed(aprilgrid, tmp_path)
    H = view(printed, 20, 10, 60, 560)
    check(printed, pw.detect([printed.seen(cv2, H)], aprilgrid), H, 0, 48)


def test_a_board_that_looks_the_same_upside_down_is_doubted(cv2, tmp_path):
    board = {"columns": 7, "rows": 5, "square_mm": 25, "first_point": 0}
    printed = Printed(board, tmp_path)
    H = view(printed, 10, 20, 60, 430)
    with pytest.warns(pw.Doubt, match="looks the same when turned"):
        found = pw.detect([printed.seen(cv2, H)], board)
    check(printed, found, H, 0, 35)


def test_images_without_a_board_are_named(cv2, tmp_path):
    printed = Printed(charuco, tmp_path)
    image = printed.seen(cv2, view(printed, 0, 0, 0))
    empty = np.full_like(image, 90)
    for name, one in (("a", image), ("b", empty), ("c", image)):
        cv2.imwrite(str(tmp_path / f"{name}.png"), one)
    paths = [tmp_path / "a.png", str(tmp_path / "b.png"), tmp_path / "c.png"]
    with pytest.warns(pw.Doubt, match="no board found in 1 of 3 images: b$"):
        found = pw.detect(paths, charuco)
    assert found["config"].unique().tolist() == ["a", "c"]
    with pytest.raises(pw.InputError, match="images` show no board.*charuco"):
        pw.detect([empty], charuco)
    for board in (chessboard, aprilgrid):
        with pytest.raises(pw.InputError, match="images` show no board"):
            pw.detect([empty], board)


@pytest.mark.parametrize(
    ("printed", "stated"),
    [
        (charuco, {"columns": 7, "rows": 5}),
        (charuco, {"columns": 4}),
        (charuco, {"marker_mm": 15}),
        (aprilgrid, {"columns": 6, "rows": 6}),
        (aprilgrid, {"spacing": 0.2}),
    ],
    ids=lambda one: "-".join(f"{key}_{one[key]}" for key in one),
)
def test_a_board_of_another_layout_is_refused(cv2, tmp_path, printed, stated):
    page = Printed(printed, tmp_path)
    image = page.seen(cv2, view(page, 20, 10, 15, 620))
    with pytest.raises(pw.InputError, match="images` show parts of .*, but not where that board"):
        pw.detect([image], {**printed, **stated})


@pytest.mark.parametrize("size", [(6, 4), (9, 3), (8, 3), (5, 6)], ids=str)
def test_a_part_of_a_larger_chessboard_is_no_board(cv2, tmp_path, size):
    page = Printed({"columns": 9, "rows": 6, "square_mm": 25}, tmp_path)
    image = page.seen(cv2, view(page, 20, 10, 5, 520))
    smaller = {"columns": size[0], "rows": size[1], "square_mm": 25}
    with pytest.raises(pw.InputError, match="images` show no board.*counts inner corners"):
        pw.detect([image], smaller)


def test_a_corner_that_is_seen_elsewhere_is_left_out(cv2, tmp_path, monkeypatch):
    """As that of a marker whose outline was found wrong."""
    printed = Printed(aprilgrid, tmp_path)
    H = view(printed, 0, 30, -120, 620)
    refine = pw.detection._refined
    lost = set()

    def spoilt(cv2, grey, points, pixels, reach):
        found, refined = refine(cv2, grey, points, pixels, reach)
        refined[[3, 10, 11]] += [[9, -4], [6, 6], [6, 6]]
        lost.update(found[[3, 10, 11]])
        return found, refined

    monkeypatch.setattr(pw.detection, "_refined", spoilt)
    found = pw.detect([printed.seen(cv2, H)], aprilgrid)
    check(printed, found, H, 0, len(printed.corners) - 3)
    assert not lost & set(found["point"])


camera_campaign = {
    "name": "two joints",
    "robot": {
        "joints": {"q1": {"limits_deg": [-90, 90]}, "q2": {"limits_deg": [-90, 90]}},
        "elements": ["Rz q1", "Tx 300 mm", "Ry q2"],
    },
    "sensor": {
        "kind": "camera", "camera": "fixed", "sigma_px": 0.1, "intrinsics": {"known": False},
        "board": charuco, "other_cameras": [{"intrinsics": {"known": False}}],
    },
}  # fmt: skip


def test_joints_and_camera_stand_beside_the_corners(cv2, tmp_path):
    printed = Printed(charuco, tmp_path)
    image = printed.seen(cv2, view(printed, 0, 0, 0))
    joints = pd.DataFrame({"config": ["x", "y"], "q1_deg": [1.0, 2.0], "q2_deg": [3.0, 4.0]})
    campaign = pw.Campaign.from_dict(camera_campaign)
    found = pw.detect([image, image], campaign, joints=joints, camera=2)
    assert list(found.columns) == [*joints.columns, "camera", "point", "u_px", "v_px"]
    assert len(found) == 48 and (found["camera"] == 2).all()
    assert found.loc[found["config"] == "y", "q2_deg"].tolist() == [4.0] * 24
    by_array = pw.detect([image, image], campaign, joints=np.radians([[1, 3], [2, 4]]), camera=2)
    assert list(by_array.columns[:3]) == ["config", "q1_rad", "q2_rad"]
    assert by_array["config"].unique().tolist() == ["0", "1"]
    assert np.allclose(np.degrees(by_array["q2_rad"]), found["q2_deg"])
    by_index = pw.detect([image, image], charuco, joints=joints.set_index("config"), camera=3)
    assert (by_index["camera"] == 3).all()
    assert by_index["config"].unique().tolist() == ["x", "y"]


@pytest.mark.parametrize(
    ("images", "board", "keywords", "words"),
    [
        ("a.png", charuco, {}, "must be a list of paths"),
        ([], charuco, {}, "must be a list of paths"),
        (["none.png"], charuco, {}, "none.png: cannot be read as an image"),
        ([np.zeros((9, 9))], charuco, {}, "must be uint8"),
        ([np.zeros((9, 9, 4), np.uint8)], charuco, {}, "must be uint8"),
        ([np.zeros((0, 5), np.uint8)], charuco, {}, "array (0, 5) of uint8"),
        ([np.zeros((1, 2000000), np.uint8)], chessboard, {}, "OpenCV cannot look for the board in image 0"),
        ({"a.png"}, charuco, {}, "must be a list of paths"),
        ([np.zeros((9, 9), np.uint8)], charuco,
         {"camera": 2, "joints": pd.DataFrame({"q1_deg": [1.0], "camera": [1]})}, "has a column camera"),
        ([np.zeros((9, 9), np.uint8)], charuco, {"joints": [[1, 2]]}, "`joints` is no DataFrame"),
        ([np.zeros((9, 9), np.uint8)], camera_campaign, {"camera": 3}, "`camera` is 3"),
        ([np.zeros((9, 9), np.uint8)], camera_campaign, {}, "needs `camera`, 1 to 2"),
        ([np.zeros((9, 9), np.uint8)], charuco, {"joints": pd.DataFrame({"q": [1, 2]})}, "2 rows for 1"),
        ([np.zeros((9, 9), np.uint8)], charuco,
         {"joints": pd.DataFrame([[1, 2]], columns=["q", "q"])}, "`joints` has the column q twice"),
        ([], 3, {}, "`board` is 3; must be a Campaign"),
        ([], {**charuco, "columns": 1}, {}, "`board`.columns is 1; must be from 3"),
        ([], {"points_mm": [[0, 0, 0], [9, 0, 0], [9, 9, 0], [0, 9, 0]]}, {}, "no pattern"),
        ([np.zeros((9, 9), np.uint8)], {**charuco, "dictionary": "DICT_X"}, {}, "no dictionary DICT_X"),
        ([np.zeros((9, 9), np.uint8)], {**charuco, "rows": 30}, {}, "has 75 markers, DICT_4X4_50 50"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_said(cv2, images, board, keywords, words):
    if board is camera_campaign:
        board = pw.Campaign.from_dict(board)
    with pytest.raises(pw.InputError) as error:
        pw.detect(images, board, **keywords)
    assert words in str(error.value)


def test_without_opencv_its_package_is_named(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "cv2", None)
    with pytest.raises(ImportError, match="python3-opencv"):
        pw.detect([np.zeros((9, 9), np.uint8)], chessboard)
    with pytest.raises(ImportError, match="python3-opencv"):
        pw.draw_board(charuco, tmp_path / "board.svg")
    pw.draw_board(chessboard, tmp_path / "board.svg")


def test_a_board_is_drawn_in_true_scale_with_its_description(tmp_path):
    printed = Printed(chessboard, tmp_path)
    size = [printed.root.get(key) for key in ("width", "height")]
    assert [float(one.removesuffix("mm")) for one in size] == [
        float(one) for one in printed.root.get("viewBox").split()[2:]
    ]
    assert (printed.rects[:, 2:] == 25).all() and len(printed.rects) == 27
    [bar] = printed.of_group("bar")
    assert bar[2] == 100 and bar[1] > printed.rects[:, 1].max() + 25
    assert "kind: chessboard, columns: 8, rows: 5, square_mm: 25, first_point: 1" in printed.description


@pytest.mark.parametrize("board", [chessboard, {**charuco, "first_point": 1}, aprilgrid])
def test_a_campaign_takes_the_description(tmp_path, board):
    if "kind" in board:
        pytest.importorskip("cv2")
    pw.draw_board(board, tmp_path / "board.svg")
    described = pw.boards.Board.of({"file": str(tmp_path / "board.yaml")})
    stated = pw.boards.Board.of(board)
    assert np.allclose(described.corners, stated.corners, rtol=0, atol=1e-12)
    assert described.keys() == stated.keys()


@pytest.mark.parametrize(
    ("board", "name", "words"),
    [
        (chessboard, "board.pdf", "must end in .svg"),
        (chessboard, "none/board.svg", "cannot be written"),
        (pw.Campaign.from_yaml(designs / "ur10" / "campaign.yaml"), "board.svg", "without a camera"),
    ],
)
def test_what_cannot_be_drawn_is_said(tmp_path, board, name, words):
    with pytest.raises(pw.InputError, match=re.escape(words)):
        pw.draw_board(board, tmp_path / name)


def test_nothing_but_a_description_is_replaced(tmp_path):
    campaign = tmp_path / "board.yaml"
    campaign.write_text((designs / "camera" / "campaign.yaml").read_text())
    before = campaign.read_text()
    with pytest.raises(pw.InputError, match="board.yaml: is not what draw_board.. writes"):
        pw.draw_board(pw.Campaign.from_yaml(campaign), tmp_path / "board.svg")
    assert campaign.read_text() == before
    assert not (tmp_path / "board.svg").exists()
    (tmp_path / "folder.yaml").mkdir()
    with pytest.raises(pw.InputError, match="folder.yaml: cannot be read"):
        pw.draw_board(chessboard, tmp_path / "folder.svg")
    assert not (tmp_path / "folder.svg").exists()
    for side in (25, 24.9999999999):
        pw.draw_board({**chessboard, "square_mm": side}, tmp_path / "again.svg")
    assert "square_mm: 24.9999999999" in (tmp_path / "again.yaml").read_text()
    with pytest.raises(pw.InputError, match="cannot be written"):
        pw.draw_board(chessboard, tmp_path / ("a" * 300 + ".svg"))


def test_squares_of_two_sides_are_not_drawn(tmp_path):
    (tmp_path / "target.yaml").write_text(
        "target_type: checkerboard\ntargetCols: 6\ntargetRows: 7\nrowSpacingMeters: 0.06\n"
        "colSpacingMeters: 0.05\n"
    )
    with pytest.raises(pw.InputError, match="squares of two sides"):
        pw.draw_board({"file": str(tmp_path / "target.yaml")}, tmp_path / "board.svg")


def test_images_calibrate_a_camera_on_the_flange(cv2, tmp_path):
    """From a printed board to where the camera is on the flange."""
    printed = Printed(charuco, tmp_path)
    text = (designs / "camera" / "campaign.yaml").read_text()
    text = text.replace("errors: full", "errors: none").replace("  class: collaborative\n", "")
    text = re.sub(r"board: .*", f"board: {{file: {tmp_path}/board.yaml}}", text)
    campaign = pw.Campaign(text)
    poses = pw.plan(campaign, poses=8, effort="quick").poses
    flange_from_camera = np.eye(4)
    flange_from_camera[:3, 3] = 0.031, 0.042, 0.055
    page = np.diag([1e-3, 1e-3, 1])  # its mm in the board's frame, whose origin is an outer corner
    page[:2, 2] = -1e-3 * (printed.corners[0] - 30)
    images = []
    for board_from_flange in campaign.flange(poses):
        camera_from_board = np.linalg.inv(board_from_flange @ flange_from_camera)
        images.append(printed.seen(cv2, K @ camera_from_board[:3, [0, 1, 3]] @ page))
    measured = pw.detect(images, campaign, joints=poses)
    measured.to_csv(tmp_path / "corners.csv", index=False)
    for table in (measured, tmp_path / "corners.csv"):
        found = pw.calibrate(campaign, table).values
        place = [found[f"camera.{axis}"] for axis in "xyz"]
        assert place == pytest.approx([0.031, 0.042, 0.055], abs=2e-4)
        assert 1e3 * found["camera.fx"] == pytest.approx(1500, abs=1)
