"""Campaigns: the robot, the instrument, and how large errors are expected to be."""

from __future__ import annotations

import json
import os
import tempfile
import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Union

import numpy as np
import numpy.typing as npt
import pandas as pd

from . import _posewise
from ._calls import (
    Array,
    InputError,
    call_options,
    check_number,
    check_text,
    made,
    numbers,
    shortened,
    warn,
)
from ._files import Files, check_path, read_text, write_file

Configurations = Union[pd.DataFrame, npt.ArrayLike]

# Of columns of tables: how many of the library's units one is.
_units = {"rad": 1.0, "deg": np.pi / 180, "mrad": 1e-3, "m": 1.0, "mm": 1e-3, "Nm": 1.0}


@dataclass(frozen=True)
class Sensor:
    """An instrument that posewise does not have, as a Python function: for studies, since it is slow.

    ``predict(frame, unknowns)`` gets the flange in the instrument's frame, (4, 4) in m, and values of
    the unknowns, and returns the numbers of one observation without noise. ``names`` are their
    columns with the unit m or rad ("right_rad"), equally many for each target; ``sigma`` their
    standard deviations. ``targets`` are points on the flange in m, None where one is to be found.
    ``unknowns`` are what must be found, with values to start from: coordinates of targets that are
    None ("target1.x_m") first, in their order, then others ("focal_m"). Derivatives are differences.
    """

    predict: Callable[[Array, Array], npt.ArrayLike]
    names: Sequence[str]
    sigma: npt.ArrayLike
    targets: Sequence[Sequence[float] | None] = ((0.0, 0.0, 0.0),)
    unknowns: Mapping[str, float] = field(default_factory=dict)

    def _parts(self) -> tuple[Any, ...]:
        """As the compiled half takes them."""
        if not callable(self.predict):
            raise InputError("`sensor.predict` must be a function of a frame and unknowns")
        try:
            names, is_angle = _split_units(self.names, "names")
            unknown, unknown_is_angle = _split_units(list(self.unknowns), "unknowns")
            of_targets = 3 * sum(one is None for one in self.targets)
            sigmas = np.broadcast_to(np.asarray(self.sigma, dtype=float), (len(names),))
            values = np.array(list(self.unknowns.values()), dtype=float)
            places = [None if one is None else np.asarray(one, float) for one in self.targets]
        except InputError:
            raise
        except (AttributeError, TypeError, ValueError, RecursionError):
            raise InputError("`sensor` must state numbers: sigma, targets, unknowns") from None
        if any(one is not None and one.shape != (3,) for one in places):
            raise InputError("`sensor.targets` must be points (x, y, z) in m, or None")
        rest = unknown[of_targets:], unknown_is_angle[of_targets:]
        return (self.predict, names, is_angle, sigmas, places, *rest, values)


# Stands in a campaign file where a function is the instrument.
_any_sensor = {"kind": "points", "sigma_mm": 1, "targets": {"count": 1}}


def _as_file(keys: Mapping[str, Any]) -> str:
    """The text of a campaign file with these keys."""
    try:
        return json.dumps(_section(keys, "keys"), allow_nan=False, default=_plain)
    except (TypeError, ValueError, RecursionError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"keys: {error}; must be numbers, texts, lists and dicts") from None


def _plain(value: Any) -> Any:
    """What JSON has for a value of NumPy."""
    if isinstance(value, (np.generic, np.ndarray)):
        return value.tolist()
    raise TypeError(f"has a {type(value).__name__}")


def _section(keys: Any, name: str) -> dict[str, Any]:
    """The keys of a section of a campaign file."""
    if keys is not None and not isinstance(keys, Mapping):
        raise InputError(f"`{name}` is {shortened(keys)}; must be a dict of keys of a campaign file")
    return dict(keys or {})


