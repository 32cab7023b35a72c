#!/bin/bash
# Ranks give the bytes that threads give, also after kills.
# usage: ranks_test.sh PROGRAM WORK_FOLDER [KILLS]
set -euo pipefail
program=$1
rm -rf "$2"
mkdir -p "$2"
cd "$2"
kills=${3:-15}  # of the list, and as many of the field

# mpirun refuses to start programs of root, whom containers have.
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
problems=(unicycle --random 120 --seed 5 --no-times --quiet)

fail() {
  printf '%s\n' "$*"
  exit 1
}

atlas() { "$program" atlas "${problems[@]}" --output "$@"; }
# ranks NUMBER OUTPUT OPTION...
ranks() { mpirun --oversubscribe -n "$1" "$program" atlas "${problems[@]}" --output "${@:2}"; }

atlas one.jsonl --threads 1 >one.txt
atlas two.jsonl --threads 2 >two.txt
cmp one.jsonl two.jsonl
for n in 1 2 3; do
  ranks "$n" "ranks$n.jsonl" --threads 1 >"ranks$n.txt"
  cmp one.jsonl "ranks$n.jsonl"
  [ "$(grep -c '^problems' "ranks$n.txt")" = 1 ] || fail "$n ranks tell more than one result"
done

# What is refused is refused by one rank for all of them.
for bad in '--count 0' '--problems none.csv'; do
  # shellcheck disable=SC2086
  if ranks 3 bad.jsonl $bad >bad.txt 2>&1; then fail "not refused: $bad"; fi
  [ "$(grep -c '^carnot:' bad.txt)" = 1 ] || fail "refused more than once: $bad: $(cat bad.txt)"
done
head -c 1000 /dev/zero >taken.jsonl.journal
if ranks 2 taken.jsonl >taken.txt 2>&1; then fail 'an old journal is not refused'; fi
[ "$(grep -c '^carnot:' taken.txt)" = 1 ] || fail "refused more than once: $(cat taken.txt)"

# Waits until no process holds the journal any more: mpirun ends before its ranks.
released() { [ ! -e "$1" ] || flock --timeout 20 "$1" true; }

# resume RANKS_FUNCTION NUMBER OUTPUT: goes on with what is left of it, if anything.
resume() {
  local option=()
  [ ! -e "$3.journal" ] || option=(--resume)
  "$1" "$2" "$3" --threads 1 "${option[@]}"
}

# kill_often RANKS_FUNCTION WHOLE OUTPUT SECONDS: two ranks, of which one or their launcher is killed
# within about so many seconds, again and again; in the end the output is that of an undisturbed run.
# A rank that is killed ends all of them; what had been done stays.
kill_often() {
  local launcher status children processes i
  for ((i = 0; i < kills; ++i)); do
    resume "$1" 2 "$3" >killed.txt 2>&1 &
    launcher=$!
    sleep "$((RANDOM % $4)).$((RANDOM % 8 + 1))"
    children=$(pgrep -d, -P "$launcher" || true)
    mapfile -t processes < <([ -z "$children" ] || pgrep -P "$children" || true)
    processes+=(${children//,/ })
    if [ ${#processes[@]} -gt 0 ]; then
      kill -KILL "${processes[RANDOM % ${#processes[@]}]}" 2>/dev/null || true
    fi
    status=0
    wait "$launcher" || status=$?
    released "$3.journal"
    if [ "$status" = 0 ]; then
      cmp "$2" "$3"
      rm "$3"
    fi
  done
  resume "$1" 3 "$3" >killed.txt
  cmp "$2" "$3"
}

RANDOM=1
kill_often ranks one.jsonl killed.jsonl 1

# SIGTERM, as of a cluster whose time is up: the journal stays, or all was done.
ranks 2 ended.jsonl --threads 1 >ended.txt 2>&1 &
launcher=$!
sleep 0.6
kill -TERM "$launcher"
wait "$launcher" || true
released ended.jsonl.journal
[ -e ended.jsonl ] || resume ranks 2 ended.jsonl >ended.txt
cmp one.jsonl ended.jsonl

# Fields, which all ranks make together.
field=(unicycle --from 0,0,0 --grid 'x=-2:2:49, y=-2:2:49, theta=-pi:pi:36' --mod-angles --field
  --check 10 --quiet)
field() { "$program" atlas "${field[@]}" --output "$@"; }
# field_ranks NUMBER OUTPUT OPTION...
field_ranks() { mpirun --oversubscribe -n "$1" "$program" atlas "${field[@]}" --output "${@:2}"; }

field field1.jsonl --threads 1 >field1.txt
for n in 1 2 3; do
  field_ranks "$n" "field_ranks$n.jsonl" --threads 1 >"field_ranks$n.txt"
  cmp field1.jsonl "field_ranks$n.jsonl"
  [ "$(grep -c '^problems' "field_ranks$n.txt")" = 1 ] || fail "$n ranks tell more than one field"
done
for bad in '--branches 0' '--resume --set beta=-1'; do
  # shellcheck disable=SC2086
  if field_ranks 3 bad.jsonl $bad >bad.txt 2>&1; then fail "not refused: $bad"; fi
  [ "$(grep -c '^carnot:' bad.txt)" = 1 ] || fail "refused more than once: $bad: $(cat bad.txt)"
done

kill_often field_ranks field1.jsonl field_killed.jsonl 2

# SIGTERM stops all of them together.
resume field_ranks 2 field_ended.jsonl >ended.txt 2>&1 &
launcher=$!
sleep 1
kill -TERM "$(pgrep -P "$launcher" -x mpirun || echo "$launcher")"
wait "$launcher" || true
released field_ended.jsonl.journal
[ -e field_ended.jsonl ] || resume field_ranks 2 field_ended.jsonl >ended.txt
cmp field1.jsonl field_ended.jsonl

# A rank that cannot go on says so once, and ends all of them: here a folder is in the way.
mkdir -p field_full.jsonl.journal.state.part/there
if resume field_ranks 2 field_full.jsonl >full.txt 2>&1; then fail 'a state that is not kept is no failure'; fi
[ "$(grep -c '^carnot: cannot write' full.txt)" = 1 ] || fail "told more than once: $(cat full.txt)"
rm -r field_full.jsonl.journal.state.part
resume field_ranks 2 field_full.jsonl >full.txt
cmp field1.jsonl field_full.jsonl
echo 'the same bytes'
