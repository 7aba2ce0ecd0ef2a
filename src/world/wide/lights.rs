//! Light samples for the points of several lanes.

use glam::{Vec2, Vec3};

use super::{SurfaceLanes, WideWorld};
use crate::light::area::MIN_SQUARE;
use crate::light::{Light, LightSample, LightSampleContext, ShadowTarget};
use crate::math::lanes::{Lanes, MAX_COUNT, Rays, Vector, VectorF64, each_lane};
use crate::math::{Density, Spectrum};
use crate::scene::ROUNDING;
use crate::shape::{Facet, NEAR, SurfacePoint};
use crate::world::World;

/// Light samples, one in each lane.
pub struct LightLanes<L: Lanes> {
    /// Which lanes have one.
    pub found: L::Mask,
    /// Unit directions towards the lights.
    pub wi: Vector<L>,
    /// Radiance divided by density, as [`LightSample::weight`].
    pub weight: Vector<L>,
    /// Densities of the directions [sr⁻¹]; negative for delta lights.
    pub pdf: L::F32,
    /// Ends of the shadow rays (m).
    end: Vector<L>,
    /// Unit normals of the surfaces at the ends; zero for points in empty space.
    end_normal: Vector<L>,
    end_offset: L::F32,
    /// Lanes whose shadow ray has no end.
    is_distant: L::Mask,
}

/// Points for which lights are sampled, one in each lane: see [`LightSampleContext`].
#[derive(Clone, Copy)]
pub struct ReceiverLanes<L: Lanes> {
    /// Positions (m).
    pub p: Vector<L>,
    /// Geometric normals.
    pub ng: Vector<L>,
    /// Shading normals on the side of the viewer.
    pub ns: Vector<L>,
    /// Whether light from behind may be scattered to the viewer too.
    pub transmits: L::Mask,
}

impl<L: Lanes> ReceiverLanes<L> {
    /// The point of a lane.
    #[inline(always)]
    pub fn get(&self, lane: usize) -> LightSampleContext {
        let transmits = L::bits(self.transmits) >> lane & 1 == 1;
        LightSampleContext { p: self.p.get(lane), ng: self.ng.get(lane), ns: self.ns.get(lane), transmits, time: 0.0 }
    }
}

/// The only light of a scene, a parallelogram.
pub(super) struct QuadLight {
    index: u32,
    corner: Vec3,
    edges: [Vec3; 2],
    normal: Vec3,
    offset: f32,
    /// Density of points [m⁻²].
    area_pdf: f32,
    radiance: Vec3,
    is_two_sided: bool,
    center: Vec3,
    /// Square of the distance of the centre within which points are sampled in another way than by area (m²).
    near2: f32,
}

impl QuadLight {
    /// The light of a scene, if it is the only one and a parallelogram that emits the same everywhere.
    pub fn of(world: &World) -> Option<QuadLight> {
        let index = world.lights.only()?;
        let Some(Light::Area(area)) = world.lights.iter().nth(index as usize) else { return None };
        let shape = &world.shapes[area.shape as usize];
        let Facet::Parallelogram([a, b, c, d]) = shape.facet(area.primitive) else { return None };
        if shape.has_shading_normals() {
            return None;
        }
        let point = shape.sample_area(area.primitive, Vec2::ZERO).0;
        let radius = 0.5 * (c - a).length();
        Some(QuadLight {
            index,
            corner: a,
            edges: [b - a, d - a],
            normal: point.ng,
            offset: point.offset,
            area_pdf: 1.0 / shape.area(area.primitive),
            radiance: Vec3::from(Spectrum::from_illuminant(area.emitter.radiance).coefficients()),
            is_two_sided: area.emitter.two_sided,
            center: 0.5 * (a + c),
            near2: NEAR * NEAR * (radius * radius),
        })
    }

    /// Lanes for which points are sampled in another way than by area.
    #[inline(always)]
    fn is_near<L: Lanes>(&self, from: Vector<L>) -> L::Mask {
        L::lt((from - Vector::splat(self.center)).length_squared(), L::f32(self.near2))
    }

    /// Density of points by area as a density by solid angle, and whether it is finite: see [`AreaPdf`](crate::math::AreaPdf).
    #[inline(always)]
    fn pdf<L: Lanes>(&self, line: Vector<L>) -> (L::F32, L::Mask) {
        let line = line.widened();
        let n = VectorF64::<L>::splat(self.normal.as_dvec3());
        let d2 = line.length_squared();
        let pdf = L::narrow(L::f64(self.area_pdf.into()) * (d2 * L::sqrt_f64(d2) / L::abs_f64(n.dot(line))));
        (pdf, L::lt(pdf, L::f32(f32::INFINITY)))
    }
}

