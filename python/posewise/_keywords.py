"""Which keywords have no effect without, or beside, others: one table for all calls."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ._calls import InputError

# Kinds of `source`, in words.
_kinds = {
    "Jacobians": "Jacobians",
    "a campaign": "a campaign",
    "a simulation": "a campaign without `measurements`",
}

# A keyword, and those of which it needs one. `prior=False` is that keyword with that value; what
# `source` is counts as "a campaign" or "Jacobians", a study without measurements as "a simulation".
_of_estimate = {"as_prior": ["estimate"], "only": ["estimate"], "moved": ["estimate"]}
_of_robot = {
    key: ["a campaign"]
    for key in ("candidates", "measurements", "random", "estimate", "focus", "repeats")
}
_needs: dict[str, dict[str, list[str]]] = {
    "select": {
        **_of_estimate,
        "groups": ["per_group"],
        "per_group": ["groups"],
        "rows": ["Jacobians"],
        "force": ["estimate", "measurements"],
        **_of_robot,
        "least_distance_deg": ["a campaign"],
    },
    "relax": {
        **_of_estimate,
        "rows": ["Jacobians"],
        "force": ["estimate", "measurements"],
        "seed": ["random"],
        **_of_robot,
    },
    "plan": {
        **_of_estimate,
        "quantity": ["target_mm"],
        "assurance": ["target_mm"],
        "poses_at_most": ["target_mm", "minutes"],
        "robust_to": ["target_mm", "minutes"],
        "drop": ["repair"],
        "force": ["estimate"],
    },
    "calibrate": {
        **_of_estimate,
        "points_unit": ["plan"],
        "refit": ["validate"],
        "limit_mm": ["validate", "plan"],
        "loss_width": ["loss"],
    },
    "study": {
        "rows": ["Jacobians"],
        "subsets": ["Jacobians"],
        "held": ["Jacobians"],
        "repeat_limit": ["Jacobians"],
        "proof": ["Jacobians"],
        "measurements": ["a campaign"],
        "least_distance_deg": ["a campaign", "a simulation"],
        "splits": ["measurements"],
        "holdout": ["measurements"],
        "force": ["measurements"],
        "exclude": ["measurements", "Jacobians"],
        "trials": ["a simulation"],
        "precision": ["a simulation"],
        "pool": ["a simulation"],
        "repeats": ["a simulation"],
        "refine": ["a simulation"],
        "test_poses": ["a simulation", "Jacobians"],
    },
}

# Pairs that exclude each other.
_of_effort = [("effort", "starts"), ("effort", "proof")]
_of_choice = [
    ("as_prior", "prior=False"),
    ("candidates", "measurements"),
    ("candidates", "random"),
    ("measurements", "random"),
]
_excludes: dict[str, list[tuple[str, str]]] = {
    "select": [*_of_effort, *_of_choice],
    "relax": _of_choice,
    "plan": [
        *_of_effort,
        ("as_prior", "prior=False"),
        ("poses", "target_mm"),
        ("poses", "minutes"),
        ("repair", "target_mm"),
        ("repair", "minutes"),
        ("workspace", "workspace_poses"),
        ("workspace", "workspace_box_mm"),
    ],
    "calibrate": [
        ("as_prior", "prior=False"),
        ("free", "estimate"),
        ("estimate", "method='two-step'"),
        ("estimate", "method='global'"),
        ("estimate", "model_selection"),
        ("loss", "method='two-step'"),
        ("loss", "method='global'"),
        ("loss_width", "loss='squares'"),
        ("model_selection", "method='two-step'"),
        ("model_selection", "method='global'"),
        ("model_selection", "folds=0"),
        ("sizes='learned'", "method='two-step'"),
        ("sizes='learned'", "method='global'"),
        ("sizes='learned'", "prior=False"),
        ("sizes='learned'", "loss='huber'"),
        ("sizes='learned'", "loss='cauchy'"),
    ],
    "study": [*_of_effort, ("holdout", "splits=0")],
}


def check_keywords(function: str, keywords: Mapping[str, Any], source: str = "") -> None:
    """Raises InputError for a keyword that would have no effect."""
    stated = {source}
    for key, value in keywords.items():
        if value is None or (isinstance(value, (list, tuple)) and not value):
            continue
        if isinstance(value, (str, bool, int)):
            stated.add(f"{key}={value!r}")
        if value is not False:
            stated.add(key)
    for key, owners in _needs[function].items():
        if key in stated and stated.isdisjoint(owners):
            raise InputError(f"{function}(): `{key}` needs {_listed(owners)}; leave it out else")
    for one, other in _excludes[function]:
        if one in stated and other in stated:
            raise InputError(f"{function}(): `{one}` excludes `{other}`; leave one of them out")


def _listed(owners: list[str]) -> str:
    return " or ".join(_kinds.get(one, f"`{one}`") for one in owners)
