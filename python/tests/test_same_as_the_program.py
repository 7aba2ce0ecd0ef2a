"""Pictures, files and messages are those of the program `pt`, bit for bit and word for word."""

import shutil
from pathlib import Path

import pytest

import pt_renderer
from conftest import ROOT, SCENES

FUZZ = ROOT / "tests" / "it" / "fuzz"
NATIVE = sorted(path.name for path in SCENES.glob("*.json"))
# Models without a camera and scenes of other programs: one of each dialect.
OTHERS = ["square.glb", "square.gltf", "model.obj", "aalto.json", "darts.json", "darts-2021.json", "dirt.json"]
MESHES = ["ascii.ply", "two.stl", "text.stl"]
CORNELL = SCENES / "cornell-box.json"


def same(pt, folder, scene, flags, load=None, **settings):
    """Renders with the program and with the package: the files have the same numbers and attributes."""
    by_program, by_package = folder / "program.exr", folder / "package.exr"
    pt(scene, *flags, "--size", "24x18", "-q", "-o", by_program)
    picture = pt_renderer.load(scene, size=(24, 18), **(load or {})).render(**settings)
    picture.save(by_package)
    assert [pt("image", "hash", path).stdout.split()[0] for path in (by_program, by_package)] == [picture.hash] * 2
    # The order of attributes in a file is left to chance.
    told = [pt("image", "info", path.name, cwd=folder).stdout.replace(path.name, "") for path in (by_program, by_package)]
    assert sorted(told[0].splitlines()) == sorted(told[1].splitlines())
    return picture


@pytest.mark.parametrize("name", NATIVE)
def test_scenes(pt, tmp_path, name):
    same(pt, tmp_path, SCENES / name, ["--spp", 4], spp=4)


@pytest.mark.parametrize("name", OTHERS)
def test_scenes_of_other_programs(pt, tmp_path, name):
    for file in [*(FUZZ / "beside").iterdir(), FUZZ / "seeds" / "scene" / name]:
        shutil.copy(file, tmp_path)
    same(pt, tmp_path, tmp_path / name, ["--spp", 4], spp=4)


@pytest.mark.parametrize("name", MESHES)
def test_meshes_without_a_scene(pt, tmp_path, name):
    same(pt, tmp_path, FUZZ / "seeds" / "mesh" / name, ["--spp", 4], spp=4)


@pytest.mark.parametrize("integrator", ["path", "nee", "light", "whitted", "card", "normals", "ao"])
def test_integrators(pt, tmp_path, integrator):
    flags = ["--spp", 16, "--integrator", integrator]
    assert same(pt, tmp_path, CORNELL, flags, spp=16, integrator=integrator).integrator == integrator
    # The same integrator, chosen when the scene is loaded.
    same(pt, tmp_path, CORNELL, flags, load={"integrator": integrator}, spp=16)


@pytest.mark.parametrize("sampler", ["independent", "stratified", "halton", "sobol"])
def test_samplers(pt, tmp_path, sampler):
    flags = ["--spp", 16, "--sampler", sampler, "--seed", 7, "--scramblings", 4]
    same(pt, tmp_path, CORNELL, flags, spp=16, sampler=sampler, seed=7, scramblings=4)


def test_layers(pt, tmp_path):
    picture = same(pt, tmp_path, SCENES / "gallery.json", ["--spp", 4, "--aov", "all"], spp=4, layers=["all"])
    assert {"albedo", "n", "ns", "p", "z", "uv", "emission", "direct", "indirect"} <= set(picture.layers)
    assert any(name.startswith("lights.") for name in picture.layers)


def test_crops(pt, tmp_path):
    scene = pt_renderer.load(CORNELL)
    pt(CORNELL, "--spp", 4, "--crop", "100,140,200,230", "-q", "-o", tmp_path / "a.exr")
    picture = scene.render(4, crop=(100, 140, 200, 230))
    assert (picture.crop, picture.rgb.shape) == ([100, 140, 200, 230], (30, 40, 3))
    assert pt("image", "hash", tmp_path / "a.exr").stdout.split()[0] == picture.hash


def test_targets(pt, tmp_path):
    scene = pt_renderer.load(CORNELL, size=(24, 18))
    pt(CORNELL, "--target", "30%", "--size", "24x18", "-q", "-o", tmp_path / "a.exr")
    picture = scene.render(target=0.3)
    assert picture.target_met is True and picture.error.value < 0.3
    assert pt("image", "hash", tmp_path / "a.exr").stdout.split()[0] == picture.hash
    assert scene.render(2, target=0.001).target_met is False
    # So few pixels that no error can be established: given up.
    picture = pt_renderer.load(CORNELL, size=(4, 4)).render(target=0.01)
    assert picture.target_met is False and picture.error.refusal.startswith("heavy tail") and picture.spp == 16384
    scene, samples = pt_renderer.load(CORNELL, size=(96, 72)), set()
    for flags, settings in [([], {}), (["--region", "8,40,8,40"], {"region": (8, 40, 8, 40)}), (["--tiles", "90%"], {"tiles": 0.9})]:
        pt(CORNELL, "--target", "10%", *flags, "--size", "96x72", "--spp", 4096, "-q", "-o", tmp_path / "a.exr")
        picture = scene.render(4096, target=0.1, **settings)
        assert picture.target_met is True and picture.spp < 4096
        samples.add(picture.spp)
        assert pt("image", "hash", tmp_path / "a.exr").stdout.split()[0] == picture.hash
        # The error of the whole picture is stated.
        assert picture.error == scene.render(int(picture.spp)).error
    assert len(samples) == 3, "each asks for something else"


