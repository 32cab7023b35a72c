#!/usr/bin/env python3
"""Plants the faults of tests/faults/faults.txt, and says which test catches each.

usage: scripts/plant_faults.py [NAME ...]   only those whose words contain one of the names

The faults are planted in a copy of the last commit, in build/faults, which is built with its tests
once: some twenty minutes. All of them are in the tests then, and the environment says which one is
awake, so that none hides another. The exit status is 0 where every fault is caught, 1 where one is
not, and 2 where a fault no longer fits the code or no name fits a fault.
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
HEADER = "awake.h"
AWAKE = """#pragma once
#include <cstdlib>
namespace carnot_faults {
// The number of the fault that is awake; 0 for none.
inline const int kAwake = [] {
  const char* const text = std::getenv("CARNOT_FAULT");
  return text == nullptr ? 0 : std::atoi(text);
}();
}  // namespace carnot_faults
"""


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


def planted(text, faults):
    """The text with each (number, fault) beside what it takes the place of."""
    places = []
    for number, fault in faults:
        if text.count(fault["from"]) != 1:
            print(f"plant_faults.py: '{fault['from']}' is not once in {fault['file']}", file=sys.stderr)
            sys.exit(2)
        places.append((text.index(fault["from"]), number, fault))
    for at, number, fault in sorted(places, key=lambda place: place[0], reverse=True):
        either = f"(carnot_faults::kAwake == {number} ? ({fault['to']}) : ({fault['from']}))"
        text = text[:at] + either + text[at + len(fault["from"]):]
    return f'#include "{SOURCE / HEADER}"\n{text}'


def plant(faults):
    """Plants all of them in the copy; the first has the number 1."""
    (SOURCE / HEADER).write_text(AWAKE)
    for name in {fault["file"] for fault in faults}:
        file = SOURCE / name
        of_file = [(i, fault) for i, fault in enumerate(faults, 1) if fault["file"] == name]
        file.write_text(planted(file.read_text(), of_file))


def build(faults):
    targets = sorted({fault["test"].split()[0] for fault in faults})
    done = run("cmake", "--build", BUILD, "--target", *targets, "--parallel", str(os.cpu_count()))
    if done.returncode != 0:
        sys.exit(done.stdout[-4000:])


def prepare():
    """A copy of the last commit, configured."""
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


def failing_test(fault, number):
    """The first of the fault's tests that fails with this one awake (none for 0), or none."""
    binary, names = fault["test"].split(None, 1)
    try:
        done = run(BUILD / "tests" / binary, f"--gtest_filter={names}", timeout=PATIENCE,
                   env={**os.environ, "CARNOT_FAULT": str(number)})
    except subprocess.TimeoutExpired:
        return "the tests do not end"
    if "[==========] 0 tests" in done.stdout or "Running 0 tests" in done.stdout:
        sys.exit(f"plant_faults.py: no test is called {names}")
    failed = re.search(r"\[  FAILED  \] ([\w/.]+)", done.stdout)
    if failed:
        return failed.group(1)
    return "the program ends at once" if done.returncode != 0 else None


def main():
    wanted = sys.argv[1:]
    faults = [f for f in read_faults() if not wanted or any(name in f["what"] for name in wanted)]
    if not faults:
        print(f"plant_faults.py: no fault's words contain {' or '.join(wanted)}", file=sys.stderr)
        return 2
    prepare()
    plant(faults)
    build(faults)
    missed = 0
    for number, fault in enumerate(faults, 1):
        asleep = failing_test(fault, 0)
        if asleep:
            sys.exit(f"plant_faults.py: {asleep} fails without a fault")
        caught = failing_test(fault, number)
        missed += caught is None
        print(f"{fault['what']}: {caught or 'NOT CAUGHT'}", flush=True)
    print(f"{len(faults) - missed} of {len(faults)} faults are caught")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
