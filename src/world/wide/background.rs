//! Infinitely distant lights, for the paths of several lanes.

use super::{LightLanes, ReceiverLanes, WideWorld};
use crate::light::environment::{FlatLight, FlatLightLanes};
use crate::light::{EnvironmentMap, Light};
use crate::math::lanes::{Kernel, Lanes, MAX_COUNT, Rays, Vector, each_lane, to_array};

impl<'a> WideWorld<'a> {
    /// Indices of the infinitely distant lights that a ray sees which hits no surface.
    pub fn background_lights(&self) -> &'a [u32] {
        self.world.lights.infinite()
    }

    /// Radiance of an infinitely distant light that arrives along rays which hit nothing, as
    /// [`Lights::background`](crate::light::Lights::background).
    ///
    /// - `which`: lanes that are asked for
    #[inline(always)]
    pub fn background<L: Lanes>(&self, light: u32, rays: &Rays<L>, which: L::Mask) -> Vector<L> {
        match self.world.lights.get(light) {
            Light::Environment(environment) => environment.radiance_lanes(),
            Light::EnvironmentMap(map) => {
                let lookup = MapRadiance { map, directions: rays.direction.to_arrays() };
                Vector::from_arrays(&self.width().run(lookup))
            }
            light => {
                let mut radiance = [[0.0; MAX_COUNT]; 3];
                for lane in each_lane(L::bits(which)) {
                    let arriving = light.background(rays.direction.get(lane)).coefficients();
                    (0..3).for_each(|axis| radiance[axis][lane] = arriving[axis]);
                }
                Vector::from_arrays(&radiance)
            }
        }
    }

    /// [`WideWorld::background`], and the densities with which [`WideWorld::sample_light`] samples the directions of the rays for the
    /// points that they leave, as [`Lights::background_pdf`](crate::light::Lights::background_pdf).
    #[inline(always)]
    pub fn background_and_pdf<L: Lanes>(&self, light: u32, rays: &Rays<L>, from: &ReceiverLanes<L>, which: L::Mask) -> (Vector<L>, L::F32) {
        let flat = from.flat();
        let (radiance, pdf) = match self.world.lights.get(light) {
            Light::Environment(environment) => (environment.radiance_lanes(), flat.pdf(rays.direction)),
            Light::EnvironmentMap(map) => {
                let lookup = MapLookup { map, points: Points::new(&flat), directions: rays.direction.to_arrays() };
                let (radiance, pdf) = self.width().run(lookup);
                (Vector::from_arrays(&radiance), L::load(&pdf))
            }
            other => {
                let mut pdfs = [0.0; MAX_COUNT];
                for lane in each_lane(L::bits(which)) {
                    pdfs[lane] = other.background_pdf(&from.get(lane), rays.direction.get(lane)).get();
                }
                (self.background(light, rays, which), L::load(&pdfs))
            }
        };
        (radiance, pdf * self.probability(light, from, which))
    }

    /// Samples directions of an environment or an environment map, with radiance in the place of weights; `None` for other lights.
    ///
    /// - `u`: two random numbers for each lane
    #[inline(always)]
    pub(super) fn sample_background<L: Lanes>(
        &self,
        light: u32,
        at: &ReceiverLanes<L>,
        u: [L::F32; 2],
        active: L::Mask,
    ) -> Option<LightLanes<L>> {
        let flat = at.flat();
        let (found, wi, radiance, pdf) = match self.world.lights.get(light) {
            Light::Environment(environment) => {
                let wi = flat.sample(u);
                (active, wi, environment.radiance_lanes(), flat.pdf(wi))
            }
            Light::EnvironmentMap(map) => {
                let sample = MapSample { map, points: Points::new(&flat), u: [to_array::<L>(u[0]), to_array::<L>(u[1])] };
                let (wi, radiance, pdf) = self.width().run(sample);
                let (wi, radiance, pdf) = (Vector::from_arrays(&wi), Vector::<L>::from_arrays(&radiance), L::load(&pdf));
                (active & L::lt(L::f32(0.0), pdf) & !radiance.is_black(), wi, radiance, pdf)
            }
            _ => return None,
        };
        Some(LightLanes { found, wi, weight: radiance, pdf, is_distant: active, ..LightLanes::none() })
    }

    /// Probabilities with which an infinitely distant light is sampled for points, see [`Lights::probability`](crate::light::Lights::probability).
    #[inline(always)]
    fn probability<L: Lanes>(&self, light: u32, from: &ReceiverLanes<L>, which: L::Mask) -> L::F32 {
        if let Some(only) = self.world.lights.only() {
            return L::f32(if light == only { 1.0 } else { 0.0 });
        }
        let (mut probability, mut others) = (L::f32(0.0), which);
        if let Some(of_few) = self.world.lights.choice_of_few() {
            let one_sided = from.one_sided(which);
            probability = of_few.infinite_probability_lanes(&one_sided, light);
            others = which & !one_sided.active;
        }
        if L::any(others) {
            let mut probabilities = to_array::<L>(probability);
            for lane in each_lane(L::bits(others)) {
                probabilities[lane] = self.world.lights.probability(light, &from.get(lane));
            }
            probability = L::load(&probabilities);
        }
        probability
    }
}