def test_overrides(pt, tmp_path):
    flags = ["--spp", 4, "-D", "/camera/fov=60", "-D", "/integrator/max_depth=2"]
    same(pt, tmp_path, CORNELL, flags, load={"overrides": {"/camera/fov": 60, "/integrator/max_depth": 2}}, spp=4)


def test_threads_change_no_bit():
    scene = pt_renderer.load(CORNELL, size=(24, 18))
    assert scene.render(8, threads=1) == scene.render(8, threads=3) == scene.render(8)
    assert scene.render(8) != scene.render(8, seed=1)


def test_developed_files(pt, tmp_path):
    pt(CORNELL, "--spp", 4, "--size", "24x18", "-q", "--exposure", "-1", "--tonemap", "filmic", "-o", tmp_path / "a.png")
    picture = pt_renderer.load(CORNELL, size=(24, 18)).render(4)
    picture.save(tmp_path / "b.png", exposure=-1, tonemap="filmic")
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


FAULTY = {
    "many": '{ "pt": 1, "camera": { "fov": 180 },\n  "materials": { "glass": { "type": "dielectric", "rougness": 0.1 } },\n'
    '  "shapes": [{ "type": "sphere", "radius": 1, "material": "glas" }] }',
    "not JSON": '{ "pt": 1, "camera": }',
    "empty": "\n",
    "missing file": '{ "pt": 1, "camera": {}, "shapes": [{ "type": "mesh", "file": "none.ply" }] }\n',
    "outside": '{ "pt": 1, "camera": {}, "shapes": [{ "type": "mesh", "file": "../none.ply" }] }\n',
    "integrator": '{ "pt": 1, "camera": {}, "integrator": { "type": "nee", "max_dept": 3 } }\n',
    "unknown integrator": '{ "pt": 1, "camera": {}, "integrator": { "type": "metropolis" } }\n',
    "too large": '{ "pt": 1, "camera": {}, "film": { "width": 65536, "height": 65536 }, "sampler": { "spp": 4294967295 } }\n',
}


@pytest.mark.parametrize("case", FAULTY)
def test_messages_for_files(pt, tmp_path, monkeypatch, case):
    monkeypatch.chdir(tmp_path)
    Path("scene.json").write_text(FAULTY[case], encoding="utf-8")
    refused = pt("scene.json", check=False, cwd=tmp_path)
    lines = [line.removeprefix("error: ") for line in refused.stderr.splitlines() if line.startswith("error: ")]
    with pytest.raises(pt_renderer.Error) as caught:
        pt_renderer.load("scene.json")
    # How much memory is free changes from one moment to the next.
    without_numbers = (lambda text: "".join(c for c in text if not c.isdigit())) if case == "too large" else str
    assert without_numbers(str(caught.value)) == without_numbers("\n".join(lines))
    assert len(caught.value.faults) == len(lines) > 0
    kinds = {2: "usage", 3: "invalid", 4: "limit", 5: "io"}
    assert caught.value.kind == kinds[refused.returncode]


def test_messages_for_text_and_dicts():
    text = FAULTY["many"]
    with pytest.raises(pt_renderer.Error) as caught:
        pt_renderer.load(text)
    faults = caught.value.faults
    places = [(1, "180", "/camera/fov"), (2, '"rougness"', "/materials/glass/rougness"), (3, '"glas"', "/shapes/0/material")]
    lines = text.splitlines()
    assert [(fault.file, fault.line, fault.column, fault.pointer) for fault in faults] == [
        ("<text>", line, lines[line - 1].index(word) + 1, pointer) for line, word, pointer in places
    ]
    import json

    with pytest.raises(pt_renderer.Error) as caught:
        pt_renderer.load(json.loads(text))
    assert [(fault.line, fault.column, fault.pointer, fault.message) for fault in caught.value.faults] == [
        (None, None, fault.pointer, fault.message) for fault in faults
    ]


def test_a_missing_file(tmp_path):
    with pytest.raises(pt_renderer.Error) as caught:
        pt_renderer.load(tmp_path / "none.json")
    assert "none.json" in str(caught.value)
    with pytest.raises(pt_renderer.Error) as caught:
        pt_renderer.load(CORNELL, size=(4, 4)).render(1).save(tmp_path / "none" / "a.exr")
    assert caught.value.kind == "io"


def test_text_dicts_and_bytes_render_the_same():
    import json

    text = CORNELL.read_text(encoding="utf-8")
    in_file = pt_renderer.load(CORNELL, size=(24, 18)).render(4)
    for source in (text, text.encode(), json.loads(pt_renderer.load(CORNELL).json())):
        assert pt_renderer.load(source, size=(24, 18), folder=SCENES).render(4) == in_file
