"""Pictures: arrays, errors, prices, and what happens to them in Python."""

import copy
import math
import pickle
import struct

import numpy as np
import pytest

import pt_renderer
from conftest import SCENES


@pytest.fixture(scope="module")
def box():
    return pt_renderer.load(SCENES / "cornell-box.json", size=(40, 30))


def test_a_ball_in_a_furnace(ball):
    """A surface that reflects half of a light of 1 from everywhere shows one half."""
    picture = pt_renderer.load(ball).render(16, integrator="path")
    np.testing.assert_allclose(picture.rgb[9, 12], 0.5, atol=1e-4)
    np.testing.assert_array_equal(picture.rgb[0, 0], 1.0)


def test_arrays(box):
    picture = box.render(4, layers=["albedo", "z"])
    shapes = {"rgb": (30, 40, 3), "stderr": (30, 40, 3), "samples": (30, 40)}
    arrays = {name: getattr(picture, name) for name in shapes} | picture.layers
    for name, array in arrays.items():
        assert array.dtype == np.float32 and array.flags.c_contiguous and not array.flags.writeable, name
        assert array.shape == (shapes | {"albedo": (30, 40, 3), "z": (30, 40)})[name], name
    # The same memory each time, and nothing can change it.
    assert picture.rgb is picture.rgb and picture.layers["z"] is picture.layers["z"]
    with pytest.raises(ValueError):
        picture.rgb[0, 0, 0] = 1
    assert (picture.samples == 4).all()
    assert (picture.width, picture.height, picture.crop, picture.spp) == (40, 30, [0, 40, 0, 30], 4)


def test_arrays_outlive_the_picture(ball):
    rgb = pt_renderer.load(ball).render(4).rgb
    assert np.isfinite(rgb).all() and rgb[0, 0, 0] == 1


def test_without_errors(box):
    picture = box.render(1)
    assert picture.stderr is None
    assert picture.error.value is None and "samples per pixel" in picture.error.refusal
    assert picture.price([0.1]) == [None]


def test_the_error_holds(box):
    """The stated error is that of the picture: a picture of many more samples is within its interval, widened threefold."""
    picture, truth = box.render(16), box.render(1024, seed=1)
    assert picture.error.low < picture.error.value < picture.error.high and picture.error.refusal is None
    found = np.sqrt(np.mean((picture.rgb - truth.rgb) ** 2 / (truth.rgb**2 + 1e-4 * np.mean(truth.rgb) ** 2)))
    assert picture.error.value / 3 < found < 3 * picture.error.value
    # Sums over the noisy pixels: what shows no noise, such as the background, has errors of 0.
    variance = picture.stderr**2 + truth.stderr**2
    assert 0.5 < np.sum((picture.rgb - truth.rgb) ** 2) / np.sum(variance) < 2


def test_prices(box):
    picture = box.render(64, sampler="independent")
    small, smaller = picture.price([0.01, 0.005])
    assert small.error == 0.01 and small.low < small.seconds < small.high
    # Independent samples: half of the error takes four times as long.
    assert math.isclose(smaller.seconds, 4 * small.seconds, rel_tol=1e-6)
    assert math.isclose(small.seconds, picture.seconds * (picture.error.value / 0.01) ** 2, rel_tol=0.02)
    with pytest.raises(pt_renderer.Error, match="errors: expected a share"):
        picture.price([0.0])


def test_pickles_and_copies(box, tmp_path):
    picture = box.render(8, layers=["albedo", "lights"], target=0.01)
    for again in (pickle.loads(pickle.dumps(picture)), copy.deepcopy(picture)):
        assert again == picture and again.hash == picture.hash and hash(again) == hash(picture)
        np.testing.assert_array_equal(again.rgb, picture.rgb)
        assert again.layers.keys() == picture.layers.keys() and not again.rgb.flags.writeable
        assert again.error == picture.error and again.price() == picture.price() and again.target_met == picture.target_met
        assert str(again) == str(picture) and again.attributes == picture.attributes
        again.save(tmp_path / "again.pfm")
        picture.save(tmp_path / "picture.pfm")
        assert (tmp_path / "again.pfm").read_bytes() == (tmp_path / "picture.pfm").read_bytes()


def test_pickled_numbers_keep_their_last_bit(box):
    """A parser of JSON that rounds twice reads this number one unit in the last place too high."""
    number = 0.10170294395409839
    picture = box.render(8)
    new, (facts, arrays) = picture.__reduce__()
    assert repr(picture.error.low) in facts
    assert new(facts.replace(repr(picture.error.low), repr(number)), arrays).error.low == number
    for wrong in (facts[:-1], facts.replace("[", "", 1)):
        with pytest.raises(pt_renderer.Error, match="the pickle of a picture is damaged"):
            new(wrong, arrays)


