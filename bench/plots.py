# SPDX-License-Identifier: Apache-2.0
"""The plots of the benchmark, for report.py: against the best peer, and the paper's figures 12, 13 and 14. Of a file of
refinement (LABEL-refine.jsonl) rounds against log(L/h): plots.py FILE."""

import json
import math
import os
import sys


def draw(rows, machine, stem, labels, times, phases):
    """Draws the rows, called `labels`, whose times held against the peers are `times`; returns the files' names."""
    try:
        import matplotlib
    except ImportError:
        print("plots: matplotlib is not there: no plots", file=sys.stderr)
        return []
    matplotlib.use("Agg")
    from matplotlib import pyplot

    made = []

    def save(figure, suffix):
        figure.tight_layout()
        figure.savefig(stem + suffix + ".png", dpi=110)
        pyplot.close(figure)
        made.append(os.path.basename(stem + suffix + ".png"))

    place = range(len(rows))
    figure, axes = pyplot.subplots(figsize=(10, 1.5 + 0.3 * len(rows)))
    axes.barh([i + 0.2 for i in place], times, 0.38, label="gcdt, " + ("core" if machine["kind"] == "gpu" else "call"))
    for source, colour, title in (
        ("measured", "tab:red", "best peer, same run"),
        ("", "tab:orange", "best peer, figure taken before"),
    ):
        at = [
            i
            for i in place
            if rows[i].get("peer_ms") and (rows[i]["peer_source"] == "measured") == (source == "measured")
        ]
        if at:
            axes.barh([i - 0.2 for i in at], [rows[i]["peer_ms"] for i in at], 0.38, color=colour, label=title)
    axes.set(xscale="log", xlabel="milliseconds", yticks=list(place), yticklabels=labels, title=machine["device"])
    axes.invert_yaxis()
    axes.legend()
    save(figure, "")

    versus = {}  # paper, figure 12
    for i in place:
        for peer in rows[i]["peers"]:
            if peer.get("ms"):
                versus.setdefault(peer["name"], []).append((peer["ms"] / times[i], i))
    if versus:
        figure, axes = pyplot.subplots(figsize=(10, 1.5 + 0.25 * len(rows)))
        for marker, (peer, points) in zip("osD^vPX", sorted(versus.items())):
            axes.plot(*zip(*points), marker, label=peer)
        axes.axvline(1, color="black", linewidth=0.8)
        axes.set(xscale="log", xlabel="peer's time / ours", yticks=list(place), yticklabels=labels)
        axes.invert_yaxis()
        axes.grid(axis="x", which="both", alpha=0.3)
        axes.legend()
        save(figure, "-speedup")

    figure, axes = pyplot.subplots(figsize=(10, 1.5 + 0.25 * len(rows)))  # paper, figure 14
    left = [0.0] * len(rows)
    for phase in phases:
        share = [100 * r["phases"][phase] / max(r["full_ms"], 1e-9) for r in rows]
        axes.barh(list(place), share, left=left, label=phase)
        left = [a + b for a, b in zip(left, share)]
    axes.set(xlabel="share of full, %", yticks=list(place), yticklabels=labels)
    axes.invert_yaxis()
    axes.legend(ncol=6, fontsize="small", loc="lower center", bbox_to_anchor=(0.5, 1.0))
    save(figure, "-phases")

    length = {r["workload"][-1]: r for r in rows if r["workload"].startswith("synthetic_cons_")}
    base = [r for r in rows if r["workload"] == "uniform" and length and r["n"] == next(iter(length.values()))["n"]]
    if len(length) > 1 and base:  # paper, figure 13
        figure, axes = pyplot.subplots(figsize=(6, 4))
        axes.plot(
            sorted(length), [length[k]["core_ms"] / base[0]["core_ms"] for k in sorted(length)], "o-", label="gcdt"
        )
        peer = [
            (k, length[k]["peer_ms"] / base[0]["peer_ms"])
            for k in sorted(length)
            if length[k].get("peer_ms") and base[0].get("peer_ms")
        ]
        if peer:
            axes.plot(*zip(*peer), "s--", label="best peer")
        axes.set(
            xlabel="synthetic-cons (constraints 4 times as long each)", ylabel="core / core of uniform", ylim=(0, None)
        )
        axes.legend()
        save(figure, "-length")

    sizes = sorted((r["n"], t) for r, t in zip(rows, times) if r["workload"] == "uniform")
    if len(sizes) > 2:
        figure, axes = pyplot.subplots(figsize=(6, 4))
        axes.plot([n for n, _ in sizes], [1e6 * t / n for n, t in sizes], "o-")
        axes.set(xscale="log", xlabel="uniform vertices", ylabel="nanoseconds per vertex", ylim=(0, None))
        save(figure, "-growth")

    shapes = {}
    for r, t in zip(rows, times):
        shapes.setdefault(r["workload"], []).append((r["n"], t))
    shapes = {name: sorted(of) for name, of in shapes.items() if len(of) > 2}
    if len(shapes) > 2:
        figure, axes = pyplot.subplots(figsize=(9, 6))
        colours = pyplot.get_cmap("tab20").colors
        for i, (name, of) in enumerate(sorted(shapes.items(), key=lambda shape: -shape[1][-1][1])):
            look = {"color": "black", "linewidth": 3} if name == "uniform" else {"color": colours[i % len(colours)]}
            axes.plot([n for n, _ in of], [t for _, t in of], "o-", label=name.replace("_", " "), **look)
        axes.set(xscale="log", yscale="log", xlabel="vertices", ylabel="ms")
        axes.legend(fontsize="small", loc="upper left", bbox_to_anchor=(1.0, 1.0))
        axes.grid(True, which="major", alpha=0.3)
        save(figure, "-growth-of-shapes")
    return made


def draw_rounds(path):
    """Rounds of squares by the ratio of side and wanted size; returns the file's name."""
    with open(path) as file:
        rows = [json.loads(line) for line in file]
    rows = sorted((r["length_ratio"], r["rounds"]) for r in rows if "length_ratio" in r)
    if len(rows) < 3:
        print("plots: fewer than three squares: no plot of rounds", file=sys.stderr)
        return None
    try:
        import matplotlib
    except ImportError:
        print("plots: matplotlib is not there: no plots", file=sys.stderr)
        return None
    matplotlib.use("Agg")
    from matplotlib import pyplot

    ratios, rounds = zip(*rows)
    logs = [math.log2(ratio) for ratio in ratios]
    mean, middle = sum(logs) / len(logs), sum(rounds) / len(rounds)
    slope = sum((x - mean) * (y - middle) for x, y in zip(logs, rounds)) / sum((x - mean) ** 2 for x in logs)
    figure, axes = pyplot.subplots(figsize=(6, 4))
    axes.plot(ratios, rounds, "o-", label="a square by area")
    axes.plot(
        ratios,
        [middle + slope * (x - mean) for x in logs],
        "--",
        color="black",
        linewidth=0.8,
        label=f"{slope:.1f} rounds each time that L/h doubles",
    )
    axes.set(xscale="log", xlabel="L/h: side of the square / root of the largest area", ylabel="rounds", ylim=(0, None))
    axes.grid(alpha=0.3)
    axes.legend()
    name = os.path.splitext(path)[0] + "-rounds.png"
    figure.tight_layout()
    figure.savefig(name, dpi=110)
    pyplot.close(figure)
    return name


if __name__ == "__main__":
    print("written:", draw_rounds(sys.argv[1]), file=sys.stderr)
