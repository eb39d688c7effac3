from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
# A JSON document, the same as text, warnings.
Result = tuple[str, str, list[str]]

version: str

class InputError(ValueError): ...

class CallOptions:
    def __init__(
        self, threads: int | None, time: float, progress: Callable[[int, int], object] | None
    ) -> None: ...

class PlainBlocks:
    def __init__(
        self, candidates: Array, rows: int, held: Array, held_count: int, test_poses: Array
    ) -> None: ...

class CandidateKind:
    measurements: CandidateKind
    configurations: CandidateKind
    random: CandidateKind

class ChoiceTables:
    def __init__(
        self, kind: CandidateKind, candidates: str, random_count: int, held: str, test_poses: str
    ) -> None: ...

class Campaign:
    name: str
    path: str
    content: str
    warnings: list[str]
    columns: list[str]
    parameter_names: list[str]
    parameter_is_angle: list[bool]
    parameter_sizes: Array
    def __init__(self, content: str, path: str) -> None: ...
    def with_sensor(
        self,
        predict: Callable[[Array, Array], npt.ArrayLike],
        names: Sequence[str],
        is_angle: Sequence[bool],
        sigmas: Array,
        targets: Sequence[Array | None],
        unknown: Sequence[str],
        unknown_is_angle: Sequence[bool],
        values: Array,
    ) -> Campaign: ...
    def jacobian(self, q: Array, scaled: bool, repeats: float, options: CallOptions) -> Array: ...
    def flange(self, q: Array) -> Array: ...
    def inspect(self, options: CallOptions) -> Result: ...

def choose_plain(
    blocks: PlainBlocks, keywords: str, groups: Sequence[int], options: CallOptions
) -> Result: ...
def verify_plain(
    plan: str, blocks: PlainBlocks, groups: Sequence[int], options: CallOptions
) -> Result: ...
def choose(
    campaign: Campaign,
    tables: ChoiceTables,
    keywords: str,
    prior: bool | None,
    estimate: str,
    force: bool,
    groups: Sequence[int],
    options: CallOptions,
) -> Result: ...
def verify(
    plan: str,
    campaign: Campaign,
    tables: ChoiceTables,
    estimate: str,
    groups: Sequence[int],
    options: CallOptions,
) -> Result: ...
def rate_blocks(stacked: Array, poses: int, blocks: PlainBlocks) -> list[tuple[str, float]]: ...
def plan(
    campaign: Campaign,
    keywords: str,
    prior: bool | None,
    estimate: str,
    force: bool,
    held: str,
    workspace: str,
    repaired: str,
    options: CallOptions,
) -> Result: ...
def write_plan(
    document: str, path: str, campaign: Campaign | None, csv: str, targets: str
) -> None: ...
def calibrate(
    campaign: Campaign,
    measurements: str,
    keywords: str,
    plan: str,
    points_unit: str,
    validate: str,
    estimate: str,
    force: bool,
    options: CallOptions,
) -> Result: ...
def predict(campaign: Campaign, estimate: str, q: Array) -> list[tuple[bool, Array]]: ...
def study(
    campaign: Campaign,
    measurements: str,
    keywords: str,
    exclude: Sequence[str],
    prior: bool | None,
    force: bool,
    options: CallOptions,
) -> Result: ...
def study_plain(
    blocks: PlainBlocks,
    keywords: str,
    subsets: Sequence[tuple[str, Sequence[int]]],
    options: CallOptions,
) -> Result: ...
def simulate_study(
    campaign: Campaign, keywords: str, prior: bool | None, options: CallOptions
) -> Result: ...
