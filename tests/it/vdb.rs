//! OpenVDB files: what pt reads is what OpenVDB wrote. `vdb/make.cc` writes the files with the formulas of this file.

use std::fs;
use std::path::{Path, PathBuf};

use assert_cmd::Command;
use glam::{DVec3, IVec3, UVec3};
use pt::Error;
use pt::describe::ValuesAt;
use pt::describe::volume::{Quantity, Request, Volume, read};
use serde_json::{Value, json};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it/vdb")
}

fn request(quantity: Quantity, grid: Option<&str>) -> Request<'_> {
    Request { quantity, size: None, grid, values_at: ValuesAt::Centers, bounds: None }
}

fn load(file: &str, request: Request) -> pt::Result<Volume> {
    read(&fs::read(folder().join(file)).expect("a file of this folder"), file, request)
}

fn density(file: &str, grid: Option<&str>) -> Volume {
    load(file, request(Quantity::Density, grid)).unwrap_or_else(|error| panic!("{file}, {grid:?}: {error}"))
}

/// Checks all values of a volume, and that its box is that of the voxels from `low` on, of a size and after a translation.
fn assert_values(volume: &Volume, low: IVec3, scale: DVec3, translation: DVec3, expected: impl Fn(IVec3) -> Vec<f32>) {
    let UVec3 { x, y, z } = volume.size;
    let voxels = (0..z).flat_map(|k| (0..y).flat_map(move |j| (0..x).map(move |i| UVec3::new(i, j, k).as_ivec3() + low)));
    let mut found = volume.values.chunks_exact(volume.channels);
    for voxel in voxels {
        assert_eq!(found.next().expect("a value"), expected(voxel), "{voxel}");
    }
    assert_eq!(found.next(), None);
    let corner = |voxel: DVec3| voxel * scale + translation;
    assert_eq!(volume.bounds, Some([corner(low.as_dvec3() - 0.5), corner((low + volume.size.as_ivec3()).as_dvec3() - 0.5)]));
}

/// Densities with gaps and a tile. All of them are numbers of 16 bits.
fn smoke(voxel: IVec3) -> Vec<f32> {
    let IVec3 { x: i, y: j, z: k } = voxel;
    let is_in = |low: IVec3, high: IVec3| voxel.cmpge(low).all() && voxel.cmple(high).all();
    let has_voxel = is_in(IVec3::new(-3, 0, 0), IVec3::new(6, 5, 9)) && (i + j + k + 3) % 3 != 0;
    let has_tile = is_in(IVec3::splat(8), IVec3::splat(15));
    vec![if has_tile { 0.75 } else { f32::from(u8::from(has_voxel)) * (1 + i.abs() + 2 * j + 3 * k) as f32 / 64.0 }]
}

/// Each way of storing values gives the same ones, which lie at the corners of OpenVDB's lattice and are 0 around the active voxels.
#[test]
fn values_are_those_that_were_written() {
    let (low, translation) = (IVec3::new(-4, -1, -1), DVec3::new(0.5, 1.5, -2.0));
    for file in ["blosc.vdb", "zip.vdb", "mask.vdb", "full.vdb", "blocks.vdb", "half.vdb"] {
        let volume = density(file, None);
        assert_eq!((volume.size, volume.channels), (UVec3::new(21, 18, 18), 1), "{file}");
        let (scale, translation) = if file == "half.vdb" { (1.0, DVec3::ZERO) } else { (0.25, translation) };
        assert_values(&volume, low, DVec3::splat(scale), translation, smoke);
    }
    // Numbers of 64 bits, in voxels that are no cubes; and a grid with the tree of another one.
    assert_values(&density("more.vdb", Some("density")), low, DVec3::new(0.5, 1.0, 2.0), DVec3::ZERO, smoke);
    assert_values(&density("blosc.vdb", Some("copy")), low, DVec3::splat(0.5), DVec3::ZERO, smoke);
}

