//! Rays in scenes and meshes, in double precision.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use glam::DVec3;
use numpy::ndarray::{Array1, Array2, ArrayView2};
use numpy::{IntoPyArray, PyReadonlyArray2};
use pt::rays::{Hit, Ray, RayCaster, SceneCaster};
use pt::world::World;
use pyo3::prelude::*;

use crate::error::{detached, usage, value};

/// Caster of a scene, made when rays are cast for the first time.
#[derive(Default)]
pub struct LazyCaster(Mutex<Option<Arc<SceneCaster>>>);

impl LazyCaster {
    /// The caster.
    ///
    /// # Errors
    /// Those of [`SceneCaster::new`].
    fn get(&self, world: &Arc<World>) -> pt::Result<Arc<SceneCaster>> {
        let mut made = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(caster) = &*made {
            return Ok(caster.clone());
        }
        let caster = Arc::new(SceneCaster::new(world.clone())?);
        *made = Some(caster.clone());
        Ok(caster)
    }
}

/// Casts rays of arrays of shape (..., 3) in a scene, and returns a `SceneHits`.
pub fn in_scene<'py>(
    py: Python<'py>,
    (world, caster): (&Arc<World>, &LazyCaster),
    origins: &Bound<'py, PyAny>,
    directions: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let Batch { rays, shape } = batch(py, origins, directions)?;
    let hits = detached(py, || Ok(caster.get(world)?.closest_of(&rays)))?;
    let t: Vec<f64> = hits.iter().map(|hit| hit.map_or(f64::INFINITY, |hit| hit.t)).collect();
    let index = |of: &dyn Fn(&pt::rays::SceneHit) -> u32| -> Vec<i64> {
        hits.iter().map(|hit| hit.as_ref().map_or(-1, |hit| i64::from(of(hit)))).collect()
    };
    let (shapes, primitives) = (index(&|hit| hit.shape), index(&|hit| hit.primitive));
    let instances = hits.iter().map(|hit| hit.and_then(|hit| hit.instance).map_or(-1, i64::from)).collect::<Vec<_>>();
    let uv = hits.iter().flat_map(|hit| hit.map_or([f64::NAN; 2], |hit| hit.uv.to_array())).collect();
    let normal = hits.iter().flat_map(|hit| hit.map_or([f64::NAN; 3], |hit| hit.normal.to_array())).collect();
    let exact: Vec<bool> = hits.iter().map(|hit| hit.is_none_or(|hit| hit.is_exact)).collect();
    value(py, "_scene_hits")?.call1((
        shape,
        Array1::from(t).into_pyarray(py),
        Array1::from(shapes).into_pyarray(py),
        Array1::from(primitives).into_pyarray(py),
        matrix(hits.len(), 2, uv).into_pyarray(py),
        matrix(hits.len(), 3, normal).into_pyarray(py),
        Array1::from(exact).into_pyarray(py),
        Array1::from(instances).into_pyarray(py),
    ))
}

/// Triangle mesh that answers where rays meet it, in double precision: Mesh(vertices, triangles).
///
/// - vertices: floats of shape (n, 3) (m)
/// - triangles: indices of shape (m, 3), counter-clockwise seen from outside
///
/// Whether a ray meets a triangle is decided by exact arithmetic. No ray slips through an edge or a vertex of a closed mesh, and no crossing is
/// counted twice.
#[pyclass(frozen, module = "pt_renderer")]
pub struct Mesh {
    caster: RayCaster,
    warnings: Vec<String>,
}

#[pymethods]
impl Mesh {
    #[new]
    fn new(py: Python<'_>, vertices: &Bound<'_, PyAny>, triangles: &Bound<'_, PyAny>) -> PyResult<Mesh> {
        let arrays = value(py, "_mesh")?.call1((vertices, triangles))?;
        let (vertices, triangles): (PyReadonlyArray2<'_, f64>, PyReadonlyArray2<'_, i64>) = arrays.extract()?;
        let positions = points(vertices.as_array());
        let count = positions.len();
        let corner = |index: &i64| u32::try_from(*index).ok().filter(|index| (*index as usize) < count);
        let rows = triangles.as_array();
        let mut found = Vec::with_capacity(rows.nrows());
        for (k, row) in rows.rows().into_iter().enumerate() {
            let corners: Option<Vec<u32>> = row.iter().map(corner).collect();
            match corners.as_deref() {
                Some(&[a, b, c]) => found.push([a, b, c]),
                _ => return Err(usage(py, format!("triangles: triangle {k} names a vertex that is not there: there are {count}"))),
            }
        }
        let caster = detached(py, || RayCaster::new(positions, found))?;
        Ok(Mesh { caster, warnings: vec![] })
    }

