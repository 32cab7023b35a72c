"""pip installs the package; cmake puts it where Python finds it."""

import os
import subprocess
import sys
import venv
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BUILD = os.environ["CARNOT_BUILD"]
ASK = "import carnot; print(carnot.__file__, carnot.scene('unicycle').coordinates)"


def run(*command, **options):
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    done = subprocess.run(
        command, capture_output=True, text=True, check=False, env=environment, **options
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.skipif("CARNOT_SANITIZED" in os.environ, reason="compilers leak")
def test_pip_installs_into_a_new_environment(tmp_path):
    venv.create(tmp_path / "env", system_site_packages=True, with_pip=True)
    python = tmp_path / "env" / "bin" / "python"
    # What was built before is taken, so that this does not take minutes.
    setting = f"--config-settings=build-dir={BUILD}"
    run(python, "-m", "pip", "install", "-q", "--no-build-isolation", setting, ROOT)
    said = run(python, "-c", ASK, cwd=tmp_path)
    assert said.startswith(str(tmp_path / "env"))
    assert "('x', 'y', 'theta')" in said
    assert "carnot" in run(python, "-m", "pip", "list", cwd=tmp_path)
    run(python, "-m", "pip", "uninstall", "-y", "-q", "carnot", cwd=tmp_path)
    assert not list((tmp_path / "env").rglob("_carnot*"))


@pytest.mark.skipif("CARNOT_SANITIZED" in os.environ, reason="compilers leak")
def test_cmake_installs_where_a_prefix_has_packages(tmp_path):
    run("cmake", "--install", BUILD, "--prefix", tmp_path, "--component", "python")
    [folder] = tmp_path.rglob("carnot")
    names = {path.name for path in folder.iterdir()}
    assert {"__init__.py", "py.typed", "_carnot.pyi", "scene.py"} <= names
    environment = f"import sys; sys.path.insert(0, {str(folder.parent)!r}); {ASK}"
    assert str(tmp_path) in run(sys.executable, "-c", environment, cwd=tmp_path)
