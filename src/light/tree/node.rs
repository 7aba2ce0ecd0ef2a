//! Nodes of a light tree, with the bounds of their children side by side.

use glam::Vec3;

use super::{LightBounds, WIDTH};
use crate::light::LightSampleContext;
use crate::math::float::sin_cos_f64;
use crate::math::lanes::{self, Each, Vector};
use crate::math::simd::{Arithmetic, Lanes, dot, splat};

/// Bounds of the children of a node. A place without a child has the intensity 0.
#[derive(Clone, Debug, Default)]
pub(super) struct Node {
    /// Centre of the sphere around the child (m).
    center: [[f32; WIDTH]; 3],
    /// Square of the sphere's radius (m²).
    radius2: [f32; WIDTH],
    /// Unit axis of the cone of normals.
    axis: [[f32; WIDTH]; 3],
    /// Cosine of the half angle θo of that cone.
    cos_normals: [f32; WIDTH],
    /// Sine of that angle.
    sin_normals: [f32; WIDTH],
    /// Cosine of the greatest angle θe between a normal and emitted light, less [`SLACK`].
    cos_emission: [f32; WIDTH],
    /// 1 if normals stand for their opposites too, 0 if not.
    two_sided: [f32; WIDTH],
    /// Intensity, times a power of two that is common to all lights.
    intensity: [f32; WIDTH],
    /// [`Child`], coded.
    child: [u32; WIDTH],
}

/// Child of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Child {
    /// Index of a node.
    Node(u32),
    /// Index of a light.
    Light(u32),
}

/// Bit of a coded child that is a light.
const IS_LIGHT: u32 = 1 << 31;

/// Point that light arrives at, and the directions from which it counts.
#[derive(Clone, Copy, Debug)]
pub(in crate::light) struct Receiver {
    /// Position (m).
    pub p: Vec3,
    /// Unit normal on the side of the viewer; zero where there is no surface.
    pub normal: Vec3,
    /// The sides of the surface whose light counts.
    pub sides: Sides,
}

/// Sides of a surface whose light counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::light) enum Sides {
    /// There is no surface: all directions count alike.
    NoSurface,
    /// Both sides, as the surface transmits light.
    Both,
    /// The side of the normal.
    One,
}

impl Receiver {
    /// The receiver at a point for which lights are sampled.
    #[inline]
    pub fn new(cx: &LightSampleContext) -> Receiver {
        let sides = match (cx.ns == Vec3::ZERO, cx.transmits) {
            (true, _) => Sides::NoSurface,
            (false, true) => Sides::Both,
            (false, false) => Sides::One,
        };
        Receiver { p: cx.p, normal: cx.ns, sides }
    }

    /// Factor of the irradiance from a direction for its angle to the normal; 0 if the direction does not count.
    ///
    /// - `cos`: cosine between the normal and the direction
    #[inline]
    pub fn cosine(&self, cos: f32) -> f32 {
        match self.sides {
            Sides::NoSurface => 1.0,
            Sides::Both => cos.abs().max(MIN_COSINE),
            Sides::One if cos < -SLACK => 0.0,
            Sides::One => cos.max(MIN_COSINE),
        }
    }

    /// Factor between the irradiance of one side and what light of equal radiance from all directions brings.
    #[inline]
    pub fn side_count(&self) -> f32 {
        match self.sides {
            Sides::NoSurface => 4.0,
            Sides::Both => 2.0,
            Sides::One => 1.0,
        }
    }
}

/// Least cosine in an importance that is not 0: the estimate is that of the middle of a child, and its edge may see more.
const MIN_COSINE: f32 = 1.0 / 32.0;

/// Bound of the rounding of cosines, which are wrong by up to 2·10⁻⁴ where an angle is small. A light must not have the importance 0
/// because of that.
const SLACK: f32 = 1.0 / 1024.0;

