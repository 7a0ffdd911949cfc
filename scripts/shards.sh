#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Goes through the faults of a test of tests/support/fault_campaign.hpp by several processes side by side, each of which has
# its share of them. Ends with what each did, each run and all of it, and with status 1 if one failed.
# Usage: scripts/shards.sh PROCESSES FOLDER TEST [ARGUMENT]...
#   FOLDER   where the output of each process goes
# GCDT_FAULT_STEP: each call with each of its errors (1, as it is here), or every N-th call.
set -euo pipefail

[[ $# -ge 3 && $1 =~ ^[1-9][0-9]*$ ]] || { sed -n '5,7s/^# //p' "$0" >&2; exit 2; }
processes=$1 folder=$2
shift 2
export GCDT_FAULT_STEP=${GCDT_FAULT_STEP-1}

running=()
for ((i = 0; i < processes; ++i)); do
  GCDT_FAULT_SHARD=$i/$processes "$@" --duration=true >"$folder/faults-$i.log" 2>&1 &
  running+=($!)
done
failed=0
for ((i = 0; i < processes; ++i)); do
  wait "${running[i]}" || { failed=1; tail -n 60 "$folder/faults-$i.log" >&2; }
  awk -v process="$i" '/ made to fail, / {
      sub(/.*MESSAGE: /, ""); calls += $1; errors += $3; faults += $7; said += $11; around += $13; missed += $16; ++runs
    }
    END { printf "process %d: %d runs, %d calls, %d errors of them, %d made to fail, %d said so, %d worked around, %d not made again\n",
          process, runs, calls, errors, faults, said, around, missed }' "$folder/faults-$i.log"
done >"$folder/faults-all.log"
cat "$folder/faults-all.log"
# By run: of what is counted alike by all, what the first process says; of the rest the sum.
awk '/^TEST CASE: / { name = $0; sub(/^TEST CASE: */, "", name); run = 0 }
  / made to fail, / {
    sub(/.*MESSAGE: /, ""); key = name " " ++run
    if (!(key in calls)) { order[++runs] = key; calls[key] = $1; errors[key] = $3; all_calls += $1; all_errors += $3 }
    faults[key] += $7; said[key] += $11; around[key] += $13; missed[key] += $16
    all_faults += $7; all_said += $11; all_around += $13; all_missed += $16
  }
  function line(what, a, b, c, d, e, f) {
    printf "%s: %d calls, %d errors of them, %d made to fail, %d said so, %d worked around, %d not made again\n", what, a, b, c, d, e, f
  }
  END {
    for (i = 1; i <= runs; ++i) { k = order[i]; line(k, calls[k], errors[k], faults[k], said[k], around[k], missed[k]) }
    line("in all", all_calls, all_errors, all_faults, all_said, all_around, all_missed)
  }' "$folder"/faults-[0-9]*.log
exit "$failed"
