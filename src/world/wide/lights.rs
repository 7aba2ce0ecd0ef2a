//! Light samples for the points of several lanes.

use glam::{Vec2, Vec3};

use super::{SurfaceLanes, WideWorld};
use crate::accel::NO_PLACE;
use crate::light::area::MIN_SQUARE;
use crate::light::environment::FlatLightLanes;
use crate::light::{Area, ChosenLanes, Light, LightSample, LightSampleContext, OneSidedLanes, ShadowTarget};
use crate::math::lanes::{Lanes, MAX_COUNT, Rays, Vector, VectorF64, each_lane, to_array, to_array_u32};
use crate::math::{Density, RectangleFrame, Spectrum, SphericalRectangle};
use crate::scene::ROUNDING;
use crate::shape::{Facet, NEAR, PointLanes, SurfacePoint, in_direction_lanes};
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
    pub(super) end: Vector<L>,
    /// Unit normals of the surfaces at the ends; zero for points in empty space.
    pub(super) end_normal: Vector<L>,
    pub(super) end_offset: L::F32,
    /// Lanes whose shadow ray has no end.
    pub(super) is_distant: L::Mask,
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

impl<L: Lanes> LightLanes<L> {
    /// No samples.
    #[inline(always)]
    pub(super) fn none() -> LightLanes<L> {
        let (zero, none) = (Vector::<L>::splat(Vec3::ZERO), L::mask(0));
        LightLanes { found: none, wi: zero, weight: zero, pdf: zero.x, end: zero, end_normal: zero, end_offset: zero.x, is_distant: none }
    }

    /// `yes` where the mask is true, `no` elsewhere.
    #[inline(always)]
    fn select(mask: L::Mask, yes: LightLanes<L>, no: LightLanes<L>) -> LightLanes<L> {
        LightLanes {
            found: (mask & yes.found) | (!mask & no.found),
            wi: Vector::select(mask, yes.wi, no.wi),
            weight: Vector::select(mask, yes.weight, no.weight),
            pdf: L::select(mask, yes.pdf, no.pdf),
            end: Vector::select(mask, yes.end, no.end),
            end_normal: Vector::select(mask, yes.end_normal, no.end_normal),
            end_offset: L::select(mask, yes.end_offset, no.end_offset),
            is_distant: (mask & yes.is_distant) | (!mask & no.is_distant),
        }
    }
}

impl<L: Lanes> ReceiverLanes<L> {
    /// Points in empty space or in a medium, see [`LightSampleContext::at`].
    #[inline(always)]
    pub fn at(p: Vector<L>) -> ReceiverLanes<L> {
        let zero = Vector::splat(Vec3::ZERO);
        ReceiverLanes { p, ng: zero, ns: zero, transmits: L::mask(0) }
    }

    /// The points as receivers of light with the same radiance from everywhere, see [`LightSampleContext::is_one_sided`].
    #[inline(always)]
    pub(super) fn flat(&self) -> FlatLightLanes<L> {
        FlatLightLanes { ns: self.ns, is_one_sided: !(self.transmits | self.ns.is_black()) }
    }

    /// The points of some lanes at which light counts from one side alone.
    #[inline(always)]
    pub(super) fn one_sided(&self, active: L::Mask) -> OneSidedLanes<L> {
        OneSidedLanes { p: self.p, normal: self.ns, active: active & !(self.transmits | self.ns.is_black()) }
    }

    /// The point of a lane.
    #[inline(always)]
    pub fn get(&self, lane: usize) -> LightSampleContext {
        let transmits = L::bits(self.transmits) >> lane & 1 == 1;
        LightSampleContext { p: self.p.get(lane), ng: self.ng.get(lane), ns: self.ns.get(lane), transmits, time: 0.0 }
    }
}

/// A light that is sampled in all lanes at once.
pub(super) struct WideLight {
    index: u32,
    kind: Kind,
}

enum Kind {
    Quad(Box<QuadLight>),
    Sphere(SphereLight),
    /// An environment or an environment map.
    Infinite,
}

