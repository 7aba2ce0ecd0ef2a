//! Numbers, vectors and colours. A number, or an array with one, stands for as many as are needed.

use crate::import::json_cursor::JsonCursor;
use crate::reader::Node;

/// Reads `count` values; a single value is repeated. `None` with a fault noted.
pub fn several<'a>(cursor: &JsonCursor<'a>, count: usize) -> Option<Vec<JsonCursor<'a>>> {
    if cursor.is_number() {
        return Some(vec![cursor.clone(); count]);
    }
    let items = if cursor.is_array() { cursor.items()? } else { vec![] };
    match items.len() {
        1 => Some(vec![items[0].clone(); count]),
        n if n == count => Some(items),
        _ => {
            cursor.expected(&format!("a number, or an array of {count}"));
            None
        }
    }
}

/// Reads `N` numbers.
pub fn numbers<const N: usize>(cursor: &JsonCursor) -> Option<[f64; N]> {
    let values: Option<Vec<f64>> = several(cursor, N)?.iter().map(JsonCursor::number).collect();
    values?.try_into().ok()
}

/// Reads `count` values and makes an array of them.
pub fn vector(cursor: &JsonCursor, count: usize) -> Option<Node> {
    Some(cursor.make_array(several(cursor, count)?.iter().map(JsonCursor::same)))
}

/// Reads one value.
pub fn scalar(cursor: &JsonCursor) -> Option<Node> {
    several(cursor, 1).map(|values| values[0].same())
}

/// Reads a colour: one number for a grey, or red, green and blue.
pub fn color(cursor: &JsonCursor) -> Option<Node> {
    if cursor.is_number() { Some(cursor.same()) } else { vector(cursor, 3) }
}