def _split_units(columns: Sequence[str], what: str) -> tuple[list[str], list[bool]]:
    names, are_angles = [], []
    for column in columns:
        name, _, unit = check_text(str(column), f"sensor.{what}").rpartition("_")
        if not name or unit not in ("m", "rad"):
            raise InputError(f"`sensor.{what}` has {column!r}; must end in _m or _rad")
        names.append(name)
        are_angles.append(unit == "rad")
    return names, are_angles


class Campaign:
    """What is known before measuring, as a campaign file states it.

    Made by :meth:`from_yaml`, :meth:`from_dict`, :meth:`from_urdf` or :meth:`from_dh`. Campaigns do
    not change, and can be pickled.

    >>> campaign = Campaign.from_dict({
    ...     "name": "arm", "robot": {"joints": {"q1": {"limits_deg": [-90, 90]}},
    ...     "elements": ["Rz q1", "Tx 300 mm [Tx1]"]},
    ...     "sensor": {"kind": "points", "sigma_mm": 0.05, "targets": {"count": 1}}})
    >>> campaign.joints
    ['q1']
    """

    def __init__(self, content: str, path: str = "campaign") -> None:
        """Reads a campaign file's text, whose paths are relative to the folder of ``path``."""
        if not isinstance(content, str) or not isinstance(path, str):
            raise InputError("Campaign(): takes the text of a campaign file; from_yaml() takes its path")
        check_text(content, "content"), check_path(path, "path")
        self._urdf: tuple[str, Mapping[str, Any]] | None = None
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        self._sensor: tuple[Campaign, Sensor] | None = None
        with Files():
            self._core = _posewise.Campaign(content, path)
        warn(self._core.warnings)

    @classmethod
    def from_yaml(cls, path: str | os.PathLike[str]) -> Campaign:
        """Reads a campaign file (posewise help the-file explains its keys)."""
        return cls(read_text(path, "a campaign file"), os.fspath(path))

    @classmethod
    def from_dict(cls, keys: Mapping[str, Any]) -> Campaign:
        """A campaign by the keys of a campaign file."""
        return cls(_as_file(keys))

    @classmethod
    def from_urdf(
        cls,
        urdf: str | os.PathLike[str],
        *,
        base: str | Mapping[str, Any] | None = None,
        tip: str | None = None,
        sensor: Mapping[str, Any] | Sensor,
        name: str = "robot",
        robot: Mapping[str, Any] | None = None,
        **keys: Any,
    ) -> Campaign:
        """A robot from a URDF, by its path or its text.

        ``base`` and ``tip`` are links, ``sensor`` (or a :class:`Sensor`) and further keywords keys of
        a campaign file (``model_error_mm=0.2``), ``robot`` those of its section robot
        (``{"errors": "geometric"}``). A dict as ``base`` is that key of a campaign file, where the
        robot stands before the instrument; its link is then ``robot={"base_link": ...}``.
        """
        if isinstance(sensor, Sensor):
            return cls.from_urdf(
                urdf, base=base, tip=tip, sensor=_any_sensor, name=name, robot=robot, **keys
            ).with_sensor(sensor)
        stated = _section(robot, "robot")
        if isinstance(base, Mapping):
            keys["base"] = base
        elif base is not None:
            stated["base_link"] = base
        if tip is not None:
            stated["tip_link"] = tip
        document = {"name": name, "robot": stated, "sensor": _section(sensor, "sensor"), **keys}
        text = check_path(urdf, "urdf")
        if text.lstrip().startswith("<"):
            return cls._from_urdf_text(text, document)
        stated["urdf"] = os.path.abspath(text)
        return cls.from_dict(document)

    @classmethod
    def _from_urdf_text(cls, text: str, document: Mapping[str, Any]) -> Campaign:
        # Beside the campaign, where the file is read again for other error models.
        folder = tempfile.TemporaryDirectory(prefix="posewise")
        name = f"robot_{zlib.crc32(text.encode()):08x}.urdf"
        path = Path(folder.name) / name
        path.write_text(text, encoding="utf-8")
        with_path = {**document, "robot": {**document["robot"], "urdf": name}}
        try:
            campaign = cls(_as_file(with_path), str(path.with_name("campaign")))
        except InputError as error:
            message = str(error).replace(str(path), "urdf")
            raise InputError(message.replace(str(path.with_name("campaign")), "campaign")) from None
        campaign._folder = folder
        campaign._urdf = (text, document)
        return campaign

    @classmethod
    def from_dh(
        cls,
        rows: Sequence[Mapping[str, Any]] | pd.DataFrame,
        *,
        sensor: Mapping[str, Any] | Sensor,
        convention: str = "standard",
        name: str = "robot",
        robot: Mapping[str, Any] | None = None,
        **keys: Any,
    ) -> Campaign:
        """A robot from a Denavit-Hartenberg table with the columns a_mm (or a_m), alpha_deg, d_mm,
        theta_deg, joint and limits_deg."""
        if isinstance(sensor, Sensor):
            return cls.from_dh(
                rows, sensor=_any_sensor, convention=convention, name=name, robot=robot, **keys
            ).with_sensor(sensor)
        if isinstance(rows, pd.DataFrame):
            rows = [
                {key: value for key, value in row.items() if np.ndim(value) or pd.notna(value)}
                for row in rows.to_dict("records")
            ]
        if not isinstance(rows, Sequence) or isinstance(rows, (str, bytes)):
            raise InputError(f"`rows` is {shortened(rows)}; must be a list of dicts, or a DataFrame")
        table = {"convention": convention, "rows": [_section(row, "rows") for row in rows]}
        stated = {"dh": table, **_section(robot, "robot")}
        return cls.from_dict(
            {"name": name, "robot": stated, "sensor": _section(sensor, "sensor"), **keys}
        )

    def with_sensor(self, sensor: Sensor) -> Campaign:
        """The campaign with a Python function as its instrument."""
        if not isinstance(sensor, Sensor):
            raise InputError(f"`sensor` is a {type(sensor).__name__}; must be a posewise.Sensor")
        campaign = Campaign.__new__(Campaign)
        campaign.__dict__.update(self.__dict__)
        with Files():
            campaign._core = self._core.with_sensor(*sensor._parts())
        campaign._sensor = (self, sensor)
        return campaign

    def write(self, path: str | os.PathLike[str]) -> None:
        """Writes the campaign file, and beside it a URDF that was given as text.

        A campaign whose instrument is a Python function cannot be written.
        """
        if self._sensor is not None:
            raise InputError(
                "the campaign's instrument is a Python function, which no file can state; write the "
                "campaign that it was added to, or what is computed (DataFrame.to_csv, numpy.save)"
            )
        target = Path(check_path(path, "path"))
        if self._urdf is not None and self._folder is not None:
            [urdf] = Path(self._folder.name).glob("robot_*.urdf")
            write_file(target.with_name(urdf.name), urdf.read_bytes())
        with Files():  # what it refers to may not be found from there
            _posewise.Campaign(self._core.content, str(target))
        write_file(target, self._core.content.encode())

    def beside(self, path: Path) -> str:
        """The path of its file, for the file at ``path`` to refer to; written beside it if need be."""
        own = Path(self._core.path)
        try:
            if self._sensor is None and own.read_text(encoding="utf-8") == self._core.content:
                return str(own)
        except (OSError, ValueError):
            pass
        target = path.with_name(path.stem + ".campaign.yaml")
        self.write(target)
        return os.path.relpath(target)

    def __reduce__(self) -> tuple[Any, ...]:
        if self._sensor is not None:
            return (Campaign.with_sensor, self._sensor)
        if self._urdf is not None:
            return (Campaign._from_urdf_text, self._urdf)
        return (Campaign, (self._core.content, self._core.path))

    @property
    def name(self) -> str:
        return str(self._core.name)

    @property
    def joints(self) -> list[str]:
        """Names of the joints (and of measured torques) in the order of configurations."""
        return [column.rsplit("_", 1)[0] for column in self._core.columns]

    @property
    def parameters(self) -> pd.DataFrame:
        """What a calibration identifies, by name: unit (m or rad) and expected size of its error."""
        return pd.DataFrame(
            {
                "unit": ["rad" if angle else "m" for angle in self._core.parameter_is_angle],
                "size": self._core.parameter_sizes,
            },
            index=pd.Index(self._core.parameter_names, name="parameter"),
        )

    def configurations(self, q: Configurations) -> Array:
        """Configurations as an array (poses, joints) in rad and m.

        ``q`` is such an array, one configuration, or a DataFrame with a column for each joint that
        ends in its unit: q1_deg, lift_mm.
        """
        columns = self._core.columns
        if isinstance(q, pd.DataFrame):
            return np.column_stack([_joint_column(q, column) for column in columns])
        array = np.atleast_2d(numbers(q, "q", "numbers, in rad and m"))
        if array.ndim != 2 or array.shape[1] != len(columns):
            raise InputError(
                f"`q` has the shape {np.shape(array)}; must be (poses, {len(columns)}), for "
                f"{', '.join(columns)}"
            )
        if not np.isfinite(array).all():
            pose, joint = np.argwhere(~np.isfinite(array))[0]
            raise InputError(f"`q` is {array[pose, joint]} at pose {pose}, {columns[joint]}")
        return np.ascontiguousarray(array)

    def jacobian(
        self,
        q: Configurations,
        *,
        scaled: bool = True,
        repeats: float = 1,
        threads: int | None = None,
    ) -> Array:
        """Identification Jacobians, (poses, rows, parameters).

        Divided by the noise of means of ``repeats`` samples and multiplied by each parameter's
        expected size, so without units: what :func:`posewise.select` takes. Of a pose that shows more
        numbers than 6 and one for each unknown of the sensor so many rows remain, with the same
        information. With ``scaled=False`` in m per m and m per rad, a row for each number.
        """
        check_number("repeats", repeats, 1, 1e9)
        if not isinstance(scaled, (bool, np.bool_)):
            raise InputError(f"`scaled` is {shortened(scaled)}; must be True or False")
        options = call_options(threads, None, None)
        times = 1.0 if repeats is None else float(repeats)
        with Files():
            J = self._core.jacobian(self.configurations(q), bool(scaled), times, options)
        return made(np.asarray(J), [], options)

    def flange(self, q: Configurations) -> Array:
        """Frames of the nominal robot's flange in the instrument's frame, (poses, 4, 4), m."""
        with Files():
            return np.asarray(self._core.flange(self.configurations(q)))

    def inspect(self) -> str:
        """Which of the robot's errors can be found, as text."""
        options = call_options(None, None, None)
        with Files():
            text = str(self._core.inspect(options)[1])
        return made(text, [], options)

    def __repr__(self) -> str:
        return f"<Campaign {self.name!r}: {len(self.joints)} joints, {len(self.parameters)} parameters>"


def _joint_column(table: pd.DataFrame, column: str) -> Array:
    """A joint's column in SI units, whatever its unit in the table."""
    name, unit = column.rsplit("_", 1)
    alike = ["rad", "deg", "mrad"] if unit == "rad" else ["m", "mm"] if unit == "m" else [unit]
    found = [f"{name}_{other}" for other in alike if f"{name}_{other}" in table.columns]
    if len(found) != 1:
        raise InputError(
            f"`q` has {'no column' if not found else 'several columns'} of joint {name}; must have "
            f"one of {', '.join(f'{name}_{other}' for other in alike)}"
        )
    try:
        of_joint = table[found[0]]
        if isinstance(of_joint, pd.DataFrame) or of_joint.dtype.kind not in "fiubO":
            raise TypeError
        values = of_joint.to_numpy(dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"`q` has other than numbers in {found[0]}, or several of it") from None
    if not np.isfinite(values).all():
        row = int(np.argmin(np.isfinite(values)))
        raise InputError(f"`q` is {values[row]} at row {row} of {found[0]}")
    scaled: Array = values * _units[found[0].rsplit("_", 1)[1]]
    return scaled
