#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the table (Markdown) and the plots (PNG) of a file of results, beside it.
Usage: report.py RESULTS.json"""

import json
import math
import os
import sys

import plots

HERE = os.path.dirname(os.path.abspath(__file__))
FAMILIES = (
    ["uniform", "gaussian", "ring", "grid"]
    + [f"synthetic_cons_{k}" for k in range(1, 7)]
    + ["leafs", "coasts", "airport", "letters", "star", "fan", "spiral"]
)
PHASES = ["order", "insert", "constrain", "flip", "check", "output", "copy"]


def ms(value):
    if value is None:
        return "-"
    return f"{value:.2f}" if value < 10 else f"{value:.1f}" if value < 100 else f"{value:.0f}"


def count(n):
    return f"{n:,}"


def name(row):
    return f"{row['workload']} {short(row['size'] or row['n'])}"


def short(n):
    return f"{n / 1e6:.3g}M" if n >= 1e6 else f"{n / 1e3:.3g}k" if n >= 1e3 else str(n)


def table(head, rows):
    return "\n".join("| " + " | ".join(str(cell) for cell in row) + " |" for row in [head, ["---"] * len(head)] + rows)


def transfer_ms(row, machine):
    """Input and output once over the link, from and to pinned memory."""
    rates = machine.get("pinned_write_gb_s"), machine.get("pinned_read_gb_s")
    if not all(rates):
        return None
    sent = 16 * row["n"] + 8 * row["m"]
    received = 25 * row["triangles"] + 4 * row["n"] + 16 * row["m"]
    return sent / rates[0] / 1e6 + received / rates[1] / 1e6


def full_goal(row, machine):
    """core + check + order + 1.5 x the transfer."""
    transfer = transfer_ms(row, machine)
    return (
        None if transfer is None else row["core_ms"] + row["phases"]["check"] + row["phases"]["output"] + 1.5 * transfer
    )


def call_ms(row):
    """The whole call on the caller's clock, from vectors to new vectors."""
    return row["call"]["median"]


def ours(row, gpu):
    """What is held against the peer: on a GPU device times, on a CPU whole calls."""
    return row["core_ms"] if gpu else call_ms(row)


def main_table(rows, machine):
    gpu = machine["kind"] == "gpu"
    lines = []
    for row in rows:
        peer = row.get("peer_ms")
        anchored = peer is not None and row.get("peer_source") != "measured"
        spread = row["core"] if gpu else row["call"]
        lines.append(
            [
                name(row),
                count(row["n"]),
                count(row["m"]),
                ms(row["core_ms"]),
                ms(row["phases"]["clean"]),
                ms(call_ms(row)),
                f"{ms(spread['min'])} / {ms(spread['q1'])} / {ms(spread['q3'])}",
                f"{row['n'] / ours(row, gpu) / 1e3:.1f}",
                "-" if peer is None else f"{row['peer']}{' *' if anchored else ''}",
                ms(peer),
                "-" if peer is None else f"{peer / ours(row, gpu):.2f}",
                "yes" if row["verified"] else "NO",
            ]
        )
    head = [
        "workload",
        "n",
        "m",
        "core ms",
        "cleaning ms",
        "call ms",
        ("core" if gpu else "call") + " min / q1 / q3",
        "M vertices/s",
        "best peer",
        "peer ms",
        "ahead",
        "verified",
    ]
    return table(head, lines)


def phase_table(rows):
    lines = [
        [name(row)]
        + [ms(row["phases"][p]) for p in PHASES]
        + [ms(row["phases"].get(part)) for part in ("clean", "walk", "gather")]
        + [count(row[k]) for k in ("insert_rounds", "flip_rounds", "flips", "crossed_pairs", "launches", "read_backs")]
        + [f"{row['bytes_per_vertex']:.0f}"]
        for row in rows
    ]
    return table(
        ["workload"]
        + [p + " ms" for p in PHASES]
        + [
            "cleaning (of constrain) ms",
            "walk (of cleaning, and of core) ms",
            "gathering (of output, and of core) ms",
            "insert rounds",
            "flip rounds",
            "flips",
            "crossed pairs",
            "launches",
            "read-backs",
            "bytes/vertex",
        ],
        lines,
    )


def fewer(row):
    """Says how many points were located where they are not a million (bench/README.md)."""
    located = row.get("located", 1_000_000)
    return "" if located == 1_000_000 else f" ({located})"


