#!/bin/bash
# Runs all the tests; installs and builds first what is missing. Arguments go to ctest.
# With CARNOT_PYTHON=ON in the environment, the package for Python is built and tested, too.
source "$(dirname "${BASH_SOURCE[0]}")/prepare.sh"

# Doxygen is among them, for it tells which public members nothing describes.
lists=("$root"/scripts/packages{,-test,-docs}.txt)
python=${CARNOT_PYTHON:-OFF}
[ "$python" = OFF ] || lists+=("$root/scripts/packages-python.txt")
install_packages "${lists[@]}"
configure CARNOT_BUILD_APPS=ON CARNOT_BUILD_TESTS=ON CARNOT_INSTALL=ON "CARNOT_PYTHON=$python"
build_targets
exec 9>&-  # the lock of prepare.sh
exec ctest --test-dir "$build" --output-on-failure --no-tests=error --parallel "$(nproc)" "$@" \
  </dev/null
