#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints the rows of gcdt_bench_refine as a table beside its peers: python3 bench/refine_table.py FILE.jsonl"""

import json
import sys

PEERS = {"gcdt": "", "Triangle": "peer", "CGAL Mesh_2": "cgal"}


def cell(row, peer, before):
    """Added vertices, the least angle, the whole call in ms."""
    if not peer:
        return f"{row['added']} / {row['least_angle']:.2f} / {row['call_ms']:.0f}"
    if f"{peer}_error" in row:
        return row[f"{peer}_error"]
    if f"{peer}_vertices" not in row:
        return "-"
    return f"{row[peer + '_vertices'] - before} / {row[peer + '_least_angle']:.2f} / {row[peer + '_ms']:.0f}"


def main():
    with open(sys.argv[1]) as file:
        rows = [row for row in map(json.loads, file) if "workload" in row]
    print("added vertices / least angle / whole call in ms\n")
    print(f"| input | degrees | {' | '.join(PEERS)} |\n|---|---|{'---|' * len(PEERS)}")
    for row in rows:
        name = row["workload"] + (f" {row['size']}" if row["size"] else "")
        cells = (cell(row, peer, row["n"]) for peer in PEERS.values())
        print(f"| {name} | {row['angle']:g} | {' | '.join(cells)} |")


main()
