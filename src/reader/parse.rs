//! Parser of strict JSON with comments.

use jsonc_parser::ast::{self, ObjectPropName};
use jsonc_parser::common::Ranged;
use jsonc_parser::errors::{ParseError, ParseErrorKind};
use jsonc_parser::{CollectOptions, ParseOptions, parse_to_ast};

use super::node::{Location, Member, Node, Value};
use crate::Fault;

/// Largest depth of nested lists and objects, so that recursion over a tree cannot exhaust the stack.
pub const MAX_DEPTH: usize = 128;

/// Parses JSON with `//` and `/* */` comments; a byte order mark is accepted.
///
/// # Errors
/// The first fault, with its line and column (no file).
pub fn parse(bytes: &[u8]) -> Result<Node, Fault> {
    let text = decode(bytes)?;
    check_tokens(text)?;
    let tree = parse_to_ast(text, &CollectOptions::default(), &STRICT).map_err(|e| fault_at(text, e.range().start, explain(text, &e)))?;
    let value = tree.value.ok_or_else(|| Fault::new("empty, expected an object").at(1, 1))?;
    Ok(Converter { text, offset: 0, line: 1, column: 1 }.node(value))
}

const STRICT: ParseOptions = ParseOptions {
    allow_comments: true,
    allow_loose_object_property_names: false,
    allow_trailing_commas: false,
    allow_missing_commas: false,
    allow_single_quoted_strings: false,
    allow_hexadecimal_numbers: false,
    allow_unary_plus_numbers: false,
    allow_bare_decimal_point_numbers: false,
    allow_non_finite_numbers: false,
    allow_extended_string_escapes: false,
};

fn decode(bytes: &[u8]) -> Result<&str, Fault> {
    if bytes.starts_with(&[0xFE, 0xFF]) || bytes.starts_with(&[0xFF, 0xFE]) || bytes.iter().take(2).any(|b| *b == 0) {
        return Err(Fault::new("byte 0: this is UTF-16 or UTF-32, expected UTF-8").at(1, 1));
    }
    if u32::try_from(bytes.len()).is_err() {
        return Err(Fault::new("a scene file of 4 GiB or more").at(1, 1));
    }
    let bytes_after_mark = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    str::from_utf8(bytes_after_mark).map_err(|e| {
        let valid = String::from_utf8_lossy(&bytes_after_mark[..e.valid_up_to()]);
        let offset = bytes.len() - bytes_after_mark.len() + e.valid_up_to();
        fault_at(&valid, valid.len(), format!("byte {offset}: not UTF-8"))
    })
}

