"""What the tests of the Python package share: campaigns, and the program to compare with."""

import json
import os
import pathlib
import subprocess

import numpy as np
import pandas as pd
import pytest

import posewise as pw

source = pathlib.Path(os.environ["POSEWISE_SOURCE"])
designs = source / "designs"
real_data = pathlib.Path(os.environ.get("POSEWISE_REAL_DATA") or "/nowhere")


@pytest.fixture(scope="session")
def run():
    """The program's document: run("select", ...)."""

    def run_program(*arguments, cwd):
        done = subprocess.run(
            [os.environ["POSEWISE_PROGRAM"], *map(str, arguments), "--json"],
            cwd=cwd,
            capture_output=True,
            text=True,
            check=True,
        )
        return json.loads(done.stdout)

    return run_program


@pytest.fixture(scope="session")
def fanuc_path():
    return designs / "fanuc_r2000ic_165f" / "campaign.yaml"


@pytest.fixture(scope="session")
def fanuc(fanuc_path):
    return pw.Campaign.from_yaml(fanuc_path)


@pytest.fixture(scope="session")
def measurements_path():
    return source / "data" / "fanuc_r2000ic_165f_simulated" / "measurements.csv"


@pytest.fixture(scope="session")
def measurements(measurements_path):
    return pd.read_csv(
        measurements_path, dtype={"config": str}, comment="#", float_precision="round_trip"
    )


@pytest.fixture
def blocks():
    """Jacobians of 40 poses, three rows and eight parameters each."""
    return np.random.default_rng(5).normal(size=(40, 3, 8))
