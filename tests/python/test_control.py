"""Progress, cancelling, threads and memory."""

import os
import signal
import threading
import time

import pcmvs
import pytest


@pytest.fixture
def frame(scene, pictures):
    return pcmvs.Frame(scene.rig(), **pictures)


def test_progress_goes_through_all_stages_and_never_back(frame):
    calls, threads = [], set()

    def progress(stage, done):
        calls.append((stage, done))
        threads.add(threading.get_ident())

    frame.run(progress=progress)
    stages = list(dict.fromkeys(stage for stage, _ in calls))
    assert stages == list(pcmvs.Frame.STAGES)
    for stage in stages:
        shares = [done for name, done in calls if name == stage]
        assert shares == sorted(shares) and 0 <= shares[0] and shares[-1] <= 1
        assert len(shares) <= 101
    # Callbacks may touch what is not safe with threads.
    assert threads == {threading.get_ident()}


@pytest.mark.parametrize("stage", ["views", "hull", "coarse", "detect", "mesh"])
def test_false_cancels_and_the_frame_can_go_on(frame, finished, stage):
    with pytest.raises(pcmvs.Cancelled) as raised:
        frame.run(progress=lambda name, done: name != stage)
    assert raised.value.code == "cancelled"
    before = pcmvs.Frame.STAGES.index(stage) - 1
    assert frame.reached == (None if stage in ("views", "hull") else pcmvs.Frame.STAGES[before])
    frame.run()
    assert frame.hashes == finished.hashes


def test_an_exception_in_the_callback_comes_out_unchanged(frame):
    problem = KeyError("of the host")

    def progress(stage, done):
        if stage == "detect":
            raise problem

    with pytest.raises(KeyError) as raised:
        frame.run(progress=progress)
    assert raised.value is problem
    assert frame.reached == "coarse"


@pytest.fixture
def ctrl_c():
    """Python's own handler of Ctrl-C, which it does not install if the tests run in the background of a script."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def test_ctrl_c_stops_the_work(scene, pictures, finished, ctrl_c):
    frames = [pcmvs.Frame(scene.rig(), **pictures) for _ in range(8)]
    presser = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    with pytest.raises(KeyboardInterrupt):
        presser.start()
        for frame in frames:
            frame.run()
    presser.join()
    # It may come just between two frames.
    assert frames[-1].reached != "colour"
    unfinished = next(frame for frame in frames if frame.reached != "colour")
    unfinished.run()
    assert unfinished.hashes == finished.hashes


def test_other_threads_run_meanwhile(frame):
    ticks, stop = [], threading.Event()

    def count():
        while not stop.is_set():
            ticks.append(time.monotonic())
            time.sleep(0.001)

    counter = threading.Thread(target=count)
    counter.start()
    start = time.monotonic()
    frame.run()
    seconds = time.monotonic() - start
    stop.set()
    counter.join()
    during = [start, *(tick for tick in ticks if start < tick < start + seconds), start + seconds]
    # If the interpreter's lock were held, the other thread would run at the beginning and at the end only.
    assert max(b - a for a, b in zip(during, during[1:])) < max(0.5 * seconds, 0.1)


def test_frames_run_side_by_side(scene, finished):
    found = {}

    def work(name):
        found[name] = pcmvs.reconstruct(scene.rig(), **scene.pictures(0), threads=1).hashes

    workers = [threading.Thread(target=work, args=(name,)) for name in range(2)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert found == {0: finished.hashes, 1: finished.hashes}


def test_a_frame_that_runs_cannot_be_used(frame):
    with pytest.raises(RuntimeError, match="borrowed"):
        frame.run(progress=lambda stage, done: frame.mesh())


def test_the_number_of_threads_does_not_change_the_result(scene, pictures, finished):
    for threads in (1, 3):
        assert pcmvs.reconstruct(scene.rig(), **pictures, threads=threads).hashes == finished.hashes


def test_a_frame_that_needs_too_much_memory_is_refused(scene, pictures):
    with pytest.raises(MemoryError, match="max_memory allows 1000000") as raised:
        pcmvs.reconstruct(scene.rig(), **pictures, max_memory=1_000_000)
    assert isinstance(raised.value, pcmvs.MemoryLimitError) and raised.value.code == "out-of-memory"
