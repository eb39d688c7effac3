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
    @property
    def is_interrupted(self) -> bool: ...

class PlainBlocks:
    def __init__(
        self,
        candidates: Array,
        rows: int,
        held: Array,
        held_count: int,
        prior: Array,
        test_poses: Array,
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
    board: dict[str, Any] | None
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

def choose_plain(blocks: PlainBlocks, keywords: str, options: CallOptions) -> Result: ...
def relax_plain(blocks: PlainBlocks, keywords: str, options: CallOptions) -> Result: ...
def verify_plain(plan: str, blocks: PlainBlocks, groups: Sequence[int]) -> Result: ...
def choose(campaign: Campaign, keywords: str, options: CallOptions) -> Result: ...
def relax(campaign: Campaign, keywords: str, options: CallOptions) -> Result: ...
def verify(plan: str, campaign: Campaign, groups: Sequence[int]) -> Result: ...
def rate_blocks(stacked: Array, poses: int, blocks: PlainBlocks) -> list[tuple[str, float]]: ...
def plan(campaign: Campaign, keywords: str, options: CallOptions) -> Result: ...
def check_plan(path: str, campaign: Campaign) -> None: ...
def write_plan(
    document: str,
    path: str,
    campaign: Campaign | None,
    csv: str,
    targets: str,
    warnings: Sequence[str],
) -> None: ...
def calibrate(campaign: Campaign, keywords: str, options: CallOptions) -> Result: ...
def check_estimate(path: str, campaign: Campaign) -> None: ...
def predict(campaign: Campaign, estimate: str, q: Array) -> list[tuple[bool, Array]]: ...
def study(campaign: Campaign, keywords: str, options: CallOptions) -> Result: ...
def study_plain(
    blocks: PlainBlocks,
    keywords: str,
    subsets: Sequence[tuple[str, Sequence[int]]],
    options: CallOptions,
) -> Result: ...