/// Greatest number of lights of a scene for which parallelograms and spheres among them are sampled in all lanes at once. With more, the
/// lanes mostly choose different lights, each of which is then sampled for few lanes.
const MAX_LIGHTS: usize = 4;

impl WideLight {
    /// Such lights of a scene.
    pub fn of(world: &World) -> Vec<WideLight> {
        let has_few = world.lights.len() <= MAX_LIGHTS;
        let kind = |light: &Light| match light {
            Light::Environment(_) | Light::EnvironmentMap(_) => Some(Kind::Infinite),
            Light::Area(area) if has_few => {
                QuadLight::of(world, area).map(|quad| Kind::Quad(Box::new(quad))).or_else(|| SphereLight::of(world, area).map(Kind::Sphere))
            }
            _ => None,
        };
        (0..).zip(world.lights.iter()).filter_map(|(index, light)| Some(WideLight { index, kind: kind(light)? })).collect()
    }
}

/// Emission that is the same everywhere on a surface.
struct Glow {
    radiance: Vec3,
    is_two_sided: bool,
}

impl Glow {
    /// Emission of a light; `None` if it has a texture.
    fn of(area: &Area) -> Option<Glow> {
        let radiance = Vec3::from(Spectrum::from_illuminant(area.emitter.radiance).coefficients());
        area.emitter.texture.is_none().then_some(Glow { radiance, is_two_sided: area.emitter.two_sided })
    }

    /// Light from sampled points of the surface, with radiance in the place of weights, and the lanes whose points are not too near.
    ///
    /// - `pdf`: densities of the points by solid angle [sr⁻¹]
    #[inline(always)]
    fn light<L: Lanes>(&self, at: &ReceiverLanes<L>, end: PointLanes<L>, pdf: L::F32, active: L::Mask) -> (LightLanes<L>, L::Mask) {
        let line = end.p - at.p;
        let square = line.length_squared();
        let sampled = active & !L::lt(square, L::f32(MIN_SQUARE));
        let inverse = L::f32(1.0) / L::sqrt(square);
        let wi = line.scaled(inverse);
        let shines = L::lt(L::f32(0.0), end.ng.dot(-wi));
        let shines = if self.is_two_sided { active } else { shines };
        let is_direction = L::lt(L::f32(0.0), inverse) & L::lt(inverse, L::f32(f32::INFINITY));
        let (found, weight) = (sampled & shines & is_direction, Vector::splat(self.radiance));
        (LightLanes { found, wi, weight, pdf, end: end.p, end_normal: end.ng, end_offset: end.offset, is_distant: L::mask(0) }, sampled)
    }
}

/// A light that is a parallelogram which emits the same everywhere.
struct QuadLight {
    /// A corner and its two neighbours.
    corners: [Vec3; 3],
    /// Frame of the edges, if they are perpendicular. Near points then sample the solid angle under which they see the rectangle.
    frame: Option<RectangleFrame>,
    normal: Vec3,
    offset: f32,
    /// Density of points [m⁻²].
    area_pdf: f32,
    glow: Glow,
    center: Vec3,
    /// Square of the distance of the centre within which a rectangle is near (m²).
    near2: f32,
}

impl QuadLight {
    fn of(world: &World, area: &Area) -> Option<QuadLight> {
        let shape = &world.shapes[area.shape as usize];
        let Facet::Parallelogram([a, b, c, d]) = shape.facet(area.primitive) else { return None };
        let glow = Glow::of(area).filter(|_| !shape.has_shading_normals())?;
        let point = shape.sample_area(area.primitive, Vec2::ZERO).0;
        let radius = 0.5 * (c - a).length();
        let frame = if shape.is_rectangle(area.primitive) { RectangleFrame::new([b - a, d - a]) } else { None };
        Some(QuadLight {
            corners: [a, b, d],
            frame,
            normal: point.ng,
            offset: point.offset,
            area_pdf: 1.0 / shape.area(area.primitive),
            glow,
            center: 0.5 * (a + c),
            near2: NEAR * NEAR * (radius * radius),
        })
    }

