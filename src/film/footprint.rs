//! The width of the area over which textures are averaged.

/// Width of the area around a camera ray over which the textures that it meets are averaged.
///
/// It is never a function of the number of samples that a picture is to have, so that parts of a render and longer renders keep their
/// bits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum TextureFootprint {
    /// 1/(S · 2^⌊log₂(i/S)⌋) pixels for the sample with the index i of a pixel whose samples are divided among S sequences, and 1 pixel for the
    /// first sample of each sequence: about 1/n after n samples. The blur of the mean of n samples then falls as 1/n, faster
    /// than its noise. With a width of 1/√n, at which the n areas together cover the pixel once, the blur would exceed the standard error when n
    /// is large.
    #[default]
    Shrinking,
    /// One width for all samples (pixels). With 0, textures are looked up at points and not averaged.
    Fixed(f32),
}

impl TextureFootprint {
    /// Width for a sample (pixels).
    ///
    /// - `index`: index of the sample in its pixel
    /// - `sequences`: number of sequences among which the samples are divided. Their samples have the same widths.
    pub fn width(self, index: u64, sequences: u64) -> f32 {
        match self {
            TextureFootprint::Fixed(width) => width,
            TextureFootprint::Shrinking => {
                let taken = (index / sequences).checked_ilog2().map_or(1, |level| sequences << level);
                1.0 / taken as f32
            }
        }
    }

    /// Whether textures are averaged at all.
    pub fn is_on(self) -> bool {
        self != TextureFootprint::Fixed(0.0)
    }
}