/// Light samples of lanes that have no vector code.
struct Samples {
    found: u32,
    wi: [[f32; MAX_COUNT]; 3],
    weight: [[f32; MAX_COUNT]; 3],
    pdf: [f32; MAX_COUNT],
    end: [[f32; MAX_COUNT]; 3],
    end_normal: [[f32; MAX_COUNT]; 3],
    end_offset: [f32; MAX_COUNT],
    is_distant: u32,
}

impl<'a> WideWorld<'a> {
    /// Samples a light in each lane, as [`Lights::sample`](crate::light::Lights::sample).
    #[inline(always)]
    pub fn sample_light<L: Lanes>(&self, at: &ReceiverLanes<L>, [choice, u, v]: [L::F32; 3], active: L::Mask) -> LightLanes<L> {
        let zero = Vector::<L>::splat(Vec3::ZERO);
        let mut found = L::mask(0);
        let mut light =
            LightLanes { found, wi: zero, weight: zero, pdf: zero.x, end: zero, end_normal: zero, end_offset: zero.x, is_distant: found };
        let mut others = active;
        if let Some(quad) = &self.tables.light {
            let (x, y) = (Vector::<L>::splat(quad.edges[0]), Vector::<L>::splat(quad.edges[1]));
            light.end = Vector::splat(quad.corner) + x.scaled(u) + y.scaled(v);
            light.end_normal = Vector::splat(quad.normal);
            light.end_offset = L::f32(quad.offset);
            let line = light.end - at.p;
            let square = line.length_squared();
            others = active & (quad.is_near(at.p) | L::lt(square, L::f32(MIN_SQUARE)));
            let (pdf, is_finite) = quad.pdf(line);
            let inverse = L::f32(1.0) / L::sqrt(square);
            light.wi = line.scaled(inverse);
            let shines = L::lt(L::f32(0.0), light.end_normal.dot(-light.wi));
            let shines = if quad.is_two_sided { active } else { shines };
            let is_direction = L::lt(L::f32(0.0), inverse) & L::lt(inverse, L::f32(f32::INFINITY));
            light.pdf = pdf;
            light.weight = Vector::splat(quad.radiance).divided(pdf);
            found = active & !others & is_finite & shines & is_direction;
        }
        if L::any(others) {
            self.sample_lights_one_by_one(at, [choice, u, v], L::bits(others), L::bits(found), &mut light);
            return light;
        }
        LightLanes { found, ..light }
    }

    #[inline(always)]
    fn sample_lights_one_by_one<L: Lanes>(
        &self,
        at: &ReceiverLanes<L>,
        numbers: [L::F32; 3],
        which: u32,
        found: u32,
        light: &mut LightLanes<L>,
    ) {
        let mut samples = Samples {
            found,
            wi: light.wi.to_arrays(),
            weight: light.weight.to_arrays(),
            pdf: [0.0; MAX_COUNT],
            end: light.end.to_arrays(),
            end_normal: light.end_normal.to_arrays(),
            end_offset: [0.0; MAX_COUNT],
            is_distant: 0,
        };
        L::store(light.pdf, &mut samples.pdf);
        L::store(light.end_offset, &mut samples.end_offset);
        let mut arrays = [[0.0; MAX_COUNT]; 3];
        L::store(numbers[0], &mut arrays[0]);
        L::store(numbers[1], &mut arrays[1]);
        L::store(numbers[2], &mut arrays[2]);
        for lane in each_lane(which) {
            if let Some(sample) = self.sample_one(&at.get(lane), [arrays[0][lane], arrays[1][lane], arrays[2][lane]]) {
                samples.set(lane, &sample);
            }
        }
        *light = LightLanes {
            found: L::mask(samples.found),
            wi: Vector::from_arrays(&samples.wi),
            weight: Vector::from_arrays(&samples.weight),
            pdf: L::load(&samples.pdf),
            end: Vector::from_arrays(&samples.end),
            end_normal: Vector::from_arrays(&samples.end_normal),
            end_offset: L::load(&samples.end_offset),
            is_distant: L::mask(samples.is_distant),
        };
    }

    #[inline(never)]
    fn sample_one(&self, at: &LightSampleContext, [choice, u, v]: [f32; 3]) -> Option<LightSample> {
        self.world.lights.sample(at, choice, Vec2::new(u, v))
    }