/// Checks for what the parser would not notice, or not survive: nesting beyond [`MAX_DEPTH`], control characters in a string.
fn check_tokens(text: &str) -> Result<(), Fault> {
    let mut depth = 0usize;
    let mut rest = text.char_indices();
    while let Some((at, c)) = rest.next() {
        match c {
            '"' => skip_string(text, &mut rest)?,
            '/' if text[at..].starts_with("//") => skip_past(&mut rest, &text[at..], "\n"),
            '/' if text[at..].starts_with("/*") => skip_past(&mut rest, &text[at..], "*/"),
            '[' | '{' => depth += 1,
            ']' | '}' => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth > MAX_DEPTH {
            return Err(fault_at(text, at, format!("lists and objects nest deeper than {MAX_DEPTH}")));
        }
    }
    Ok(())
}

fn skip_string(text: &str, rest: &mut std::str::CharIndices) -> Result<(), Fault> {
    while let Some((at, c)) = rest.next() {
        match c {
            '"' => return Ok(()),
            '\\' => drop(rest.next()),
            c if c < ' ' => return Err(fault_at(text, at, format!("a string holds the control character {c:?}: is a quote missing?"))),
            _ => {}
        }
    }
    Ok(())
}

/// Moves `rest` past the first `end` in `comment`, which starts two characters before `rest` does, or past everything.
fn skip_past(rest: &mut std::str::CharIndices, comment: &str, end: &str) {
    let stop = rest.offset() - 1 + comment[2..].find(end).map_or(comment.len(), |i| 2 + i + end.len());
    while rest.offset() < stop && rest.next().is_some() {}
}

/// Message for an error of the parser.
fn explain(text: &str, error: &ParseError) -> String {
    use ParseErrorKind as Kind;
    let (before, after) = text.split_at(error.range().start);
    let word: String = after.chars().take_while(|c| c.is_alphanumeric() || matches!(c, '_' | '-' | '.' | '+')).take(40).collect();
    if before.ends_with('0') && after.starts_with(|c: char| c.is_ascii_digit()) {
        return "a number may not start with 0".into();
    }
    match error.kind() {
        Kind::UnexpectedWord | Kind::UnexpectedToken if !word.is_empty() => format!("expected a value, found the word {word}"),
        Kind::UnaryPlusNumbersNotAllowed => "a number may not start with +".into(),
        Kind::BareDecimalPointNumbersNotAllowed => "a number needs digits on both sides of its point".into(),
        Kind::NonFiniteNumbersNotAllowed => format!("expected a number, found {word}"),
        Kind::HexadecimalNumbersNotAllowed => "expected a decimal number".into(),
        Kind::SingleQuotedStringsNotAllowed => "strings stand in double quotes".into(),
        Kind::TrailingCommasNotAllowed => "a comma may not follow the last value".into(),
        Kind::ExpectedComma => "expected a comma".into(),
        Kind::ExpectedStringObjectProperty => "expected a key in double quotes".into(),
        Kind::ExpectedColonAfterObjectKey => "expected a colon after the key".into(),
        Kind::ExpectedObjectValue => "expected a value after the colon".into(),
        Kind::MultipleRootJsonValues => "expected the end of the file after the value".into(),
        Kind::UnterminatedArray => "this [ is never closed".into(),
        Kind::UnterminatedObject => "this { is never closed".into(),
        Kind::UnterminatedCommentBlock => "this /* is never closed".into(),
        Kind::UnexpectedTokenInObject => "expected a key in double quotes or }".into(),
        other => uncapitalised(&other.to_string()),
    }
}

fn uncapitalised(sentence: &str) -> String {
    let mut chars = sentence.chars();
    chars.next().map_or_else(String::new, |first| first.to_lowercase().chain(chars).collect())
}

fn fault_at(text: &str, offset: usize, message: impl Into<String>) -> Fault {
    let mut position = Converter { text, offset: 0, line: 1, column: 1 };
    position.advance(offset);
    Fault::new(message).at(position.line as usize, position.column as usize)
}

/// Converter from the tree of the parser to [`Node`]. Offsets come in file order, so lines are counted only once.
struct Converter<'t> {
    text: &'t str,
    offset: usize,
    line: u32,
    column: u32,
}

impl Converter<'_> {
    fn advance(&mut self, offset: usize) {
        for c in self.text.get(self.offset..offset).unwrap_or_default().chars() {
            match c {
                '\n' => (self.line, self.column) = (self.line + 1, 1),
                _ => self.column += 1,
            }
        }
        self.offset = offset;
    }

    fn location(&mut self, at: &impl Ranged) -> Location {
        self.advance(at.start());
        Location::Text { line: self.line, column: self.column }
    }

    fn node(&mut self, value: ast::Value) -> Node {
        let location = self.location(&value);
        let value = match value {
            ast::Value::NullKeyword(_) => Value::Null,
            ast::Value::BooleanLit(b) => Value::Bool(b.value),
            ast::Value::NumberLit(n) => Value::Number(n.value.into()),
            ast::Value::StringLit(s) => Value::String(s.value.into_owned()),
            ast::Value::Array(array) => Value::Array(array.elements.into_iter().map(|v| self.node(v)).collect()),
            ast::Value::Object(object) => Value::Object(object.properties.into_iter().map(|p| self.member(p)).collect()),
        };
        Node { value, location }
    }

    fn member(&mut self, property: ast::ObjectProp) -> Member {
        let key_location = self.location(&property.name);
        let key = match property.name {
            ObjectPropName::String(name) => name.value.into_owned(),
            ObjectPropName::Word(name) => name.value.into(),
        };
        Member { key, key_location, node: self.node(property.value) }
    }
}
