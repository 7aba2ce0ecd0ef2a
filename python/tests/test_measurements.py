"""Rays, tests of methods, and meters."""

import json
import math

import numpy as np
import pytest

import pt_renderer
from conftest import ROOT, SCENES

PAWN = SCENES / "meshes" / "pawn.ply"
BOX = {
    "pt": 1,
    "camera": {"look_at": {"from": [0, 0, 5], "to": [0, 0, 0]}},
    "materials": {"grey": {"type": "diffuse", "albedo": 0.5}},
    "shapes": [
        {"type": "box", "size": [2, 2, 2], "material": "grey", "name": "the box"},
        {"type": "sphere", "radius": 1, "center": [10, 0, 0], "material": "grey", "name": "the ball"},
    ],
    "background": {"radiance": 1},
}


def test_rays_in_a_scene():
    scene = pt_renderer.load(BOX)
    hits = scene.intersect([[0, 0, 5], [0.3, 0.4, 5], [10, 0, 5], [0, 5, 5], [5, 0, 0]], [[0, 0, -2], [0, 0, -1], [0, 0, -4], [0, 0, -1], [1, 0, 0]])
    np.testing.assert_allclose(hits.t, [2, 4, 1, math.inf, 4], rtol=1e-6)
    assert hits.hit.tolist() == [True, True, True, False, True] and hits.exact.tolist() == [True, True, False, True, False]
    names = [scene.shapes[shape] if shape >= 0 else None for shape in hits.shape]
    assert names == ["the box", "the box", "the ball", None, "the ball"] and (hits.instance == -1).all()
    np.testing.assert_allclose(hits.normal[[0, 2, 4]], [[0, 0, 1], [0, 0, 1], [-1, 0, 0]], atol=1e-6)
    assert np.isnan(hits.normal[3]).all() and hits.primitive[3] == -1
    assert hits.t.dtype == hits.uv.dtype == np.float64 and hits.shape.dtype == np.int64


def test_shapes_of_batches():
    scene = pt_renderer.load(BOX)
    assert scene.intersect([0, 0, 5], [0, 0, -1]).t == 4
    hits = scene.intersect(np.zeros((4, 1, 3)) + [0, 0, 5], np.zeros((3, 3)) + [0, 0, -1])
    assert hits.t.shape == (4, 3) and hits.normal.shape == (4, 3, 3) and hits.uv.shape == (4, 3, 2) and (hits.t == 4).all()
    assert scene.intersect(np.zeros((0, 3)), [0, 0, 1]).t.shape == (0,)
    for origins, directions, message in [
        ([0, 0], [0, 0, 1], "origins: expected numbers of shape (..., 3), found shape (2,)"),
        ([[0, 0, 0]] * 2, [[0, 0, 1]] * 3, "do not go together"),
        (["x"] * 3, [0, 0, 1], "origins: expected numbers"),
        ([[0, 0, 5], [0, math.nan, 5]], [0, 0, 1], "origins[1]: expected a vector whose largest coordinate is up to 1e60, found [0.0, nan, 5.0]"),
        ([0, math.inf, 5], [0, 0, 1], "origins: expected a vector"),
        ([0, 0, 1e61], [0, 0, 1], "origins: expected a vector"),
        ([0, 0, 5], [[[0, 0, 1], [0, 0, 0]]], "directions[0][1]: expected a vector whose largest coordinate is from 1e-60 to 1e60"),
        ([0, 0, 5], [0, 0, -1e-300], "directions: expected a vector"),
        ([0, 0, 5], [-math.inf, 0, 0], "directions: expected a vector"),
    ]:
        with pytest.raises(pt_renderer.Error) as caught:
            scene.intersect(origins, directions)
        assert message in str(caught.value)
    for origin, direction in [([0, 0, 1e59], [0, 0, -1]), ([0, 0, 5], [0, 0, -1e-59]), ([0, 0, 5], [0, 0, -1e59])]:
        assert np.isfinite(scene.intersect(origin, direction).t)
    mesh = pt_renderer.Mesh(np.eye(3), [[0, 1, 2]])
    with pytest.raises(pt_renderer.Error, match=r"points\[0\]: expected a vector"):
        mesh.winding([[math.nan, 0, 0]])
    with pytest.raises(pt_renderer.Error, match="points: expected numbers of shape"):
        mesh.winding([[1, 2]])