    /// The mesh in a file: OBJ, PLY or STL, recognised by its content, or all triangles of a glTF model (.gltf, .glb).
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Mesh> {
        let (caster, warnings) = detached(py, || RayCaster::load(&path))?;
        Ok(Mesh { caster, warnings })
    }

    /// Where rays first meet the mesh, as MeshHits.
    ///
    /// `origins` (m) and `directions` have the shape (..., 3), or are broadcast to one; directions need not be unit vectors.
    fn intersect<'py>(&self, py: Python<'py>, origins: &Bound<'py, PyAny>, directions: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let Batch { rays, shape } = batch(py, origins, directions)?;
        let hits = detached(py, || Ok(self.caster.closest_of(&rays)))?;
        let normal = |hit: Option<Hit>| hit.map_or([f64::NAN; 3], |hit| self.caster.normal(hit.triangle).to_array());
        let t: Vec<f64> = hits.iter().map(|hit| hit.map_or(f64::INFINITY, |hit| hit.t)).collect();
        let triangle: Vec<i64> = hits.iter().map(|hit| hit.map_or(-1, |hit| hit.triangle.into())).collect();
        let uv = hits.iter().flat_map(|hit| hit.map_or([f64::NAN; 2], |hit| hit.uv.to_array())).collect();
        let normals = hits.iter().flat_map(|hit| normal(*hit)).collect();
        let enters: Vec<bool> = hits.iter().map(|hit| hit.is_some_and(|hit| hit.enters)).collect();
        value(py, "_mesh_hits")?.call1((
            shape,
            Array1::from(t).into_pyarray(py),
            Array1::from(triangle).into_pyarray(py),
            matrix(hits.len(), 2, uv).into_pyarray(py),
            matrix(hits.len(), 3, normals).into_pyarray(py),
            Array1::from(enters).into_pyarray(py),
        ))
    }

    /// How often the mesh surrounds each point of shape (..., 3): 1 within a closed mesh whose triangles are counter-clockwise seen from
    /// outside, -1 if it is turned inside out, 0 outside. An int64 for each point.
    fn winding<'py>(&self, py: Python<'py>, points: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let (rows, shape): (PyReadonlyArray2<'py, f64>, Bound<'py, PyAny>) = value(py, "_points")?.call1((points,))?.extract()?;
        let places = self::points(rows.as_array());
        let numbers: Vec<i64> = detached(py, || Ok(places.iter().map(|place| self.caster.winding(*place)).collect()))?;
        Array1::from(numbers).into_pyarray(py).call_method1("reshape", (shape,))
    }

    /// Number of triangles.
    fn __len__(&self) -> usize {
        self.caster.len()
    }

    /// Sentences about what was left out of a file.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }

    fn __repr__(&self) -> String {
        format!("<pt_renderer.Mesh of {} triangles>", self.caster.len())
    }
}

/// Rays in a row, and the shape of the arrays that they came in.
struct Batch<'py> {
    rays: Vec<Ray>,
    shape: Bound<'py, PyAny>,
}

fn batch<'py>(py: Python<'py>, origins: &Bound<'py, PyAny>, directions: &Bound<'py, PyAny>) -> PyResult<Batch<'py>> {
    let arrays = value(py, "_rays")?.call1((origins, directions))?;
    let (origins, directions, shape): (PyReadonlyArray2<'py, f64>, PyReadonlyArray2<'py, f64>, Bound<'py, PyAny>) = arrays.extract()?;
    let (origins, directions) = (points(origins.as_array()), points(directions.as_array()));
    Ok(Batch { rays: origins.into_iter().zip(directions).map(|(origin, direction)| Ray::new(origin, direction)).collect(), shape })
}

/// Points of the rows of an array with three columns.
fn points(rows: ArrayView2<'_, f64>) -> Vec<DVec3> {
    rows.rows().into_iter().map(|row| DVec3::new(row[0], row[1], row[2])).collect()
}

/// Matrix of numbers row by row.
fn matrix(rows: usize, columns: usize, values: Vec<f64>) -> Array2<f64> {
    Array2::from_shape_vec((rows, columns), values).unwrap_or_else(|_| Array2::zeros((rows, columns)))
}
