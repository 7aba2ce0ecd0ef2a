//! Cancellation of long samples.

/// Query by which a long sample learns that the render was cancelled. The result of a cancelled sample is discarded.
#[derive(Clone, Copy)]
pub struct Interrupt<'a> {
    is_cancelled: Option<&'a dyn Fn() -> bool>,
}

impl<'a> Interrupt<'a> {
    /// The interrupt that never happens.
    pub const NEVER: Interrupt<'static> = Interrupt { is_cancelled: None };

    /// An interrupt that asks `is_cancelled`, which must stay `true` once it was.
    pub fn new(is_cancelled: &'a dyn Fn() -> bool) -> Interrupt<'a> {
        Interrupt { is_cancelled: Some(is_cancelled) }
    }

    /// Whether to give up a sample that has `vertices` path vertices. The query runs once in 256 vertices, so that short paths
    /// pay nothing for it.
    #[inline(always)]
    pub fn ends(self, vertices: u32) -> bool {
        vertices % 256 == 255 && self.query()
    }

    /// Whether the render was cancelled.
    pub fn is_cancelled(self) -> bool {
        self.query()
    }

    #[cold]
    fn query(self) -> bool {
        self.is_cancelled.is_some_and(|is_cancelled| is_cancelled())
    }
}
