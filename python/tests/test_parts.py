"""Parts of a render are added, in any order and grouping, to the bits and the error of one render."""

import copy
import itertools
import multiprocessing
import os
import pickle
import signal
import threading

import pytest

import pt_renderer
from conftest import SCENES

CORNELL = SCENES / "cornell-box.json"


@pytest.fixture(scope="module")
def box():
    return pt_renderer.load(CORNELL, size=(24, 18))


def told(picture):
    """All that a picture says, without times."""
    return (picture.hash, picture.error, picture.integrator, picture.attributes, picture.rgb.tobytes(), picture.stderr.tobytes())


def test_parts_in_any_order_are_one_render(box):
    parts = [pickle.loads(pickle.dumps(box.part(first, end))) for first, end in [(0, 16), (16, 17), (17, 40), (40, 64)]]
    whole = told(box.render(64))
    for order in itertools.permutations(parts):
        assert told(pt_renderer.merge(part for part in order).picture()) == whole
    assert copy.copy(parts[0]) == parts[0] != parts[1] and len({*parts, copy.deepcopy(parts[2])}) == 4
    a, b, c, d = parts
    grouped = pt_renderer.merge([pt_renderer.merge([d, b]), pt_renderer.merge([c]), a, a])
    assert grouped.samples == [(0, 64)], "a part that is there twice counts once"
    assert told(grouped.picture()) == whole
    assert bytes(grouped) == bytes(pt_renderer.merge([grouped]))


SETTINGS = [{"integrator": "light"}, {"sampler": "stratified", "spp": 16}, {"layers": ["all"], "crop": (2, 9, 3, 5), "seed": 7}]


@pytest.mark.parametrize("settings", SETTINGS)
def test_settings_are_those_of_a_render(box, settings):
    parts = [box.part(5, 16, **settings), box.part(0, 5, **settings)]
    render = box.render(**{"spp": 16, **settings})
    assert told(pt_renderer.merge(parts).picture()) == told(render)
    assert parts[0].scene_hash == render.scene_hash and (parts[0].width, parts[0].height) == (render.width, render.height)


def test_parts_of_the_program(pt, tmp_path, box):
    """Parts of the program and of the package belong together, in both directions."""
    pt(CORNELL, "--size", "24x18", "--spp", 32, "--samples", "8..32", "-q", "-o", tmp_path / "b.ptc")
    box.part(0, 8).save(tmp_path / "a.ptc")
    pt("merge", tmp_path / "a.ptc", tmp_path / "b.ptc", "-q", "-o", tmp_path / "a.exr")
    picture = pt_renderer.merge([pt_renderer.Part.load(tmp_path / name) for name in ("a.ptc", "b.ptc")]).picture()
    assert pt("image", "hash", tmp_path / "a.exr").stdout.split()[0] == picture.hash == box.render(32).hash


def test_missing_samples_are_named(box):
    part = pt_renderer.merge([box.part(0, 4), box.part(8, 16), box.part(20, 21)])
    assert part.samples == [(0, 4), (8, 16), (20, 21)]
    assert repr(part) == "<pt_renderer.Part 24×18, samples 0..4, 8..16, 20..21>"
    with pytest.raises(pt_renderer.Error, match=r"samples 4\.\.8 are missing; partial=True"):
        part.picture()
    picture = part.picture(partial=True)
    assert picture.spp == 13 and picture.samples.min() == picture.samples.max() == 13
    assert picture.attributes["pt/samples"] == "0..4, 8..16, 20..21" and picture.error.refusal
    # The error is that of the samples that there are.
    error = pt_renderer.merge([box.part(0, 16), box.part(32, 64)]).picture(partial=True).error
    assert error.low < box.render(48).error.value < error.high and error.value > box.render(64).error.value


def test_what_does_not_belong_together_is_refused(box, ball):
    a = box.part(0, 4)
    for other, message in [
        (box.part(4, 8, seed=1), "/sampler/seed is 1, not 0"),
        (pt_renderer.load(ball).part(4, 8), "not of the same picture as <part 0..4>"),
        (box.part(3, 8), "sample"),
    ]:
        with pytest.raises(pt_renderer.Error, match=message):
            pt_renderer.merge([a, other])
    with pytest.raises(pt_renderer.Error, match=r"<part 0\.\.8>: samples 0\.\.4 are in <part 0\.\.4> too"):
        pt_renderer.merge([pt_renderer.merge([a, box.part(4, 8)]), a])
    with pytest.raises(pt_renderer.Error, match="expected parts to merge"):
        pt_renderer.merge([])
    with pytest.raises(pt_renderer.Error, match="0 <= first < end <= 4294967295, found 4 and 4"):
        box.part(4, 4)
    with pytest.raises(pt_renderer.Error, match="found -1 and 4"):
        box.part(-1, 4)
    with pytest.raises(pt_renderer.Error, match="found 8 and 17; 16 is the number of samples that stratified has"):
        box.part(8, 17, sampler="stratified", spp=16)
    # Strata of 16 samples: four of them are no picture of their own.
    with pytest.raises(pt_renderer.Error, match=r"samples 4\.\.16 are missing"):
        box.part(0, 4, sampler="stratified", spp=16).picture()
    with pytest.raises(TypeError):
        pt_renderer.merge(range(1 << 40))
    with pytest.raises(TypeError):
        box.part(0, 4, integrator=object())
    damaged = bytearray(bytes(a))
    damaged[-30] ^= 1
    with pytest.raises(pt_renderer.Error, match="<bytes>: damaged"):
        pt_renderer._native._part(bytes(damaged))


def test_files_that_are_no_parts(tmp_path, box):
    with pytest.raises(pt_renderer.Error, match="a.exr: expected a name that ends in .ptc"):
        box.part(0, 1).save(tmp_path / "a.exr")
    for path, message in [("-", "-: "), (tmp_path / "none.ptc", "none.ptc"), (tmp_path, str(tmp_path)), (CORNELL, "expected a part of a render")]:
        with pytest.raises(pt_renderer.Error, match=message):
            pt_renderer.Part.load(path)


def test_progress_and_interrupts(box):
    seen = []
    box.part(64, 128, progress=lambda progress: seen.append(progress.samples))
    assert seen == sorted(seen) and seen[-1] == 64

    def stop(progress):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        box.part(0, 1 << 30, progress=stop)
    threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        box.part(0, 1 << 30)


def test_nothing_is_written_to_temporary_files(box, monkeypatch):
    monkeypatch.setenv("TMPDIR", "/none")
    parts = [box.part(0, 4), box.part(4, 8)]
    assert pt_renderer.merge(pickle.loads(pickle.dumps(parts))).picture() == box.render(8)


def render(samples):
    return pt_renderer.load(CORNELL, size=(24, 18)).part(*samples, threads=1)


def test_other_processes_render_parts(box):
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        parts = pool.map(render, [(k, k + 8) for k in range(0, 64, 8)])
    assert pt_renderer.merge(parts).picture() == box.render(64)