    /// Densities with which [`WideWorld::sample_light`] samples the points of emitting surfaces for other points: see
    /// [`Lights::pdf`](crate::light::Lights::pdf).
    #[inline(always)]
    pub fn light_pdf<L: Lanes>(&self, from: &ReceiverLanes<L>, rays: &Rays<L>, surface: &SurfaceLanes<L>, active: L::Mask) -> L::F32 {
        let mut pdf = L::f32(0.0);
        let mut others = L::bits(active);
        if let Some(quad) = &self.tables.light {
            let mut is_it = 0;
            for lane in each_lane(others) {
                is_it |= u32::from(self.light_index(surface, lane) == quad.index) << lane;
            }
            let by_area = L::mask(is_it) & !quad.is_near(from.p);
            let (by_solid_angle, is_finite) = quad.pdf(surface.p - from.p);
            pdf = L::select(by_area & is_finite, by_solid_angle, pdf);
            others &= !L::bits(by_area);
        }
        if others != 0 {
            let mut pdfs = [0.0; MAX_COUNT];
            L::store(pdf, &mut pdfs);
            for lane in each_lane(others) {
                let point = self.point(&rays.get(lane), &surface.hits, lane);
                pdfs[lane] = self.light_pdf_of_one(self.light_index(surface, lane), &from.get(lane), &point);
            }
            pdf = L::load(&pdfs);
        }
        pdf
    }

    /// Index of the light of a lane's surface.
    #[inline(always)]
    fn light_index<L: Lanes>(&self, surface: &SurfaceLanes<L>, lane: usize) -> u32 {
        let hits = &surface.hits;
        self.world.appearances[hits.shape[lane] as usize].first_light + hits.primitive[lane]
    }

    #[inline(never)]
    fn light_pdf_of_one(&self, light: u32, from: &LightSampleContext, point: &SurfacePoint) -> f32 {
        self.world.lights.pdf(light, from, point).get()
    }
}

impl Samples {
    #[inline(always)]
    fn set(&mut self, lane: usize, sample: &LightSample) {
        let weight = sample.weight().coefficients();
        let (end, normal, offset) = match sample.target {
            ShadowTarget::Infinity => (Vec3::ZERO, Vec3::ZERO, 0.0),
            ShadowTarget::Point(end) => (end, Vec3::ZERO, 0.0),
            ShadowTarget::Surface(point) => (point.p, point.ng, point.offset),
        };
        for axis in 0..3 {
            self.wi[axis][lane] = sample.wi[axis];
            self.weight[axis][lane] = weight[axis];
            self.end[axis][lane] = end[axis];
            self.end_normal[axis][lane] = normal[axis];
        }
        self.end_offset[lane] = offset;
        self.pdf[lane] = match sample.density {
            Density::Smooth(pdf) => pdf.get(),
            Density::Delta => -1.0,
        };
        self.is_distant |= u32::from(sample.target == ShadowTarget::Infinity) << lane;
        self.found |= 1 << lane;
    }
}

impl<L: Lanes> SurfaceLanes<L> {
    /// Shadow rays towards light samples, as [`Surface::shadow_ray`](crate::scene::Surface::shadow_ray).
    #[inline(always)]
    pub fn shadow_rays(&self, light: &LightLanes<L>) -> Rays<L> {
        let start = self.spawn(light.wi);
        let origin = start.origin;
        let far = light.end - origin;
        let deviation = L::f32(ROUNDING) * (L::abs(far.x) + L::abs(far.y) + L::abs(far.z));
        let offset = light.end_offset + deviation;
        let below = L::lt(light.end_normal.dot(-light.wi), L::f32(0.0));
        let line = light.end + light.end_normal.scaled(L::select(below, -offset, offset)) - origin;
        let distance = line.length();
        let t_max = distance * L::f32(1.0 - ROUNDING);
        let direction = Vector::select(light.is_distant, start.direction, line.divided(distance));
        // The rays end off the lights, so that their directions are not exactly `wi`.
        Rays { origin, direction, t_max: L::select(light.is_distant, start.t_max, t_max), skip: self.skip(light.wi, direction) }
    }

    /// The surfaces as lights are sampled for them.
    ///
    /// - `wo`: directions to the viewer
    #[inline(always)]
    pub fn receiver(&self, wo: Vector<L>) -> ReceiverLanes<L> {
        ReceiverLanes { p: self.p, ng: self.ng, ns: self.ns_towards(wo), transmits: self.transmits }
    }
}
