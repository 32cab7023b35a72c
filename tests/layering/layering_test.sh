#!/bin/sh
# The layers, lib <- shooting <- apps <- python and lib <- plots <- apps, and the order of the rooms
# in each.
# usage: layering_test.sh PROJECT_FOLDER
#
# Whatever a folder includes must be on the list of its layer, and in a room of its own floor or of
# one below. The check is then checked itself: on a small tree with one bad include at a time it
# must fail.
set -eu

std='[a-z_]+'
posix='(fcntl|poll|sched|signal|spawn|unistd)\.h|sys/[a-z]+\.h'
eigen='Eigen/[A-Za-z]+'
core='carnot/((laws|language|transcription|flow|step|tableau|system|scene|numerics)/)?[a-z0-9_]+\.h'
scenes='carnot/scenes/[a-z0-9_]+\.h'

# The rooms of a layer from the top floor down: folders, or headers that are not in a folder.
lib_rooms='make_limit make_inlined_dynamics make_rattle_dynamics make_dynamics load_scene language laws dynamics transcription flow step tableau system scenes scene
  numerics'
shooting_rooms='ompl_state_space distance_field wavefront front solve_many solve_field field continuation warm_start steering_function cut_time rays steer continue
  find_geodesics search extremal shoot path problem geodesic_options boundary_value_problem geodesic
  reason linear'
apps_rooms='ompl main families laboratory program benchmark paper verify front atlas continue tables flow geodesic run catalogue text'