/// Inactive voxels keep their values, of which a file stores none, one, two or all, wherever they are; and large tiles are whole.
#[test]
fn inactive_voxels_and_tiles_have_their_values() {
    let inactive = |voxel: IVec3| {
        let IVec3 { x, y: j, z: k } = voxel;
        if voxel.min_element() < 0 || x >= 40 || j >= 8 || k >= 8 {
            return vec![0.0];
        }
        let (leaf, i) = (x / 8, x % 8);
        let is_odd = k % 2 == 1;
        let values = [0.0, 0.5, if is_odd { 0.5 } else { 0.0 }, if is_odd { 0.25 } else { 0.5 }, (i + 8 * j + 64 * k) as f32 / 512.0];
        vec![if i == j { (1 + leaf) as f32 } else { values[leaf as usize] }]
    };
    for file in ["more.vdb", "half.vdb"] {
        assert_values(&density(file, Some("inactive")), IVec3::NEG_ONE, DVec3::ONE, DVec3::ZERO, inactive);
    }
    assert_values(&density("odd.vdb", Some("loose")), IVec3::NEG_ONE, DVec3::ONE, DVec3::ZERO, |voxel| {
        let is_at = |x: i32| voxel == IVec3::new(x, 0, 0);
        let has_tile = voxel.cmpge(IVec3::new(8, 0, 0)).all() && voxel.cmplt(IVec3::new(16, 8, 8)).all();
        vec![if is_at(0) {
            1.0
        } else if is_at(5) {
            3.0
        } else if has_tile {
            2.0
        } else {
            0.0
        }]
    });
    let block = density("more.vdb", Some("block"));
    assert_values(&block, IVec3::NEG_ONE, DVec3::ONE, DVec3::ZERO, |voxel| {
        vec![if voxel.min_element() >= 0 && voxel.max_element() < 128 { 0.5 } else { 0.0 }]
    });
}

/// A colour has a box of its own, or is given in that of the density.
#[test]
fn colors_are_given_where_the_density_is() {
    let flame = |voxel: IVec3| {
        let has_voxel = voxel.min_element() >= 0 && voxel.max_element() <= 2;
        if has_voxel { vec![voxel.x as f32 / 8.0, voxel.y as f32 / 4.0, voxel.z as f32 * 3.0 / 8.0] } else { vec![0.0; 3] }
    };
    let (scale, translation) = (DVec3::splat(0.25), DVec3::new(0.5, 1.5, -2.0));
    let wanted = request(Quantity::Emission, Some("flame"));
    assert_values(&load("blosc.vdb", wanted).expect("a colour"), IVec3::NEG_ONE, scale, translation, flame);
    let around = density("blosc.vdb", None);
    let within = load("blosc.vdb", Request { bounds: around.bounds, ..wanted }).expect("a colour");
    assert_eq!(within.size, around.size);
    assert_values(&within, IVec3::new(-4, -1, -1), scale, translation, flame);
    assert_values(&load("half.vdb", wanted).expect("a colour"), IVec3::NEG_ONE, scale, translation, flame);
    // A box between the voxels is not that of any of them.
    let shifted = around.bounds.map(|bounds| bounds.map(|corner| corner + 0.1));
    let refused = load("blosc.vdb", Request { bounds: shifted, ..wanted }).expect_err("no such voxels").to_string();
    assert!(refused.contains("\"flame\" has no voxels that fill the box of the density"), "{refused}");
}

/// Moving the box of a density moves its colours too.
#[test]
fn colors_move_with_the_box_of_the_density() {
    let [low, high] = density("blosc.vdb", None).bounds.expect("a box").map(|corner| corner.to_array());
    let file = folder().join("blosc.vdb");
    let plain = json!({"type": "grid", "file": file});
    let placed = json!({"type": "grid", "file": file, "bounds": {"low": low, "high": high}});
    let pictures = [plain, placed].map(|density| {
        picture_of(&json!({"type": "heterogeneous", "absorption": 2, "scattering": 1, "emission": 3, "density": density,
            "emission_grid": {"file": file, "grid": "flame"}}))
    });
    assert!(pictures[0] == pictures[1], "the box is that of the file");
}

