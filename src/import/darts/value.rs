//! Numbers, vectors and colours: a number or an array of one stands for as many as are wanted.

use crate::import::view::View;
use crate::reader::Node;

/// `count` values; one is repeated.
pub fn several<'a>(view: &View<'a>, count: usize) -> Option<Vec<View<'a>>> {
    if view.is_number() {
        return Some(vec![view.clone(); count]);
    }
    let items = if view.is_array() { view.items()? } else { vec![] };
    match items.len() {
        1 => Some(vec![items[0].clone(); count]),
        n if n == count => Some(items),
        _ => {
            view.expected(&format!("a number, or an array of {count}"));
            None
        }
    }
}

pub fn numbers<const N: usize>(view: &View) -> Option<[f64; N]> {
    let values: Option<Vec<f64>> = several(view, N)?.iter().map(View::number).collect();
    values?.try_into().ok()
}

/// As an array of pt's.
pub fn vector(view: &View, count: usize) -> Option<Node> {
    Some(view.make_array(several(view, count)?.iter().map(View::same)))
}

pub fn scalar(view: &View) -> Option<Node> {
    several(view, 1).map(|values| values[0].same())
}

/// Gray as one number, else red, green and blue.
pub fn color(view: &View) -> Option<Node> {
    if view.is_number() { Some(view.same()) } else { vector(view, 3) }
}