impl Node {
    /// Sets the child at a place.
    ///
    /// - `scale`: factor for intensities
    pub fn set(&mut self, place: usize, bounds: &LightBounds, scale: f64, child: Child) {
        let center = bounds.space.center();
        let reach = (bounds.space.max.as_dvec3() - center.as_dvec3()).max(center.as_dvec3() - bounds.space.min.as_dvec3());
        for axis in 0..3 {
            self.center[axis][place] = center[axis];
            self.axis[axis][place] = bounds.axis[axis] as f32;
        }
        // The sphere reaches from the rounded centre to the farthest corner; cones and radius are raised by more than their rounding.
        let widened = |angle: f64| sin_cos_f64((angle + 1e-6).min(std::f64::consts::PI));
        let (sin, cos) = widened(bounds.theta_o);
        self.radius2[place] = reach.length_squared() as f32 * (1.0 + 8.0 * f32::EPSILON);
        self.cos_normals[place] = cos as f32;
        self.sin_normals[place] = sin as f32;
        self.cos_emission[place] = widened(bounds.theta_e).1 as f32 - SLACK;
        self.two_sided[place] = f32::from(u8::from(bounds.two_sided));
        self.intensity[place] = ((bounds.intensity * scale) as f32).max(f32::MIN_POSITIVE);
        self.child[place] = match child {
            Child::Node(index) => index,
            Child::Light(index) => index | IS_LIGHT,
        };
    }

    /// The child at a place.
    #[inline]
    pub fn child(&self, place: usize) -> Child {
        let code = self.child[place];
        if code & IS_LIGHT == 0 { Child::Node(code) } else { Child::Light(code & !IS_LIGHT) }
    }

    /// [`importance`] of each child.
    #[inline(always)]
    pub fn importances<L: Lanes>(&self, at: &Receiver) -> [f32; WIDTH] {
        let children = Bounds {
            center: load(&self.center),
            radius2: L::load(&self.radius2),
            axis: load(&self.axis),
            cos_normals: L::load(&self.cos_normals),
            sin_normals: L::load(&self.sin_normals),
            cos_emission: L::load(&self.cos_emission),
            two_sided: L::load(&self.two_sided),
            intensity: L::load(&self.intensity),
        };
        importance(&children, splat(at.p.to_array()), splat((-at.normal).to_array()), at.sides).to_array()
    }

    /// [`importance`] of one child for surfaces that receive light on one side, one in each lane.
    #[inline(always)]
    pub fn importance_lanes<W: lanes::Lanes>(&self, place: usize, p: Vector<W>, normal: Vector<W>) -> W::F32 {
        let (center, axis) = (&self.center, &self.axis);
        let child = Bounds {
            center: splat([center[0][place], center[1][place], center[2][place]]),
            radius2: Each::splat(self.radius2[place]),
            axis: splat([axis[0][place], axis[1][place], axis[2][place]]),
            cos_normals: Each::splat(self.cos_normals[place]),
            sin_normals: Each::splat(self.sin_normals[place]),
            cos_emission: Each::splat(self.cos_emission[place]),
            two_sided: Each::splat(self.two_sided[place]),
            intensity: Each::splat(self.intensity[place]),
        };
        let opposite = [Each::<W>(-normal.x), Each(-normal.y), Each(-normal.z)];
        importance(&child, [Each(p.x), Each(p.y), Each(p.z)], opposite, Sides::One).0
    }

    /// Intensities of the children.
    pub fn intensities(&self) -> [f32; WIDTH] {
        self.intensity
    }
}

/// Bounds of children: the fields of [`Node`].
struct Bounds<A> {
    center: [A; 3],
    radius2: A,
    axis: [A; 3],
    cos_normals: A,
    sin_normals: A,
    cos_emission: A,
    two_sided: A,
    intensity: A,
}

