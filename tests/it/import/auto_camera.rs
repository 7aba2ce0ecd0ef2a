//! The automatic camera of models: everything is visible from the requested side, and lit from behind the camera.

use std::f64::consts::PI;
use std::fs;

use glam::DVec3;
use pt::import::{AutoCamera, Up, Viewpoint};

use super::read::{Read, assert_near, met, try_read_with};

/// A wedge that is widest in x and narrowest in z.
const WEDGE: &str = "v -4 -1 0.5\nv 4 -1 0\nv 0 2 1\nv 0 0 -0.5\nf 1 2 3\nf 1 3 4\n";
const VERTICES: [[f64; 3]; 4] = [[-4.0, -1.0, 0.5], [4.0, -1.0, 0.0], [0.0, 2.0, 1.0], [0.0, 0.0, -0.5]];

fn wedge(auto_camera: AutoCamera, overrides: &[(&str, &str)]) -> Read {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("wedge.obj"), WEDGE).expect("a file");
    let mut read = try_read_with(&folder.path().join("wedge.obj"), auto_camera, overrides).unwrap_or_else(|e| panic!("{e}"));
    read.files.made.insert("wedge.obj".into(), WEDGE.as_bytes().to_vec());
    read
}

fn view(name: &str) -> Viewpoint {
    Viewpoint::ALL.into_iter().find(|view| view.name == name).expect("a view")
}

/// The camera's place, and the axes right, up and back of its picture, by the rules of `look_at`.
fn camera(scene: &Read) -> (DVec3, [DVec3; 3]) {
    let vector = |key: &str| DVec3::from_slice(&scene.numbers(&format!("/camera/look_at/{key}")));
    let up = if scene.at("/camera/look_at").get("up").is_some() { vector("up") } else { DVec3::Y };
    let back = (vector("from") - vector("to")).normalize();
    let right = up.cross(back).normalize();
    (vector("from"), [right, back.cross(right), back])
}