def besides_table(rows):
    """What cleaning, checking, domains, location and verification cost beside the triangulation."""
    lines = [
        [
            name(row),
            count(row["m"]),
            ms(row["core_ms"]),
            ms(row["phases"]["clean"]),
            ms(row["phases"]["check"]),
            ms(row["regions_ms"]),
            ms(row["locate_ms"]) + fewer(row),
            ms(row["device_locate_ms"]) + fewer(row) if "device_locate_ms" in row else "-",
            ms(row["verify_ms"]) if row["verify_ms"] else "-",
        ]
        for row in rows
        if "regions_ms" in row
    ]
    return table(
        [
            "workload",
            "m",
            "core ms",
            "cleaning ms",
            "device check ms",
            "regions, depths, windings ms",
            "1M points (or so many) located, from and to the host ms",
            "device to device ms",
            "proof on the host, one thread ms",
        ],
        lines,
    )


def limits_table(rows, machine):
    lines = []
    for row in rows:
        moved = 8 * row["n"] + 24 * row["triangles"]  # vertices read once, triangles and neighbours written once
        floor = moved / machine["copy_gb_s"] / 1e6 if machine.get("copy_gb_s") else None
        waits = row["read_backs"] * machine.get("launch_read_us", 0) / 1e3
        order = row["phases"]["check"] + row["phases"]["output"]
        lines.append(
            [
                name(row),
                ms(row["core_ms"]),
                ms(floor),
                ms(waits),
                ms(row["full_ms"]),
                ms(row["call"]["median"]),
                ms(row.get("pinned_ms")),
                ms(full_goal(row, machine)),
                f"{order / row['core_ms']:.2f}",
            ]
        )
    return table(
        [
            "workload",
            "core ms",
            "least traffic at copy speed ms",
            "read-backs x launch and read ms",
            "full ms",
            "call, caller's clock ms",
            "call from and to pinned memory ms",
            "core + check + order + 1.5 x pinned transfer ms",
            "(check + output) / core",
        ],
        lines,
    )


# Kernels that do the same for few edges and for many, so that a smaller input has other shares of them.
ALTERNATIVES = {"flip_test": "flip_sweep, flip_test", "flip_mark": "flip_mark, flip_propagate"}
ALTERNATIVES |= {"flip_sweep": ALTERNATIVES["flip_test"], "flip_propagate": ALTERNATIVES["flip_mark"]}


def by_alternatives(kernels):
    """Name to sums of the numbers of (name, numbers)."""
    sums = {}
    for kernel, numbers in kernels:
        key = ALTERNATIVES.get(kernel, kernel)
        sums[key] = [a + b for a, b in zip(sums.get(key, [0] * len(numbers)), numbers)]
    return sums


def traffic_tables(rows, machine):
    """Bytes that each kernel moves (scripts/traffic.sh), at what rate, and what part of the copy kernel's rate that is."""
    path = os.path.join(HERE, "results", "traffic.json")
    if machine["kind"] != "gpu" or not machine.get("copy_gb_s") or not os.path.exists(path):
        return ""
    with open(path) as file:
        traffic = json.load(file)
    text = ""
    for row in rows:
        counted = traffic.get(row["workload"])
        if not counted or counted["stands_for"] != row["size"] or "kernels" not in row:
            continue
        sectors = by_alternatives(
            (kernel, [found["read_sectors"] + found["written_sectors"]]) for kernel, found in counted["kernels"].items()
        )
        timed = by_alternatives((kernel["name"], [kernel["ms"], kernel["launches"]]) for kernel in row["kernels"])
        lines, sums = [], [0, 0]
        for kernel, (took, launches) in sorted(timed.items(), key=lambda item: -item[1][0]):
            if kernel not in sectors or took <= 0:
                continue
            moved = 32 * sectors[kernel][0] * row["n"] / counted["n"]
            sums = [sums[0] + took, sums[1] + moved]
            lines.append((kernel, launches, took, moved))
        all_ms = sum(k["ms"] for k in row["kernels"])
        lines = [line for line in lines if line[2] >= 0.01 * all_ms]
        lines.append(("all counted", "", *sums))

        def cells(kernel, launches, took, moved):
            rate = moved / took / 1e6
            return [kernel, launches, ms(took), f"{moved / 1e6:.0f}", f"{rate:.0f}", f"{rate / machine['copy_gb_s']:.0%}"]

        text += (
            f"\n### {name(row)}: {sums[0] / all_ms:.0%} of the {ms(all_ms)} ms that its launches take\n\n"
            + table(["kernel", "launches", "ms", "MB", "GB/s", "of the copy rate"], [cells(*line) for line in lines])
            + "\n"
        )
    return text and "\n## Bytes moved by each kernel\n" + text