/// Importance of a child, an estimate of the irradiance that it brings:
///
/// I cos θ′ cos θ′i / d²,    θ′ = max(0, θ − θo − θb),    θ′i = max(0, θi − θb)                [W·m⁻²]
///
/// The estimate uses a sphere around the centre of the child with half the radius of the one that contains the child. θ is the angle
/// between the axis and the direction to the point, θi the angle between the normal and the direction to the centre, θb half the
/// angle under which the sphere is seen, and d the distance of the centre, or the radius of the sphere if that is more.
///
/// The importance is 0 only where the sphere that contains the child sends no light. For the estimate that sphere would be too
/// large, because lights are spread over it: for lamps over a floor the mean square of samples is less than 1.5 times the least possible
/// with half of the radius, and 3.0 times with all of it (`choices_follow_what_lights_bring`).
///
/// - `p`: position of the point (m); `opposite`: its normal with the other sign
#[inline(always)]
fn importance<A: Arithmetic>(child: &Bounds<A>, p: [A; 3], opposite: [A; 3], sides: Sides) -> A {
    let (zero, least) = (A::splat(0.0), A::splat(MIN_COSINE));
    let center = &child.center;
    let to_point = [p[0].minus(center[0]), p[1].minus(center[1]), p[2].minus(center[2])];
    let d2 = dot(to_point, to_point);
    let inverse = zero.choose_below(d2, A::splat(1.0).over(d2.root()), zero);
    // Squared sine of half the angle under which the sphere is seen. The centre is within the half sphere too.
    let sin2 = zero.choose_below(d2, child.radius2.over(d2), A::splat(8.0));
    let (whole, half) = (seen(sin2), seen(sin2.times(A::splat(0.25))));

    let cos = dot(child.axis, to_point).times(inverse);
    let cos = zero.choose_below(child.two_sided, cos.size(), cos);
    let beyond_normals = reduced((cos, sine(cos)), (child.cos_normals, child.sin_normals));
    let (best, cos) = (reduced(beyond_normals, whole).0, reduced(beyond_normals, half).0);
    let emitted = best.choose_below(child.cos_emission, zero, cos.larger(least));

    let cosines = match sides {
        Sides::NoSurface => emitted,
        Sides::Both | Sides::One => {
            let cos = dot(opposite, to_point).times(inverse);
            let cos = if sides == Sides::Both { cos.size() } else { cos };
            let from_normal = (cos, sine(cos));
            let (best, cos) = (reduced(from_normal, whole).0, reduced(from_normal, half).0);
            let least_seen = if sides == Sides::Both { A::splat(f32::NEG_INFINITY) } else { A::splat(-SLACK) };
            let received = best.choose_below(least_seen, zero, cos.larger(least));
            emitted.times(received)
        }
    };
    // A light that can shine must not get the importance 0 by rounding, nor a point light an infinite one at its own place.
    let smallest = A::splat(f32::MIN_POSITIVE);
    let d2 = d2.larger(child.radius2.times(A::splat(0.25))).larger(smallest);
    let importance = child.intensity.times(cosines).over(d2).larger(smallest).smaller(A::splat(f32::MAX / 16.0));
    let is_lit = zero.choose_below(child.intensity, cosines, zero);
    zero.choose_below(is_lit, importance, zero)
}

#[inline(always)]
fn load<L: Lanes>(vectors: &[[f32; WIDTH]; 3]) -> [L; 3] {
    [L::load(&vectors[0]), L::load(&vectors[1]), L::load(&vectors[2])]
}

/// Cosine and sine of half the angle under which a sphere is seen, from the squared sine: (radius / distance)². If that is 1 or more, the
/// point is within the sphere and sees it in all directions.
#[inline(always)]
fn seen<A: Arithmetic>(sin2: A) -> (A, A) {
    let (zero, one) = (A::splat(0.0), A::splat(1.0));
    let cos = one.minus(sin2).larger(zero).root();
    (sin2.choose_below(one, cos, A::splat(-1.0)), sin2.choose_below(one, sin2.root(), zero))
}

/// Sine of an angle in [0, π] with the given cosine.
#[inline(always)]
fn sine<A: Arithmetic>(cos: A) -> A {
    A::splat(1.0).minus(cos.times(cos)).larger(A::splat(0.0)).root()
}

/// Cosine and sine of max(0, a − b), from those of a and of b in [0, π].
#[inline(always)]
fn reduced<A: Arithmetic>((cos_a, sin_a): (A, A), (cos_b, sin_b): (A, A)) -> (A, A) {
    let cos = cos_a.times(cos_b).plus(sin_a.times(sin_b));
    let sin = sin_a.times(cos_b).minus(cos_a.times(sin_b));
    (cos_a.choose_below(cos_b, cos, A::splat(1.0)), cos_a.choose_below(cos_b, sin, A::splat(0.0)))
}
