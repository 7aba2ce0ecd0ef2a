//! Pictures at the checkpoints, for comparisons at equal time or equal error.

use std::collections::VecDeque;

use crate::film::Image;

/// Number of checkpoints of which a method keeps the picture. Checkpoints double, so that eight span a factor of 128 in time.
const KEPT: usize = 8;

/// Picture of one replicate at a checkpoint.
#[derive(Clone, Debug)]
pub struct Snapshot {
    /// Samples per pixel.
    pub samples: u64,
    /// Render time of this replicate.
    pub seconds: f64,
    /// Relative error √relMSE of this picture; `None` if it is as close to the truth as the reference.
    pub error: Option<f64>,
    /// The picture: `R`, `G` and `B`.
    pub image: Image,
}

impl Snapshot {
    /// Snapshot of a picture, whose other channels are dropped.
    pub fn new(samples: u64, seconds: f64, relmse: f64, mut image: Image) -> Snapshot {
        image.channels.retain(|channel| ["R", "G", "B"].contains(&channel.name.as_str()));
        Snapshot { samples, seconds, error: (relmse > 0.0).then(|| relmse.sqrt()), image }
    }
}

/// Adds a snapshot to the last ones.
pub fn keep(snapshots: &mut VecDeque<Snapshot>, snapshot: Snapshot) {
    if snapshots.len() == KEPT {
        snapshots.pop_front();
    }
    snapshots.push_back(snapshot);
}

#[cfg(test)]
mod tests {
    use super::super::synthetic::image;
    use super::*;

    /// After ten checkpoints, whose samples double from 1 to 512, the pictures of the last eight are left: those of 4 to 512 samples.
    #[test]
    fn the_last_checkpoints_keep_their_pictures() {
        let mut kept = VecDeque::new();
        for k in 0..10u32 {
            keep(&mut kept, Snapshot::new(1 << k, f64::from(k), 0.25, image(|_| 1.0, 0.1)));
        }
        assert_eq!(kept.iter().map(|one| one.samples).collect::<Vec<_>>(), [4, 8, 16, 32, 64, 128, 256, 512]);
        assert!(kept.iter().all(|one| one.error == Some(0.5) && one.image.channels.len() == 3));
        assert_eq!(Snapshot::new(1, 1.0, -1e-9, image(|_| 1.0, 0.1)).error, None, "closer than the reference");
    }
}