def peers_table(rows):
    lines = []
    for row in rows:
        for peer in row["peers"]:
            if "error" in peer:
                lines.append([name(row), peer["name"], "-", "-", "failed: " + peer["error"]])
                continue
            triangles = peer.get("triangles")
            agrees = (
                "-"
                if triangles is None
                else "as ours" if triangles == row["triangles"] else f"{triangles - row['triangles']:+d}"
            )
            lines.append([name(row), peer["name"], ms(peer["ms"]), agrees, peer["source"]])
    return table(["workload", "peer", "ms", "triangles", "source"], lines)


def goals(rows, machine, targets):
    """What was to be met, what was measured, whether it was; only rows of the full sizes."""
    gpu = machine["kind"] == "gpu"
    at = {(r["workload"], r["size"]): r for r in rows}
    lines = []

    def goal(row, what, value, limit, unit="ms"):
        if value is not None and limit is not None:
            lines.append(
                [name(row), what, f"{value:.3g} {unit}", f"{limit:.3g} {unit}", "yes" if value <= limit else "NO"]
            )

    if not gpu:
        for key, factor in ((("uniform", 1000), 3), (("uniform", 1000000), 1), (("synthetic_cons_1", 1000000), 1)):
            row = at.get(key)
            if row and row.get("peer_source") == "measured":
                what = f"call at most {row['peer']}" + (f" x {factor}" if factor > 1 else "")
                goal(row, what, call_ms(row), factor * row["peer_ms"])
        return lines
    for row in rows:
        target = targets.get((row["workload"], row["size"]))
        if target:
            goal(row, "core", row["core_ms"], target.get("must"))
        if target and "crossed_on_delaunay" in target:
            goal(
                row,
                "constraint phase without cleaning: 1 ms and 0.2 ns a pair crossed on the Delaunay mesh",
                row["phases"]["constrain"] - row["phases"]["clean"],
                1 + 0.2e-6 * target["crossed_on_delaunay"],
            )
    row = at.get(("uniform", 1000))
    if row:
        goal(row, "call", call_ms(row), 1)
    least = at.get(("uniform", 100000))
    for row in rows:
        if least and row["workload"] == "uniform" and row["n"] > least["n"]:
            goal(
                row,
                "core grows like n log n from 100k on",
                row["core_ms"],
                least["core_ms"] * row["n"] * math.log(row["n"]) / (least["n"] * math.log(least["n"])),
            )
    star, plain = at.get(("star", 1000000)), at.get(("uniform", 1000000))
    if star and plain:
        goal(star, "core within 5% of uniform", star["core_ms"], 1.05 * plain["core_ms"])
    for row in rows:
        if row["m"] == 0 and row["size"] >= 1000000:
            goal(row, "peak device memory per vertex, no constraints", row["bytes_per_vertex"], 200, "bytes")
        if row["size"] >= 1000000:
            goal(
                row,
                "check + output, at most half of core",
                row["phases"]["check"] + row["phases"]["output"],
                row["core_ms"] / 2,
            )
            transfers = full_goal(row, machine)
            if row.get("pinned_ms") and transfers:
                goal(row, "call from and to pinned memory", row["pinned_ms"], transfers)
    return lines


def verdicts(rows, machine, targets):
    gpu = machine["kind"] == "gpu"
    behind = [
        f"{name(r)}: {ms(ours(r, gpu))} ms, {r['peer']} {ms(r['peer_ms'])} ms"
        for r in rows
        if r.get("peer_ms") and r["peer_ms"] < ours(r, gpu)
    ]
    wrong = [f"{name(r)}: {r.get('fault', 'runs differ')}" for r in rows if not r["verified"]]
    missed = [f"{g[0]}: {g[1]} {g[2]}, goal {g[3]}" for g in goals(rows, machine, targets) if g[4] == "NO"]
    text = ""
    for title, lines in (("Not verified", wrong), ("Losses", behind), ("Goals missed", missed)):
        text += f"\n## {title}\n" + ("".join(f"- {line}\n" for line in lines) or "none\n")
    return text