/// Directions to the camera and up in the picture, in the file's axes: y up and z to the front, or z up and y to the back as in modelling
/// programs.
#[test]
fn views_show_the_sides_that_they_name() {
    let sides: [(&str, Up, [f64; 3], [f64; 3]); 12] = [
        ("front", Up::Y, [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]),
        ("back", Up::Y, [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]),
        ("left", Up::Y, [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
        ("right", Up::Y, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
        ("top", Up::Y, [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]),
        ("bottom", Up::Y, [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]),
        ("front", Up::Z, [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]),
        ("back", Up::Z, [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]),
        ("left", Up::Z, [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
        ("right", Up::Z, [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
        ("top", Up::Z, [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]),
        ("bottom", Up::Z, [0.0, 0.0, -1.0], [0.0, -1.0, 0.0]),
    ];
    for (name, up, towards, upwards) in sides {
        let scene = wedge(AutoCamera { view: Some(view(name)), up: Some(up), ..AutoCamera::default() }, &[]);
        let (_, [_, above, back]) = camera(&scene);
        assert_near(&back.to_array(), &towards, 1e-12, &format!("{name}, {up:?}: to the camera"));
        assert_near(&above.to_array(), &upwards, 1e-12, &format!("{name}, {up:?}: up"));
        scene.built();
    }
}

/// From every side, everything is within the middle 9/10 of the picture, and something reaches its border.
#[test]
fn everything_is_seen_from_every_side() {
    for view in Viewpoint::ALL {
        for up in [Up::Y, Up::Z] {
            let scene = wedge(AutoCamera { view: Some(view), up: Some(up), ..AutoCamera::default() }, &[]);
            let (from, [right, above, back]) = camera(&scene);
            let tan = (scene.number("/camera/fov").to_radians() / 2.0).tan();
            let aspect = scene.number("/film/width") / scene.number("/film/height");
            let reach = VERTICES.map(|p| {
                let d = DVec3::from(p) - from;
                let [x, y] = [d.dot(right) / aspect, d.dot(above)].map(|side| (side / (tan * -d.dot(back))).abs());
                x.max(y)
            });
            let farthest = reach.into_iter().fold(0.0, f64::max);
            assert!((farthest - 0.9).abs() < 1e-6, "{}, {up:?}: {farthest}", view.name);
        }
    }
}

/// The disk of the key light lies behind the camera, for every position of the camera, and gives the middle the documented irradiance.
#[test]
fn no_picture_shows_the_key_light() {
    let (low, high) = (DVec3::new(-4.0, -1.0, -0.5), DVec3::new(4.0, 2.0, 1.0));
    let middle = 0.5 * (low + high);
    let cameras =
        ["", r#"{"from":[0,0,30],"to":[0,0,0]}"#, r#"{"from":[-900,20,0],"to":[0,0,0]}"#, r#"{"from":[0,9,0],"to":[0,0,0],"up":[0,0,1]}"#];
    for look_at in cameras {
        let overrides = [("/camera/look_at", look_at)];
        for view in Viewpoint::ALL {
            let auto_camera = AutoCamera { view: Some(view), studio: true, ground: Some(false), ..AutoCamera::default() };
            let scene = wedge(auto_camera, if look_at.is_empty() { &[] } else { &overrides });
            assert_eq!(scene.notes_say("no camera"), look_at.is_empty(), "{look_at}: {:?}", scene.notes);
            let (eye, [.., back]) = camera(&scene);
            let lamp = DVec3::from_slice(&scene.numbers("/shapes/1/transform/1/look_at/from"));
            let radius = scene.number("/shapes/1/radius");
            let axis = (lamp - middle).normalize();
            // Distance of the nearest point of the disk behind the plane of the camera.
            let behind = (lamp - eye).dot(back) - radius * (1.0 - axis.dot(back).powi(2)).sqrt();
            assert!(behind > 0.0, "{look_at}, {}: {behind}", view.name);
            let sin2 = radius * radius / (radius * radius + (lamp - middle).length_squared());
            assert_near(&[PI * scene.number("/shapes/1/emission") * sin2], &[2.5], 1e-9, "irradiance");
            let built = scene.built();
            let half_way = 0.5 * (middle + lamp);
            let emitted = met(&built, half_way.to_array(), axis.as_vec3().to_array(), |s, _| s.emitted(-axis.as_vec3()).to_rgb()[0]);
            assert!(emitted > 0.0, "{look_at}, {}: the disk faces the model", view.name);
        }
    }
}

/// A model without light gets a sky whose sun stands to the left of the camera, and behind it or above, from every side and with every
/// axis up, and a ground unless the camera looks from below.
#[test]
fn models_without_light_get_a_sky_and_its_sun_is_behind_the_camera() {
    let cameras = [
        ("", Up::Y),
        ("", Up::Z),
        (r#"{"from":[0,0.5,30],"to":[0,0,0.2]}"#, Up::Y),
        (r#"{"from":[-900,20,5],"to":[0,0,0]}"#, Up::Y),
        (r#"{"from":[-900,20,5],"to":[0,0,0],"up":[0,0,1]}"#, Up::Z),
    ];
    for ((look_at, up), view) in cameras.into_iter().flat_map(|camera| Viewpoint::ALL.map(|view| (camera, view))) {
        let overrides = [("/camera/look_at", look_at)];
        let auto_camera = AutoCamera { view: Some(view), up: Some(up), ..AutoCamera::default() };
        let scene = wedge(auto_camera, if look_at.is_empty() { &[] } else { &overrides });
        assert!(scene.notes_say("no light: a clear sky was added"), "{:?}", scene.notes);
        let azimuth = scene.number("/background/sky/azimuth").to_radians();
        let level = DVec3::new(azimuth.sin(), 0.0, -azimuth.cos());
        let towards = if up == Up::Y { level } else { DVec3::new(level.x, -level.z, 0.0) };
        let (_, [right, above, back]) = camera(&scene);
        // For a camera that looks straight down or up, "behind" is no side.
        let is_steep = above.dot(if up == Up::Y { DVec3::Y } else { DVec3::Z }).abs() < 0.5;
        let case = format!("{look_at} {} {up:?}: {towards}", view.name);
        assert!(towards.dot(right) < -0.5, "{case}");
        assert!(is_steep || towards.dot(back) > 0.2, "{case}");
        let grounds = if view.name == "bottom" { 0 } else { 1 };
        assert_eq!(scene.at("/shapes").as_array().map(Vec::len), Some(1 + grounds), "{case}");
    }
}

/// What the scene or the command line says about the sun stays.
#[test]
fn a_stated_azimuth_stays() {
    let scene = wedge(AutoCamera::default(), &[("/background", r#"{"sky": {"azimuth": 7}}"#)]);
    assert_eq!(scene.number("/background/sky/azimuth"), 7.0);
    assert_eq!(scene.at("/shapes").as_array().map(Vec::len), Some(2), "a ground under a sky that was asked for");
    let albedo = serde_json::to_value(pt::describe::Sky::default()).expect("JSON")["ground"].clone();
    assert_eq!(scene.at("/shapes/1/material/albedo"), &albedo, "the ground meets the ground of the sky without an edge");
    let scene = wedge(AutoCamera { ground: Some(false), ..AutoCamera::default() }, &[]);
    assert_eq!(scene.at("/shapes").as_array().map(Vec::len), Some(1));
}

/// Each lamp of the studio gives the middle its irradiance: key, fill and rim.
#[test]
fn a_studio_has_three_lamps() {
    let scene = wedge(AutoCamera { studio: true, ..AutoCamera::default() }, &[]);
    assert!(scene.notes_say("that of a studio"), "{:?}", scene.notes);
    assert_eq!(scene.at("/shapes").as_array().map(Vec::len), Some(5), "the model, the ground and the lamps");
    for (lamp, irradiance) in [(2, 2.5), (3, 0.6), (4, 1.5)] {
        let [from, to] = ["from", "to"].map(|key| DVec3::from_slice(&scene.numbers(&format!("/shapes/{lamp}/transform/1/look_at/{key}"))));
        let radius2 = scene.number(&format!("/shapes/{lamp}/radius")).powi(2);
        let sin2 = radius2 / (radius2 + (from - to).length_squared());
        assert_near(&[PI * scene.number(&format!("/shapes/{lamp}/emission")) * sin2], &[irradiance], 1e-9, "irradiance");
    }
}

/// If the command line adds a light, no default light is added.
#[test]
fn lights_from_the_command_line_replace_the_default_lights() {
    for (pointer, value) in [("/background", r#"{"radiance": 0.5}"#), ("/lights", r#"[{"type":"point","position":[0,9,0],"intensity":1}]"#)]
    {
        let scene = wedge(AutoCamera::default(), &[(pointer, value)]);
        assert!(!scene.notes_say("no light"), "{:?}", scene.notes);
        assert_eq!(scene.at("/shapes").as_array().map(Vec::len), Some(1), "no lamp, and no ground");
    }
}

/// The ground lies just below the lowest vertex, along the axis that points up, and faces upwards.
#[test]
fn the_ground_is_below_everything() {
    for (up, axis, lowest) in [(Up::Y, DVec3::Y, -1.0), (Up::Z, DVec3::Z, -0.5)] {
        let built = wedge(AutoCamera { up: Some(up), ground: Some(true), ..AutoCamera::default() }, &[]).built();
        let beside = DVec3::splat(9.0) * (DVec3::ONE - axis);
        met(&built, (beside + 2.0 * axis).to_array(), (-axis).as_vec3().to_array(), |surface, p| {
            let gap = lowest - p.dot(axis);
            assert!(gap > 0.0 && gap < 0.01, "{up:?}: {gap}");
            assert_near(&surface.point.ng.as_dvec3().to_array(), &axis.to_array(), 1e-6, "its normal");
            assert!(surface.emission.is_none());
        });
    }
}

/// Scenes that have a camera and light of their own are not framed, and a note says that the options have no effect.
#[test]
fn scenes_with_a_camera_are_not_framed() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("s.json");
    fs::write(&path, r#"{"pt": 1, "camera": {}, "shapes": []}"#).expect("a file");
    let scene = try_read_with(&path, AutoCamera { ground: Some(true), ..AutoCamera::default() }, &[]).unwrap_or_else(|e| panic!("{e}"));
    assert!(scene.notes_say("are for models"), "{:?}", scene.notes);
    assert_eq!(scene.at("/shapes").as_array().map(Vec::len), Some(0));
}