/// Three numbers for each lane.
type Triples = [[f32; MAX_COUNT]; 3];

// These kernels run within those that follow paths. Each is compiled once for a width and not wherever it is used, because it is long.

/// [`EnvironmentMap::radiance_lanes`].
struct MapRadiance<'a> {
    map: &'a EnvironmentMap,
    directions: Triples,
}

impl Kernel for MapRadiance<'_> {
    type Output = Triples;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Triples {
        self.map.radiance_lanes::<L>(Vector::from_arrays(&self.directions)).to_arrays()
    }
}

/// [`EnvironmentMap::radiance_and_pdf_lanes`].
struct MapLookup<'a> {
    map: &'a EnvironmentMap,
    points: Points,
    directions: Triples,
}

impl Kernel for MapLookup<'_> {
    type Output = (Triples, [f32; MAX_COUNT]);

    #[inline(always)]
    fn run<L: Lanes>(self) -> (Triples, [f32; MAX_COUNT]) {
        let (radiance, pdf) = self.map.radiance_and_pdf_lanes(&self.points.flat::<L>(), Vector::from_arrays(&self.directions));
        (radiance.to_arrays(), to_array::<L>(pdf))
    }
}

/// [`EnvironmentMap::sample_lanes`].
struct MapSample<'a> {
    map: &'a EnvironmentMap,
    points: Points,
    u: [[f32; MAX_COUNT]; 2],
}

impl Kernel for MapSample<'_> {
    type Output = (Triples, Triples, [f32; MAX_COUNT]);

    #[inline(always)]
    fn run<L: Lanes>(self) -> (Triples, Triples, [f32; MAX_COUNT]) {
        let u = [L::load(&self.u[0]), L::load(&self.u[1])];
        let (wi, radiance, pdf) = self.map.sample_lanes(&self.points.flat::<L>(), u);
        (wi.to_arrays(), radiance.to_arrays(), to_array::<L>(pdf))
    }
}

/// [`FlatLightLanes`] without a width.
struct Points {
    ns: Triples,
    is_one_sided: u32,
}

impl Points {
    #[inline(always)]
    fn new<L: Lanes>(flat: &FlatLightLanes<L>) -> Points {
        Points { ns: flat.ns.to_arrays(), is_one_sided: L::bits(flat.is_one_sided) }
    }

    #[inline(always)]
    fn flat<L: Lanes>(&self) -> FlatLightLanes<L> {
        FlatLightLanes { ns: Vector::from_arrays(&self.ns), is_one_sided: L::mask(self.is_one_sided) }
    }
}
