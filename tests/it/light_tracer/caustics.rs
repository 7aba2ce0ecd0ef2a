//! Caustics whose light is known exactly: distant light through a plate and a ball of glass, and from a mirror.
//!
//! The floor has a small albedo ρ, so that its radiance is ρE/π and light that it sends back to the glass is ρ times weaker. It is seen
//! by an orthographic camera between glass and floor.

use std::f64::consts::PI;
use std::sync::Arc;

use pt::sampler::{Kind, SamplerSpec};

use super::{built, film};

const ALBEDO: f64 = 1e-3;
/// Scramblings: independent observations of the mean.
const K: u32 = 16;

/// Irradiance of the part of the floor that the film shows: its mean and standard error over the scramblings.
///
/// - `log_paths`: binary logarithm of the number of paths of each scrambling
fn irradiance(scene: &str, options: &str, log_paths: u32) -> (f64, f64) {
    let built = built(scene);
    let pixels = built.film.crop.pixel_count();
    let spp = (u64::from(K) << log_paths) / pixels;
    let sampler = SamplerSpec { kind: Kind::Sobol, seed: 5, spp, scramblings: K };
    let film = film(Arc::new(built.world), "light", options, built.film, sampler);
    let mut sums = vec![0.0; K as usize];
    for pixel in film.total().pixels() {
        (0..K as usize).for_each(|r| sums[r] += pixel[3 * r]);
    }
    let means: Vec<f64> = sums.iter().map(|sum| PI / ALBEDO * sum * f64::from(K) / (pixels * spp) as f64).collect();
    let mean = means.iter().sum::<f64>() / f64::from(K);
    let variance = means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / f64::from(K - 1);
    (mean, (variance / f64::from(K)).sqrt())
}

/// Binary logarithm of the factor by which a full run has more paths than a quick one.
const FULL: u32 = 4;

/// Asserts that a mean is the exact value: within 4 standard errors and the rounding of the table. A standard error may be 0.3 % in a
/// quick run, and a quarter of that in a full one.
///
/// - `more`: binary logarithm of the factor of the number of paths
fn is_exact(name: &str, (mean, error): (f64, f64), exact: f64, more: u32) {
    println!("{name}: {mean:.6} ± {error:.1e}, exact {exact:.6} ({:+.3} %)", 100.0 * (mean / exact - 1.0));
    assert!(error < 3e-3 * 0.5f64.powf(0.5 * f64::from(more)) * exact, "{name}: too noisy, {mean} ± {error}");
    assert!((mean - exact).abs() < 4.0 * error + 1e-4 * exact, "{name}: {mean} ± {error}, expected {exact}");
}

/// Parallel light of irradiance 1 on a plane across it, at `degrees` from the normal of the floor, with these shapes above the floor.
fn under(degrees: f64, floor: &str, shapes: &str, camera: &str) -> String {
    let (sin, cos) = degrees.to_radians().sin_cos();
    format!(
        r#"{{ "pt": 1, "film": {{ "width": 16, "height": 16 }}, "camera": {camera},
        "materials": {{ "glass": {{ "type": "dielectric", "eta": 1.5 }}, "dark": {{ "type": "diffuse", "albedo": {ALBEDO} }} }},
        "lights": [{{ "type": "directional", "direction": [{sin}, 0, {}], "irradiance": 1 }}],
        "shapes": [{floor}, {shapes}] }}"#,
        -cos
    )
}

/// Under a plate the irradiance is cos θ (1 − F)/(1 + F), with all reflections inside the plate.
#[test]
fn light_through_a_plate() {
    plate(0);
}

#[test]
#[ignore = "some minutes: to 0.3 %, with 16 times as many paths"]
fn light_through_a_plate_to_three_per_mille() {
    plate(FULL);
}