def test_instances_are_met_where_they_are():
    """Unit squares of two instances, one of them twice as large and turned: the rays know which they meet, and where."""
    here, turned = [{"translate": [0, 0, 0]}], [{"scale": 2}, {"rotate": {"axis": [0, 1, 0], "degrees": 90}}, {"translate": [5, 0, 0]}]
    placements = [{"transform": here}, {"transform": turned}]
    scene = pt_renderer.load(
        {
            "pt": 1,
            "camera": {},
            "background": {"radiance": 1},
            "groups": {"square": [{"type": "quad", "size": 1}]},
            "shapes": [{"type": "instances", "group": "square", "placements": placements}],
        }
    )
    hits = scene.intersect([[0.25, 0.25, 1], [0, 0.5, -0.5], [0.25, 0.75, 1]], [[0, 0, -1], [1, 0, 0], [0, 0, -1]])
    assert hits.t.tolist() == pytest.approx([1, 5, np.inf]) and hits.instance.tolist() == [0, 1, -1]
    assert hits.shape.tolist() == [0, 0, -1] and hits.exact.all()
    assert np.abs(hits.normal[:2]) == pytest.approx(np.array([[0, 0, 1], [1, 0, 0]]), abs=1e-12)


def test_no_ray_slips_through_a_closed_mesh():
    """Twice 100,000 rays from inside of a cube, aimed at its edges and corners: all meet it, wherever the cube is."""
    random = np.random.default_rng(1)
    for center in ([0, 0, 0], [1e6, -1e6, 1e6]):
        corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) + np.array(center, dtype=float)
        quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        triangles = [(a, b, c) for a, b, c, d in quads] + [(a, c, d) for a, b, c, d in quads]
        mesh = pt_renderer.Mesh(corners, triangles)
        ends = corners[random.integers(0, 8, (100_000, 2))]
        aims = ends[:, 0] + random.choice([0, 0.25, 0.5, 1], (100_000, 1)) * (ends[:, 1] - ends[:, 0])
        origins = np.array(center) + random.uniform(-0.9, 0.9, (100_000, 3))
        hits = mesh.intersect(origins, aims - origins)
        assert hits.hit.all() and not hits.enters.any()
        # The points are on the ray: at a corner or an edge t is 1; on a diagonal through the cube it is that of the wall behind.
        assert (hits.t > 0).all() and np.isfinite(hits.normal).all()
        assert (mesh.winding(origins) == 1).all() and (mesh.winding(origins + 10) == 0).all()


def test_no_ray_leaves_a_closed_mesh_of_a_scene():
    """A ball of triangles, turned, stretched and moved far away: rays from within to its corners and the points of its edges meet it."""
    columns, rows = 24, 12
    ring = [[math.sin(math.pi * i / rows) * math.cos(2 * math.pi * j / columns),
             math.sin(math.pi * i / rows) * math.sin(2 * math.pi * j / columns),
             math.cos(math.pi * i / rows)] for i in range(1, rows) for j in range(columns)]  # fmt: skip
    positions = [[0, 0, 1], *ring, [0, 0, -1]]
    at = lambda i, j: 1 + i * columns + j % columns
    triangles = [(0, at(0, j), at(0, j + 1)) for j in range(columns)]
    triangles += [(len(positions) - 1, at(rows - 2, j + 1), at(rows - 2, j)) for j in range(columns)]
    for i in range(rows - 2):
        for j in range(columns):
            a, b, c, d = at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)
            triangles += [(a, b, c), (a, c, d)]
    turn, center = math.radians(33), np.array([3e5, -1e4, 7.0])
    steps = [{"scale": [2, 0.5, 1]}, {"rotate": {"axis": [0, 0, 1], "degrees": 33}}, {"translate": center.tolist()}]
    mesh = {"type": "mesh", "positions": positions, "triangles": triangles}
    scene = pt_renderer.load({"pt": 1, "camera": {}, "shapes": [{**mesh, "transform": steps}], "background": {"radiance": 1}})
    to_world = np.array([[math.cos(turn), -math.sin(turn), 0], [math.sin(turn), math.cos(turn), 0], [0, 0, 1]]) @ np.diag([2, 0.5, 1])
    random = np.random.default_rng(7)
    ends = np.array(positions, dtype=np.float32).astype(float)[np.array(triangles)[random.integers(0, len(triangles), 200_000)]]
    aims = ends[:, 0] + random.choice([0, 0.25, 0.5, 1], (200_000, 1)) * (ends[:, 1] - ends[:, 0])
    origins, aims = random.uniform(-0.3, 0.3, (200_000, 3)) @ to_world.T + center, aims @ to_world.T + center
    hits = scene.intersect(origins, aims - origins)
    assert hits.hit.all()
    # They meet it where they aim: corners of up to 2 m from the centre are rounded to single precision, by 2⁻²³ m at most, and where
    # a ray meets the ball at a slant the hit moves by several times that.
    assert np.abs((hits.t - 1) * np.linalg.norm(aims - origins, axis=1)).max() < 8 * 2**-23
    assert not scene.intersect(origins + [10, 0, 0], aims - origins).hit.all()


