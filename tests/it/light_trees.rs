//! The choice among many lights: probabilities that are exact, and that follow what each light brings to a point.

use std::f64::consts::PI;
use std::sync::Arc;

use glam::{DVec3, Mat3, UVec2, Vec2, Vec3};
use pt::light::{
    Area, Directional, Emitter, Environment, EnvironmentMap, Falloff, Light, LightSampleContext, Lights, Mapping, Point, ProfiledPoint,
    Spot, Sun,
};
use pt::math::{Rgb, Transform};
use pt::shape::{BilinearPatch, Cone, Cylinder, Disk, Geometry, PartialDisk, PartialSphere, Quad, Shape, Sphere};
use pt::texture::image::Pixels;

use crate::random::Random;

/// Radius of the scenes around the origin (m).
const RADIUS: f64 = 4.0;

/// Lights of a scene and the shapes that they refer to, before either is given away.
#[derive(Default)]
struct Scene {
    lights: Vec<Light>,
    shapes: Vec<(Box<dyn Geometry>, DVec3, Transform)>,
}

impl Scene {
    /// All kinds of lights at random places.
    ///
    /// - `distant`: number of suns, besides a sky, a sun with a disk and a map
    /// - `decades`: number of decades above 1 and below over which powers are spread
    fn mixed(count: usize, distant: usize, decades: f64, random: &mut Random) -> Scene {
        let mut scene = Scene::default();
        for k in 0..count {
            let (place, turn) = (random.in_cube() * RADIUS, random.rotation());
            let gray = Rgb::gray(random.decade(-decades, decades) as f32);
            let corners = [[-0.2, -0.1, 0.1], [0.2, -0.2, -0.1], [-0.1, 0.2, -0.2], [0.2, 0.1, 0.1]].map(DVec3::from);
            match k % 11 {
                0 => scene.area(Box::new(Quad { size: [0.3, 0.1] }), place, turn, gray, false),
                1 => scene.area(Box::new(Disk { radius: 0.2 }), place, turn, gray, true),
                2 => scene.area(Box::new(Sphere { radius: 0.1 }), place, turn, gray, false),
                3 => scene.lights.push(Light::Point(Point { position: place, intensity: gray })),
                4 => scene.lights.push(spot(place, random.direction(), gray)),
                5 => scene.area(Box::new(Cylinder { radius: 0.1, z: [-0.5, 0.5], phi_max: 360.0 }), place, turn, gray, false),
                6 => scene.area(Box::new(Cone { radius: 0.2, height: 0.3, phi_max: 200.0 }), place, turn, gray, false),
                7 => scene.area(Box::new(PartialSphere { radius: 0.2, z: [0.1, 0.2], phi_max: 360.0 }), place, turn, gray, true),
                8 => scene.area(Box::new(PartialDisk { radius: 0.3, inner_radius: 0.2, phi_max: 90.0 }), place, turn, gray, false),
                9 => scene.area(Box::new(BilinearPatch { corners }), place, turn, gray, false),
                _ => scene.area(Box::new(Quad { size: [1.5, 0.7] }), place, turn, gray, false),
            }
        }
        for _ in 0..distant {
            let irradiance = Rgb::gray(random.decade(-1.0, 1.0) as f32);
            scene.lights.push(Light::Directional(Directional { direction: random.direction().as_vec3(), irradiance }));
        }
        if distant > 0 {
            scene.lights.push(Light::Environment(Environment { radiance: Rgb::gray(0.2) }));
            scene.lights.push(Light::Sun(Sun::new(random.direction().as_vec3(), Rgb::gray(5.0), 10.0)));
            scene.lights.push(environment_map(1.0));
        }
        scene
    }

    fn area(&mut self, geometry: Box<dyn Geometry>, place: DVec3, turn: Transform, radiance: Rgb, two_sided: bool) {
        let emitter = Emitter { two_sided, ..Emitter::new(radiance) };
        self.lights.push(Light::Area(Area::new(self.shapes.len() as u32, 0, emitter)));
        self.shapes.push((geometry, place, turn));
    }

