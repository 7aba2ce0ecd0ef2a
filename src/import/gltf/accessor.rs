//! Accessors: rows of numbers in buffers. In a sparse accessor some rows are replaced.

use gltf::accessor::{DataType, Dimensions, sparse::IndexType};

use super::document::Document;
use crate::import::json_cursor::JsonCursor;

/// Greatest number of rows of an accessor that has no bytes in a buffer, whose rows are all zero. No real file has more.
const MOST_ZEROS: usize = 1 << 24;

impl Document<'_> {
    /// Rows of an accessor, each with `N` components; `None` with a fault noted.
    ///
    /// - integers that are `normalized` are mapped to 0 … 1 or −1 … 1
    pub fn rows<const N: usize>(&self, accessor: &gltf::Accessor) -> Option<Vec<[f32; N]>> {
        let at = self.item("accessors", accessor.index());
        if accessor.dimensions().multiplicity() != N {
            at.fault(format!("expected rows of {N} numbers, found {}", accessor.dimensions().multiplicity()));
            return None;
        }
        let (kind, normalized) = (accessor.data_type(), accessor.normalized());
        self.each(accessor, &at, |row| std::array::from_fn(|k| component(row, k, kind, normalized)))
    }

    /// Whole numbers of an accessor; `None`, with a fault noted, if it has no such numbers.
    pub fn indices(&self, accessor: &gltf::Accessor) -> Option<Vec<u32>> {
        let at = self.item("accessors", accessor.index());
        if accessor.dimensions() != Dimensions::Scalar {
            at.fault("expected single numbers");
            return None;
        }
        let whole = match accessor.data_type() {
            DataType::U8 => |row: &[u8]| u32::from(row[0]),
            DataType::U16 => |row: &[u8]| u32::from(u16::from_le_bytes([row[0], row[1]])),
            DataType::U32 => |row: &[u8]| u32::from_le_bytes([row[0], row[1], row[2], row[3]]),
            _ => {
                at.fault("expected whole numbers of 8, 16 or 32 bits");
                return None;
            }
        };
        self.each(accessor, &at, whole)
    }

    /// Results of `read` for the bytes of each row.
    fn each<T>(&self, accessor: &gltf::Accessor, at: &JsonCursor, read: impl Fn(&[u8]) -> T) -> Option<Vec<T>> {
        let size = accessor.size();
        let rows = Rows { count: accessor.count(), offset: accessor.offset(), size };
        let mut values: Vec<T> = match accessor.view() {
            Some(view) => self.bytes(rows, &view, at)?.map(&read).collect(),
            None if rows.count <= MOST_ZEROS => (0..rows.count).map(|_| read(&vec![0; size])).collect(),
            None => {
                at.fault(format!("{} rows without bytes, expected at most {MOST_ZEROS}", rows.count));
                return None;
            }
        };
        if let Some(sparse) = accessor.sparse() {
            let (indices, replaced) = (sparse.indices(), sparse.values());
            let width = match indices.index_type() {
                IndexType::U8 => 1,
                IndexType::U16 => 2,
                IndexType::U32 => 4,
            };
            let places = self.bytes(Rows { count: sparse.count(), offset: indices.offset(), size: width }, &indices.view(), at)?;
            let replacements = self.bytes(Rows { count: sparse.count(), offset: replaced.offset(), size }, &replaced.view(), at)?;
            for (location, row) in places.zip(replacements) {
                let i = location.iter().rev().fold(0, |i, byte| i << 8 | usize::from(*byte));
                let Some(value) = values.get_mut(i) else {
                    at.fault(format!("a sparse row {i}, but there are {}", rows.count));
                    return None;
                };
                *value = read(row);
            }
        }
        Some(values)
    }

    /// Bytes of each row; `None` with a fault noted if they extend beyond their view.
    fn bytes(&self, rows: Rows, view: &gltf::buffer::View, at: &JsonCursor) -> Option<impl Iterator<Item = &[u8]> + use<'_>> {
        let stride = view.stride().unwrap_or(rows.size);
        if stride < rows.size {
            at.fault(format!("rows of {} bytes, {stride} bytes apart", rows.size));
            return None;
        }
        let reach = || {
            let before_last = rows.count.checked_sub(1)?.checked_mul(stride)?;
            before_last.checked_add(rows.size)?.checked_add(rows.offset)
        };
        let end = if rows.count == 0 { Some(0) } else { reach() };
        let Some(bytes) = self.buffers.view(view).filter(|bytes| end.is_some_and(|end| end <= bytes.len())) else {
            at.fault(format!("{} rows of {} bytes reach beyond bufferView {}", rows.count, rows.size, view.index()));
            return None;
        };
        let start = move |i: usize| rows.offset + i * stride;
        Some((0..rows.count).map(move |i| &bytes[start(i)..start(i) + rows.size]))
    }
}

/// Layout of rows within a view.
#[derive(Clone, Copy)]
struct Rows {
    count: usize,
    offset: usize,
    size: usize,
}

/// Value of a component. Source: glTF 2.0, §3.11: c / 255, max(c / 127, −1), …
fn component(row: &[u8], k: usize, kind: DataType, normalized: bool) -> f32 {
    let bytes = &row[k * kind.size()..(k + 1) * kind.size()];
    let (value, most) = match kind {
        DataType::F32 => return f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
        DataType::I8 => (f64::from(bytes[0] as i8), f64::from(i8::MAX)),
        DataType::U8 => (f64::from(bytes[0]), f64::from(u8::MAX)),
        DataType::I16 => (f64::from(i16::from_le_bytes([bytes[0], bytes[1]])), f64::from(i16::MAX)),
        DataType::U16 => (f64::from(u16::from_le_bytes([bytes[0], bytes[1]])), f64::from(u16::MAX)),
        DataType::U32 => (f64::from(u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])), f64::from(u32::MAX)),
    };
    if normalized { (value / most).max(-1.0) as f32 } else { value as f32 }
}
