//! A plot as marks: what is painted, not how. `svg` and `raster` paint it.

use super::letters;

/// Right and down, in CSS pixels.
pub type Spot = [f64; 2];

/// Marks in the order in which they are painted.
pub struct Drawing {
    pub size: Spot,
    /// What can be seen, in words, for those who cannot see it.
    pub description: String,
    pub marks: Vec<Mark>,
}

pub enum Mark {
    Line {
        points: Vec<Spot>,
        ink: Ink,
        width: f64,
        dashes: Dashes,
    },
    /// Closed; the hint appears under a pointer.
    Area {
        points: Vec<Spot>,
        ink: Ink,
        opacity: f64,
        hint: String,
    },
    /// `at` is on the baseline.
    Text {
        at: Spot,
        text: String,
        ink: Ink,
        size: f64,
        anchor: Anchor,
    },
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Dashes {
    None,
    Short,
    Long,
}

impl Dashes {
    /// Length of stroke and gap, in widths of the line.
    pub fn pattern(self) -> Option<[f64; 2]> {
        match self {
            Dashes::None => None,
            Dashes::Short => Some([1.0, 3.0]),
            Dashes::Long => Some([4.0, 3.0]),
        }
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    Start,
    Middle,
    End,
}

/// Colours by their task, so that a page may change them.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Ink {
    Text,
    Muted,
    Grid,
    Paper,
    /// Of a method, by its place.
    Method(usize),
}

/// Around a plot that is a file of its own.
pub const MARGIN: f64 = 16.0;

/// Told apart with every kind of colour vision. Source: Okabe, Ito, *Color Universal Design* (2008), without its yellow.
const METHODS: [[u8; 3]; 6] =
    [[0x00, 0x72, 0xb2], [0xd5, 0x5e, 0x00], [0x00, 0x9e, 0x73], [0xcc, 0x79, 0xa7], [0xe6, 0x9f, 0x00], [0x56, 0xb4, 0xe9]];

impl Ink {
    pub fn rgb(self) -> [u8; 3] {
        match self {
            Ink::Text => [0x1a, 0x1d, 0x21],
            Ink::Muted => [0x5b, 0x64, 0x6e],
            Ink::Grid => [0xe4, 0xe7, 0xeb],
            Ink::Paper => [0xff, 0xff, 0xff],
            Ink::Method(i) => METHODS[i % METHODS.len()],
        }
    }

    /// The class that `assets/dark.css` gives a colour for dark windows.
    pub fn class(self) -> String {
        match self {
            Ink::Text => "text".into(),
            Ink::Muted => "muted".into(),
            Ink::Grid => "grid".into(),
            Ink::Paper => "paper".into(),
            Ink::Method(i) => format!("m{}", i % METHODS.len()),
        }
    }
}

impl Drawing {
    pub fn new(width: f64, height: f64) -> Drawing {
        Drawing { size: [width, height], description: String::new(), marks: vec![] }
    }

    pub fn line(&mut self, points: Vec<Spot>, ink: Ink, width: f64, dashes: Dashes) {
        self.marks.push(Mark::Line { points, ink, width, dashes });
    }

    pub fn area(&mut self, points: Vec<Spot>, ink: Ink, opacity: f64, hint: impl Into<String>) {
        self.marks.push(Mark::Area { points, ink, opacity, hint: hint.into() });
    }

    pub fn text(&mut self, at: Spot, text: impl Into<String>, ink: Ink, size: f64, anchor: Anchor) {
        self.marks.push(Mark::Text { at, text: text.into(), ink, size, anchor });
    }

    /// The symbol of the method in this place: with the colour's cycle of six and the shape's of five, thirty differ.
    pub fn symbol(&mut self, place: usize, at: Spot, radius: f64, opacity: f64, hint: impl Into<String>) {
        let points = symbol(place).iter().map(|[x, y]| [at[0] + radius * x, at[1] + radius * y]).collect();
        self.area(points, Ink::Method(place), opacity, hint);
    }

    /// Room for a text, in whatever font the reader has: the widest usual ones are a fifth wider than ours.
    pub fn width_of(text: &str, size: f64) -> f64 {
        1.2 * letters::width(text, size)
    }
}

/// Unit polygons of about equal area.
fn symbol(place: usize) -> Vec<Spot> {
    let polygon = |corners: usize, radius: f64, start: f64| -> Vec<Spot> {
        let angle = |i: usize| (start + i as f64 / corners as f64) * std::f64::consts::TAU;
        (0..corners).map(|i| [radius * angle(i).sin(), -radius * angle(i).cos()]).collect()
    };
    match place % 5 {
        0 => polygon(24, 1.0, 0.0),
        1 => polygon(4, 1.25, 0.125),
        2 => polygon(3, 1.5, 0.0),
        3 => polygon(4, 1.25, 0.0),
        _ => polygon(3, 1.5, 0.5),
    }
}