    /// The lights of a scene whose lengths are multiplied by `size` and whose radiances by `power`.
    fn lights(&self, size: f64, power: f32) -> Lights {
        let baked = |(geometry, place, turn): &(Box<dyn Geometry>, DVec3, Transform)| {
            let grown = turn.then(&Transform::scale(DVec3::splat(size)).expect("a scale"));
            geometry.bake(&grown.then(&moved(*place * size))).expect("a shape")
        };
        let shapes: Vec<Box<dyn Shape>> = self.shapes.iter().map(baked).collect();
        let (length, area) = (size as f32, (size * size) as f32);
        let lights = self.lights.iter().cloned().map(|light| match light {
            Light::Area(a) => Light::Area(Area::new(a.shape, a.primitive, Emitter { radiance: a.emitter.radiance * power, ..a.emitter })),
            Light::Point(p) => Light::Point(Point { position: p.position * size, intensity: p.intensity * (power * area) }),
            Light::Spot(s) => Light::Spot(Spot { position: s.position * size, intensity: s.intensity * (power * area), ..s }),
            Light::Directional(d) => Light::Directional(Directional { irradiance: d.irradiance * power, ..d }),
            Light::Sun(s) => Light::Sun(Sun { radiance: s.radiance * power, ..s }),
            Light::Environment(e) => Light::Environment(Environment { radiance: e.radiance * power }),
            Light::EnvironmentMap(_) => environment_map(power),
            Light::Profiled(p) => {
                Light::Profiled(ProfiledPoint { position: p.position * size, intensity: p.intensity * (power * area), ..p })
            }
            Light::Projector(mut p) => {
                p.spot = Spot { position: p.spot.position * size, intensity: p.spot.intensity * (power * area), ..p.spot };
                Light::Projector(p)
            }
            Light::Placed(_) => unreachable!("none of these lights is placed"),
        });
        Lights::new(lights.collect(), shapes.into(), (Vec3::ZERO, RADIUS as f32 * length))
    }

    /// A light `count` times, and nothing else: with one, sampling it needs no choice.
    fn alone(&self, index: usize, count: usize) -> Lights {
        let mut light = self.lights[index].clone();
        let mut shapes = vec![];
        if let Light::Area(area) = &mut light {
            let (geometry, place, turn) = &self.shapes[area.shape as usize];
            shapes.push(geometry.bake(&turn.then(&moved(*place))).expect("a shape"));
            area.shape = 0;
        }
        Lights::new(vec![light; count], shapes.into(), (Vec3::ZERO, RADIUS as f32))
    }
}

/// A picture of a bright half of the sky.
fn environment_map(scale: f32) -> Light {
    let values = (0..32).map(|k| if k % 8 < 4 { [0.3, 0.2, 0.1] } else { [0.0, 0.01, 0.0] }).collect();
    let pixels = Arc::new(Pixels::new(UVec2::new(8, 4), values).expect("pixels"));
    Light::EnvironmentMap(Arc::new(EnvironmentMap::new(pixels, Mapping::LatLong, Rgb::gray(scale), Mat3::IDENTITY)))
}

fn moved(place: DVec3) -> Transform {
    Transform::translate(place).expect("finite")
}

fn spot(position: DVec3, axis: DVec3, intensity: Rgb) -> Light {
    let axis = axis.as_vec3();
    Light::Spot(Spot { position, axis, intensity, cos_inner: 0.9, cos_outer: 0.8, falloff: Falloff::Smooth })
}

/// A point in the scene: on an opaque surface, on one that transmits light, or in empty space.
fn receiver(random: &mut Random) -> LightSampleContext {
    let (p, n) = ((random.in_cube() * RADIUS).as_vec3(), random.direction().as_vec3());
    let on_surface = LightSampleContext { ng: n, ns: n, ..LightSampleContext::at(p) };
    match random.below(3) {
        0 => on_surface,
        1 => LightSampleContext { transmits: true, ..on_surface },
        _ => LightSampleContext::at(p),
    }
}

