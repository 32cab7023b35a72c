"""Ctrl-C, progress and other threads. Scripts run in processes of their own."""

import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import carnot

SANITIZED = "CARNOT_SANITIZED" in os.environ
# Seconds for what ends within a few. Sanitizers make a search twenty times as long.
PATIENCE = 1200 if SANITIZED else 60
# Searches for minutes, if it is let.
LONG = "carnot.scene('trailer3').geodesics([0]*6, [5, 9, 1, 1, 1, 1], all=True, starts=100000)"
ENDLESS = """
import sys, time, carnot
print("begun", flush=True)
began = time.monotonic()
try:
    LONG
except KeyboardInterrupt:
    print("interrupted", flush=True)
report = carnot.scene("unicycle").geodesics([0, 0, 0], [0, 1, 0])
print(report.best().label, flush=True)
""".replace("LONG", LONG)


def begun(script):
    process = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "begun\n"
    time.sleep(0.5)
    return process


def test_ctrl_c_is_heard_at_once_and_breaks_nothing():
    process = begun(ENDLESS)
    process.send_signal(signal.SIGINT)
    out, _ = process.communicate(timeout=PATIENCE)
    assert out.split() == ["interrupted", "locally-minimal"]
    assert process.returncode == 0


def test_ctrl_c_ends_a_script_as_python_does():
    script = f"import carnot\nprint('begun', flush=True)\n{LONG}"
    process = begun(script)
    process.send_signal(signal.SIGINT)
    assert process.wait(timeout=PATIENCE) == -signal.SIGINT


def test_ctrl_c_stops_steering_and_keeps_nothing_of_it():
    script = """
import carnot, numpy
steer = carnot.scene("trailer3").steering()
near, far = [0.5, 0, 0, 0, 0, 0], numpy.random.default_rng(0).uniform(-20, 20, (1000, 6))
print("begun", flush=True)
try:
    steer.distances([0] * 6, far)
except KeyboardInterrupt:
    print("interrupted", flush=True)
print(steer.distance([0] * 6, near), flush=True)
"""
    process = begun(script)
    process.send_signal(signal.SIGINT)
    out, _ = process.communicate(timeout=PATIENCE)
    assert out.split() == ["interrupted", "0.5"]


# What is thrown away with the scene that it was asked of.
DROPPED = """
import gc, os, signal, threading, carnot
TEXT = "coordinates x, y, theta [angle]\\nparameters turning = 1 > 0\\n"
TEXT += "kinetic = (x'^2 + y'^2 + turning theta'^2) / 2\\n0 = x' sin(theta) - y' cos(theta)\\n"
def follow():
    scene = carnot.Scene(TEXT)
    best = scene.geodesics([0, 0, 0], [0, 1, 0]).best()
    def stop(fraction):
        raise KeyError
    scene.follow(best, turning=1e-4, max_points=100000, tolerance=1e-13, progress=stop)
print("begun", flush=True)
for i in range(10):
    try:
        follow()
    except KeyError:
        pass
    gc.collect()
"""

DAEMONS = """
import threading, time, carnot, numpy
scene = carnot.scene("unicycle")
goals = numpy.random.default_rng(0).uniform(-3, 3, (50, 3))
def work():
    while True:
        scene.solve_many([0, 0, 0], goals, threads=1)
for i in range(4):
    threading.Thread(target=work, daemon=True).start()
print("begun", flush=True)
time.sleep(0.3)
"""

FORKED = """
import os, sys, threading, time, carnot
print("begun", flush=True)
def work():
    LONG
threading.Thread(target=work, daemon=True).start()
time.sleep(0.3)
child = os.fork()
if child == 0:
    best = carnot.scene("unicycle").geodesics([0, 0, 0], [0, 1, 0]).best()
    sys.exit(0 if best.label == "locally-minimal" else 1)
sys.exit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
""".replace("LONG", LONG)

LATE = """
import atexit
def late():
    try:
        scene.geodesics([0, 0, 0], [0, 1, 0])
    except RuntimeError as error:
        print(error, flush=True)
atexit.register(late)
import carnot
scene = carnot.scene("unicycle")
print("begun", flush=True)
"""


