"""Comparisons of methods, and integrators that are written in Python."""

import json
import os
import signal
import threading
import time

import numpy as np
import pytest

import pt_renderer
from conftest import SCENES


@pytest.fixture(scope="module")
def box():
    return pt_renderer.load(SCENES / "cornell-box.json", size=(16, 12))


class Paths:
    """Path tracing that finds light by chance: the integrator `path` in a few lines."""

    def li(self, scene, ray, sampler):
        radiance, throughput = np.zeros(3), np.ones(3)
        for depth in range(64):
            surface = scene.intersect(ray)
            if surface is None:
                return radiance + throughput * scene.background(ray)
            radiance += throughput * surface.emitted
            sampled = surface.sample(sampler)
            if sampled is None:
                return radiance
            ray, weight = sampled
            throughput = throughput * weight
            if depth >= 4:
                survival = min(1.0, throughput.max())
                if sampler.get_1d() >= survival:
                    return radiance
                throughput /= survival
        return radiance


def test_a_method_in_python_agrees_with_path(ball):
    ball["shapes"].append({"type": "quad", "size": 6, "material": "white", "transform": [{"rotate": {"axis": [1, 0, 0], "degrees": -90}}, {"translate": [0, -1, 0]}]})
    ball["materials"]["white"] = {"type": "diffuse", "albedo": [0.8, 0.5, 0.3]}
    scene = pt_renderer.load(ball)
    found = pt_renderer.verify(Paths(), "path", scene=scene, spp=64)
    assert found.verdict == "same" and found.smallest_bias < 0.02, found
    # One that loses a twentieth of the light is found.
    assert pt_renderer.verify(Lossy(), "path", scene=scene, spp=64).verdict == "different"


class Lossy(Paths):
    def li(self, scene, ray, sampler):
        return 0.95 * super().li(scene, ray, sampler)


def test_a_ball_in_a_furnace_by_python(ball):
    ball["film"] = {"width": 8, "height": 6}
    picture = pt_renderer.load(ball).render(16, integrator=Paths(), sampler="independent")
    np.testing.assert_array_equal(picture.rgb[0, 0], 1)
    np.testing.assert_allclose(picture.rgb[2:4, 3:5], 0.5, atol=1e-4)
    assert picture.integrator == "python"


class Normals:
    def li(self, scene, ray, sampler):
        surface = scene.intersect(ray)
        return (0, 0, 0) if surface is None else [0.5 * (x + 1) for x in surface.normal]


def test_what_a_method_sees(ball):
    seen = []

    class Look:
        def li(self, scene, ray, sampler):
            surface = scene.intersect(ray)
            if surface is not None:
                onward, weight = surface.sample(sampler)
                seen.append((surface, ray, onward, weight, sampler.get_2d()))
            return (0.0, 0.0, 0.0)

    pt_renderer.load(ball).render(1, integrator=Look(), crop=(10, 14, 8, 10))
    assert len(seen) == 8
    for surface, ray, onward, weight, numbers in seen:
        point, origin, direction = (np.array(x) for x in (surface.point, ray.origin, ray.direction))
        np.testing.assert_allclose(origin, [0, 0, 4], atol=1e-6)
        np.testing.assert_allclose(np.linalg.norm(point), 1, atol=1e-5)
        np.testing.assert_allclose(surface.normal, point, atol=1e-4)
        np.testing.assert_allclose(point, origin + surface.distance * direction, atol=1e-5)
        np.testing.assert_allclose(weight, 0.5, rtol=1e-5)
        assert np.dot(onward.direction, surface.normal) > 0 and all(0 <= x < 1 for x in numbers)
        assert surface.emitted == [0, 0, 0] and surface.spawn((0, 0, 0)) is None


def test_methods_in_python_are_reproducible(box):
    assert box.render(4, integrator=Paths()) == box.render(4, integrator=Paths())
    normals = box.render(4, integrator=Normals())
    assert (normals.rgb >= 0).all() and normals.rgb.max() <= 1