def test_meshes_as_the_program(pt, tmp_path):
    random = np.random.default_rng(2)
    origins = random.normal(size=(200, 3)) * 3
    rays = np.hstack([origins, -origins + random.normal(size=(200, 3)) * 0.2])
    np.savetxt(tmp_path / "rays.csv", rays, delimiter=",", fmt="%.17g")
    lines = [line.split(",") for line in pt("rays", PAWN, "--from", tmp_path / "rays.csv").stdout.splitlines()[1:]]
    mesh = pt_renderer.Mesh.load(PAWN)
    hits = mesh.intersect(rays[:, :3], rays[:, 3:])
    assert 10 < hits.hit.sum() < 200 and len(mesh) > 1000
    found = {int(words[0]): float(words[1]) for words in lines if len(words) > 1 and words[1].strip()}
    assert sorted(found) == np.flatnonzero(hits.hit).tolist()
    np.testing.assert_allclose([found[k] for k in sorted(found)], hits.t[hits.hit], rtol=1e-12)


def test_faces_of_meshes_that_are_refused():
    for vertices, triangles, message in [
        ([[0, 0, 0]], [[0, 0, 1]], "triangle 0 names a vertex that is not there: there are 1"),
        ([[0, 0, 0]], [[0, 0, -1]], "triangle 0 names a vertex"),
        ([[0, 0, 0]], [[0.0, 0.0, 0.0]], "triangles: expected whole numbers"),
        ([[0, 0, math.nan]], [[0, 0, 0]], "vertex 0"),
        ([[0, 0]], [[0, 0, 0]], "vertices: expected numbers of shape (..., 3)"),
    ]:
        with pytest.raises(pt_renderer.Error) as caught:
            pt_renderer.Mesh(vertices, triangles)
        assert message in str(caught.value)


@pytest.fixture(scope="module")
def box():
    return pt_renderer.load(SCENES / "cornell-box.json", size=(48, 36))


def test_methods_that_agree(pt, box):
    found = pt_renderer.verify("nee", "path", scene=box, spp=256)
    said = pt("verify", SCENES / "cornell-box.json", "nee", "path", "--size", "48x36", "--spp", 256, check=False)
    assert (found.verdict, said.returncode) == ("same", 0)
    assert found.p > found.alpha == 0.01 and set(found.tests) == {"pixel", "block", "global", "spread"}
    # The same number as the program prints, in per cent with two digits.
    (shown,) = [line for line in said.stdout.splitlines() if "would have shown" in line]
    assert math.isclose(100 * found.smallest_bias, float(shown.split()[3]), rel_tol=0.06)


