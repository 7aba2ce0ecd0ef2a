//! What is connected stays connected, and no ray passes through.

use glam::DVec3;
use pt::accel;
use pt::math::Ray;
use pt::rays::RayCaster;
use pt::torture::meshes::{baked, shapes};

use super::cages::{closed, half_bipyramid, icosahedron, irregular, square};
use super::{border, edges, shaken, subdivided};
use crate::random::Random;

/// Each level makes four triangles of one, and a closed surface stays closed, wound alike and in one piece: V − E + F stays.
#[test]
fn closed_meshes_stay_closed() {
    for (cage, euler) in closed() {
        for levels in 1..=4 {
            let data = subdivided(&cage, levels);
            assert_eq!(data.triangles.len(), cage.triangles.len() << (2 * levels));
            assert!(border(&data.triangles).is_empty());
            let edges = edges(&data.triangles).len() as i64 / 2;
            assert_eq!(data.positions.len() as i64 - edges + data.triangles.len() as i64, euler);
            assert_eq!(data.positions.len(), data.normals.len());
        }
    }
}

/// The limit surface lies within the convex hull of its cage and around its middle: the winding number is 1 in the middle and 0 outside,
/// along every ray, decided exactly.
#[test]
fn closed_meshes_have_an_inside() {
    for (seed, cage) in closed().into_iter().map(|(cage, _)| cage).take(4).enumerate() {
        let data = subdivided(&shaken(cage, seed as u64, 0.1), 3);
        let caster = RayCaster::new(data.positions.iter().map(|p| p.as_dvec3()).collect(), data.triangles.clone()).expect("triangles");
        let mut random = Random::new(9);
        for _ in 0..200 {
            let [inside, outside] = [random.in_cube() * 0.05, random.direction() * 2.5];
            assert_eq!([caster.winding(inside), caster.winding(outside)], [1, 0], "cage {seed}");
        }
    }
}

/// Rays from inside through vertices and middles of edges, of few binary digits, hit the surface, and see its back.
#[test]
fn no_ray_passes_between_triangles() {
    for (seed, cage) in closed().into_iter().map(|(cage, _)| cage).take(4).enumerate() {
        let data = subdivided(&cage, 2);
        let targets: Vec<DVec3> = edges(&data.triangles)
            .keys()
            .flat_map(|&[a, b]| {
                let [a, b] = [a, b].map(|v| data.positions[v as usize].as_dvec3());
                [a, 0.5 * (a + b), a.lerp(b, 0.25)]
            })
            .collect();
        let hierarchy = accel::build(shapes(vec![baked(data)]));
        let mut random = Random::new(seed as u64);
        for target in targets {
            let origin = (random.in_cube() * 0.05).as_vec3();
            let ray = Ray::new(origin, (target - origin.as_dvec3()).as_vec3());
            assert!(hierarchy.intersect(&ray).is_some() && hierarchy.occluded(&ray), "cage {seed}: {ray:?}");
        }
    }
}

/// Open surfaces keep one border of twice as many edges for each level.
#[test]
fn borders_stay_borders() {
    for (cage, count) in [(square(3), 12), (half_bipyramid(4), 4)] {
        for levels in 1..=3 {
            let border = border(&subdivided(&cage, levels).triangles);
            assert_eq!(border.len(), count << levels);
            let (first, mut at, mut steps) = (*border.keys().next().unwrap(), *border.values().next().unwrap(), 1);
            while at != first {
                (at, steps) = (border[&at], steps + 1);
            }
            assert_eq!(steps, count << levels, "one loop");
        }
    }
}

/// No level is the mesh as it is, and threads change no bit.
#[test]
fn threads_change_no_bit() {
    let cage = icosahedron();
    assert_eq!(cage.data().subdivided(0).unwrap(), cage.data());
    for cage in irregular() {
        let in_pool = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| subdivided(&cage, 3))
        };
        assert_eq!(in_pool(1), in_pool(5));
    }
}
