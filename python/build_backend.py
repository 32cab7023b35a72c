"""Builds a wheel of carnot by CMake, for pip (PEP 517), with nothing but Python's own library.

`--config-settings=build-dir=DIR` takes a folder that was configured before, with
CARNOT_PYTHON=ON, and builds what is missing there. Else build/python is configured for this
machine's own instruction set.
"""

from __future__ import annotations

import base64
import hashlib
import os
import pathlib
import re
import subprocess
import sys
import sysconfig
import zipfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
FLAGS = "-march=native -fno-math-errno"  # as the preset `release`


def build_wheel(
    wheel_directory: str,
    config_settings: dict[str, str] | None = None,
    metadata_directory: str | None = None,
) -> str:
    """The name of the wheel, which is in `wheel_directory`."""
    package = _build((config_settings or {}).get("build-dir"))
    version = _version()
    tag = _tag()
    name = f"carnot-{version}-{tag}.whl"
    info = f"carnot-{version}.dist-info"
    files = {
        f"carnot/{path.name}": path.read_bytes()
        for path in sorted(package.iterdir())
        if path.is_file()
    }
    files[f"{info}/METADATA"] = _metadata(version).encode()
    wheel = f"Wheel-Version: 1.0\nGenerator: carnot\nRoot-Is-Purelib: false\nTag: {tag}\n"
    files[f"{info}/WHEEL"] = wheel.encode()
    record = [f"{path},sha256={_digest(data)},{len(data)}" for path, data in files.items()]
    files[f"{info}/RECORD"] = "\n".join([*record, f"{info}/RECORD,,", ""]).encode()
    with zipfile.ZipFile(pathlib.Path(wheel_directory) / name, "w", zipfile.ZIP_DEFLATED) as out:
        for path, data in files.items():
            out.writestr(path, data)
    return name


def get_requires_for_build_wheel(config_settings: dict[str, str] | None = None) -> list[str]:
    """Nothing from an index: the compiler and the libraries are the system's."""
    return []


def _build(given: str | None) -> pathlib.Path:
    folder = pathlib.Path(given).resolve() if given else ROOT / "build" / "python"
    if not given:
        configure = ["cmake", "-S", ROOT, "-B", folder, "-D", "CMAKE_BUILD_TYPE=Release"]
        configure += ["-D", f"CMAKE_CXX_FLAGS={FLAGS}", "-D", "CARNOT_PYTHON=ON"]
        configure += ["-D", "CARNOT_BUILD_APPS=ON", "-D", "CARNOT_BUILD_TESTS=OFF"]
        configure += ["-D", "CARNOT_INSTALL=OFF", "-D", f"Python_EXECUTABLE={sys.executable}"]
        subprocess.run(configure, check=True)
    jobs = str(os.cpu_count() or 1)
    subprocess.run(
        ["cmake", "--build", folder, "--target", "_carnot", "--parallel", jobs], check=True
    )
    return folder / "python" / "carnot"


def _version() -> str:
    found = re.search(r"VERSION (\d+\.\d+\.\d+)", (ROOT / "CMakeLists.txt").read_text())
    if found is None:
        raise RuntimeError("CMakeLists.txt: there is no version of the project")
    return found[1]


def _tag() -> str:
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    return f"{python}-{python}-{platform}"


def _metadata(version: str) -> str:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    return (
        f"Metadata-Version: 2.1\nName: carnot\nVersion: {version}\n"
        "Summary: Geodesics under velocity constraints\n"
        "Requires-Python: >=3.9\nRequires-Dist: numpy\n"
        "Provides-Extra: plot\nRequires-Dist: matplotlib; extra == 'plot'\n"
        "Provides-Extra: formulas\nRequires-Dist: sympy; extra == 'formulas'\n"
        "Provides-Extra: bars\nRequires-Dist: tqdm; extra == 'bars'\n"
        f"Description-Content-Type: text/markdown\n\n{readme}"
    )


def _digest(data: bytes) -> str:
    digest = hashlib.sha256(data).digest()
    return base64.urlsafe_b64encode(digest).rstrip(b"=").decode()