# The allocator of GCC 12's address sanitizer does not let go of its locks at a fork: where another
# thread allocates at that moment, the child waits for ever.
forked = pytest.param(
    FORKED,
    id="forked",
    marks=pytest.mark.skipif(SANITIZED, reason="a fork may leave the sanitizer's allocator locked"),
)


@pytest.mark.parametrize(
    "script", [pytest.param(DROPPED, id="dropped"), pytest.param(DAEMONS, id="daemons"), forked]
)
def test_ends_well(script):
    for _ in range(3):
        assert begun(script).wait(timeout=PATIENCE) == 0


def test_nothing_is_begun_when_the_interpreter_ends():
    process = begun(LATE)
    # Not communicate(), which would miss what has come with the first line.
    assert "ending" in process.stdout.read()
    assert process.wait(timeout=PATIENCE) == 0


def test_exit_while_a_thread_searches():
    script = f"import carnot, threading\ndef work():\n    {LONG}\n"
    script += "threading.Thread(target=work, daemon=True).start()\nprint('begun', flush=True)\n"
    process = begun(script + "import time; time.sleep(0.3)")
    assert process.wait(timeout=PATIENCE) == 0


@pytest.mark.parametrize("call", ["geodesics", "many", "field"])
def test_callback_stops_the_work(call, unicycle):
    told = []

    def stop(fraction):
        told.append(fraction)
        return False

    goals = np.random.default_rng(0).uniform(-9, 9, (5000, 3))
    grid = np.linspace(-2, 2, 101)
    if call == "geodesics":
        trailers = carnot.scene("trailer3")
        report = trailers.geodesics([0] * 6, [5, 9, 1, 1, 1, 1], starts=100000, progress=stop)
        assert report.status == "interrupted"
    elif call == "many":
        answers = unicycle.solve_many(np.zeros(3), goals, progress=stop)
        assert not answers["solved"].all()
        assert set(answers["reason"]) <= {"none", "interrupted"}
    else:
        field = unicycle.distance_field({"x": grid, "y": grid, "theta": grid}, progress=stop)
        assert not field.finished
    assert told
    assert all(0 <= fraction <= 1 for fraction in told)


def test_what_a_callback_raises_is_raised(unicycle):
    def fail(fraction):
        raise RuntimeError("mine")

    goals = np.random.default_rng(0).uniform(-9, 9, (5000, 3))
    with pytest.raises(RuntimeError, match="mine"):
        unicycle.solve_many(np.zeros(3), goals, progress=fail)


def test_progress_grows(unicycle):
    told = []
    goals = np.random.default_rng(0).uniform(-1, 1, (300, 3))
    unicycle.solve_many(np.zeros(3), goals, progress=told.append)
    assert told == sorted(told)
    assert unicycle.solve_many(np.zeros(3), goals[:2], progress=True)["solved"].all()


def test_other_threads_run_meanwhile(unicycle):
    counted = 0
    done = threading.Event()

    def count():
        nonlocal counted
        while not done.is_set():
            counted += 1
            time.sleep(0.001)

    other = threading.Thread(target=count)
    other.start()
    goals = np.random.default_rng(0).uniform(-3, 3, (100, 3))
    unicycle.solve_many(np.zeros(3), goals, threads=1)
    done.set()
    other.join()
    assert counted > 10


def test_searches_in_two_threads_at_once(unicycle):
    goals = np.random.default_rng(0).uniform(-1, 1, (6, 3))
    alone = [unicycle.geodesics([0, 0, 0], goal).best().action for goal in goals]
    found = {}

    def search(i):
        found[i] = unicycle.geodesics([0, 0, 0], goals[i], threads=1).best().action

    threads = [threading.Thread(target=search, args=(i,)) for i in range(len(goals))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [found[i] for i in range(len(goals))] == alone


@pytest.mark.skipif(not hasattr(os, "fork"), reason="only where processes fork")
def test_forked_processes_search(unicycle):
    import multiprocessing

    unicycle.geodesics([0, 0, 0], [0, 1, 0])
    with multiprocessing.get_context("fork").Pool(2) as pool:
        actions = pool.map(_action, [(unicycle, [0, 1, 0]), (unicycle, [1, 1, 0])])
    assert actions == [_action((unicycle, goal)) for goal in ([0, 1, 0], [1, 1, 0])]


def _action(question):
    scene, goal = question
    return scene.geodesics([0, 0, 0], goal).best().action
