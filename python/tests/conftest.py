"""What the tests share. CARNOT_PROGRAM is the program, CARNOT_BUILD the folder of the build."""

import json
import os
import subprocess

import matplotlib
import numpy as np
import pytest

import carnot

matplotlib.use("Agg")


@pytest.fixture(scope="session")
def program():
    """program(*arguments): the completed process."""

    def run(*arguments):
        command = [os.environ["CARNOT_PROGRAM"], *arguments]
        return subprocess.run(command, capture_output=True, text=True, check=False)

    return run


@pytest.fixture(scope="session")
def answer(program):
    """answer(*arguments): the JSON that the program prints."""

    def run(*arguments):
        return json.loads(program(*arguments, "--json").stdout)

    return run


@pytest.fixture(scope="session")
def refusal(program):
    """refusal(*arguments): what the program says of bad input."""

    def run(*arguments):
        done = program(*arguments)
        assert done.returncode == 2
        return done.stderr.removeprefix("carnot: ").rstrip("\n")

    return run


@pytest.fixture(scope="session")
def car():
    return carnot.scene("vehicle")


@pytest.fixture(scope="session")
def unicycle():
    return carnot.scene("unicycle")


@pytest.fixture(scope="session")
def parking(car):
    return car.geodesics(np.zeros(4), [0, 1, 0, 0], count=2)