/// The probabilities of all lights add up to 1 at every point, and the probability that a sample states is that of its light to the
/// last bit.
#[test]
fn probabilities_add_up_and_are_stated_exactly() {
    let mut random = Random::new(1);
    for (count, distant, decades) in [(2, 0, 2.0), (7, 1, 2.0), (9, 0, 15.0), (70, 0, 2.0), (300, 3, 15.0), (0, 3, 2.0)] {
        let scene = Scene::mixed(count, distant, decades, &mut random);
        let lights = scene.lights(1.0, 1.0);
        let mut lit = 0;
        for _ in 0..2000 {
            let cx = receiver(&mut random);
            let probability = |light: usize| lights.probability(light as u32, &cx);
            let sum: f64 = (0..lights.len()).map(|light| f64::from(probability(light))).sum();
            // Each probability is the product of a few rounded ratios. Where no light shines, none is chosen.
            let may_be_dark = distant == 0 && cx.is_one_sided();
            assert!((sum - 1.0).abs() < 2e-6 || sum == 0.0 && may_be_dark, "{count} lights and {distant} suns at {cx:?}: {sum}");
            lit += u32::from(sum > 0.0);
            if let Some(sample) = lights.sample(&cx, random.unit() as f32, random.square()) {
                assert!(sum > 0.0, "{count} lights at {cx:?}");
                assert_eq!(sample.probability.to_bits(), probability(sample.light as usize).to_bits(), "{count} lights at {cx:?}");
            }
        }
        // Each of two lights has a dark side for one receiver in three.
        assert!(lit > 1500, "{count} lights light {lit} of 2000 points");
    }
}

/// Evenly spaced choices choose each light as often as its probability says.
#[test]
fn lights_are_chosen_as_often_as_stated() {
    const N: u32 = 1 << 16;
    let mut random = Random::new(2);
    // Points and quads that shine to both sides, so that a chosen light always gives a sample.
    let mut scene = Scene::default();
    for _ in 0..50 {
        let (place, turn) = (random.in_cube() * RADIUS, random.rotation());
        scene.area(Box::new(Quad { size: [0.3, 0.1] }), place, turn, Rgb::gray(random.decade(-1.0, 1.0) as f32), true);
        scene.lights.push(Light::Point(Point { position: random.in_cube() * RADIUS, intensity: Rgb::WHITE }));
    }
    let lights = scene.lights(1.0, 1.0);
    for _ in 0..20 {
        let cx = receiver(&mut random);
        let mut counts = vec![0u32; lights.len()];
        for k in 0..N {
            let choice = (f64::from(k) + 0.5) / f64::from(N);
            counts[lights.sample(&cx, choice as f32, Vec2::splat(0.4)).expect("a sample").light as usize] += 1;
        }
        for (light, count) in counts.into_iter().enumerate() {
            let expected = f64::from(lights.probability(light as u32, &cx)) * f64::from(N);
            // The choices of a light are at most two intervals, each with a choice more or less at its ends; the number is rounded at
            // each level.
            assert!((f64::from(count) - expected).abs() < 3.0, "light {light} at {cx:?}: {count} and not {expected}");
        }
    }
}

