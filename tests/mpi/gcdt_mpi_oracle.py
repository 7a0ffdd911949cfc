# SPDX-License-Identifier: Apache-2.0
"""gcdt_mpi as its user sees it: the files of gcdt triangulate, pieces that are the same mesh, and an end of all ranks,
without output, when one is lost.

Usage: gcdt_mpi_oracle.py MPIEXEC GCDT GCDT_MPI FAULT_LAYER
"""
import concurrent.futures
import json
import os
import signal
import struct
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree as xml

import meshio
import numpy

MPIEXEC, GCDT, GCDT_MPI, FAULT_LAYER = (os.path.abspath(argument) for argument in sys.argv[1:5])
SECONDS = 30  # in which all ranks have to end
ENVIRONMENT = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}


def start(ranks, *arguments, program=(GCDT_MPI,), environment=None):
    command = [MPIEXEC, "--oversubscribe", "--bind-to", "none", "-n", str(ranks), *program, *arguments]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    return subprocess.Popen(command, env={**ENVIRONMENT, **(environment or {})}, **pipes)


def ranks(count, *arguments, status=0, **how):
    """What is written to standard error, without what mpiexec adds."""
    job = start(count, *arguments, **how)
    out, err = job.communicate(timeout=120)
    assert job.returncode == status, (arguments, job.returncode, out, err)
    return "".join(line + "\n" for line in err.splitlines() if line.startswith(("gcdt_mpi", "  segment", "  and")))


def gcdt(*arguments, status=0):
    done = subprocess.run([GCDT, "triangulate", *arguments], capture_output=True, text=True, timeout=120)
    assert done.returncode == status, (arguments, done.stderr)
    return done.stderr


def same(a, b):
    with open(a, "rb") as one, open(b, "rb") as other:
        assert one.read() == other.read(), (a, b)


def write_pslg(name, points, segments):
    with open(name, "wb") as out:
        out.write(b"PSLGBIN1" + struct.pack("<qq", len(points), len(segments)))
        out.write(numpy.asarray(points, "<f8").tobytes() + numpy.asarray(segments, "<i4").tobytes())


def write_grid(name):
    """900 vertices of a square grid, and a zigzag of constraints through it that meets many of them."""
    with open(name, "w") as out:
        out.write("900 2 0 0\n")
        out.writelines(f"{i} {i % 30} {i // 30}\n" for i in range(900))
        out.write("20 0\n")
        out.writelines(f"{i} {30 * i + i % 2 * 29} {30 * (i + 5) + (1 - i % 2) * 29}\n" for i in range(20))
        out.write("0\n")


def write_squares(name):
    """Squares in squares, turned a little, with scattered points."""
    random = numpy.random.default_rng(3)
    points, segments = list(random.uniform(-1, 1, (3000, 2))), []
    for i in range(1, 30):
        corners = [numpy.pi / 2 * k + i * 0.01 for k in range(4)]
        segments += [(len(points) + k, len(points) + (k + 1) % 4) for k in range(4)]
        points += [(i / 20 * numpy.cos(a), i / 20 * numpy.sin(a)) for a in corners]
    write_pslg(name, points, segments)


def write_walls(name):
    """400 vertices of a square grid, two walls that make four rooms, two holes and two attributes."""
    with open(name, "w") as out:
        out.write("400 2 0 0\n")
        out.writelines(f"{i} {i % 20} {i // 20}\n" for i in range(400))
        out.write("2 0\n0 7 387\n1 180 199\n2\n0 2 2\n1 7 9\n2\n0 2 15 5 0\n1 15 2 6 0\n")


