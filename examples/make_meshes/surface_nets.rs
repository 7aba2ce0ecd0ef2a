//! Conversion of an implicit surface f(p) = 0 to a smooth mesh.

use glam::{DVec3, IVec3};
use pt::shape::mesh_data::{MeshData, MeshPart};

/// Grid of cubes in a box of space, with the length of their edges.
pub struct Grid {
    pub min: DVec3,
    pub cells: IVec3,
    pub edge: f64,
}

impl Grid {
    fn corner(&self, c: IVec3) -> DVec3 {
        self.min + c.as_dvec3() * self.edge
    }

    /// Index of a cell or corner. There is one more corner than cells along each axis.
    fn index(&self, c: IVec3) -> usize {
        let size = self.cells + 1;
        ((c.z * size.y + c.y) * size.x + c.x) as usize
    }

    fn each(size: IVec3) -> impl Iterator<Item = IVec3> {
        (0..size.z).flat_map(move |z| (0..size.y).flat_map(move |y| (0..size.x).map(move |x| IVec3::new(x, y, z))))
    }
}

/// Meshes the surface where `f` changes its sign; `f` is negative inside.
///
/// One vertex for each cell that the surface passes through, at the mean of where it crosses the cell's edges, then
/// moved onto the surface by Newton's method along the gradient. One quadrilateral for each crossed edge of the
/// grid, between the four cells around it.
///
/// Source: Gibson, *Constrained Elastic Surface Nets* (1998).
pub fn mesh(grid: &Grid, f: &impl Fn(DVec3) -> f64) -> MeshData {
    let values: Vec<f64> = Grid::each(grid.cells + 1).map(|c| f(grid.corner(c))).collect();
    let is_inside = |c: IVec3| values[grid.index(c)] < 0.0;

    let mut found = MeshData::default();
    let mut vertex_of = vec![u32::MAX; values.len()];
    for cell in Grid::each(grid.cells) {
        let crossings: Vec<DVec3> =
            EDGES.iter().filter_map(|&[a, b]| crossing(grid, &values, cell + corner(a), cell + corner(b))).collect();
        if !crossings.is_empty() {
            vertex_of[grid.index(cell)] = found.positions.len() as u32;
            let mean = crossings.iter().sum::<DVec3>() / crossings.len() as f64;
            // Vertices stay in their cells, so that neighbours keep their distance and triangles keep their orientation.
            let (low, high) = (grid.corner(cell) + 0.1 * grid.edge, grid.corner(cell) + 0.9 * grid.edge);
            let point = onto_surface(mean, grid.edge, f).clamp(low, high);
            let normal = gradient(point, grid.edge, f).normalize_or(DVec3::Y);
            found.positions.push(point.as_vec3());
            found.normals.push(normal.as_vec3());
        }
    }

    for start in Grid::each(grid.cells) {
        for (axis, [u, v]) in [(IVec3::X, [IVec3::Y, IVec3::Z]), (IVec3::Y, [IVec3::Z, IVec3::X]), (IVec3::Z, [IVec3::X, IVec3::Y])] {
            let outwards = is_inside(start);
            if outwards == is_inside(start + axis) || (start - u - v).min_element() < 0 {
                continue;
            }
            let around = [start - u - v, start - v, start, start - u].map(|cell| vertex_of[grid.index(cell)]);
            let [a, b, c, d] = if outwards { around } else { [around[3], around[2], around[1], around[0]] };
            let length = |i: u32, j: u32| found.positions[i as usize].distance_squared(found.positions[j as usize]);
            let halves = if length(a, c) <= length(b, d) { [[a, b, c], [a, c, d]] } else { [[b, c, d], [b, d, a]] };
            found.triangles.extend(halves);
        }
    }
    found.parts = vec![MeshPart { triangles: 0..found.triangles.len() as u32, ..MeshPart::default() }];
    found
}

/// The corners of a cell, by the bits of their number.
fn corner(bits: i32) -> IVec3 {
    IVec3::new(bits & 1, (bits >> 1) & 1, (bits >> 2) & 1)
}

/// Pairs of corners that differ in one bit.
const EDGES: [[i32; 2]; 12] = [[0, 1], [2, 3], [4, 5], [6, 7], [0, 2], [1, 3], [4, 6], [5, 7], [0, 4], [1, 5], [2, 6], [3, 7]];

/// Point where the surface crosses an edge of the grid, by linear interpolation of f.
fn crossing(grid: &Grid, values: &[f64], a: IVec3, b: IVec3) -> Option<DVec3> {
    let (fa, fb) = (values[grid.index(a)], values[grid.index(b)]);
    ((fa < 0.0) != (fb < 0.0)).then(|| grid.corner(a).lerp(grid.corner(b), fa / (fa - fb)))
}

/// Moves `p` onto the surface, by at most the length of an edge.
fn onto_surface(p: DVec3, edge: f64, f: &impl Fn(DVec3) -> f64) -> DVec3 {
    const STEPS: usize = 4;
    let mut q = p;
    for _ in 0..STEPS {
        let g = gradient(q, edge, f);
        let step = g * (f(q) / g.length_squared().max(f64::MIN_POSITIVE));
        q -= step.clamp_length_max(0.25 * edge);
    }
    q
}

/// Gradient of f by central differences over a small part of a cell.
fn gradient(p: DVec3, edge: f64, f: &impl Fn(DVec3) -> f64) -> DVec3 {
    let h = edge / 16.0;
    let slope = |axis: DVec3| (f(p + axis * h) - f(p - axis * h)) / (2.0 * h);
    DVec3::new(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z))
}
