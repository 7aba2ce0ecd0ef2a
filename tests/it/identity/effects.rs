//! An effect that is simulated but does not occur in the scene changes no bit.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use pt::camera::Camera;
use pt::effects::Effects;
use pt::integrators::ALL;
use pt::light::Lights;
use pt::math::{Ray, RayDifferential, SurfaceDifferential};
use pt::medium::{Boundaries, Inside, InterfaceCrossing, Media};
use pt::primitive::Hit;
use pt::sampler::{Kind, SamplerSpec};
use pt::scene::{Scene, Surface};
use pt::shape::SurfacePoint;

use super::new;
use pt::torture::everything::{Everything, Shot, Which, bits, picture};

/// A scene that claims to have all effects.
struct Wide(Arc<dyn Scene>);

impl Scene for Wide {
    fn intersect(&self, ray: &Ray) -> Option<Hit> {
        self.0.intersect(ray)
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.0.occluded(ray)
    }

    fn surface(&self, ray: &Ray, hit: &Hit) -> Surface<'_> {
        self.0.surface(ray, hit)
    }

    fn surface_with_footprint(&self, ray: &Ray, hit: &Hit, differential: &RayDifferential) -> (Surface<'_>, Option<SurfaceDifferential>) {
        self.0.surface_with_footprint(ray, hit, differential)
    }

    fn surface_seen_from(&self, ray: &Ray, hit: &Hit, wo: Vec3) -> Surface<'_> {
        self.0.surface_seen_from(ray, hit, wo)
    }

    fn lights(&self) -> &Lights {
        self.0.lights()
    }

    fn camera(&self) -> &Camera {
        self.0.camera()
    }

    fn media(&self) -> Option<&Media> {
        self.0.media()
    }

    fn boundaries(&self, hit: &Hit, point: &SurfacePoint) -> Boundaries {
        self.0.boundaries(hit, point)
    }

    fn bodies_around(&self, p: Vec3) -> Inside {
        self.0.bodies_around(p)
    }

    fn interface(&self, ray: &Ray) -> Option<InterfaceCrossing> {
        self.0.interface(ray)
    }

    fn effects(&self) -> Effects {
        Effects::ALL
    }

    fn origin(&self) -> DVec3 {
        self.0.origin()
    }
}

/// An integrator that simulates all effects gives the same bits as one that simulates only those of the scene.
#[test]
fn simulating_effects_that_do_not_occur_changes_no_bit() {
    for (entry, lights) in ALL.iter().flat_map(|e| [Which::All, Which::AreaOnly, Which::EnvironmentOnly].map(|l| (e, l))) {
        let scene = Everything { lights, ..Everything::default() };
        let shot = Shot { scene, ..Shot::default() };
        assert_ne!(scene.build().effects(), Effects::ALL);
        let [narrow, wide] =
            [scene.build() as Arc<dyn Scene>, Arc::new(Wide(scene.build()))].map(|scene| bits(&picture(scene, &*new(entry), &shot)));
        assert!(narrow == wide, "{} {lights:?}", entry.name);
    }
}

/// A lens that is too small to move a ray uses random numbers, and so may a light without power. This does not change the random numbers of
/// anything else.
#[test]
fn unused_effects_do_not_shift_random_numbers() {
    for (entry, (kind, ..)) in ALL.iter().flat_map(|e| Kind::ALL.iter().map(move |k| (e, k))) {
        let shot = Shot { sampler: SamplerSpec { kind: *kind, spp: 4, seed: 3, ..SamplerSpec::default() }, ..Shot::default() };
        let taken = |scene: Everything| bits(&picture(scene.build(), &*new(entry), &shot));
        let wanted = taken(Everything::default());
        assert!(taken(Everything { lens_radius: 1e-30, ..Everything::default() }) == wanted, "{} {kind:?}: the lens", entry.name);
        assert!(taken(Everything { idle: true, ..Everything::default() }) == wanted, "{} {kind:?}: the idle light", entry.name);
    }
}
