//! Text of a tree: objects, and lists that hold them, take several lines; lists of plain values take one.

use std::fmt::{self, Display, Formatter, Write};

use super::node::{Node, Value};

/// Writes JSON that [`parse`](super::parse()) reads back as an equal tree. Numbers stay as they are written.
impl Display for Node {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        write(self, 0, f)
    }
}

fn write(node: &Node, depth: usize, f: &mut Formatter) -> fmt::Result {
    match &node.value {
        Value::Null => f.write_str("null"),
        Value::Bool(flag) => write!(f, "{flag}"),
        Value::Number(text) => f.write_str(text),
        Value::String(text) => quoted(text, f),
        Value::Array(items) => {
            let lines = Some(depth).filter(|_| !items.iter().all(is_plain));
            list(items, ['[', ']'], lines, f, |item, f| write(item, depth + 1, f))
        }
        Value::Object(members) => list(members, ['{', '}'], Some(depth), f, |member, f| {
            quoted(&member.key, f)?;
            f.write_str(": ")?;
            write(&member.node, depth + 1, f)
        }),
    }
}

fn is_plain(node: &Node) -> bool {
    !matches!(node.value, Value::Array(_) | Value::Object(_))
}

/// Writes a list between its brackets, with each item on a line of its own if there are `lines` at that depth.
fn list<T>(
    items: &[T],
    brackets: [char; 2],
    lines: Option<usize>,
    f: &mut Formatter,
    item: impl Fn(&T, &mut Formatter) -> fmt::Result,
) -> fmt::Result {
    let [open, close] = brackets;
    let new_line = |more: usize| lines.map(|depth| format!("\n{}", "  ".repeat(depth + more))).unwrap_or_default();
    let gap = if lines.is_none() { " ".to_owned() } else { new_line(1) };
    f.write_char(open)?;
    for (i, one) in items.iter().enumerate() {
        if i == 0 {
            f.write_str(&new_line(1))?
        } else {
            write!(f, ",{gap}")?
        }
        item(one, f)?;
    }
    let end = if items.is_empty() { String::new() } else { new_line(0) };
    write!(f, "{end}{close}")
}

/// Writes a string with the escapes that JSON requires.
fn quoted(text: &str, f: &mut Formatter) -> fmt::Result {
    f.write_str(&serde_json::to_string(text).map_err(|_| fmt::Error)?)
}
