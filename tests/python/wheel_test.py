"""A stranger installs the wheel without network and runs the first example."""

import os
import pathlib
import subprocess
import sys

import pytest
from conftest import source

example = """
import numpy as np, posewise as pw
J = np.random.default_rng(0).normal(size=(200, 3, 10))
choice = pw.select(J, 12)
assert choice.efficiency > 0.9 and choice.verify()["is_right"].all()
print(pathlib.Path(pw.__file__).parent.parent)
"""


def test_wheel(tmp_path):
    pytest.importorskip("pip")
    # In the folder that the tests are of: nothing is compiled anew.
    environment = {**os.environ, "POSEWISE_BUILD": os.environ["POSEWISE_BUILD_FOLDER"]}
    environment.pop("PYTHONPATH")
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "-q"]
    subprocess.run(
        [*pip, "wheel", "--no-index", "--no-deps", "-w", tmp_path, source],
        env=environment, check=True, capture_output=True,
    )
    [wheel] = tmp_path.glob("posewise-*.whl")
    installed = tmp_path / "installed"
    subprocess.run(
        [*pip, "install", "--no-index", "--no-deps", "--target", installed, wheel],
        env=environment, check=True, capture_output=True,
    )
    done = subprocess.run(
        [sys.executable, "-c", "import pathlib" + example],
        env={**environment, "PYTHONPATH": str(installed)},
        cwd=tmp_path, check=True, capture_output=True, text=True,
    )
    assert pathlib.Path(done.stdout.strip()) == installed