/// What is no fog volume, or cannot be told apart, is refused with its reason.
#[test]
fn other_grids_are_refused() {
    let density = |grid| request(Quantity::Density, grid);
    for (file, wanted, expected) in [
        ("odd.vdb", density(Some("distance")), "\"distance\" is a level set"),
        ("odd.vdb", density(Some("haze")), "\"haze\" has the background [0.5]"),
        ("odd.vdb", density(Some("empty")), "\"empty\" has no values but the background"),
        ("odd.vdb", density(Some("turned")), "a turned grid"),
        ("odd.vdb", density(Some("count")), "\"count\" is of type \"Tree_int32_5_4_3\""),
        ("odd.vdb", density(Some("velocity")), "\"velocity\" has three channels: expected one channel, the density"),
        ("odd.vdb", density(Some("far")), "a grid of 100003 × 100003 × 100003 values, at most"),
        ("odd.vdb", density(Some("sparse")), "has a box of 1003 × 1003 × 1003 voxels: at most"),
        ("odd.vdb", density(Some("beyond")), "a node at voxel [1073741824, 1073741824, 1073741824]"),
        ("odd.vdb", density(Some("twin")), "\"twin[0]\", \"twin[1]\": say which one by \"grid\""),
        ("odd.vdb", density(None), "the file has the grids \"distance\", \"haze\""),
        ("odd.vdb", density(Some("smoke")), "no grid \"smoke\": the file has the grids \"distance\""),
        ("blosc.vdb", request(Quantity::Albedo, None), "say which one by \"grid\""),
        ("blosc.vdb", Request { values_at: ValuesAt::Corners, ..density(None) }, "leave \"values_at\" out"),
        ("blosc.vdb", Request { size: Some(UVec3::ONE), ..density(None) }, "the file has 21 × 18 × 18 values, and \"size\" says otherwise"),
        ("make.cc", density(Some("density")), "\"grid\" is for OpenVDB files"),
    ] {
        let error = load(file, wanted).err().unwrap_or_else(|| panic!("{file}, {wanted:?}: accepted"));
        let said = error.to_string();
        assert!(said.contains(expected) && said.contains(file), "{said}");
    }
}

/// A file that was cut, or of which some bytes are others, is read or refused.
#[test]
fn damaged_files_are_answered() {
    for file in ["blocks.vdb", "zip.vdb", "half.vdb"] {
        let content = fs::read(folder().join(file)).expect("a file of this folder");
        let answer = |content: &[u8]| read(content, file, request(Quantity::Density, Some("density")));
        for end in (0..content.len()).step_by(101) {
            // Only what follows the grid may be missing.
            assert!(answer(&content[..end]).is_err() || end > content.len() / 4, "{file} up to byte {end}");
        }
        for (place, by) in (0..content.len()).step_by(17).zip([0xff, 0x01, 0x80, 0x10].into_iter().cycle()) {
            let mut changed = content.clone();
            changed[place] ^= by;
            if let Err(error) = answer(&changed) {
                assert!(matches!(error, Error::Invalid(_) | Error::Limit(_)), "{file}, byte {place}: {error}");
            }
        }
    }
}

/// Descriptors that lead back to themselves end: such a file would take all memory.
#[test]
fn descriptors_cannot_lead_back() {
    let start =
        [&[0x20, 0x42, 0x44, 0x56, 0, 0, 0, 0, 224, 0, 0, 0, 10, 0, 0, 0, 0, 0, 0, 0, 1][..], &[b'0'; 36], &[0; 4], &[0xff; 4]].concat();
    let places = [0u64, 0, start.len() as u64].map(u64::to_le_bytes).concat();
    let file = [&start[..], &[0; 12], &places].concat();
    let refused = read(&file, "loop.vdb", request(Quantity::Density, None)).expect_err("no grid").to_string();
    assert!(refused.contains("ends before it begins"), "{refused}");
}

/// Bits of the picture of a medium in a box, in front of a background.
fn picture_of(medium: &Value) -> Vec<u32> {
    let scene = json!({"pt": 1, "camera": {"look_at": {"from": [1.5, 2.5, 9], "to": [1.5, 2.5, 0]}, "fov": 50},
        "film": {"width": 16, "height": 16}, "sampler": {"spp": 4}, "background": {"radiance": 1},
        "shapes": [{"type": "box", "size": 12, "medium": medium}]});
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("s.json"), scene.to_string()).expect("written");
    let mut program = Command::cargo_bin("pt").expect("the program");
    program.current_dir(folder.path()).args(["s.json", "--allow-outside", "-o", "s.exr"]).assert().success();
    let picture = pt::output::exr::read(&folder.path().join("s.exr")).expect("a picture").0;
    let bits: Vec<u32> = picture.pixels().flatten().map(f32::to_bits).collect();
    assert!(bits.iter().any(|other| *other != bits[0]), "something is seen");
    bits
}

/// The picture of a file is that of the same numbers in the scene, to the last bit.
#[test]
fn pictures_are_those_of_the_numbers() {
    let volume = density("zip.vdb", None);
    let [low, high] = volume.bounds.expect("a box").map(|corner| corner.to_array());
    let size = volume.size.to_array();
    let numbers = json!({"type": "grid", "size": size, "values": volume.values, "bounds": {"low": low, "high": high}});
    let pictures = [json!({"type": "grid", "file": folder().join("zip.vdb")}), numbers]
        .map(|density| picture_of(&json!({"type": "heterogeneous", "absorption": 1, "scattering": 2, "density": density})));
    assert!(pictures[0] == pictures[1]);
}
