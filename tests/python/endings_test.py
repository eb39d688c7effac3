"""Calls end with the interpreter, in a forked process, and by Ctrl-C."""

import os
import pickle
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import posewise as pw

begin = """
import os, sys, threading, time
import numpy as np, posewise as pw
J = np.random.default_rng(3).normal(size=(3000, 3, 40))
"""


def run(script, seconds=60):
    return subprocess.run(
        [sys.executable, "-c", begin + script], capture_output=True, text=True, timeout=seconds
    )


@pytest.mark.parametrize("progress", ["None", "lambda done, total: told.append(done)"])
def test_the_interpreter_exits_while_a_thread_is_in_a_call(progress):
    done = run(f"""
told = []
def work():
    while True:
        pw.select(J, 60, criterion="v", progress={progress})
threading.Thread(target=work, daemon=True).start()
time.sleep(1.0)
print("end")
""")
    assert (done.returncode, done.stdout) == (0, "end\n"), done.stderr
    assert "terminate" not in done.stderr and "Fatal" not in done.stderr


def test_a_process_forked_in_a_callback_ends_there():
    done = run("""
children = []
def fork(done, total):
    if not children:
        children.append(os.fork())
choice = pw.select(J[:100], 20, criterion="v", progress=fork)
print(len(choice), os.waitstatus_to_exitcode(os.waitpid(children[0], 0)[1]))
""")
    assert (done.returncode, done.stdout) == (0, "20 1\n"), done.stderr
    assert done.stderr.startswith("posewise: a process that was forked within a call")


def test_a_process_forked_beside_a_call_may_exit():
    done = run("""
thread = threading.Thread(target=lambda: pw.select(J, 60, criterion="v", time=2))
thread.start()
time.sleep(0.5)
child = os.fork()
if child == 0:
    sys.exit(3)
print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
thread.join()
""")
    assert (done.returncode, done.stdout) == (0, "3\n"), done.stderr


def interrupt_after(seconds):
    timer = threading.Timer(seconds, lambda: os.kill(os.getpid(), signal.SIGINT))
    timer.start()
    return timer


def test_an_interrupt_ends_a_loop_over_calls_with_the_best_so_far():
    J = np.random.default_rng(3).normal(size=(3000, 3, 40))
    timer = interrupt_after(1.0)
    with pytest.raises(KeyboardInterrupt) as raised:
        for _ in range(100):
            pw.select(J, 60, criterion="v")
    timer.join()
    assert isinstance(raised.value, pw.Interrupted)
    assert len(raised.value.result) == 60
    assert any("stopped early" in one for one in raised.value.result.warnings)
    copy = pickle.loads(pickle.dumps(raised.value))
    assert copy.result == raised.value.result


def test_an_interrupted_plan_is_the_best_so_far(fanuc):
    timer = interrupt_after(1.5)
    with pytest.raises(pw.Interrupted) as raised:
        pw.plan(fanuc, 24, pool=20000, starts=1000)
    timer.join()
    assert len(raised.value.result) == 24 and "stopped early" in raised.value.result.warnings[-1]


def test_an_interrupted_jacobian_is_no_loop(fanuc):
    q = np.zeros((300000, 6))
    timer = interrupt_after(0.1)
    with pytest.raises(KeyboardInterrupt):
        for _ in range(100):
            fanuc.jacobian(q)
    timer.join()


def test_a_calibration_cut_by_time_says_so(fanuc, measurements):
    with pytest.warns(pw.Doubt, match="stopped early"):
        estimate = pw.calibrate(fanuc, measurements, time=0.02, force=True, folds=24)
    assert any("stopped early" in one for one in estimate.doubts)
    assert estimate.document["warnings"] == estimate.doubts


def test_a_study_that_stopped_early_says_so(fanuc, measurements):
    with pytest.warns(pw.Doubt, match="stopped early; the splits that are finished"):
        study = pw.study(fanuc, measurements, poses=[10, 14], random=50, splits=200, time=5)
    assert len(study) > 0
    with pytest.raises(pw.InputError, match="stopped before any split was finished"):
        pw.study(fanuc, measurements, poses=[14], random=5000, splits=2, time=0.01)


def test_a_study_of_blocks_that_stopped_early_says_so():
    J = np.random.default_rng(3).normal(size=(2000, 3, 20))
    with pytest.warns(pw.Doubt, match="stopped early; the pose counts that are finished"):
        study = pw.study(J, poses=range(10, 400), random=5, time=3)
    assert 0 < len(study) < 390
    with pytest.raises(pw.InputError, match="stopped before any"):
        pw.study(J, poses=[300], time=0.001)


def test_predictions_can_be_interrupted(fanuc, measurements):
    estimate = pw.calibrate(fanuc, measurements, folds=0)
    q = np.random.default_rng(1).uniform(-0.3, 0.3, (20000, 6))
    began = time.monotonic()
    timer = interrupt_after(1.0)
    with pytest.raises(KeyboardInterrupt):
        estimate.predict(q)
    timer.join()
    assert time.monotonic() - began < 8


def test_indices_of_large_blocks_can_be_interrupted():
    J = np.random.default_rng(1).normal(size=(60000, 3, 40))
    began = time.monotonic()
    timer = interrupt_after(0.7)
    with pytest.raises(KeyboardInterrupt):
        pw.indices(J)
    timer.join()
    assert time.monotonic() - began < 6
