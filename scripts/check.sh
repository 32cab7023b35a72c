#!/bin/bash
# Builds and tests the presets that look for mistakes, one after the other, and prints a summary.
# usage: scripts/check.sh [dev] [asan] [tsan] [tidy]   without arguments: all of them
#
# What each did is in build/check-PRESET.log. A preset that fails does not keep the others from
# running. The exit status is 0 where all of them pass, and 1 otherwise.
source "$(dirname "${BASH_SOURCE[0]}")/prepare.sh"

known=(dev asan tsan tidy)
[ $# -gt 0 ] || set -- "${known[@]}"
for preset in "$@"; do
  if [[ " ${known[*]} " != *" $preset "* ]]; then
    say "no such preset: '$preset'; accepted: ${known[*]}"
    exit 2
  fi
done

lists=("$root"/scripts/packages{,-test,-docs,-python}.txt)
[[ " $* " != *" tidy "* ]] || lists+=("$root/scripts/packages-check.txt")
install_packages "${lists[@]}"
exec 9>&-  # the lock of prepare.sh: nothing here builds in build/release
cd "$root"

# step NAME COMMAND...: runs it into the log of the preset, and remembers the name if it fails.
step() {
  local name=$1
  shift
  say "$preset: $name"
  printf '\n=== %s: %s\n' "$name" "$*" >>"$log"
  "$@" >>"$log" 2>&1 </dev/null && return
  failed=$name
  return 1
}

# The thread sanitizer of GCC 12 needs addresses that are not too random, where that can be had.
fixed_addresses() {
  if setarch "$(uname -m)" -R true 2>/dev/null; then
    setarch "$(uname -m)" -R "$@"
  else
    "$@"
  fi
}

# Configures, builds all that builds, and runs the tests; tidy has none, its build is the check.
check() {
  # Python does not run with the thread sanitizer.
  local python=ON
  [ "$preset" != tsan ] || python=OFF
  step configure cmake --preset "$preset" -D CARNOT_BUILD_APPS=ON -D CARNOT_BUILD_TESTS=ON \
    -D "CARNOT_PYTHON=$python" &&
    step build cmake --build --preset "$preset" --parallel "$(job_count)" -- -k 0 || return
  [ "$preset" != tidy ] || return 0
  step test fixed_addresses ctest --preset "$preset" --parallel "$(nproc)"
}

# "812 of 812 tests", or nothing where none were run.
tests_in() {
  sed -nE 's/^[0-9]+% tests passed, ([0-9]+) tests? failed out of ([0-9]+)$/\1 \2/p' "$1" |
    awk 'END { if (NR) print $2 - $1 " of " $2 " tests" }'
}

row() { printf '%-7s  %-16s  %-22s  %8s  %s\n' "$@"; }

table=()
status=0
for preset in "$@"; do
  log=$root/build/check-$preset.log
  result=passed
  failed=
  : >"$log"
  SECONDS=0
  if ! check; then
    result="failed: $failed"
    status=1
  fi
  time=$(printf '%d:%02d' $((SECONDS / 60)) $((SECONDS % 60)))
  table+=("$(row "$preset" "$result" "$(tests_in "$log")" "$time" "${log#"$root"/}")")
done
row preset result tests time log
printf '%s\n' "${table[@]}"
exit $status
