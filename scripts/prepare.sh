# shellcheck shell=bash
# Sourced by run.sh and test.sh: installs packages, configures and builds the release preset.
# stdout belongs to the caller's program; all that is said here goes to stderr or into a log.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
build=$root/build/release
log=$root/build/prepare.log

mkdir -p "$root/build"
exec 9>"$root/build/.lock"
flock 9  # two callers at once would build over each other

say() { printf 'carnot: %s\n' "$*" >&2; }

# quietly COMMAND...: shows only the end of a failure, and exits with it.
quietly() {
  "$@" >"$log" 2>&1 </dev/null 9>&- && return
  tail -n 60 "$log" >&2
  say "failed: $*"
  exit 1
}

# install_packages LIST...: those of the lists that are not there yet.
install_packages() {
  local wanted missing sudo=()
  mapfile -t wanted < <(sed 's/#.*//; /^ *$/d' "$@")
  mapfile -t missing < <(comm -13 \
    <(dpkg-query -W -f '${db:Status-Status} ${Package}\n' "${wanted[@]}" 2>/dev/null |
      sed -n 's/^installed //p' | sort -u) \
    <(printf '%s\n' "${wanted[@]}" | sort -u))
  [ ${#missing[@]} -gt 0 ] || return 0
  say "installing ${missing[*]}"
  [ "$(id -u)" = 0 ] || sudo=(sudo)
  local apt_get=("${sudo[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -y
    -o DPkg::Lock::Timeout=300 -o Acquire::Retries=3)
  quietly "${apt_get[@]}" update
  quietly "${apt_get[@]}" install --no-install-recommends "${missing[@]}"
}

# is_configured OPTION...: build/release is of this tree, with these options and today's presets.
is_configured() {
  local cache=$build/CMakeCache.txt line
  [ -f "$build/build.ninja" ] && [ "$cache" -nt "$root/CMakePresets.json" ] || return 1
  for line in "CMAKE_HOME_DIRECTORY:INTERNAL=$root" "${@/=/:BOOL=}"; do
    grep -qxF "$line" "$cache" || return 1
  done
}

# configure OPTION=VALUE...
configure() {
  is_configured "$@" && return
  say 'configuring'
  # A cache of another generator or another place is of no use.
  if ! cmake -S "$root" --preset release "${@/#/-D}" >"$log" 2>&1 </dev/null 9>&-; then
    quietly cmake -S "$root" --preset release --fresh "${@/#/-D}"
  fi
}

# As many jobs of the compiler as there are cores, and 3 GB of memory for each.
job_count() {
  awk -v n="$(nproc)" '/^MemAvailable/ { m = int($2 / 3e6) }
    END { print m < 1 ? 1 : m < n ? m : n }' /proc/meminfo
}

# build_targets [TARGET...]
build_targets() {
  [ -x "$build/bin/carnot" ] || say 'building, which takes some minutes'
  quietly cmake --build "$build" --parallel "$(job_count)" ${1:+--target "$@"}
}