/// A light that can bring anything to a point can be chosen for it: 10⁶ pairs. With the same light twice and nothing else, its own bounds
/// decide; in the tree of all lights those of the nodes above do.
#[test]
fn every_light_that_shines_can_be_chosen() {
    let mut random = Random::new(3);
    let scene = Scene::mixed(250, 3, 2.0, &mut random);
    let lights = scene.lights(1.0, 1.0);
    let [alone, twice] = [1, 2].map(|count| (0..scene.lights.len()).map(|k| scene.alone(k, count)).collect::<Vec<_>>());
    let mut shining = 0;
    for _ in 0..4000 {
        let cx = receiver(&mut random);
        for (index, light) in alone.iter().enumerate() {
            let Some(sample) = light.sample(&cx, 0.5, random.square()) else { continue };
            if cx.ns == Vec3::ZERO || cx.transmits || cx.ns.dot(sample.wi) > 0.0 {
                shining += 1;
                assert!(twice[index].probability(0, &cx) > 0.0, "light {index} alone at {cx:?}");
                assert!(lights.probability(index as u32, &cx) > 0.0, "light {index} at {cx:?}");
            }
        }
    }
    assert!(shining > 200_000, "{shining} of 10⁶ pairs are lit");
}

/// Behind an opaque surface nothing is chosen.
#[test]
fn no_light_is_chosen_behind_an_opaque_surface() {
    let light = |x: f64| Light::Point(Point { position: DVec3::new(x, 0.0, -1.0), intensity: Rgb::WHITE });
    let lights = Lights::new(vec![light(-1.0), light(1.0)], vec![].into(), (Vec3::ZERO, 2.0));
    let above = LightSampleContext { ng: Vec3::Z, ns: Vec3::Z, ..LightSampleContext::at(Vec3::ZERO) };
    assert!(lights.sample(&above, 0.3, Vec2::splat(0.5)).is_none());
    assert_eq!(lights.probability(0, &above), 0.0);
    for cx in
        [LightSampleContext { transmits: true, ..above }, LightSampleContext { ns: -Vec3::Z, ..above }, LightSampleContext::at(Vec3::ZERO)]
    {
        assert_eq!(lights.probability(0, &cx), 0.5, "{cx:?}");
    }
}

/// A light is found where a stronger one is hidden by its side of the surface, however weak and far it is.
#[test]
fn weak_lights_are_found_beside_strong_ones() {
    let light = |z: f64, intensity: f32| Light::Point(Point { position: DVec3::new(0.0, 0.0, z), intensity: Rgb::gray(intensity) });
    for (z, intensity) in [(1.0, 1e-30), (1e8, 1e-30), (1e18, 1e-10), (1e18, 1e-37)] {
        let lights = Lights::new(vec![light(-1.0, 1.0), light(z, intensity)], vec![].into(), (Vec3::ZERO, 1e18));
        let above = LightSampleContext { ng: Vec3::Z, ns: Vec3::Z, ..LightSampleContext::at(Vec3::ZERO) };
        let [hidden, seen] = [0, 1].map(|light| lights.probability(light, &above));
        assert!(seen > 0.98 && hidden < 0.02, "{intensity} W/sr at {z} m: {hidden} and {seen}");
    }
}

/// Multiplying all lengths or all radiances by a power of two changes no bit of any choice.
#[test]
fn scale_of_size_and_power_is_exact() {
    let mut random = Random::new(4);
    let scene = Scene::mixed(200, 2, 2.0, &mut random);
    let lights = scene.lights(1.0, 1.0);
    for (size, power) in [(1.0, 1024.0), (1.0, 2f32.powi(-60)), (2f64.powi(-40), 1.0), (2f64.powi(40), 2f32.powi(20))] {
        let scaled = scene.lights(size, power);
        for _ in 0..500 {
            let cx = receiver(&mut random);
            let far = LightSampleContext { p: cx.p * size as f32, ..cx };
            let (choice, u) = (random.unit() as f32, random.square());
            let chosen = |lights: &Lights, cx| lights.sample(&cx, choice, u).map(|s| (s.light, s.probability.to_bits()));
            assert_eq!(chosen(&lights, cx), chosen(&scaled, far), "size {size}, power {power}, at {cx:?}");
        }
    }
}

