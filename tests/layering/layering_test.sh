#!/bin/sh
# The layers: lib <- shooting <- apps, lib <- plots <- apps. usage: layering_test.sh PROJECT_FOLDER
#
# Whatever a folder includes must be on the list of its layer. The check is then checked itself: on
# a small tree with one bad include at a time it must fail.
set -eu

std='[a-z_]+'
posix='(fcntl|poll|sched|signal|spawn|unistd)\.h|sys/[a-z]+\.h'
eigen='Eigen/[A-Za-z]+'
core='carnot/[a-z0-9_]+\.h'
scenes='carnot/scenes/[a-z0-9_]+\.h'

# only PATTERN PATH...: prints each include in the sources there that is not of the pattern.
only() {
  pattern=$1
  shift
  find "$@" -type f \( -name '*.h' -o -name '*.cc' \) \
    -exec grep -HE '^[[:space:]]*#[[:space:]]*include' {} + |
    grep -vE "include[[:space:]]*[<\"]($pattern)[>\"]" || true
}

# Headers without code of their own.
umbrellas() {
  find "$@" -type f -name '*.h' | while read -r header; do
    grep -qvE '^[[:space:]]*((//|#).*|(inline )?namespace.*|})?[[:space:]]*$' "$header" ||
      echo "$header: only includes others"
  done
}

# Prints what breaks a layer under the current folder.
broken() {
  sees="$std|$eigen|ceres/jet\.h|xsimd/[a-z_]+\.hpp|$core"
  only "$sees" lib/carnot/*.h
  only "$sees|$scenes" lib/carnot/scenes
  shooting="$core|carnot/shooting/[a-z0-9_]+\.h"
  ompl='ompl/([a-z]+/)+[A-Za-z0-9]+\.h'
  only "$std|$eigen|ceres/[a-z_]+\.h|nlopt\.hp*|$shooting" \
    $(find shooting -type f ! -name ompl_state_space.h)
  adapter=shooting/carnot/shooting/ompl_state_space.h
  [ ! -f $adapter ] || only "$std|$ompl|$shooting" $adapter
  only "$std|$posix|$eigen|gnuplot-iostream\.h|$core|carnot/plots/[a-z0-9_]+\.h" plots
  own=$(find apps -name '*.h' | sed -E 's:^apps/::; s:\.:\\.:; s:^(.*)/:(\1/)?:' | tr '\n' '|')
  libraries='CLI/[A-Za-z]+\.hpp|nlohmann/[a-z_]+\.hpp|fmt/[a-z]+\.h'
  quad='boost/multiprecision/(eigen|float128)\.hpp'
  only "$std|$posix|$eigen|$libraries|$quad|${own}version\.h|carnot/[a-z0-9_/]+\.h" \
    $(find apps -maxdepth 1 -type f)
  peers='boost/numeric/odeint/[a-z0-9_/]+\.hpp|gsl/[a-z0-9_]+\.h|benchmark/benchmark\.h'
  peers="$peers|(cvode|ida|nvector|sundials|sunlinsol|sunmatrix|sunnonlinsol)/[a-z_]+\.h"
  peers="$peers|coin/Ip[A-Za-z]+\.hpp"
  [ ! -d apps/peers ] || only "$std|$peers|${own}$shooting|$scenes" apps/peers
  [ ! -d apps/micro ] || only "$std|$peers|fmt/[a-z]+\.h|${own}$shooting|$scenes" apps/micro
  [ ! -d apps/ompl ] || only "$std|$ompl|$shooting|$scenes|carnot/plots/[a-z_]+\.h" apps/ompl
  umbrellas lib shooting plots
}

failed=0
fail() {
  printf '%s\n' "$*"
  failed=1
}

cd "$1"
found=$(broken)
[ -z "$found" ] || fail "These includes break a layer:
$found"

tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
cd "$tree"
mkdir -p lib/carnot/scenes shooting/carnot/shooting plots/carnot/plots apps

# write FILE INCLUDE...: a source with these includes and a line of code.
write() {
  file=$1
  shift
  printf '#include %s\n' "$@" >"$file"
  echo 'int x();' >>"$file"
}
write lib/carnot/flow.h '<cmath>' '<Eigen/Core>' '<ceres/jet.h>' '"carnot/gauss.h"'
write lib/carnot/scenes/vehicle.h '"carnot/flow.h"' '"carnot/scenes/unicycle.h"'
write shooting/carnot/shooting/path.cc '<ceres/ceres.h>' '<nlopt.hpp>' '"carnot/shooting/path.h"'
write plots/carnot/plots/plot.cc '<gnuplot-iostream.h>' '"carnot/trajectory.h"'
write apps/scene_entry.h '<string>' '<fmt/format.h>' '"carnot/plots/plot.h"'
write apps/main.cc '<CLI/CLI.hpp>' '"carnot/scenes/vehicle.h"' '"scene_entry.h"'
found=$(broken)
[ -z "$found" ] || fail "A good tree is rejected:
$found"

must_fail() {
  write "$@"
  [ -n "$(broken)" ] || fail "Not noticed: $*"
  rm "$1"
}
must_fail lib/carnot/bad.h '<ceres/ceres.h>'
must_fail lib/carnot/bad.h '<cmath>' '"carnot/shooting/geodesic.h"'
must_fail lib/carnot/bad.h '"carnot/scenes/vehicle.h"'
must_fail lib/carnot/scenes/bad.h '<boost/math/constants/constants.hpp>'
must_fail shooting/carnot/shooting/bad.h '"carnot/plots/plot.h"'
must_fail shooting/carnot/shooting/bad.cc '"carnot/scenes/vehicle.h"'
must_fail shooting/carnot/shooting/bad.cc '"../../apps/scene_entry.h"'
must_fail shooting/carnot/shooting/bad.cc '<gnuplot-iostream.h>'
must_fail shooting/carnot/shooting/bad.h '<ompl/base/State.h>'
must_fail plots/carnot/plots/bad.cc '"carnot/shooting/geodesic.h"'
must_fail plots/carnot/plots/bad.h '<ceres/ceres.h>'
must_fail apps/bad.cc '<gnuplot-iostream.h>'
must_fail apps/bad.cc '<ceres/ceres.h>'
must_fail apps/bad.cc '<nlopt.h>'
must_fail apps/bad.cc '<gsl/gsl_odeiv2.h>'
mkdir apps/peers
must_fail apps/peers/bad.cc '<fmt/format.h>'
printf '%s\n' '#pragma once' '// Everything.' '#include "carnot/flow.h"' >lib/carnot/carnot.h
[ -n "$(broken)" ] || fail 'Not noticed: an umbrella header'

exit $failed
