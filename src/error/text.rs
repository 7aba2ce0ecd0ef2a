//! Text from files and users in a form that is safe for terminals.

use std::borrow::Cow;

/// Greatest number of characters of one piece of a message, such as a name, a pointer or a sentence.
const MAX_LENGTH: usize = 600;

/// The text on one line and with bounded length: control characters are written as escapes such as `\u001b`, and the middle of a long
/// text is left out.
pub fn one_line(text: &str) -> Cow<'_, str> {
    match bounded(text) {
        Cow::Borrowed(text) => escaped(text, is_control),
        Cow::Owned(text) => Cow::Owned(escaped(&text, is_control).into_owned()),
    }
}

/// The text with control characters other than newline and tab written as escapes.
#[cfg(feature = "cli")]
pub fn printable(text: &str) -> Cow<'_, str> {
    escaped(text, |c| is_control(c) && c != '\n' && c != '\t')
}

/// The text without its middle part if it is too long.
pub fn bounded(text: &str) -> Cow<'_, str> {
    if text.len() <= MAX_LENGTH {
        return text.into();
    }
    let count = text.chars().count();
    let Some(left_out) = count.checked_sub(MAX_LENGTH).filter(|n| *n > 0) else { return text.into() };
    let at = |nth: usize| text.char_indices().nth(nth).map_or(text.len(), |(at, _)| at);
    let (head, tail) = (&text[..at(MAX_LENGTH / 2)], &text[at(count - MAX_LENGTH / 2)..]);
    format!("{head}… ({left_out} characters) …{tail}").into()
}

fn escaped(text: &str, is_escaped: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.contains(&is_escaped) {
        return text.into();
    }
    let mut escaped = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        match c {
            _ if !is_escaped(c) => escaped.push(c),
            '\n' => escaped.push_str("\\n"),
            '\r' => escaped.push_str("\\r"),
            '\t' => escaped.push_str("\\t"),
            // The escape of JSON, because the text may be JSON.
            _ => escaped += &format!("\\u{:04x}", u32::from(c)),
        }
    }
    escaped.into()
}

/// Whether the character may control a terminal: control characters, and characters that change the direction of writing.
fn is_control(c: char) -> bool {
    c.is_control() || matches!(c, '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every character of Unicode is tried.
    #[test]
    fn no_control_character_gets_through() {
        let all: String = (char::MIN..=char::MAX).collect();
        for text in all.chars().collect::<Vec<_>>().chunks(MAX_LENGTH) {
            let text: String = text.iter().collect();
            assert!(!one_line(&text).contains(char::is_control));
            assert!(!printable(&text).contains(|c: char| c.is_control() && c != '\n' && c != '\t'));
            assert!(!printable(&text).contains(['\u{202e}', '\u{2066}', '\u{2028}']));
        }
        assert_eq!(one_line("a\x1b[31m\nb\u{202e}é🫖"), "a\\u001b[31m\\nb\\u202eé🫖");
        assert_eq!(printable("a\tb\nc\r"), "a\tb\nc\\r");
    }

    #[test]
    fn what_is_short_stays_and_what_is_long_is_bounded() {
        for length in [0, 1, MAX_LENGTH - 1, MAX_LENGTH] {
            assert_eq!(one_line(&"é".repeat(length)), "é".repeat(length));
        }
        for length in [MAX_LENGTH + 1, 10 * MAX_LENGTH, 1_000_000] {
            let text = format!("<{}>", "é".repeat(length - 2));
            let found = one_line(&text).into_owned();
            assert!(found.starts_with('<') && found.ends_with('>') && found.contains(&format!("({} characters)", length - MAX_LENGTH)));
            assert!(found.chars().count() < MAX_LENGTH + 40);
        }
    }
}