/// A light alone is chosen without looking at the point, and many lights at one place are all chosen.
#[test]
fn single_and_coincident_lights() {
    let light = || Light::Point(Point { position: DVec3::ONE, intensity: Rgb::WHITE });
    for count in [1, 2, 8, 9, 100] {
        let lights = Lights::new((0..count).map(|_| light()).collect(), vec![].into(), (Vec3::ZERO, 2.0));
        for k in 0..count {
            let exact = 1.0 / f64::from(count);
            let [beside, within] = [Vec3::ZERO, Vec3::ONE].map(|p| f64::from(lights.probability(k, &LightSampleContext::at(p))));
            assert!((beside / exact - 1.0).abs() < 1e-5, "{count} lights, {k}: {beside}");
            // At the place of the lights themselves all importances are the greatest number, also those of unequal parts of the tree.
            assert!(within > 0.1 * exact && within < 10.0 * exact, "{count} lights, {k}: {within}");
        }
        if count == 1 {
            assert_eq!(lights.probability(0, &LightSampleContext::at(Vec3::ONE)), 1.0);
        }
    }
}

/// Ten thousand lamps under a ceiling and the floor below: the sum of the squares of what a lamp brings, divided by its probability, is
/// the mean square of a sample. It is near the least possible, the square of the sum, and far below that of equal probabilities.
#[test]
fn choices_follow_what_lights_bring() {
    let mut random = Random::new(5);
    let mut scene = Scene::default();
    for _ in 0..10_000 {
        let down = Transform::rotate(DVec3::X, 180.0).expect("an axis");
        let place = DVec3::new(random.range(-20.0, 20.0), random.range(-20.0, 20.0), random.range(1.0, 3.0));
        scene.area(Box::new(Quad { size: [0.05, 0.05] }), place, down, Rgb::gray(random.decade(-0.5, 0.5) as f32), false);
    }
    let lights = scene.lights(1.0, 1.0);
    let (mut tree, mut equal, mut least) = (0.0, 0.0, 0.0);
    for _ in 0..200 {
        let p = DVec3::new(random.range(-20.0, 20.0), random.range(-20.0, 20.0), 0.0);
        let cx = LightSampleContext { ng: Vec3::Z, ns: Vec3::Z, ..LightSampleContext::at(p.as_vec3()) };
        let mut sum = 0.0;
        for (index, (light, (_, place, _))) in (0..).zip(scene.lights.iter().zip(&scene.shapes)) {
            let Light::Area(area) = light else { panic!("all are quads") };
            let line = *place - p;
            let brings = f64::from(area.emitter.radiance.max()) * line.z * line.z / line.length_squared().powi(2);
            sum += brings;
            tree += brings * brings / f64::from(lights.probability(index, &cx));
            equal += brings * brings * 10_000.0;
        }
        least += sum * sum;
    }
    // The lamps of a node are compared by one distance and one angle each: 1.5 leaves room for that, and equal probabilities cost some 95
    // times the least.
    assert!(tree < 1.5 * least, "{} times the least mean square", tree / least);
    assert!(equal > 50.0 * tree, "equal probabilities have {} times the mean square", equal / tree);
}

/// The sky of an opaque surface is sampled in proportion to the cosine: every sample brings the same, π times the radiance.
#[test]
fn sky_is_sampled_with_the_cosine() {
    let sky = Lights::new(vec![Light::Environment(Environment { radiance: Rgb::WHITE })], vec![].into(), (Vec3::ZERO, 1.0));
    let mut random = Random::new(6);
    for _ in 0..1000 {
        let n = random.direction().as_vec3();
        let above = LightSampleContext { ng: n, ns: n, ..LightSampleContext::at(Vec3::ZERO) };
        let sample = sky.sample(&above, 0.5, random.square()).expect("a sample");
        let cos = f64::from(sample.wi.dot(n));
        // Near the horizon the cosine of a unit vector has few digits.
        assert!((f64::from(sample.weight().average()) * cos / PI - 1.0).abs() < 1e-5 + 1e-6 / cos, "cos {cos}");
        assert_eq!(sky.background_pdf(0, &above, -sample.wi).get(), 0.0, "below the horizon");
    }
}