    /// Lanes whose points are near.
    #[inline(always)]
    fn is_near<L: Lanes>(&self, from: Vector<L>) -> L::Mask {
        L::lt((from - Vector::splat(self.center)).length_squared(), L::f32(self.near2))
    }

    /// The rectangle as near points see it, and the lanes in which it is sampled so; `None` if there are none.
    #[inline(always)]
    fn seen<L: Lanes>(&self, from: Vector<L>, active: L::Mask) -> Option<(SphericalRectangle<L>, L::Mask)> {
        let frame = self.frame.as_ref()?;
        let near = active & self.is_near(from);
        if !L::any(near) {
            return None;
        }
        let (seen, is_seen) = SphericalRectangle::seen(frame, Vector::splat(self.corners[0]) - from);
        Some((seen, near & is_seen))
    }

    /// Points with given coordinates.
    #[inline(always)]
    fn point<L: Lanes>(&self, [x, y]: [L::F32; 2]) -> Vector<L> {
        let [a, b, d] = self.corners;
        Vector::splat(a) + Vector::<L>::splat(b - a).scaled(x) + Vector::<L>::splat(d - a).scaled(y)
    }

    /// Samples points, with radiance in the place of weights, and the lanes for which this is the way to sample them.
    #[inline(always)]
    fn sample<L: Lanes>(&self, at: &ReceiverLanes<L>, [u, v]: [L::F32; 2], active: L::Mask) -> (LightLanes<L>, L::Mask) {
        let (mut x, mut y, mut by_solid_angle, mut solid_angle_pdf) = (u, v, L::mask(0), L::f32(0.0));
        if let Some((seen, is_seen)) = self.seen(at.p, active) {
            let near = in_direction_lanes::<L>(self.corners, at.p, seen.sample_lanes([u, v]));
            (x, y) = (L::select(is_seen, near[0], u), L::select(is_seen, near[1], v));
            (by_solid_angle, solid_angle_pdf) = (is_seen, seen.pdf_lanes());
        }
        let end = self.point([x, y]);
        let (by_area, is_finite) = self.pdf(end - at.p);
        let pdf = L::select(by_solid_angle, solid_angle_pdf, by_area);
        let end = PointLanes { p: end, ng: Vector::splat(self.normal), offset: L::f32(self.offset) };
        let (light, sampled) = self.glow.light(at, end, pdf, active);
        (LightLanes { found: light.found & (by_solid_angle | is_finite), ..light }, sampled)
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

/// A light that is a sphere which emits the same everywhere. Points inside of it have no vector code.
struct SphereLight {
    shape: u32,
    glow: Glow,
}

impl SphereLight {
    fn of(world: &World, area: &Area) -> Option<SphereLight> {
        let is_sphere = world.shapes[area.shape as usize].ellipsoid().is_some_and(|ellipsoid| ellipsoid.is_sphere());
        Glow::of(area).filter(|_| is_sphere).map(|glow| SphereLight { shape: area.shape, glow })
    }

    /// Samples points, with radiance in the place of weights, and the lanes for which this is the way to sample them.
    #[inline(always)]
    fn sample<L: Lanes>(&self, world: &World, at: &ReceiverLanes<L>, u: [L::F32; 2], active: L::Mask) -> (LightLanes<L>, L::Mask) {
        let none = (LightLanes::none(), L::mask(0));
        let Some(ellipsoid) = world.shapes[self.shape as usize].ellipsoid() else { return none };
        let Some((end, pdf, is_outside)) = ellipsoid.sample_lanes(at.p, u, active) else { return none };
        self.glow.light(at, end, pdf, is_outside)
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
        let chosen = self.choose_light(at, choice, active);
        let mut others = chosen.found;
        let mut light = LightLanes::none();
        for each in &self.tables.lights {
            let which = others & L::eq_u32(chosen.light, L::u32(each.index));
            if L::any(which) {
                let (sample, sampled) = match &each.kind {
                    Kind::Quad(quad) => quad.sample(at, [u, v], which),
                    Kind::Sphere(sphere) => sphere.sample(self.world, at, [u, v], which),
                    Kind::Infinite => {
                        let Some(sample) = self.sample_background(each.index, at, [u, v], which) else { continue };
                        (sample, which)
                    }
                };
                light = LightLanes::select(sampled, sample, light);
                others = others & !sampled;
            }
        }
        light.pdf = light.pdf * chosen.probability;
        light.weight = light.weight.divided(light.pdf);
        if L::any(others) {
            self.sample_lights_one_by_one(at, &chosen, [u, v], L::bits(others), &mut light);
        }
        light
    }

    /// Points of lights that are chosen by their power, and the lanes that have one, as [`Lights::place`](crate::light::Lights::place).
    #[inline(always)]
    pub fn place_of_light<L: Lanes>(&self, [choice, u, v]: [L::F32; 3], active: L::Mask) -> (Vector<L>, L::Mask) {
        if let [WideLight { index, kind: Kind::Quad(quad) }] = &self.tables.lights[..]
            && self.world.lights.only_emitter() == Some(*index)
        {
            return (quad.point([u, v]), active);
        }
        let (numbers, mut places, mut found) = ([choice, u, v].map(to_array::<L>), [[0.0; MAX_COUNT]; 3], 0);
        for lane in each_lane(L::bits(active)) {
            if let Some(place) = self.place_of_one(numbers[0][lane], Vec2::new(numbers[1][lane], numbers[2][lane])) {
                (0..3).for_each(|axis| places[axis][lane] = place[axis]);
                found |= 1 << lane;
            }
        }
        (Vector::from_arrays(&places), L::mask(found))
    }

    #[inline(never)]
    fn place_of_one(&self, choice: f32, u: Vec2) -> Option<Vec3> {
        self.world.lights.place(choice, u, 0.0)
    }

    /// Chooses lights, as [`Lights::choose`](crate::light::Lights::choose).
    #[inline(always)]
    fn choose_light<L: Lanes>(&self, at: &ReceiverLanes<L>, choice: L::F32, active: L::Mask) -> ChosenLanes<L> {
        if let Some(only) = self.world.lights.only() {
            return ChosenLanes { light: L::u32(only), probability: L::f32(1.0), found: active };
        }
        let mut chosen = ChosenLanes { light: L::u32(0), probability: L::f32(0.0), found: L::mask(0) };
        let mut others = active;
        if let Some(of_few) = self.world.lights.choice_of_few() {
            let one_sided = at.one_sided(active);
            chosen = of_few.sample_lanes(&one_sided, choice);
            others = active & !one_sided.active;
        }
        if L::any(others) {
            let (numbers, mut found) = (to_array::<L>(choice), L::bits(chosen.found));
            let (mut lights, mut probabilities) = (to_array_u32::<L>(chosen.light), to_array::<L>(chosen.probability));
            for lane in each_lane(L::bits(others)) {
                if let Some((light, probability)) = self.choose_one(&at.get(lane), numbers[lane]) {
                    (lights[lane], probabilities[lane]) = (light, probability);
                    found |= 1 << lane;
                }
            }
            chosen = ChosenLanes { light: L::load_u32(&lights), probability: L::load(&probabilities), found: L::mask(found) };
        }
        chosen
    }

    #[inline(never)]
    fn choose_one(&self, at: &LightSampleContext, choice: f32) -> Option<(u32, f32)> {
        self.world.lights.choose(at, choice)
    }

    #[inline(always)]
    fn sample_lights_one_by_one<L: Lanes>(
        &self,
        at: &ReceiverLanes<L>,
        chosen: &ChosenLanes<L>,
        [u, v]: [L::F32; 2],
        which: u32,
        light: &mut LightLanes<L>,
    ) {
        let mut samples = Samples {
            found: L::bits(light.found),
            wi: light.wi.to_arrays(),
            weight: light.weight.to_arrays(),
            pdf: to_array::<L>(light.pdf),
            end: light.end.to_arrays(),
            end_normal: light.end_normal.to_arrays(),
            end_offset: to_array::<L>(light.end_offset),
            is_distant: L::bits(light.is_distant),
        };
        let (lights, probabilities) = (to_array_u32::<L>(chosen.light), to_array::<L>(chosen.probability));
        let (u, v) = (to_array::<L>(u), to_array::<L>(v));
        for lane in each_lane(which) {
            let chosen = (lights[lane], probabilities[lane]);
            if let Some(sample) = self.sample_one(chosen, &at.get(lane), Vec2::new(u[lane], v[lane])) {
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
    fn sample_one(&self, chosen: (u32, f32), at: &LightSampleContext, u: Vec2) -> Option<LightSample> {
        self.world.lights.sample_of(chosen, at, u)
    }

    /// Densities with which [`WideWorld::sample_light`] samples the points of emitting surfaces for other points: see
    /// [`Lights::pdf`](crate::light::Lights::pdf).
    #[inline(always)]
    pub fn light_pdf<L: Lanes>(&self, from: &ReceiverLanes<L>, rays: &Rays<L>, surface: &SurfaceLanes<'_, L>, active: L::Mask) -> L::F32 {
        let mut pdf = L::f32(0.0);
        let mut others = L::bits(active);
        if let [WideLight { index, kind: Kind::Quad(quad) }] = &self.tables.lights[..]
            && self.world.lights.only() == Some(*index)
        {
            let mut is_it = 0;
            for lane in each_lane(others) {
                is_it |= u32::from(self.light_index(surface, lane) == *index) << lane;
            }
            let is_it = L::mask(is_it);
            let (by_area, is_finite) = quad.pdf(surface.p - from.p);
            pdf = L::select(is_it & is_finite, by_area, pdf);
            if let Some((seen, is_seen)) = quad.seen(from.p, is_it) {
                pdf = L::select(is_seen, seen.pdf_lanes(), pdf);
            }
            others &= !L::bits(is_it);
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
    fn light_index<L: Lanes>(&self, surface: &SurfaceLanes<'_, L>, lane: usize) -> u32 {
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

impl<L: Lanes> LightLanes<L> {
    /// Rays from points to the samples.
    #[inline(always)]
    pub(super) fn rays_from(&self, origin: Vector<L>) -> Rays<L> {
        let far = self.end - origin;
        let deviation = L::f32(ROUNDING) * (L::abs(far.x) + L::abs(far.y) + L::abs(far.z));
        let offset = self.end_offset + deviation;
        let below = L::lt(self.end_normal.dot(-self.wi), L::f32(0.0));
        let line = self.end + self.end_normal.scaled(L::select(below, -offset, offset)) - origin;
        let distance = line.length();
        let t_max = distance * L::f32(1.0 - ROUNDING);
        // The rays end off the lights, so that their directions are not exactly `wi`.
        let direction = Vector::select(self.is_distant, self.wi, line.divided(distance));
        Rays { origin, direction, t_max: L::select(self.is_distant, L::f32(f32::INFINITY), t_max), skip: L::u32(NO_PLACE) }
    }
}

impl<L: Lanes> SurfaceLanes<'_, L> {
    /// Shadow rays towards light samples, as [`Surface::shadow_ray`](crate::scene::Surface::shadow_ray).
    #[inline(always)]
    pub fn shadow_rays(&self, light: &LightLanes<L>) -> Rays<L> {
        let rays = light.rays_from(self.spawn(light.wi).origin);
        Rays { skip: self.skip(light.wi, rays.direction), ..rays }
    }

    /// The surfaces as lights are sampled for them.
    ///
    /// - `wo`: directions to the viewer
    #[inline(always)]
    pub fn receiver(&self, wo: Vector<L>) -> ReceiverLanes<L> {
        ReceiverLanes { p: self.p, ng: self.ng, ns: self.ns_towards(wo), transmits: self.transmits }
    }
}
