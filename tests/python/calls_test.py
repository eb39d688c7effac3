"""Calls leave nothing behind, end when asked to, and may be made by several at once."""

import multiprocessing
import pickle
import resource
import signal
import threading
import time

import numpy as np
import pandas as pd
import pytest
from conftest import designs

import posewise as pw


def large():
    return np.random.default_rng(3).normal(size=(3000, 3, 40))


def test_results_can_be_pickled(fanuc, measurements, blocks):
    for result in (pw.select(blocks, 5), pw.select(fanuc, 14, measurements=measurements)):
        copy = pickle.loads(pickle.dumps(result))
        assert copy == result and copy.verify()["is_right"].all()
    estimate = pickle.loads(pickle.dumps(pw.calibrate(fanuc, measurements)))
    assert len(estimate.predict(measurements.iloc[:2])) == 2
    plan = pickle.loads(pickle.dumps(pw.plan(fanuc, 14, pool=100, workspace_poses=30)))
    assert plan.verify()["is_right"].all()
    study = pickle.loads(pickle.dumps(pw.study(fanuc, poses=12, trials=2, pool=60)))
    assert len(study) == 1


def test_time_ends_a_search_with_the_best_so_far():
    began = time.monotonic()
    with pytest.warns(pw.Doubt, match="stopped early"):
        choice = pw.select(large(), 60, criterion="v", time=1)
    assert time.monotonic() - began < 10
    assert len(choice) == 60


def test_what_another_handler_raises_is_raised():
    def handler(number, frame):
        raise TimeoutError("enough")

    before = signal.signal(signal.SIGALRM, handler)
    signal.alarm(1)
    try:
        with pytest.raises(TimeoutError, match="enough"):
            pw.select(large(), 60, criterion="v")
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def test_progress_is_told_and_what_it_raises_ends_the_call(blocks):
    told = []
    pw.select(large()[:400], 60, criterion="v", progress=lambda done, total: told.append((done, total)))
    assert told and all(0 <= done <= total for done, total in told)

    def refuse(done, total):
        raise KeyError("no more")

    with pytest.raises(KeyError, match="no more"):
        pw.select(large()[:400], 60, criterion="v", progress=refuse)
    assert len(pw.select(blocks, 5)) == 5


def test_threads_do_not_matter(blocks):
    expected = pw.select(blocks, 5, criterion="v", threads=1)
    found = [None, None]

    def choose(i):
        found[i] = pw.select(blocks, 5, criterion="v", threads=2)

    threads = [threading.Thread(target=choose, args=(i,)) for i in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == [expected, expected]


def choose_in_child(seed):
    J = np.random.default_rng(seed).normal(size=(40, 3, 8))
    campaign = pw.Campaign.from_yaml(designs / "abb_irb120" / "campaign.yaml")
    assert len(campaign.joints) == 6
    return pw.select(J, 5, threads=2).value


def test_processes_may_be_forked_after_calls(blocks, fanuc, measurements):
    pw.select(blocks, 5, threads=2)
    fanuc.jacobian(measurements, threads=2)
    with multiprocessing.get_context("fork").Pool(2) as pool:
        values = pool.map_async(choose_in_child, [1, 2, 1]).get(timeout=120)
    assert values[0] == values[2] and values[0] == choose_in_child(1)


def test_memory_does_not_grow(blocks, fanuc, measurements):
    q = fanuc.configurations(measurements)

    def work(count):
        for _ in range(count):
            fanuc.jacobian(q)
            pw.indices(blocks, [1, 2, 3])
            with pytest.raises(pw.InputError):
                pw.select(blocks, 0)

    work(300)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    work(3000)
    grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
    assert grown < 4096, f"{grown} kB more"


def test_a_jacobian_outlives_what_it_came_from(measurements):
    campaign = pw.Campaign.from_yaml(designs / "fanuc_r2000ic_165f" / "campaign.yaml")
    J = campaign.jacobian(measurements)
    expected = J.copy()
    del campaign
    np.testing.assert_array_equal(J, expected)
    J[0, 0, 0] = 7  # ours


def test_results_draw_and_show_themselves(fanuc, measurements):
    pytest.importorskip("matplotlib")
    estimate = pw.calibrate(fanuc, measurements)
    study = pw.study(fanuc, poses=[12, 16], trials=3, pool=60)
    plan = pw.plan(fanuc, 14, pool=100, workspace_poses=30)
    for result in (estimate, study, plan):
        assert result.plot() is not None
        assert "<table>" in result._repr_html_()
        assert str(result)
    assert isinstance(plan["q1_deg"], pd.Series)
