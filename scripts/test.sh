#!/bin/bash
# Runs all the tests; installs and builds first what is missing. Arguments go to ctest.
source "$(dirname "${BASH_SOURCE[0]}")/prepare.sh"

install_packages "$root/scripts/packages.txt" "$root/scripts/packages-test.txt"
configure CARNOT_BUILD_APPS=ON CARNOT_BUILD_TESTS=ON CARNOT_INSTALL=ON
build_targets
exec 9>&-  # the lock of prepare.sh
exec ctest --test-dir "$build" --output-on-failure --no-tests=error --parallel "$(nproc)" "$@" \
  </dev/null