def describe(machine, rows):
    text = f"{machine['device']} ({machine['platform']}, driver {machine['driver']}), {machine['host_threads']} host threads; {machine['date']}"
    if machine.get("commit"):
        text += f", commit {machine['commit']}"
    if machine.get("command"):
        text += f". Command: `{machine['command']}`"
    before = {}  # rows that the last run did not measure keep what an earlier one did
    for row in rows:
        if row.get("commit", machine.get("commit")) != machine.get("commit"):
            before.setdefault(row["commit"], []).append(name(row))
    for commit, names in before.items():
        text += f"\n\nOf commit {commit}: {', '.join(names)}."
    if machine.get("copy_gb_s"):
        text += (
            f"\n\nMeasured in the same run: copy kernel {machine['copy_gb_s']:.0f} GB/s (read + written), buffer copy "
            f"{machine['buffer_copy_gb_s']:.0f} GB/s; host to device {machine['write_gb_s']:.1f} GB/s pageable, "
            f"{machine['pinned_write_gb_s']:.1f} pinned; back {machine['read_gb_s']:.1f} and "
            f"{machine['pinned_read_gb_s']:.1f}; launch {machine['launch_us']:.1f} us, launch and read "
            f"{machine['launch_read_us']:.1f} us."
        )
    return text


def start_text(path):
    if not os.path.exists(path):
        return ""
    with open(path) as file:
        s = json.load(file)
    columns = {
        "all caches empty": "all_caches_empty_s",
        "the same with constraints (letters 98k)": "constrained_all_caches_empty_s",
        "only gcdt's cache warm": "own_cache_warm_s",
        "all caches warm": "all_caches_warm_s",
        "context and queue only": "context_only_s",
    }
    seconds = [f"{s[key]:.2f} s" if key in s else "-" for key in columns.values()]
    return "\n## First triangulation of 1000 points, whole process\n" + table(list(columns), [seconds]) + "\n"


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    path = sys.argv[1]
    stem = path[: -len(".json")]
    with open(path) as file:
        results = json.load(file)
    with open(os.path.join(HERE, "targets.json")) as file:
        targets = {(t["workload"], t["size"]): t for t in json.load(file)["targets"]}
    machine = results["machine"]
    rank = {family: i for i, family in enumerate(FAMILIES)}
    rows = sorted(results["rows"], key=lambda r: (rank.get(r["workload"], len(rank)), r["workload"], r["n"]))
    gpu = machine["kind"] == "gpu"
    made = plots.draw(rows, machine, stem, [name(row) for row in rows], [ours(row, gpu) for row in rows], PHASES)
    title = main_table(rows, machine)
    with open(stem + ".md", "w") as file:
        file.write("# Results\n" + describe(machine, rows) + "\n\n")
        file.writelines(f"![]({picture})\n" for picture in made)
        file.write(
            "\n"
            + title
            + "\n\nMedians in milliseconds. `core` begins with vertices on the grid and clean constraints on the device and "
            + "ends with triangles and neighbours there; `call` is the caller's clock, from vectors to new vectors "
            + "(`docs/statistics.md`). "
            + f'"Ahead" is the peer\'s time over `{"core" if machine["kind"] == "gpu" else "call"}`'
            + ". `*`: the peer did not run here; its figure was taken before (see the peers below).\n"
        )
        file.write(verdicts(rows, machine, targets))
        met = goals(rows, machine, targets)
        if met:
            file.write("\n## Goals\n" + table(["workload", "goal", "measured", "at most", "met"], met) + "\n")
        file.write("\n## Phases, counts, memory\n" + phase_table(rows) + "\n")
        file.write("\n## Beside the triangulation\n" + besides_table(rows) + "\n")
        file.write("\n## Against the machine's limits\n" + limits_table(rows, machine) + "\n")
        file.write(traffic_tables(rows, machine))
        file.write(start_text(stem + "-start.json"))
        file.write("\n## All peers\n" + peers_table(rows) + "\n")
    print(title)
    print(verdicts(rows, machine, targets))
    print("written:", stem + ".md", *made)


main()
