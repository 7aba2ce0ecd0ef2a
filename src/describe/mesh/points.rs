//! Points of instances, from PLY files.

use std::io::{BufRead, Seek};

use glam::{DMat4, DQuat, DVec4};

use super::ply::opened;
use super::ply_row::{is_slot_of_points, slots};
use crate::format::check_volume;
use crate::{Error, Fault, Result};

/// The place of one instance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InstancePoint {
    /// The position, in metres.
    pub position: [f32; 3],
    /// The rotation as the quaternion x, y, z, w of any length above 0.
    pub rotation: [f32; 4],
    /// The scale along each axis.
    pub scale: [f32; 3],
    /// The number of the material; 0 where the file has none.
    pub material: u32,
}

/// The largest number of points in a file.
pub const MAX_POINTS: usize = 1 << 24;

impl InstancePoint {
    /// The matrix that scales, then rotates, then moves.
    pub fn matrix(&self) -> DMat4 {
        let rotation = DQuat::from_vec4(DVec4::from(self.rotation.map(f64::from)).normalize());
        DMat4::from_scale_rotation_translation(self.scale.map(f64::from).into(), rotation, self.position.map(f64::from).into())
    }
}

/// Reads the points of a PLY file: its element `vertex` with `x y z`, optionally `qx qy qz qw`, `scale` or `scale_x scale_y scale_z`,
/// and `material`. Returns them with warnings, which are sentences that begin with `name`.
///
/// # Errors
/// [`Error::Invalid`] with the line (ASCII) or the element's number; [`Error::Limit`] beyond [`MAX_POINTS`]; [`Error::Io`] where the
/// source cannot be read.
pub fn read(mut source: impl BufRead + Seek, name: &str) -> Result<(Vec<InstancePoint>, Vec<String>)> {
    let (header, mut body) = opened(&mut source, name, &["vertex"])?;
    let vertex = &header.elements["vertex"];
    if vertex.count > MAX_POINTS {
        return Err(Error::Limit(Fault::new(format!("{} points, at most {MAX_POINTS} are possible", vertex.count)).in_file(name)));
    }
    let has = slots(vertex);
    let (has_rotation, has_uniform, has_scale, has_material) = (&has[12..16], has[16], &has[17..20], has[20]);
    for (slots, names) in [(has_rotation, "qx qy qz qw"), (has_scale, "scale_x scale_y scale_z")] {
        if slots.contains(&true) && slots.contains(&false) {
            return Err(Error::invalid(Fault::new(format!("vertex has some of {names}, expected all or none")).in_file(name)));
        }
    }
    if has_uniform && has_scale[0] {
        return Err(Error::invalid(Fault::new("vertex has scale and scale_x, expected one of them").in_file(name)));
    }
    let (has_rotation, has_scale) = (has_rotation[0], has_scale[0]);
    let mut points = Vec::with_capacity(vertex.count);
    for element in header.elements.values() {
        if element.name != "vertex" {
            body.read_rows(element, |_| Ok(()))?;
            continue;
        }
        body.read_rows(element, |row| {
            let point = InstancePoint {
                position: row.position(),
                rotation: if has_rotation { row.rotation() } else { [0.0, 0.0, 0.0, 1.0] },
                scale: if has_scale { row.scale() } else { [if has_uniform { row.uniform_scale() } else { 1.0 }; 3] },
                material: if has_material { whole(row.material())? } else { 0 },
            };
            checked(&point).map(|()| points.push(point))
        })?;
    }
    let mut warnings = vec![];
    let unused: Vec<&str> = vertex.properties.keys().map(String::as_str).filter(|property| !is_slot_of_points(property)).collect();
    if !unused.is_empty() {
        warnings.push(format!("{name}: instances have no property {}: left out", unused.join(", ")));
    }
    if body.has_more().map_err(|e| Error::io(name, e))? {
        warnings.push(format!("{name}: data after the last element ignored"));
    }
    Ok((points, warnings))
}

/// Converts the number of a material.
fn whole(number: f32) -> Result<u32, String> {
    let is_whole = (0.0..=16_777_216.0).contains(&number) && number.fract() == 0.0;
    if is_whole { Ok(number as u32) } else { Err(format!("material: expected a whole number from 0, found {number}")) }
}

/// Checks that a point makes a transform with an inverse.
fn checked(point: &InstancePoint) -> Result<(), String> {
    let named = |key: &str, values: &[f32]| match values.iter().find(|value| !value.is_finite()) {
        Some(value) => Err(format!("{key} is not a finite f32 ({value})")),
        None => Ok(()),
    };
    named("position", &point.position)?;
    named("rotation", &point.rotation)?;
    named("scale", &point.scale)?;
    if point.rotation == [0.0; 4] {
        return Err("a quaternion of length 0 is no rotation".into());
    }
    if point.scale.contains(&0.0) {
        return Err("a scale of 0 makes the instance flat, expected other numbers".into());
    }
    check_volume(point.scale.map(f64::from).iter().product()).map_err(|message| format!("scale: {message}"))
}

/// The points as a binary PLY file, which [`read`] reads back.
pub fn ply_binary(points: &[InstancePoint]) -> Vec<u8> {
    let names = ["x", "y", "z", "qx", "qy", "qz", "qw", "scale_x", "scale_y", "scale_z", "material"];
    let properties: String = names.iter().map(|name| format!("property float {name}\n")).collect();
    let count = points.len();
    let mut bytes = format!("ply\nformat binary_little_endian 1.0\nelement vertex {count}\n{properties}end_header\n").into_bytes();
    for InstancePoint { position, rotation, scale, material } in points {
        let numbers = position.iter().chain(rotation).chain(scale).copied().chain([*material as f32]);
        numbers.for_each(|number| bytes.extend(number.to_le_bytes()));
    }
    bytes
}
