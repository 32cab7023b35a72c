#!/bin/bash
# Which lines of lib and shooting the tests reach, by gcov: builds the preset coverage, runs its test
# programs, and prints the share of each file and the lines that are left.
# usage: scripts/coverage.sh [--report]     --report: of what has been run before
#
# It takes hours on a small machine. A line counts as reached where any of its instances is. Lines of
# templates that no test instantiates, and those that -O1 removes, are not counted. The exit status is
# 1 where a test fails or less than 95 % is reached.
source "$(dirname "${BASH_SOURCE[0]}")/prepare.sh"
exec 9>&-  # the lock of prepare.sh: nothing here builds in build/release
cd "$root"
build=build/coverage

status=0
if [ "${1:-}" != --report ]; then
  install_packages "$root"/scripts/packages{,-test}.txt
  cmake --preset coverage
  cmake --build --preset coverage
  find $build -name '*.gcda' -delete
  for program in lib shooting verification; do
    (cd tests && "../$build/tests/${program}_test" --gtest_brief=1) || status=1
  done
fi
python3 scripts/coverage_report.py "$root" "$root/$build" || status=1
exit $status
