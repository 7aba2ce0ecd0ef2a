//! Which samples of a picture there are.

use std::fmt;
use std::ops::Range;

/// Indices of the samples of every pixel: ranges in order, with gaps between them where samples are missing.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SampleSet {
    ranges: Vec<Range<u64>>,
}

impl SampleSet {
    /// The samples 0 … n − 1.
    pub fn first(n: u64) -> SampleSet {
        SampleSet::of(std::iter::once(0..n))
    }

    /// The samples of ranges that are in order and do not overlap.
    pub fn of(ranges: impl IntoIterator<Item = Range<u64>>) -> SampleSet {
        let mut joined: Vec<Range<u64>> = vec![];
        for range in ranges {
            match joined.last_mut() {
                Some(last) if last.end == range.start => last.end = range.end,
                _ => joined.push(range),
            }
        }
        SampleSet { ranges: joined }
    }

    /// Ranges without gaps, in order.
    pub fn ranges(&self) -> &[Range<u64>] {
        &self.ranges
    }

    /// Gaps between sample 0 and sample `end` − 1, in order.
    pub fn missing(&self, end: u64) -> Vec<Range<u64>> {
        let ends = [0].into_iter().chain(self.ranges.iter().map(|range| range.end));
        let starts = self.ranges.iter().map(|range| range.start).chain([end]);
        ends.zip(starts).map(|(end, start)| end..start).filter(|gap| !gap.is_empty()).collect()
    }

    /// Samples of a pixel that takes 2^`level` samples in the place of each of these.
    pub fn of_pixel(&self, level: u32) -> PixelSamples<'_> {
        PixelSamples { ranges: &self.ranges, level }
    }
}

/// `0..16, 32..64`
impl fmt::Display for SampleSet {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let words: Vec<String> = self.ranges.iter().map(|range| format!("{}..{}", range.start, range.end)).collect();
        f.write_str(&words.join(", "))
    }
}

/// Samples of one pixel.
#[derive(Clone, Copy, Debug)]
pub struct PixelSamples<'a> {
    ranges: &'a [Range<u64>],
    level: u32,
}

impl PixelSamples<'_> {
    /// Number of samples.
    pub fn count(self) -> u64 {
        self.ranges.iter().map(|range| (range.end - range.start) << self.level).sum()
    }

    /// Number of samples of scrambling r, where sample i belongs to scrambling i mod k.
    pub fn of_scrambling(self, k: u64, r: u64) -> u64 {
        let below = |end: u64| (end << self.level).saturating_sub(r).div_ceil(k);
        self.ranges.iter().map(|range| below(range.end) - below(range.start)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Counted one by one.
    #[test]
    fn samples_are_counted() {
        let set = SampleSet::of([3..4, 4..9, 14..15]);
        assert_eq!(set.ranges(), [3..9, 14..15]);
        assert_eq!(set.to_string(), "3..9, 14..15");
        assert_eq!(set.missing(20), [0..3, 9..14, 15..20]);
        assert!(SampleSet::first(8).missing(8).is_empty());
        assert_eq!(SampleSet::default().missing(2), SampleSet::first(2).ranges());
        for level in 0..3 {
            let all: Vec<u64> = set.ranges().iter().flat_map(|range| range.start << level..range.end << level).collect();
            assert_eq!(set.of_pixel(level).count(), all.len() as u64);
            for (k, r) in [1, 2, 4, 8].into_iter().flat_map(|k| (0..k).map(move |r| (k, r))) {
                let expected = all.iter().filter(|i| *i % k == r).count() as u64;
                assert_eq!(set.of_pixel(level).of_scrambling(k, r), expected, "level {level}, scrambling {r} of {k}");
            }
        }
    }
}
