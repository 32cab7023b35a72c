#!/usr/bin/env python3
"""Plants the faults of tests/faults/faults.txt, one at a time, and says which test catches each.

usage: scripts/plant_faults.py [NAME ...]   only those whose words contain one of the names

The faults are planted in a copy of the last commit, in build/faults, which is built with its tests:
some twenty minutes at first. The exit status is 0 where every fault is caught, 1 where one is not, and
2 where a fault no longer fits the code or no name fits a fault.
"""
import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
PLACE = ROOT / "build" / "faults"
SOURCE = PLACE / "source"
BUILD = PLACE / "build"
KEYS = ("what", "file", "from", "to", "test")
PATIENCE = 120  # seconds; the slowest of these tests takes some twenty


def read_faults():
    faults = []
    for block in re.split(r"\n\s*\n", (ROOT / "tests/faults/faults.txt").read_text()):
        lines = [line for line in block.splitlines() if line and not line.startswith("#")]
        if not lines:
            continue
        fault = dict(line.split(None, 1) for line in lines)
        if tuple(fault) != KEYS:
            sys.exit(f"plant_faults.py: a fault must have {', '.join(KEYS)}: {fault}")
        faults.append(fault)
    return faults


def run(*command, **options):
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          check=False, **options)


def build(target):
    done = run("cmake", "--build", BUILD, "--target", target, "--parallel", str(os.cpu_count()))
    return done.returncode == 0, done.stdout


def prepare():
    """A copy of the last commit with its tests built."""
    subprocess.run(["rm", "-rf", SOURCE], check=True)
    SOURCE.mkdir(parents=True)
    archive = subprocess.Popen(["git", "-C", ROOT, "archive", "HEAD"], stdout=subprocess.PIPE)
    subprocess.run(["tar", "-x", "-m", "-C", SOURCE], stdin=archive.stdout, check=True)
    if archive.wait() != 0:
        sys.exit("plant_faults.py: git archive failed")
    generator = ["-G", "Ninja"] if not (BUILD / "CMakeCache.txt").exists() else []
    configured = run("cmake", "-S", SOURCE, "-B", BUILD, *generator, "-D", "CMAKE_BUILD_TYPE=Release",
                     "-D", "CMAKE_CXX_FLAGS=-march=native -fno-math-errno", "-D", "CARNOT_BUILD_APPS=ON",
                     "-D", "CARNOT_BUILD_TESTS=ON")
    if configured.returncode != 0:
        sys.exit(configured.stdout)


def failing_test(binary, names):
    """The first test that fails, or none."""
    try:
        done = run(BUILD / "tests" / binary, f"--gtest_filter={names}", timeout=PATIENCE)
    except subprocess.TimeoutExpired:
        return "the tests do not end"
    if "[==========] 0 tests" in done.stdout or "Running 0 tests" in done.stdout:
        sys.exit(f"plant_faults.py: no test is called {names}")
    failed = re.search(r"\[  FAILED  \] ([\w/.]+)", done.stdout)
    if failed:
        return failed.group(1)
    return "the program ends at once" if done.returncode != 0 else None


def plant(fault):
    """The test that catches the fault, or none."""
    file = SOURCE / fault["file"]
    text = file.read_text()
    if text.count(fault["from"]) != 1:
        print(f"plant_faults.py: '{fault['from']}' is not once in {fault['file']}", file=sys.stderr)
        sys.exit(2)
    binary, names = fault["test"].split(None, 1)
    try:
        file.write_text(text.replace(fault["from"], fault["to"]))
        built, log = build(binary)
        if not built:
            sys.exit(f"plant_faults.py: with the fault '{fault['what']}' nothing compiles\n{log[-2000:]}")
        return failing_test(binary, names)
    finally:
        file.write_text(text)


def main():
    wanted = sys.argv[1:]
    faults = [f for f in read_faults() if not wanted or any(name in f["what"] for name in wanted)]
    if not faults:
        print(f"plant_faults.py: no fault's words contain {' or '.join(wanted)}", file=sys.stderr)
        return 2
    prepare()
    for binary in sorted({fault["test"].split()[0] for fault in faults}):
        built, log = build(binary)
        if not built:
            sys.exit(log[-4000:])
        for fault in faults:
            if fault["test"].split()[0] == binary:
                failed = failing_test(*fault["test"].split(None, 1))
                if failed:
                    sys.exit(f"plant_faults.py: {failed} fails without a fault")
    missed = 0
    for fault in faults:
        caught = plant(fault)
        missed += caught is None
        print(f"{fault['what']}: {caught or 'NOT CAUGHT'}", flush=True)
    print(f"{len(faults) - missed} of {len(faults)} faults are caught")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
