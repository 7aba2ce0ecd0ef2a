//! There are no absolute constants: lengths × 2^k give the same bits, and light × 2^k gives pixels × 2^k.

use pt::film::Image;
use pt::integrators::ALL;

use super::new;
use super::zoo::{Lens, Shot, Which, Zoo, bits, picture};

fn taken(zoo: Zoo, entry: &pt::integrator::Entry) -> Image {
    picture(zoo.build(), &*new(entry), &Shot { zoo, ..Shot::default() })
}

#[test]
fn scale_is_exact() {
    for (entry, camera) in ALL.iter().flat_map(|e| [Lens::Perspective, Lens::Orthographic, Lens::Spherical].map(|c| (e, c))) {
        let zoo = Zoo { camera, lens_radius: 0.05, ..Zoo::default() };
        let wanted = bits(&taken(zoo, entry));
        for k in [-20, -3, 1, 20] {
            let found = bits(&taken(Zoo { scale: 2f64.powi(k), ..zoo }, entry));
            assert!(found == wanted, "{} {camera:?} scaled by 2^{k}", entry.name);
        }
    }
}

#[test]
fn brightness_is_exact() {
    for (entry, lights) in
        ALL.iter().flat_map(|e| [Which::All, Which::AreaOnly, Which::DirectionalOnly, Which::EnvironmentOnly].map(|l| (e, l)))
    {
        if entry.simulates.is_empty() {
            continue;
        }
        let dim = taken(Zoo { lights, ..Zoo::default() }, entry);
        assert!(dim.pixels().flatten().any(|v| v > 0.0) || ["path", "card"].contains(&entry.name), "{} {lights:?} is black", entry.name);
        for k in [-20, 7, 20] {
            let factor = 2f32.powi(k);
            let bright = taken(Zoo { lights, emission: factor, ..Zoo::default() }, entry);
            for (dim, bright) in dim.channels.iter().zip(&bright.channels).filter(|(c, _)| c.name != "SampleCount.Y") {
                let wanted: Vec<u32> = dim.values.iter().map(|v| (v * factor).to_bits()).collect();
                let found: Vec<u32> = bright.values.iter().map(|v| v.to_bits()).collect();
                assert!(found == wanted, "{} {lights:?} ×2^{k}, channel {}", entry.name, dim.name);
            }
        }
    }
}
