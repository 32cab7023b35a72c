"""Type stubs, doctests, and how long an import takes."""

import doctest
import importlib
import os
import pkgutil
import subprocess
import sys
from pathlib import Path

import pytest

import carnot

ROOT = Path(__file__).resolve().parents[2]


def run(*command, **options):
    return subprocess.run(command, capture_output=True, text=True, check=False, **options)


def test_mypy_is_content(tmp_path):
    done = run("mypy", "--python-executable", sys.executable, "--cache-dir", tmp_path, cwd=ROOT)
    assert done.returncode == 0, done.stdout


def test_stubs_are_those_of_the_module(tmp_path):
    package = Path(carnot.__file__).resolve().parents[1]
    environment = {**os.environ, "MYPYPATH": str(package), "PYTHONPATH": str(package)}
    # With this Python, whose module it is: mypy may belong to another one.
    command = [sys.executable, "-m", "mypy.stubtest", "carnot._carnot"]
    allowed = tmp_path / "allowed"
    # Classes of pybind11 have a metaclass of their own, which is no type to speak of.
    allowed.write_text("carnot._carnot.Model\ncarnot._carnot.Steering\n")
    done = run(*command, "--allowlist", allowed, env=environment, cwd=tmp_path)
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize(
    "name", ["carnot", *(f"carnot.{one.name}" for one in pkgutil.iter_modules(carnot.__path__))]
)
def test_examples_are_true(name):
    found = doctest.testmod(importlib.import_module(name))
    assert found.failed == 0


def test_the_page_is_true():
    found = doctest.testfile(str(ROOT / "docs" / "python.md"), module_relative=False)
    assert found.attempted > 20
    assert found.failed == 0


def test_everything_public_has_words():
    for name in carnot.__all__:
        thing = getattr(carnot, name)
        if name.startswith("__"):
            continue
        assert thing.__doc__, name
        members = vars(thing) if isinstance(thing, type) else {}
        for member, value in members.items():
            plain = member.startswith("_") or not (callable(value) or isinstance(value, property))
            assert plain or value.__doc__, f"{name}.{member}"


def test_import_loads_nothing_that_is_not_needed():
    script = "import sys, carnot; print(sorted({'matplotlib', 'sympy', 'tqdm'} & set(sys.modules)))"
    assert run(sys.executable, "-c", script).stdout.strip() == "[]"
