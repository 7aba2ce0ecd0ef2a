//! One row of a PLY file: a vertex, a face or another element that the header describes.

use ply_rs_bw::ply::{BeginList, ElementDef, Property, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType};

/// The number of numbers that a vertex may have.
const COUNT: usize = 21;

/// The numbers that a vertex may have, each with the property names for it. The last nine are those of instances.
const SLOTS: [&[&str]; COUNT] = [
    &["x"],
    &["y"],
    &["z"],
    &["nx"],
    &["ny"],
    &["nz"],
    &["u", "s", "texture_u"],
    &["v", "t", "texture_v"],
    &["red", "r", "diffuse_red"],
    &["green", "g", "diffuse_green"],
    &["blue", "b", "diffuse_blue"],
    &["alpha", "a"],
    &["qx"],
    &["qy"],
    &["qz"],
    &["qw"],
    &["scale"],
    &["scale_x"],
    &["scale_y"],
    &["scale_z"],
    &["material"],
];

/// The values of a row that are used. Others (such as `confidence`) are skipped.
#[derive(Default)]
pub struct Row {
    /// Position, normal, texture coordinates, colour and opacity, and the numbers of an instance, in the order of `SLOTS`.
    pub numbers: [f32; COUNT],
    signed: Vec<i32>,
    unsigned: Vec<u32>,
}

impl Row {
    /// The position, in metres.
    pub fn position(&self) -> [f32; 3] {
        [self.numbers[0], self.numbers[1], self.numbers[2]]
    }

    /// The normal as the file has it, of any length.
    pub fn normal(&self) -> [f32; 3] {
        [self.numbers[3], self.numbers[4], self.numbers[5]]
    }

    /// The texture coordinates.
    pub fn uv(&self) -> [f32; 2] {
        [self.numbers[6], self.numbers[7]]
    }

    /// Red, green, blue and opacity, as the file has them.
    pub fn color(&self) -> [f32; 4] {
        [self.numbers[8], self.numbers[9], self.numbers[10], self.numbers[11]]
    }

    /// The rotation of an instance, as the quaternion x, y, z, w of any length.
    pub fn rotation(&self) -> [f32; 4] {
        [self.numbers[12], self.numbers[13], self.numbers[14], self.numbers[15]]
    }

    /// The scale of an instance, the same along all axes.
    pub fn uniform_scale(&self) -> f32 {
        self.numbers[16]
    }

    /// The scale of an instance along each axis.
    pub fn scale(&self) -> [f32; 3] {
        [self.numbers[17], self.numbers[18], self.numbers[19]]
    }

    /// The number of an instance's material.
    pub fn material(&self) -> f32 {
        self.numbers[20]
    }

    /// The indices of a face's corners.
    pub fn indices(&self) -> impl ExactSizeIterator<Item = i64> {
        // One of the two is empty, but an exact size needs one iterator.
        let count = self.signed.len() + self.unsigned.len();
        (0..count).map(|i| self.unsigned.get(i).map_or_else(|| i64::from(self.signed[i]), |&index| i64::from(index)))
    }

    /// Parses the line of an ASCII element. ply-rs-bw is not used here, because it refuses `.5` and `1.`, and its messages do not name
    /// the property.
    pub fn from_line(line: &str, element: &ElementDef) -> Result<Row, String> {
        let mut row = Row::default();
        let mut words = line.split_ascii_whitespace();
        for (name, property) in &element.properties {
            let word = words.next().ok_or_else(|| format!("{name} is missing"))?;
            let expected = |what: &str| format!("{name}: expected {what}, found {}", word.chars().take(40).collect::<String>());
            match property.data_type {
                PropertyType::Scalar(_) => {
                    let value = word.parse().map_err(|_| expected("a number"))?;
                    slot(name).into_iter().for_each(|i| row.numbers[i] = value);
                }
                PropertyType::List(..) => {
                    let count: usize = word.parse().map_err(|_| expected("a count"))?;
                    for i in 0..count {
                        let word = words.next().ok_or_else(|| format!("{name}: {count} values promised, only {i} there"))?;
                        if is_indices(name) {
                            row.unsigned.push(word.parse().map_err(|_| format!("{name}: expected a vertex index, found {word}"))?);
                        }
                    }
                }
            }
        }
        match words.next() {
            None => Ok(row),
            Some(_) => Err("more values than the header names".to_string()),
        }
    }
}

/// Whether the element has a property for each of the `SLOTS`.
pub fn slots(element: &ElementDef) -> [bool; COUNT] {
    let has = |name: &&str| matches!(element.properties.get(*name).map(|p| &p.data_type), Some(PropertyType::Scalar(_)));
    SLOTS.map(|names| names.iter().any(has))
}

/// The largest value of an integer colour channel, which is encoded in sRGB; `None` for floats, which are linear values from 0 to 1.
pub fn full_channel(element: &ElementDef) -> Option<f32> {
    let scalar = SLOTS[8].iter().find_map(|name| match &element.properties.get(*name)?.data_type {
        PropertyType::Scalar(scalar) => Some(scalar),
        PropertyType::List(..) => None,
    })?;
    match scalar {
        ScalarType::Float | ScalarType::Double => None,
        ScalarType::Short | ScalarType::UShort => Some(65535.0),
        _ => Some(255.0),
    }
}

/// Whether a property is the list of a face's corners.
pub fn is_indices(name: &str) -> bool {
    matches!(name, "vertex_indices" | "vertex_index")
}

fn slot(name: &str) -> Option<usize> {
    SLOTS.iter().position(|names| names.contains(&name))
}

impl PropertyAccess for Row {
    fn new() -> Row {
        Row::default()
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        if let (Some(slot), Some(number)) = (slot(name), value.to_f32_lossy()) {
            self.numbers[slot] = number;
            return PropertyAccessResult::Set;
        }
        match value {
            _ if !is_indices(name) => return PropertyAccessResult::Ignored,
            Property::ListChar(list) => self.signed = list.into_iter().map(i32::from).collect(),
            Property::ListShort(list) => self.signed = list.into_iter().map(i32::from).collect(),
            Property::ListUChar(list) => self.unsigned = list.into_iter().map(u32::from).collect(),
            Property::ListUShort(list) => self.unsigned = list.into_iter().map(u32::from).collect(),
            _ => return PropertyAccessResult::UnsupportedType,
        }
        PropertyAccessResult::Set
    }

    fn begin_list_int(&mut self, name: &str, _: usize) -> BeginList<'_, i32> {
        if is_indices(name) { BeginList::Fill(&mut self.signed) } else { BeginList::UseSetter }
    }

    fn begin_list_uint(&mut self, name: &str, _: usize) -> BeginList<'_, u32> {
        if is_indices(name) { BeginList::Fill(&mut self.unsigned) } else { BeginList::UseSetter }
    }
}

/// Whether a property is one of an instance's numbers.
pub fn is_slot_of_points(name: &str) -> bool {
    slot(name).is_some_and(|slot| !(3..12).contains(&slot))
}
