"""The interpreter ends, forks or is a second one while the core computes: real processes, which must end well."""

from __future__ import annotations

import subprocess
import sys

import pytest
from patience import PATIENCE

HOLE = """
import os, sys, threading, time
import numpy as np
import helibore as hb
n = 100_000
depth, toolface, radius = np.linspace(100, 150, n), np.arange(n) * 37.0 % 360, np.full(n, 0.11)
begun = threading.Event()
def rebuild(): hb.reconstruct(hb.Caliper(depth, toolface, radius), bit_diameter=0.216, threads=2)
def busy():
    while True:
        begun.set()
        rebuild()
"""
ENDS = """
threading.Thread(target=busy, daemon=True).start()
begun.wait()
time.sleep(0.2)
"""
FORKS = """
rebuild()  # imports what it needs: a fork during an import leaves its lock held in the child, whatever the package
threading.Thread(target=busy, daemon=True).start()
begun.wait()
for _ in range(3):
    child = os.fork()
    if child == 0:
        import signal
        signal.alarm(PATIENCE)
        rebuild()
        os._exit(0)
    assert os.waitpid(child, 0)[1] == 0
os._exit(0)
"""
REFUSED = """
sys.setswitchinterval(1e-6)
wall = hb.Wall(bit_diameter=0.216)
def refused():
    while True:
        begun.set()
        try:
            wall.vertices(0, 1)
        except hb.InputError:
            pass
for _ in range(4): threading.Thread(target=refused, daemon=True).start()
begun.wait()
time.sleep(0.05)
"""
FEEDS = """
wall = hb.Wall(bit_diameter=0.216, start_depth=100.0)
def feed():
    k = 0
    while True:
        begun.set()
        wall.append(100 + (k + np.arange(1000)) * 1e-4, toolface[:1000], radius[:1000])
        k += 1000
threading.Thread(target=feed, daemon=True).start()
begun.wait()
time.sleep(0.2)
"""
GROWS = """
import signal
wall = hb.Wall(bit_diameter=0.216, start_depth=100.0)
def append(rows): wall.append(depth[:rows], toolface[:rows], radius[:rows])
append(10)
def feed():
    while True:
        begun.set()
        append(n)
"""
SIGNALS = """
import numpy.ma  # where NumPy imports it, a signal would import it again
inside, answers = False, {"appended": 0, "refused": 0}
def handler(*_):
    global inside
    if inside: return
    inside = True
    try:
        append(1)
        answers["appended"] += 1
    except hb.InputError as error:
        assert "in this thread" in str(error)
        answers["refused"] += 1
    inside = False
signal.signal(signal.SIGALRM, handler)
signal.setitimer(signal.ITIMER_REAL, 0.001, 0.001)
end = time.monotonic() + PATIENCE
while not all(answers.values()) and time.monotonic() < end: append(1)
signal.setitimer(signal.ITIMER_REAL, 0)
assert all(answers.values()), answers
"""
FORKS_A_WALL = """
threading.Thread(target=feed, daemon=True).start()
begun.wait()
for _ in range(3):
    child = os.fork()
    if child == 0:
        signal.alarm(PATIENCE)
        try:
            append(10)
        except hb.InputError as error:
            assert "when this process was forked" in str(error)
        os._exit(0)
    assert os.waitpid(child, 0)[1] == 0
os._exit(0)
"""
FINALIZES = """
class Last:
    def __init__(self): self.circle = self
    def __del__(self):
        try:
            append(10)
        except error as found:
            assert "ended with the program" in str(found)
error, last = hb.InputError, Last()
threading.Thread(target=feed, daemon=True).start()
begun.wait()
time.sleep(0.1)
"""
WRITES = """
def scribble():
    while True:
        depth[:] = np.roll(depth, 50_000)
threading.Thread(target=scribble, daemon=True).start()
for _ in range(15): hb.Wall(bit_diameter=0.216, start_depth=100.0, stop_depth=101.0).append(depth, toolface, radius)
os._exit(0)
"""


def run(script: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-W", "ignore", "-c", script.replace("PATIENCE", str(int(PATIENCE)))]
    return subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE)


@pytest.mark.parametrize("script", [ENDS, REFUSED, FEEDS, WRITES], ids=["rebuilds", "refused", "feeds", "writes"])
def test_a_program_ends_while_a_thread_is_in_a_call(script: str) -> None:
    done = run(HOLE + script)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.skipif(sys.platform != "linux", reason="needs fork")
@pytest.mark.parametrize("script", [SIGNALS, FORKS_A_WALL, FINALIZES], ids=["signals", "forks", "finalizes"])
def test_a_call_within_a_call_is_refused_where_it_would_wait_for_ever(script: str) -> None:
    done = run(HOLE + GROWS + script)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.skipif(sys.platform != "linux", reason="needs fork")
def test_a_child_that_is_forked_during_a_call_rebuilds_a_wall() -> None:
    done = run(HOLE + FORKS)
    assert (done.returncode, done.stderr) == (0, "")


def test_a_subinterpreter_refuses_the_package_in_one_sentence() -> None:
    script = """
try:
    import _xxsubinterpreters as interpreters
except ImportError:
    import _interpreters as interpreters
other = interpreters.create()
try:
    raised = interpreters.run_string(other, "import helibore; helibore.Wall")
except Exception as error:
    raised = error
print(raised)
"""
    done = run(script)
    assert "ImportError" in done.stdout, done.stderr
    assert "subinterpreter" in done.stdout  # the text is that of Python, where it knows that a module refuses
