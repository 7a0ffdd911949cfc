#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Times the first triangulation of 1000 points in a process of its own: with all caches empty (gcdt's, PoCL's,
NVIDIA's), with only gcdt's cache warm, with all warm; that of 98,000 vertices of letters with constraints, all caches
empty; and a program that only creates a context and a queue.
Usage: start.py GCDT_BENCH DEVICE RESULTS.json   writes RESULTS-start.json"""

import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

COLD_RUNS, WARM_RUNS = 3, 7


def main():
    bench, device, results = sys.argv[1:]
    folder = tempfile.mkdtemp(prefix="gcdt-start-")
    ours, others = os.path.join(folder, "ours"), os.path.join(folder, "others")
    environment = dict(
        os.environ, GCDT_CACHE_DIR=ours, POCL_CACHE_DIR=others, CUDA_CACHE_PATH=others, XDG_CACHE_HOME=others
    )

    def run(what):
        start = time.perf_counter()
        subprocess.run([bench, what, "--device", device], env=environment, check=True)
        return time.perf_counter() - start

    def empty(*caches):
        for cache in caches:
            shutil.rmtree(cache, ignore_errors=True)
            os.makedirs(cache)

    def median(runs, what, *emptied):
        times = []
        for _ in range(runs):
            empty(*emptied)
            times.append(run(what))
        return round(statistics.median(times), 4)

    try:
        seconds = {"all_caches_empty_s": median(COLD_RUNS, "--first-call", ours, others)}
        seconds["own_cache_warm_s"] = median(COLD_RUNS, "--first-call", others)
        seconds["constrained_all_caches_empty_s"] = median(COLD_RUNS, "--first-constrained", ours, others)
        run("--first-call")
        seconds["all_caches_warm_s"] = median(WARM_RUNS, "--first-call")
        seconds["context_only_s"] = median(WARM_RUNS, "--context-only")
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    with open(results[: -len(".json")] + "-start.json", "w") as file:
        json.dump(seconds, file, indent=1)
        file.write("\n")
    print("first call:", ", ".join(f"{key} {value}" for key, value in seconds.items()))


main()
