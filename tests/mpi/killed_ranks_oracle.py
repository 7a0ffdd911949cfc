# SPDX-License-Identifier: Apache-2.0
"""The first rank of gcdt_mpi is killed at a call that changes files (file_faults.c), between any two renames, too.
Where another rank is left, all files are as before or all are new. Where none is left, each file is one or the other, and
a .pvtu names whole pieces of one run. The next run gives what it should in any case.

Usage: killed_ranks_oracle.py MPIEXEC GCDT_MPI FILE_FAULTS [--all]
  --all   at each call; otherwise at each that renames
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile

MPIEXEC, GCDT_MPI, FILE_FAULTS = (os.path.abspath(argument) for argument in sys.argv[1:4])
RENAMES = {} if "--all" in sys.argv[4:] else {"GCDT_FILE_RENAMES": "1"}
ENVIRONMENT = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
FIRST_IS_FAULTY = """\
if [ "$OMPI_COMM_WORLD_RANK" != 0 ]; then exec "$@"; fi
export GCDT_FILES="$PWD/out" GCDT_FILE_CALL="$CALL" GCDT_FILE_FAULT=kill GCDT_FILE_MARK="$PWD/reached"
export LD_PRELOAD="$FILE_FAULTS" ASAN_OPTIONS=verify_asan_link_order=0
exec "$@"
"""


def run(ranks, arguments, call=None):
    """The status. With the number of a call it is the last one of the first rank."""
    program = [GCDT_MPI] if call is None else ["sh", "faulty.sh", GCDT_MPI]
    command = [MPIEXEC, "--oversubscribe", "--bind-to", "none", "-n", str(ranks), *program, *arguments, "--quiet"]
    environment = {**ENVIRONMENT, "CALL": str(call), "FILE_FAULTS": FILE_FAULTS, **RENAMES}
    return subprocess.run(command, env=environment, capture_output=True, timeout=120).returncode


def files():
    found = {}
    for folder, _, names in os.walk("out"):
        for name in names:
            with open(os.path.join(folder, name), "rb") as file:
                found[os.path.relpath(os.path.join(folder, name), "out")] = file.read()
    return found


def restore(contents):
    shutil.rmtree("out", ignore_errors=True)
    os.mkdir("out")
    for name, content in contents.items():
        with open(os.path.join("out", name), "wb") as file:
            file.write(content)


def is_hidden(name):
    return name.startswith(".gcdt-mpi-")


def pieces_of(contents):
    """The files that an index names, and itself."""
    index = contents.get("m.pvtu")
    names = re.findall(rb'<Piece Source="([^"]*)"', index) if index else []
    return {name: contents[name] for name in ["m.pvtu", *(name.decode() for name in names)] if index}


def judge(now, before, after, ranks_left):
    visible = {name: content for name, content in now.items() if not is_hidden(name)}
    for name, content in visible.items():
        assert content in (before.get(name), after.get(name)), name
    if "m.pvtu" in {**before, **after}:
        assert pieces_of(visible) in (pieces_of(before), pieces_of(after)), sorted(visible)
    else:
        assert set(before) <= set(visible), sorted(visible)
    if ranks_left:
        # Of the index's old pieces some may be left where it is new.
        extra = {} if visible.get("m.pvtu") == before.get("m.pvtu") else before
        assert visible == before or {**extra, **visible} == {**extra, **after}, (sorted(visible), sorted(after))
        assert visible == now, sorted(now)


def kill_at_each_call(ranks, arguments, before):
    """Returns how many there are, and how often all files were new."""
    restore(before)
    assert run(ranks, arguments) == 0
    after = files()
    assert not any(map(is_hidden, after)), sorted(after)
    tried = became_new = 0
    for call in range(1, 1000):
        restore(before)
        if os.path.exists("reached"):
            os.remove("reached")
        status = run(ranks, arguments, call)
        if not os.path.exists("reached"):
            assert status == 0 and files() == after, (call, status)
            return tried, became_new
        assert status != 0, call
        now = files()
        try:
            judge(now, before, after, ranks > 1)
        except AssertionError:
            print(f"{ranks} ranks, {arguments}, killed at call {call}")
            raise
        tried += 1
        became_new += all(now.get(name) == content for name, content in after.items())
        if call % 5 == 0:
            assert run(ranks, arguments) == 0
            again = {name: content for name, content in files().items() if not is_hidden(name)}
            if "m.pvtu" in after:
                names = [name for name in pieces_of(again) if name != "m.pvtu"]
                assert [again[name] for name in names] == [after[name] for name in pieces_of(after) if name != "m.pvtu"]
            else:
                assert again == after, sorted(again)
    raise AssertionError("a run of more than a thousand calls")


def write_grid(name, side):
    with open(name, "w") as out:
        out.write(f"{side * side} 2 0 0\n")
        out.writelines(f"{i} {i % side} {i // side}\n" for i in range(side * side))
        out.write("0 0\n0\n")


with tempfile.TemporaryDirectory() as scratch:
    os.chdir(os.path.realpath(scratch))
    write_grid("small.poly", 10)
    write_grid("large.poly", 20)
    with open("faulty.sh", "w") as script:
        script.write(FIRST_IS_FAULTY)
    tried = became_new = 0
    for ranks in (2, 1):
        for targets in (["out/m.pvtu"], ["out/a.ele", "out/b.vtu", "out/c.npz"]):
            outputs = [word for target in targets for word in ("-o", target)]
            restore({})
            assert run(ranks, ["small.poly", *outputs]) == 0
            before = files()
            if len(targets) > 1:
                del before["b.vtu"]  # one of them is not there before
            done = kill_at_each_call(ranks, ["large.poly", *outputs], before)
            tried, became_new = tried + done[0], became_new + done[1]
    assert 0 < became_new < tried
    os.chdir("/")
print(f"killed_ranks: killed {tried} times, {became_new} times with the new files there")