# climbing FOLDER PREFIX ROOMS: prints each include that goes to a floor above its own. FOLDER holds
# the rooms, and PREFIX is how their headers are included.
climbing() {
  grep -rHE '^#include "' --include='*.h' --include='*.cc' --include='*.in' "$1" |
    awk -v folder="$1/" -v prefix="$2" -v rooms="$3" '
      BEGIN { count = split(rooms, name); for (i = 1; i <= count; ++i) floor_of[name[i]] = i }
      function room(path) { sub(/[.].*/, "", path); sub(/\/.*/, "", path); return path }
      {
        split($0, part, ":")
        split($0, quoted, "\"")
        if (index(quoted[2], prefix) != 1) next
        to = substr(quoted[2], length(prefix) + 1)
        if (prefix == "" && to ~ /^carnot\//) next
        if (prefix == "carnot/" && to ~ /^(shooting|plots)\//) next
        from = room(substr(part[1], length(folder) + 1))
        to = room(to)
        if (!(from in floor_of) || !(to in floor_of)) print $0 ": a room without a floor"
        else if (floor_of[to] < floor_of[from]) print $0 ": goes up"
      }'
}

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
  find "$@" -type f -name '*.h' \
    -exec grep -LvE '^[[:space:]]*((//|#).*|(inline )?namespace.*|})?[[:space:]]*$' {} + |
    sed 's/$/: only includes others/'
}

# Prints what breaks a layer under the current folder.
broken() {
  sees="$std|$eigen|xsimd/[a-z_]+\.hpp|xbyak/xbyak\.h|$core"
  only "$sees" $(find lib -type f ! -path '*/scenes/*')
  only "$sees|$scenes" $(find lib -type f -path '*/scenes/*')
  climbing lib/carnot carnot/ "$lib_rooms"
  shooting="$core|carnot/shooting/([a-z]+/)?[a-z0-9_]+\.h"
  ompl='ompl/([a-z]+/)+[A-Za-z0-9]+\.h'
  only "$std|$eigen|ceres/[a-z_]+\.h|nlopt\.hp*|$shooting" \
    $(find shooting -type f ! -name ompl_state_space.h)
  climbing shooting/carnot/shooting carnot/shooting/ "$shooting_rooms"
  adapter=shooting/carnot/shooting/ompl_state_space.h
  [ ! -f $adapter ] || only "$std|$ompl|$shooting" $adapter
  only "$std|$posix|$eigen|gnuplot-iostream\.h|$core|carnot/plots/[a-z0-9_]+\.h" plots
  own=$(find apps -name '*.h' | sed -E 's:^apps/::; s:\.:\\.:; s:^(.*)/:(\1/)?:' | tr '\n' '|')
  libraries='mpi\.h|CLI/[A-Za-z]+\.hpp|nlohmann/[a-z_]+\.hpp|fmt/[a-z]+\.h|boost/crc\.hpp|hdf5\.h'
  quad='boost/multiprecision/(eigen|float128)\.hpp'
  only "$std|$posix|$eigen|$libraries|$quad|${own}text/version\.h|carnot/[a-z0-9_/]+\.h" \
    $(find apps -type f ! -path '*/peers/*' ! -path '*/micro/*' ! -path '*/ompl/*')
  climbing apps '' "$apps_rooms"
  peers='boost/numeric/odeint/[a-z0-9_/]+\.hpp|gsl/[a-z0-9_]+\.h|benchmark/benchmark\.h'
  peers="$peers|(cvode|ida|nvector|sundials|sunlinsol|sunmatrix|sunnonlinsol)/[a-z_]+\.h"
  peers="$peers|coin/Ip[A-Za-z]+\.hpp"
  [ ! -d apps/benchmark/peers ] || only "$std|$peers|${own}$shooting|$scenes" apps/benchmark/peers
  [ ! -d apps/benchmark/micro ] || only "$std|$peers|fmt/[a-z]+\.h|${own}$shooting|$scenes" apps/benchmark/micro
  [ ! -d apps/ompl ] || only "$std|$ompl|$shooting|$scenes|carnot/plots/[a-z_]+\.h" apps/ompl
  rooms='(verify|tables|flow|geodesic|continue|catalogue|run|text)/[a-z_]+\.h'
  [ ! -d python ] ||
    only "$std|pybind11/[a-z0-9]+\.h|fmt/format\.h|$rooms|[a-z]+\.h|carnot/[a-z0-9_/]+\.h" python
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
mkdir -p lib/carnot/scenes lib/carnot/flow lib/carnot/step lib/carnot/system lib/carnot/numerics
mkdir -p shooting/carnot/shooting/path shooting/carnot/shooting/search plots/carnot/plots
mkdir -p apps/catalogue apps/geodesic

# write FILE INCLUDE...: a source with these includes and a line of code.
write() {
  file=$1
  shift
  printf '#include %s\n' "$@" >"$file"
  echo 'int x();' >>"$file"
}
write lib/carnot/flow/flow.h '<cmath>' '<Eigen/Core>' '"carnot/step/gauss.h"'
write lib/carnot/scenes/vehicle.h '"carnot/numerics/scalar.h"' '"carnot/scenes/unicycle.h"'
write shooting/carnot/shooting/path/path.cc '<ceres/ceres.h>' '<nlopt.hpp>' \
  '"carnot/shooting/path/path.h"'
write plots/carnot/plots/plot.cc '<gnuplot-iostream.h>' '"carnot/flow/reports.h"'
write apps/catalogue/scene_entry.h '<string>' '<fmt/format.h>' '"carnot/plots/plot.h"'
write apps/main.cc '<CLI/CLI.hpp>' '"carnot/scenes/vehicle.h"' '"catalogue/scene_entry.h"'
found=$(broken)
[ -z "$found" ] || fail "A good tree is rejected:
$found"

must_fail() {
  mkdir -p "$(dirname "$1")"
  write "$@"
  [ -n "$(broken)" ] || fail "Not noticed: $*"
  rm "$1"
}
must_fail lib/carnot/flow/bad.h '<ceres/ceres.h>'
must_fail lib/carnot/flow/bad.h '<ceres/jet.h>'
must_fail lib/carnot/flow/bad.h '<cmath>' '"carnot/shooting/geodesic.h"'
must_fail lib/carnot/flow/bad.h '"carnot/scenes/vehicle.h"'
must_fail lib/carnot/step/bad.h '"carnot/flow/flow.h"'
must_fail lib/carnot/numerics/bad.h '"carnot/system/stationary.h"'
must_fail lib/carnot/attic/bad.h '"carnot/system/stationary.h"'
must_fail lib/carnot/scenes/bad.h '<boost/math/constants/constants.hpp>'
must_fail lib/carnot/scenes/bad.h '"carnot/step/gauss.h"'
must_fail shooting/carnot/shooting/path/bad.h '"carnot/plots/plot.h"'
must_fail shooting/carnot/shooting/path/bad.h '"carnot/shooting/search/search.h"'
must_fail shooting/carnot/shooting/search/bad.h '"carnot/shooting/find_geodesics.h"'
must_fail shooting/carnot/shooting/bad.cc '"carnot/scenes/vehicle.h"'
must_fail shooting/carnot/shooting/bad.cc '"../../apps/scene_entry.h"'
must_fail shooting/carnot/shooting/bad.cc '<gnuplot-iostream.h>'
must_fail shooting/carnot/shooting/bad.h '<ompl/base/State.h>'
must_fail plots/carnot/plots/bad.cc '"carnot/shooting/geodesic.h"'
must_fail plots/carnot/plots/bad.h '<ceres/ceres.h>'
must_fail apps/catalogue/bad.cc '"geodesic/geodesic_result.h"'
must_fail apps/geodesic/bad.cc '<gnuplot-iostream.h>'
must_fail apps/geodesic/bad.cc '<ceres/ceres.h>'
must_fail apps/geodesic/bad.cc '<nlopt.h>'
must_fail apps/geodesic/bad.cc '<gsl/gsl_odeiv2.h>'
must_fail apps/geodesic/bad.cc '<pybind11/pybind11.h>'
must_fail python/binding/bad.cc '"atlas/journal.h"'
must_fail python/binding/bad.cc '<nlohmann/json.hpp>'
mkdir -p apps/benchmark/peers
must_fail apps/benchmark/peers/bad.cc '<fmt/format.h>'
printf '%s\n' '#pragma once' '// Everything.' '#include "carnot/flow/flow.h"' >lib/carnot/dynamics.h
[ -n "$(broken)" ] || fail 'Not noticed: an umbrella header'

exit $failed