@pytest.mark.parametrize("result", [None, (1, 2), "red", "raise"])
def test_exceptions_of_methods_end_the_render(box, result):
    class Broken:
        def li(self, scene, ray, sampler):
            if result == "raise":
                raise ZeroDivisionError("of mine")
            return result

    start = time.monotonic()
    with pytest.raises((ZeroDivisionError, TypeError, ValueError)):
        box.render(100_000, integrator=Broken())
    with pytest.raises((ZeroDivisionError, TypeError, ValueError)):
        pt_renderer.verify("path", Broken(), scene=box, spp=64)
    assert time.monotonic() - start < 20


def test_invalid_light_is_counted(box):
    class Bad:
        def li(self, scene, ray, sampler):
            return (float("nan"), 0, 0)

    picture = box.render(2, integrator=Bad())
    assert picture.invalid == 2 * 16 * 12 and (picture.rgb == 0).all()


def test_ctrl_c_ends_a_method_in_python(box):
    threading.Timer(0.7, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    picture = box.render(time=60, integrator=Normals())
    assert picture.interrupted and picture.spp >= 1


def test_what_is_no_method(box):
    for thing in (3, object(), Paths.li):
        with pytest.raises(pt_renderer.Error, match="expected the name of an integrator, or an object with a method li"):
            box.render(1, integrator=thing)


def test_comparisons(pt, tmp_path):
    scene = pt_renderer.load(SCENES / "cornell-box.json", size=(24, 18))
    found = pt_renderer.compare(scene, ["nee", "path"], spp=16, reference_time=1, folder=tmp_path / "report")
    names = [row["method"] for row in found.rows]
    assert sorted(set(names)) == ["nee", "path"]
    last = {row["method"]: row for row in found.rows if row["spp"] == 16}
    assert 0 < last["nee"]["error"] < last["path"]["error"] and last["nee"]["seconds"] > 0
    assert {price["error"] for price in found.prices} >= {0.1, 0.03, 0.01} and found.conclusions
    assert str(found) == "\n".join(found.conclusions) and "nee, path" in repr(found)
    # The report is that of the program, which repeats the comparison and finds the same bits.
    assert {path.name for path in (tmp_path / "report").iterdir()} >= {"index.html", "convergence.json", "convergence.csv", "reference.exr"}
    assert found.html.startswith("<!") and "<iframe srcdoc=" in found._repr_html_()
    said = pt("compare", "--replay", tmp_path / "report" / "convergence.json", "--progress", "none", check=False).stdout
    assert said.count("the same picture bit for bit") == 2, said


def test_comparisons_that_are_refused(box):
    for scene, integrators, failure, message in [
        (box, "nee", pt_renderer.Error, r'integrators: expected several names, such as \["nee"\], found a string'),
        (box, [], pt_renderer.Error, "integrators: expected at least one name"),
        ("box.json", ["nee"], TypeError, "scene: expected a Scene, as load returns it, found str"),
    ]:
        with pytest.raises(failure, match=message):
            pt_renderer.compare(scene, integrators)


def test_comparisons_with_a_reference(tmp_path):
    scene = pt_renderer.load(SCENES / "cornell-box.json", size=(24, 18))
    reference = scene.render(512, seed=99)
    found = pt_renderer.compare(scene, ["nee"], samplers=["sobol", "independent"], spp=4, reference=reference, replicates=2, metrics=["flip"])
    assert {row["method"] for row in found.rows} == {"nee · sobol", "nee · independent"} and found.folder is None
    assert all("flip" in row for row in found.rows)
    assert json.dumps(found.rows) and found.data["provenance"]["reference_hash"] == reference.hash
    for arguments, message in [
        ({"integrators": ["neee"]}, "unknown integrator"),
        ({"samplers": ["sobel"]}, "unknown sampler"),
        ({"metrics": ["flop"]}, "flop"),
        ({"replicates": 1}, "replicates: expected a whole number from 2 to 256"),
        ({"reference": pt_renderer.load(SCENES / "cornell-box.json", size=(8, 8)).render(1)}, "reference: expected a picture with the pixels"),
    ]:
        with pytest.raises(pt_renderer.Error) as caught:
            pt_renderer.compare(scene, **({"spp": 2} | arguments))
        assert message in str(caught.value)
