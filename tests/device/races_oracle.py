#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs small calls on Oclgrind, which reports every pair of accesses of a launch that nothing orders, and holds each pair
against allowed_races.txt: a pair that is not there fails, as does any other report, and a hash that PoCL does not have.

Usage: races_oracle.py RACE_CASES [--all]
  RACE_CASES   the program (tests/support/race_cases.cpp)
  --all        every kind of device and every case, some minutes, and each pair that is allowed must be seen; otherwise
               those that take seconds
"""
import collections
import fnmatch
import os
import re
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
ALL = [(kind, []) for kind in ("threads", "shares", "lanes", "gpu", "few")]
QUICK = [("threads", []), ("shares", ["pslg"]), ("gpu", ["vertices"]), ("few", ["vertices"])]
# With LLVM's passes Oclgrind 21.10 ends at functions that it does not know.
OCLGRIND = ["oclgrind", "--data-races", "--num-threads", "1", "--max-errors", "100000000",
            "--build-options", "-cl-opt-disable -disable-llvm-passes"]


def read_allowed(path):
    """The entries, and how often each was needed."""
    arguments, entries = set(), {}
    for number, line in enumerate(open(path), 1):
        line = line.rstrip("\n")
        if line.startswith("argument "):
            arguments.add(line.split()[1].rstrip(":"))
        elif line and line[0] not in "# ":
            fields = [field.strip() for field in line.split(" | ")]
            if len(fields) != 4:
                sys.exit(f"{path}:{number}: not KERNELS | STATEMENT | STATEMENT | ARGUMENT")
            if fields[3] not in arguments:
                sys.exit(f"{path}:{number}: no argument is named {fields[3]}")
            entries[fields[0], *sorted(fields[1:3])] = 0
    unused = arguments - {line.rsplit(" | ", 1)[-1].strip() for line in open(path)}
    if unused:
        sys.exit(f"{path}: no entry names {', '.join(sorted(unused))}")
    return entries


def statement(entity):
    """The source of an access, or its instruction where there is no source; a bar in it stands without blanks."""
    found = re.search(r"\n\tAt line \d+.*\n\t  (.*)", entity)
    return (found or re.search(r"\n\t  (.*)", entity)).group(1).strip().replace(" | ", "|")


def pairs_of(log):
    """Counts by (kernel, statement, statement), and reports that are no races."""
    pairs, others = collections.Counter(), []
    for report in re.split(r"\n(?=\S)", log):
        if not report.strip():
            continue
        kernel = re.search(r"\n\tKernel: (\S+)", report)
        halves = re.split(r"\n\t(?:First|Second) entity:", report)
        if "data race at" not in report or not kernel or len(halves) != 3:
            others.append(report)
        else:
            pairs[(kernel.group(1), *sorted(map(statement, halves[1:])))] += 1
    return pairs, others


def run(command, **environment):
    variables = {**os.environ, "GCDT_DISABLE_CACHE": "1", **environment}
    done = subprocess.run(command, env=variables, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}: status {done.returncode}\n{done.stdout[-500:]}{done.stderr[-2000:]}")
    lines = done.stdout.splitlines()
    return ([line for line in lines if line.startswith("hash ")],
            {line.split()[1] for line in lines if line.startswith("kernel ")})


def main():
    program, runs = os.path.abspath(sys.argv[1]), ALL if "--all" in sys.argv[2:] else QUICK
    allowed = read_allowed(os.path.join(HERE, "allowed_races.txt"))
    pairs, others, kernels, cases, failed = collections.Counter(), [], set(), 0, False
    for kind, names in runs:
        usual, _ = run([program, "Portable Computing Language", kind, *names])
        with tempfile.NamedTemporaryFile("r", errors="replace") as log:
            found, launched = run([*OCLGRIND, "--log", log.name, program, "0", kind, *names])
            of_kind, other = pairs_of(log.read())
        if not found or found != usual:
            failed = True
            print(f"races: {kind}: other hashes than on PoCL:\n", "\n".join(found), "\n", "\n".join(usual))
        pairs, others, kernels, cases = pairs + of_kind, others + other, kernels | launched, cases + len(found)
        print(f"races: {kind}: {len(found)} cases, {len(launched)} kernels, {sum(of_kind.values())} reports", flush=True)
    for (kernel, one, two), count in sorted(pairs.items()):
        entry = next((e for e in allowed if fnmatch.fnmatchcase(kernel, e[0]) and e[1:] == (one, two)), None)
        if entry:
            allowed[entry] += count
        else:
            failed = True
            print(f"races: not allowed, {count} times:\n{kernel} | {one} | {two} |")
    for report in others[:20]:
        print("races: a report that is no race:", report)
    unseen = [" | ".join(entry) for entry, count in allowed.items() if count == 0]
    if runs is ALL and unseen:
        failed = True
        print("races: allowed, but never seen:", *unseen, sep="\n")
    print(f"races: {cases} cases, {len(kernels)} kernels, {sum(pairs.values())} reports of {len(pairs)} pairs; "
          f"{len(allowed) - len(unseen)} of {len(allowed)} allowed ones")
    sys.exit(1 if failed or others or not pairs else 0)


main()