def gathered_files_are_those_of_gcdt():
    for name in ("one", "all"):
        os.mkdir(name)
    gcdt("grid.poly", "--crossing", "split", "--quiet", "-o", "one/g.vtu", "-o", "one/g.ele")
    ranks(2, "grid.poly", "--crossing", "split", "--quiet", "-o", "all/g.vtu", "-o", "all/g.ele")
    options = ("squares.pslg", "--crossing", "drop", "--domain", "even-odd", "--quiet")
    gcdt(*options, "-o", "one/s.npz", "-o", "one/s.vtu")
    ranks(4, *options, "-o", "all/s.npz", "-o", "all/s.vtu", "--tiles", "8")
    for domain in ("holes", "outer-holes", "hull"):
        options = ("walls.poly", "--domain", domain, "--regions", "--quiet")
        gcdt(*options, "-o", f"one/w-{domain}.vtu", "-o", f"one/w-{domain}.ele")
        ranks(3, *options, "-o", f"all/w-{domain}.vtu", "-o", f"all/w-{domain}.ele")
    assert os.path.getsize("one/w-holes.ele") < os.path.getsize("one/w-hull.ele")
    assert sorted(os.listdir("one")) == sorted(os.listdir("all")), os.listdir("all")
    for name in os.listdir("one"):
        same(f"one/{name}", f"all/{name}")


def pieces_are_the_mesh_of_gcdt():
    ranks(4, "grid.poly", "--crossing", "split", "-o", "pieces.pvtu", "--quiet")
    whole = meshio.read("one/g.vtu")
    names = [piece.get("Source") for piece in xml.parse("pieces.pvtu").iter("Piece")]
    assert names == [f"pieces_{rank}.vtu" for rank in range(4)], names
    triangles, seen = [], {}
    for name in names:
        piece = meshio.read(name)
        vertex = piece.point_data["vertex"].ravel()
        assert len(set(vertex)) == len(vertex), name
        assert (piece.points == whole.points[vertex]).all(), name
        numbers = piece.cell_data["triangle"][0].ravel()
        assert (numbers == len(triangles) + numpy.arange(len(numbers))).all(), name
        triangles += vertex[piece.cells_dict["triangle"]].tolist()
        for array in ("constrained", "neighbours"):
            seen.setdefault(array, []).extend(piece.cell_data[array][0].tolist())
    assert triangles == whole.cells_dict["triangle"].tolist()
    for array, values in seen.items():
        assert values == whole.cell_data[array][0].tolist(), array


def pieces_of_an_earlier_run_go_when_the_new_ones_are_there():
    with open("again_5.vtu", "w") as other:
        other.write("no piece of it")
    for count, end in ((3, ""), (2, ".1"), (2, ""), (1, ".1")):
        ranks(count, "grid.poly", "--crossing", "split", "-o", "again.pvtu", "--quiet")
        pieces = [f"again_{rank}{end}.vtu" for rank in range(count)]
        assert [piece.get("Source") for piece in xml.parse("again.pvtu").iter("Piece")] == pieces, pieces
        found = sorted(name for name in os.listdir() if name.startswith("again"))
        assert found == sorted(["again.pvtu", "again_5.vtu", *pieces]), found


def a_result_is_proved_and_a_trace_has_all_ranks():
    ranks(2, "walls.poly", "--domain", "holes", "--verify", "--trace", "trace.json", "--quiet", "-o", "proved.ele")
    same("one/w-holes.ele", "proved.ele")
    ranks(2, "grid.poly", "--crossing", "split", "--verify", "--quiet")
    with open("trace.json") as file:
        events = json.load(file)["traceEvents"]
    names = {event["pid"]: event["args"]["name"] for event in events if event["name"] == "process_name"}
    assert sorted(name[:8] for name in names.values()) == ["rank 0: ", "rank 1: "], names
    rows = {(event["pid"], event["tid"]): event["args"]["name"] for event in events if event["name"] == "thread_name"}
    spans = [event for event in events if event["ph"] == "X"]
    for rank in names:
        own = [(rows[rank, span["tid"]], span["name"]) for span in spans if span["pid"] == rank]
        for step in ("read", "solve", "write"):
            assert ("rank", step) in own, (step, own)
        for phase in ("survey", "take", "final", "write"):
            assert any(row == phase for row, _ in own), (phase, sorted(set(own)))
        assert all(span["ts"] >= 0 and span["dur"] >= 0 for span in spans)