fn plate(more: u32) {
    const FACTORS: [(f64, f64, u32); 6] = [
        (0.0, 0.923076923, 14),
        (30.0, 0.920265533, 14),
        (45.0, 0.904326791, 14),
        (60.0, 0.836232463, 15),
        (75.0, 0.596092048, 16),
        (85.0, 0.240079638, 21),
    ];
    // At 85° the plate takes 13 times as many paths as at all the other angles together.
    let angles = if more == 0 { &FACTORS[..5] } else { &FACTORS };
    for &(degrees, factor, log_paths) in angles {
        // The gap under the plate is so small that light from beside it does not reach the part that is seen.
        let scene = under(
            degrees,
            r#"{ "type": "quad", "size": 0.26, "material": "dark" }"#,
            r#"{ "type": "box", "size": [0.26, 0.26, 0.001], "material": "glass", "transform": [{ "translate": [0, 0, 0.0015] }] }"#,
            r#"{ "type": "orthographic", "look_at": { "from": [0, 0, 0.0009], "to": [0, 0, 0], "up": [0, 1, 0] }, "height": 0.2 }"#,
        );
        is_exact(&format!("{degrees}°"), irradiance(&scene, "", log_paths + more), degrees.to_radians().cos() * factor, more);
    }
}

/// Mean irradiance of disks under a ball of glass, with the two refractions only and with all reflections inside.
#[test]
fn light_through_a_ball() {
    balls(0);
}

#[test]
#[ignore = "some minutes: to 0.3 %, with 16 times as many paths"]
fn light_through_a_ball_to_three_per_mille() {
    balls(FULL);
}

fn balls(more: u32) {
    const TWO_REFRACTIONS: [(f64, [(f64, f64); 4]); 3] = [
        (-1.25, [(0.1, 65.0748), (0.2, 18.0778), (0.3, 8.48068), (0.5, 3.20657)]),
        (-1.5, [(0.1, 37.3117), (0.2, 12.9585), (0.3, 6.74896), (0.5, 2.83154)]),
        (-2.0, [(0.1, 6.80701), (0.2, 4.74524), (0.3, 3.34990), (0.5, 1.87121)]),
    ];
    const ALL_REFLECTIONS: [(f64, f64); 4] = [(0.1, 65.0764), (0.2, 18.0808), (0.3, 8.48225), (0.5, 3.20736)];
    let ball = |floor: f64, radius: f64| {
        let disk =
            format!(r#"{{ "type": "disk", "radius": {radius}, "material": "dark", "transform": [{{ "translate": [0, 0, {floor}] }}] }}"#);
        let eye = 0.5 * (floor - 1.0);
        let camera = format!(
            r#"{{ "type": "orthographic", "look_at": {{ "from": [0, 0, {eye}], "to": [0, 0, {floor}], "up": [0, 1, 0] }}, "height": {} }}"#,
            2.0 * radius
        );
        under(0.0, &disk, r#"{ "type": "sphere", "radius": 1, "material": "glass" }"#, &camera)
    };
    // The film is a square around the disk.
    let in_square = PI / 4.0;
    for (floor, disks) in TWO_REFRACTIONS {
        for (radius, exact) in disks {
            let found = irradiance(&ball(floor, radius), r#", "max_depth": 3"#, 16 + more);
            is_exact(&format!("floor {floor}, radius {radius}"), found, exact * in_square, more);
        }
    }
    for (radius, exact) in ALL_REFLECTIONS {
        is_exact(&format!("all reflections, radius {radius}"), irradiance(&ball(-1.25, radius), "", 16 + more), exact * in_square, more);
    }
}

/// Beside an upright mirror of reflectance R, light at 45° falls on the floor twice: (1 + R) cos 45°.
#[test]
fn light_from_a_mirror() {
    for reflectance in [1.0, 0.6] {
        let scene = under(
            45.0,
            r#"{ "type": "quad", "size": 4, "material": "dark" }"#,
            &format!(
                r#"{{ "type": "quad", "size": 2, "material": {{ "type": "mirror", "color": {reflectance} }},
                "transform": [{{ "rotate": {{ "axis": [0, 1, 0], "degrees": -90 }} }}, {{ "translate": [1, 0, 1] }}] }}"#
            ),
            // It sees a strip of 0.8 m, from the mirror's foot at x = 1 on; the mirror is 2 m high.
            r#"{ "type": "orthographic", "look_at": { "from": [0.4, 0, 0.5], "to": [0.4, 0, 0], "up": [0, 1, 0] }, "height": 0.8 }"#,
        );
        is_exact(&format!("R {reflectance}"), irradiance(&scene, "", 14), (1.0 + reflectance) * 0.5f64.sqrt(), 0);
    }
}
