"""A render in a process of Python: threads, signals, progress and memory."""

import os
import signal
import subprocess
import sys
import threading
import time

import pytest

import pt_renderer
from conftest import SCENES

CORNELL = SCENES / "cornell-box.json"


@pytest.fixture(scope="module")
def box():
    return pt_renderer.load(CORNELL, size=(64, 48))


def interrupt_after(seconds):
    threading.Timer(seconds, lambda: os.kill(os.getpid(), signal.SIGINT)).start()


def test_ctrl_c_returns_what_is_there(box):
    start = time.monotonic()
    interrupt_after(0.7)
    picture = box.render(time=60)
    assert picture.interrupted and picture.spp >= 1 and time.monotonic() - start < 20
    # A picture is a function of its number of samples.
    assert box.render(int(picture.spp)) == picture and not box.render(2).interrupted


def test_ctrl_c_before_the_first_sample():
    scene = pt_renderer.load(CORNELL, size=(4096, 4096))
    interrupt_after(0.3)
    with pytest.raises(KeyboardInterrupt):
        scene.render(1)


def test_progress(box):
    seen = []
    picture = box.render(32, progress=seen.append)
    assert seen and all(isinstance(state, pt_renderer.Progress) for state in seen)
    samples = [state.samples for state in seen]
    assert samples == sorted(samples) and samples[-1] == 32 and seen[-1].seconds > 0
    assert seen[-1].error == picture.error.value


def test_exceptions_of_progress_end_the_render(box):
    def fail(state):
        raise ZeroDivisionError("enough")

    start = time.monotonic()
    with pytest.raises(ZeroDivisionError, match="enough"):
        box.render(time=60, progress=fail)
    assert time.monotonic() - start < 20


def test_the_lock_is_released(box):
    counted, done = 0, threading.Event()

    def count():
        nonlocal counted
        while not done.is_set():
            counted += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    box.render(time=0.5)
    done.set()
    thread.join()
    assert counted > 50


def test_two_renders_at_once(box):
    pictures = {}

    def render(seed):
        pictures[seed] = box.render(32, seed=seed)

    threads = [threading.Thread(target=render, args=(seed,)) for seed in (1, 2)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert all(pictures[seed] == box.render(32, seed=seed) for seed in (1, 2)) and pictures[1] != pictures[2]


MEMORY = """
import ctypes, gc, sys
import pt_renderer

# glibc keeps freed memory, more or less of it as threads happen to run; before a reading it gives all of it back.
give_back = getattr(ctypes.CDLL(None), "malloc_trim", lambda kept: None)

def resident():
    gc.collect()
    give_back(0)
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * 4096

def once():
    picture = pt_renderer.load(sys.argv[1], size=(96, 72)).render(2, layers=["albedo", "z"])
    assert picture.rgb.shape == (72, 96, 3) and picture.save is not None

for _ in range(20):
    once()
before = resident()
for _ in range(200):
    once()
print(resident() - before)
"""


@pytest.mark.skipif(not os.path.exists("/proc/self/statm"), reason="memory is read from /proc")
def test_memory_stays_flat():
    """200 loads and renders in one process: its memory grows by less than 5 MB."""
    scene = SCENES / "pawns.json"
    grown = subprocess.run([sys.executable, "-c", MEMORY, str(scene)], capture_output=True, text=True, check=True)
    print(f"memory grew by {int(grown.stdout) / 1e6:.2f} MB")
    assert int(grown.stdout) < 5e6