def test_methods_that_differ(pt, box):
    """Whitted's method leaves out the light between walls."""
    found = pt_renderer.verify("nee", "whitted", scene=box, spp=64)
    said = pt("verify", SCENES / "cornell-box.json", "nee", "whitted", "--size", "48x36", "--spp", 64, check=False)
    assert (found.verdict, said.returncode) == ("different", 1) and found.p < 1e-6


def test_pictures_are_sides(box):
    settings = {"spp": 256, "scramblings": 16}
    one, other = box.render(**settings), box.render(integrator="path", seed=1, **settings)
    assert pt_renderer.verify(one, other).verdict == "same"
    dimmer = pt_renderer.load(SCENES / "cornell-box.json", size=(48, 36), overrides={"/integrator/max_depth": 2})
    assert pt_renderer.verify(one, dimmer.render(seed=2, **settings)).verdict == "different"
    assert pt_renderer.verify(one, "path", scene=box, spp=256).verdict == "same"
    for arguments, message in [
        ((one, box.render(integrator="path", **settings)), "both pictures have seed 0"),
        ((one, "path"), "b: expected a Picture; integrators and files need scene="),
        ((one, box.render(1, seed=3)), "b: has no channel StdErr.R"),
        ((one, 3), "b: expected a Picture, the name of an integrator"),
    ]:
        with pytest.raises(pt_renderer.Error) as caught:
            pt_renderer.verify(*arguments)
        assert message in str(caught.value)
    with pytest.raises(pt_renderer.Error, match="at least 32 are needed"):
        pt_renderer.verify("nee", "path", scene=box, spp=4)
    with pytest.raises(pt_renderer.Error, match="unknown integrator"):
        pt_renderer.verify("nee", "paht", scene=box)


def test_meters(pt, tmp_path, ball):
    """The irradiance under a sky of radiance 1 is π, and half of that beside a wall; the program says the same."""
    ball["meters"] = [
        {"type": "irradiance", "position": [0, 3, 0], "normal": [0, 1, 0], "name": "up"},
        {"type": "radiance", "position": [0, 0, 4], "direction": [0, 0, -1]},
        {"type": "illuminance", "position": [0, 3, 0], "normal": [0, 1, 0]},
    ]
    scene = pt_renderer.load(ball)
    up, ahead, lux = scene.measure(samples=4096)
    assert (up.name, up.quantity, up.unit, ahead.name, ahead.quantity) == ("up", "irradiance", "W/m²", "/meters/1", "radiance")
    assert math.isclose(up.value, math.pi, rel_tol=1e-5) and math.isclose(ahead.value, 0.5, rel_tol=0.05)
    assert lux.unit == "lx" and math.isclose(lux.value, 683 * math.pi, rel_tol=1e-5) and math.isclose(lux.rgb[0], math.pi, rel_tol=1e-5)
    path = tmp_path / "ball.json"
    path.write_text(json.dumps(ball), encoding="utf-8")
    said = json.loads(pt("meter", path, "--samples", 4096, "--json").stdout)["meters"]
    for reading, row in zip((up, ahead, lux), said):
        for name in ("name", "unit", "value", "half_width", "samples", "invalid", "confidence", "refusal"):
            assert getattr(reading, name) == row[name], name
        assert list(reading.rgb) == row["rgb"] and list(reading.rgb_half_width) == row["rgb_half_width"]
    assert [reading.target_met for reading in scene.measure(target=0.01)] == [True, True, True]
    assert up.target_met is None


def test_meters_that_are_refused(ball):
    with pytest.raises(pt_renderer.Error, match='no "meters"'):
        pt_renderer.load(ball).measure()
    ball["meters"] = [{"type": "irradiance", "position": [0, 3, 0], "normal": [0, 1, 0]}]
    scene = pt_renderer.load(ball)
    for arguments, message in [
        ({"integrator": "light"}, "light: expected an integrator that finds the light along rays from the camera"),
        ({"target": 1e-9}, "expected a target of at least"),
        ({"samples": 0}, "samples: expected a whole number above 0"),
        ({"time": -1}, "time: expected a number of seconds above 0"),
    ]:
        with pytest.raises(pt_renderer.Error) as caught:
            scene.measure(**arguments)
        assert message in str(caught.value)