def errors_have_the_status_of_gcdt():
    said, of_gcdt = ranks(2, "grid.poly", "-o", "none.vtu", status=3), gcdt("grid.poly", "-o", "none.vtu", status=3)
    assert said.splitlines()[1:] == [line for line in of_gcdt.splitlines()[1:] if line.startswith("  ")], said
    assert said.startswith("gcdt_mpi: grid.poly: "), said
    wrong = [
        (2, "grid.poly", "--domain", "even-odd", "-o", "none.pvtu"),
        (2, "grid.poly", "--verify", "-o", "none.pvtu"),
        (2, "grid.poly", "--tiles", "3"),
        (2, "grid.poly", "-o", "none.foo"),
        (3, "missing.pslg"),
        (6, "squares.pslg", "--crossing", "drop", "-o", "missing/none.vtu"),
    ]
    with concurrent.futures.ThreadPoolExecutor() as at_once:  # they mostly wait
        for said in at_once.map(lambda row: ranks(2, *row[1:], status=row[0]), wrong):
            assert said.count("gcdt_mpi: ") == 1, said
    nothing_is_left("none")


def nothing_is_left(name):
    left = [entry for entry in os.listdir() if entry.startswith((name, ".gcdt"))]
    assert left == [], left


def processes_of(job):
    listed = subprocess.run(["pgrep", "-P", str(job.pid)], capture_output=True, text=True)
    return [int(line) for line in listed.stdout.split()]


def is_there(process):
    try:
        with open(f"/proc/{process}/stat") as stat:
            return stat.read().rsplit(")", 1)[1].split()[0] != "Z"
    except FileNotFoundError:
        return False


def kill_one(job, number, count):
    """Kills a rank; all must end in time, and with an error."""
    processes = processes_of(job)
    assert len(processes) == count, processes
    os.kill(processes[number], signal.SIGKILL)
    begin = time.monotonic()
    job.communicate(timeout=SECONDS)
    while any(is_there(process) for process in processes):
        assert time.monotonic() - begin < SECONDS
        time.sleep(0.01)
    assert job.returncode != 0


def a_killed_rank_ends_all():
    job = start(4, "many.pslg", "-o", "killed.vtu", "--repeat", "100000")
    time.sleep(2.5)
    kill_one(job, 1, 4)
    nothing_is_left("killed")
    # While output is written: rank 0 writes all, then each its piece over an earlier one.
    for name, number in (("killed.vtu", 0), ("kept.pvtu", 1)):
        with open("kept.pvtu", "w") as kept:
            kept.write("as before")
        job = start(2, "many.pslg", "-o", name)
        while not any(entry.startswith(".gcdt-mpi") for entry in os.listdir()):
            assert job.poll() is None
            time.sleep(0.001)
        kill_one(job, number, 2)
        nothing_is_left("killed")
        assert [entry for entry in os.listdir() if entry.startswith("kept")] == ["kept.pvtu"]
        assert open("kept.pvtu").read() == "as before"


def a_failing_device_ends_all():
    with open("second_fails.sh", "w") as script:
        script.write('[ "$OMPI_COMM_WORLD_RANK" = 0 ] && unset GCDT_FAULT_BUFFERS\nexec "$@"\n')
    environment = {"OPENCL_LAYERS": FAULT_LAYER, "GCDT_FAULT_BUFFERS": "20000"}
    begin = time.monotonic()
    said = ranks(2, "many.pslg", "-o", "failed.vtu", program=("sh", "second_fails.sh", GCDT_MPI), status=4,
                 environment=environment)
    assert time.monotonic() - begin < SECONDS
    assert said.startswith("gcdt_mpi: rank 1: "), said
    nothing_is_left("failed")


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    write_grid("grid.poly")
    write_walls("walls.poly")
    write_squares("squares.pslg")
    write_pslg("many.pslg", numpy.random.default_rng(1).uniform(0, 1, (200000, 2)), [])
    gathered_files_are_those_of_gcdt()
    pieces_are_the_mesh_of_gcdt()
    pieces_of_an_earlier_run_go_when_the_new_ones_are_there()
    a_result_is_proved_and_a_trace_has_all_ranks()
    errors_have_the_status_of_gcdt()
    a_killed_rank_ends_all()
    a_failing_device_ends_all()
    os.chdir("/")
print("gcdt_mpi: files, pieces, errors and lost ranks are as they should be")
