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
        let scene = wedge(AutoCamera { view: Some(view(name)), up: Some(up), ground: false }, &[]);
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
            let scene = wedge(AutoCamera { view: Some(view), up: Some(up), ground: false }, &[]);
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
            let auto_camera = AutoCamera { view: Some(view), up: None, ground: false };
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

/// If the command line adds a light, no default light is added.
#[test]
fn lights_from_the_command_line_replace_the_default_lights() {
    for (pointer, value) in [("/background", r#"{"radiance": 0.5}"#), ("/lights", r#"[{"type":"point","position":[0,9,0],"intensity":1}]"#)]
    {
        let scene = wedge(AutoCamera::default(), &[(pointer, value)]);
        assert!(!scene.notes_say("no light"), "{:?}", scene.notes);
        assert_eq!(scene.at("/shapes").as_array().map(Vec::len), Some(1));
    }
}

/// The ground lies just below the lowest vertex, along the axis that points up, and faces upwards.
#[test]
fn the_ground_is_below_everything() {
    for (up, axis, lowest) in [(Up::Y, DVec3::Y, -1.0), (Up::Z, DVec3::Z, -0.5)] {
        let built = wedge(AutoCamera { up: Some(up), view: None, ground: true }, &[]).built();
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
    let scene = try_read_with(&path, AutoCamera { ground: true, ..AutoCamera::default() }, &[]).unwrap_or_else(|e| panic!("{e}"));
    assert!(scene.notes_say("--view, --up and --ground are for models"), "{:?}", scene.notes);
    assert_eq!(scene.at("/shapes").as_array().map(Vec::len), Some(0));
}
