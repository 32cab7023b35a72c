#!/bin/bash
# Runs carnot with the given arguments, here; installs and builds first what is missing.
# usage: scripts/run.sh geodesic vehicle --from 0,0,0,0 --to 0,1,0,0 --plot parking.png
source "$(dirname "${BASH_SOURCE[0]}")/prepare.sh"

install_packages "$root/scripts/packages.txt"
# Tests or not is left as it is, so that a built tree is not configured again.
is_configured CARNOT_BUILD_APPS=ON || configure CARNOT_BUILD_APPS=ON CARNOT_BUILD_TESTS=OFF
targets=(carnot)
case ${1-} in
  atlas | continue | front) targets+=(carnot_families) ;;
  methods | verify | paper | benchmark | stress) targets+=(carnot_laboratory) ;;
esac
build_targets "${targets[@]}"
exec 9>&-  # the lock of prepare.sh
exec "$build/bin/carnot" "$@"
