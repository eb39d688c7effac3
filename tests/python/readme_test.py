"""The lines of Python in README, as they stand there, with its own campaign file and measurements of it."""

import os
import pathlib
import re
import subprocess

import pandas as pd
from conftest import source

import posewise


def block(kind):
    """The first block of that kind in README."""
    readme = (source / "README.md").read_text()
    return re.search(rf"^```{kind}\n(.*?)^```", readme, re.M | re.S)[1]


def test_the_lines_of_readme_run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    pathlib.Path("campaign.yaml").write_text(block("yaml"))
    subprocess.run(
        [os.environ["POSEWISE_PROGRAM"], "simulate", "campaign.yaml", "--poses", "40", "-o", "m.csv"],
        check=True,
        stdout=subprocess.DEVNULL,
    )
    measurements = pd.read_csv("m.csv", comment="#", dtype={"config": str})
    q = measurements.filter(regex=r"^q\d_rad$").to_numpy()
    names = {"posewise": posewise, "measurements": measurements, "q": q}
    exec(block("python"), names)
    assert len(names["choice"].poses) == 12
    assert names["estimate"].held_out is not None
