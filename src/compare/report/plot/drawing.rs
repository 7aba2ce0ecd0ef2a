//! A plot as a list of marks, which `svg` and `raster` paint.

/// Point in CSS pixels, x to the right and y down.
pub type Point = [f64; 2];

/// Marks, in the order in which they are painted.
pub struct Drawing {
    /// Width and height.
    pub size: Point,
    /// Description of the plot in words, for people who cannot see it.
    pub description: String,
    /// The marks.
    pub marks: Vec<Mark>,
}

/// A shape or text of a drawing.
pub enum Mark {
    /// Open line through points.
    Line { points: Vec<Point>, color: Color, width: f64, dashes: Dashes },
    /// Filled polygon; the hint appears under a pointer.
    Area { points: Vec<Point>, color: Color, opacity: f64, hint: String },
    /// Text; `at` is on the baseline.
    Text { at: Point, text: String, color: Color, size: f64, anchor: Anchor },
}

/// Dash pattern of a line.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Dashes {
    /// Solid line.
    None,
    /// Dots.
    Short,
    /// Dashes.
    Long,
}

impl Dashes {
    /// Lengths of dash and gap, in widths of the line.
    pub fn pattern(self) -> Option<[f64; 2]> {
        match self {
            Dashes::None => None,
            Dashes::Short => Some([1.0, 3.0]),
            Dashes::Long => Some([4.0, 3.0]),
        }
    }
}

/// Part of a text that its point belongs to.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// Left end.
    Start,
    /// Middle.
    Middle,
    /// Right end.
    End,
}

/// Colours named by their use, so that a page may change them.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Color {
    /// Text.
    Text,
    /// Less important text.
    Muted,
    /// Grid lines.
    Grid,
    /// Background.
    Paper,
    /// Colour of a method, by its index.
    Method(usize),
}

/// Margin around a plot that is a file of its own (CSS pixels).
pub const MARGIN: f64 = 16.0;

/// Colours that people with any kind of colour vision can tell apart. Source: Okabe, Ito, *Color Universal Design* (2008), without
/// its yellow.
const METHODS: [[u8; 3]; 6] =
    [[0x00, 0x72, 0xb2], [0xd5, 0x5e, 0x00], [0x00, 0x9e, 0x73], [0xcc, 0x79, 0xa7], [0xe6, 0x9f, 0x00], [0x56, 0xb4, 0xe9]];

impl Color {
    /// sRGB value.
    pub fn rgb(self) -> [u8; 3] {
        match self {
            Color::Text => [0x1a, 0x1d, 0x21],
            Color::Muted => [0x5b, 0x64, 0x6e],
            Color::Grid => [0xe4, 0xe7, 0xeb],
            Color::Paper => [0xff, 0xff, 0xff],
            Color::Method(i) => METHODS[i % METHODS.len()],
        }
    }

    /// CSS class; `assets/dark.css` gives it a colour for dark windows.
    pub fn class(self) -> String {
        match self {
            Color::Text => "text".into(),
            Color::Muted => "muted".into(),
            Color::Grid => "grid".into(),
            Color::Paper => "paper".into(),
            Color::Method(i) => format!("m{}", i % METHODS.len()),
        }
    }
}

impl Drawing {
    /// Empty drawing.
    pub fn new(width: f64, height: f64) -> Drawing {
        Drawing { size: [width, height], description: String::new(), marks: vec![] }
    }

    /// Adds a line.
    pub fn line(&mut self, points: Vec<Point>, color: Color, width: f64, dashes: Dashes) {
        self.marks.push(Mark::Line { points, color, width, dashes });
    }

    /// Adds a filled polygon.
    pub fn area(&mut self, points: Vec<Point>, color: Color, opacity: f64, hint: impl Into<String>) {
        self.marks.push(Mark::Area { points, color, opacity, hint: hint.into() });
    }

    /// Adds a text.
    pub fn text(&mut self, at: Point, text: impl Into<String>, color: Color, size: f64, anchor: Anchor) {
        self.marks.push(Mark::Text { at, text: text.into(), color, size, anchor });
    }

    /// Adds the symbol of a method. Six colours and five shapes repeat, so that thirty methods differ.
    pub fn symbol(&mut self, index: usize, at: Point, radius: f64, opacity: f64, hint: impl Into<String>) {
        let points = symbol(index).iter().map(|[x, y]| [at[0] + radius * x, at[1] + radius * y]).collect();
        self.area(points, Color::Method(index), opacity, hint);
    }
}

/// Unit polygons of about equal area.
fn symbol(index: usize) -> Vec<Point> {
    let polygon = |corners: usize, radius: f64, start: f64| -> Vec<Point> {
        let angle = |i: usize| (start + i as f64 / corners as f64) * std::f64::consts::TAU;
        (0..corners).map(|i| [radius * angle(i).sin(), -radius * angle(i).cos()]).collect()
    };
    match index % 5 {
        0 => polygon(24, 1.0, 0.0),
        1 => polygon(4, 1.25, 0.125),
        2 => polygon(3, 1.5, 0.0),
        3 => polygon(4, 1.25, 0.0),
        _ => polygon(3, 1.5, 0.5),
    }
}