def test_notebooks(box):
    png = box.render(4)._repr_png_()
    assert png.startswith(b"\x89PNG") and struct.unpack(">II", png[16:24]) == (40, 30)
    large = pt_renderer.load(SCENES / "cornell-box.json", size=(1200, 900)).render(1, integrator="path")
    assert len(large._repr_png_()) <= 1_000_000
    assert "nee" in repr(box.render(4)) and "spp" in str(box.render(4))


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"spp": 0}, "spp=0: /sampler/spp: expected"),
        ({"spp": -3}, "spp=-3: /sampler/spp: expected"),
        ({"spp": 2**70}, "/sampler/spp: expected"),
        ({"seed": -1}, "seed=-1: /sampler/seed: expected"),
        ({"scramblings": 3}, "expected a power of two from 1 to 64, found 3"),
        ({"sampler": "sobel"}, 'unknown sampler "sobel", did you mean "sobol"?'),
        ({"integrator": "neee"}, 'unknown integrator "neee", did you mean "nee"?'),
        ({"layers": ["albdo"]}, 'layers: unknown layer "albdo", did you mean "albedo"?'),
        ({"crop": (0, 0, 0, 0)}, "/film/crop"),
        ({"crop": (0, 41, 0, 30)}, "/film/crop"),
        ({"crop": (-1, 4, 0, 30)}, "/film/crop"),
        ({"target": 0}, "target: expected a share"),
        ({"region": (0, 20, 0, 20)}, "only with a target"),
        ({"target": 0.1, "region": (0, 20, 0, 20), "tiles": 0.9}, "expected one of them"),
        ({"target": 0.1, "region": (0, 41, 0, 20)}, "region 0,41,0,20: expected X0 < X1 and Y0 < Y1 within the picture, 0,40,0,30"),
        ({"target": 0.1, "region": (0, 4, 0, 4)}, "expected at least 64 pixels"),
        ({"target": 0.1, "region": (-1, 20, 0, 20)}, "region=[-1, 20, 0, 20]: expected whole numbers from 0"),
        ({"target": 0.1, "region": (0, 20, 0, 20), "integrator": "light"}, "region: expected an integrator whose paths"),
        ({"target": 0.1, "tiles": 1}, "tiles: expected a share"),
        ({"target": 0.1, "tiles": 0.9, "confidence": 0.5}, "tiles: expected a confidence of 95 %"),
        ({"target": math.nan}, "target: expected a share"),
        ({"target": 0.1, "scramblings": 1, "sampler": "sobol"}, "a single scrambling gives no error estimate"),
        ({"confidence": 1}, "confidence: expected a share"),
        ({"time": 0}, "time: expected a number of seconds above 0"),
        ({"time": math.inf}, "time: expected"),
        ({"time": -1}, "time: expected"),
        ({"threads": 0}, "threads: expected a whole number from 1"),
    ],
)
def test_settings_that_are_refused(box, settings, message):
    with pytest.raises(pt_renderer.Error) as caught:
        box.render(**settings)
    assert message in str(caught.value)
    assert caught.value.kind == "usage" and caught.value.faults[0].message


def test_sequences_are_taken_item_by_item(box):
    """A sequence that states a huge length is refused and does not exhaust the memory; a string is not a list of names."""
    with pytest.raises(TypeError):
        box.render(1, layers=range(1 << 40))
    with pytest.raises(TypeError):
        box.part(0, 1, layers=range(1 << 40))
    with pytest.raises(pt_renderer.Error, match="expected at most 10000 items"):
        box.render(1).price(range(1, 1 << 40))
    with pytest.raises(pt_renderer.Error, match="such as a list, found a string"):
        box.render(1, layers="albedo")
    assert "albedo" in box.render(1, layers=iter(["albedo"])).layers


def test_arguments_of_load_that_are_refused(ball):
    for arguments, message in [
        ({"overrides": {"/camera/fov": 180}}, "/camera/fov=180: /camera/fov: expected an angle"),
        ({"overrides": {"camera": 1}}, "expected a JSON pointer such as /camera/fov"),
        ({"overrides": {"/camera/fov": object()}}, "object is not JSON"),
        ({"size": (0, 4)}, "size=(0, 4)"),
        ({"view": "fron"}, 'did you mean "front"?'),
        ({"up": "x"}, 'up: expected "y" or "z"'),
        ({"integrator": "neee"}, "unknown integrator"),
    ]:
        with pytest.raises(pt_renderer.Error) as caught:
            pt_renderer.load(ball, **arguments)
        assert message in str(caught.value), arguments
    with pytest.raises(pt_renderer.Error, match="folder: expected with a scene in memory"):
        pt_renderer.load(SCENES / "cornell-box.json", folder=".")
    with pytest.raises(pt_renderer.Error, match="exposure: expected a number of stops"):
        pt_renderer.load(ball).render(1).save("a.png", exposure="bright")


def test_errors_pickle():
    with pytest.raises(pt_renderer.Error) as caught:
        pt_renderer.load('{ "pt": 1,\n "camera": { "fov": 0 } }')
    again = pickle.loads(pickle.dumps(caught.value))
    assert str(again) == str(caught.value) and again.faults == caught.value.faults and again.kind == "invalid"


def test_check(ball):
    found = pt_renderer.load(SCENES / "caustic.json").check()
    assert found["lights"] > 0 and found["primitives"] >= found["shapes"] > 0
    assert any("refraction" in effect for effect in found["effects"]) and found["lacks"] is None
    whitted = pt_renderer.load(SCENES / "cornell-box.json", integrator="whitted").check()
    assert whitted["lacks"]
    del ball["background"]
    assert any("no light" in warning for warning in pt_renderer.load(ball).warnings)


def test_numpy_in_scenes(ball):
    ball["shapes"] = [{"type": "sphere", "radius": np.float32(1), "center": np.zeros(3), "material": "grey"}]
    assert pt_renderer.load(ball).render(1).rgb[0, 0, 0] == 1
