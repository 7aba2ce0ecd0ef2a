//! `pt rays MESH`: where rays meet a mesh, and which points it contains, in double precision.

use std::fmt::Write;
use std::io::Read;
use std::path::{Path, PathBuf};

use glam::DVec3;
use rayon::prelude::*;

use super::parse::threads;
use super::{note, print_stdout, render};
use crate::error::{Error, Result};
use crate::output;
use crate::rays::table::rows;
use crate::rays::{Hit, Ray, RayCaster};

#[derive(clap::Args, Debug)]
pub struct RaysArgs {
    /// Mesh file: OBJ, PLY or STL; or glTF (.gltf, .glb): all triangles of the model, placed by its nodes.
    #[arg(value_name = "MESH")]
    pub mesh: PathBuf,
    /// Rays, one in each line: origin and direction, six numbers with commas or spaces between; `-` reads stdin.
    #[arg(long, value_name = "FILE", required_unless_present = "inside", conflicts_with = "inside")]
    pub from: Option<PathBuf>,
    /// All hits of each ray, and not only the first.
    #[arg(long, requires = "from")]
    pub all: bool,
    /// Points, three numbers in each line: print whether the mesh contains them, and how often it surrounds them.
    #[arg(long, value_name = "FILE")]
    pub inside: Option<PathBuf>,
    /// Output file. Default: stdout.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Number of threads. Default: all cores. The answers do not depend on it.
    #[arg(short, long, env = "PT_THREADS", value_parser = threads, allow_negative_numbers = true)]
    pub threads: Option<u32>,
}

/// Runs the command.
pub fn rays(args: &RaysArgs) -> Result<()> {
    args.output.as_deref().map(output::check_folder).transpose()?;
    let (caster, warnings) = RayCaster::load(&args.mesh)?;
    warnings.iter().for_each(|warning| note(&format!("warning: {warning}")));
    let text = render::pool(args.threads)?.install(|| match (&args.from, &args.inside) {
        (Some(file), _) => Ok(hits(&caster, &numbers::<6>(file)?, args.all)),
        (None, Some(file)) => Ok(contained(&caster, &numbers::<3>(file)?)),
        (None, None) => Err(Error::Usage("expected --from RAYS or --inside POINTS".into())),
    })?;
    match &args.output {
        Some(path) => output::replace(path, text.as_bytes()),
        None => print_stdout(&text),
    }
}

/// A line for each hit; a ray without a hit has one with its number only.
fn hits(caster: &RayCaster, rows: &[[f64; 6]], all: bool) -> String {
    let lines = |(index, row): (usize, &[f64; 6])| {
        let ray = Ray::new(DVec3::from_slice(&row[..3]), DVec3::from_slice(&row[3..]));
        let found = if all { caster.all(&ray) } else { caster.closest(&ray).into_iter().collect() };
        let mut text = String::new();
        for Hit { t, triangle, uv, enters } in &found {
            let ([x, y, z], [nx, ny, nz]) = (ray.at(*t).to_array(), caster.normal(*triangle).to_array());
            let side = if *enters { "front" } else { "back" };
            let _ = writeln!(text, "{index},{t},{x},{y},{z},{triangle},{},{},{nx},{ny},{nz},{side}", uv.x, uv.y);
        }
        if found.is_empty() {
            let _ = writeln!(text, "{index},,,,,,,,,,,");
        }
        text
    };
    let lines: Vec<String> = rows.par_iter().enumerate().map(lines).collect();
    format!("ray,t,x,y,z,triangle,u,v,nx,ny,nz,side\n{}", lines.concat())
}

fn contained(caster: &RayCaster, rows: &[[f64; 3]]) -> String {
    let line = |row: &[f64; 3]| {
        let point = DVec3::from(*row);
        format!("{},{},{},{},{}\n", point.x, point.y, point.z, u8::from(caster.contains(point)), caster.winding(point))
    };
    let lines: Vec<String> = rows.par_iter().map(line).collect();
    format!("x,y,z,inside,winding\n{}", lines.concat())
}

/// The rows of a table in a file.
///
/// # Errors
/// `Invalid` with the line for what is no number; `Io` if the file cannot be read.
fn numbers<const N: usize>(path: &Path) -> Result<Vec<[f64; N]>> {
    let mut text = String::new();
    let read = match path.to_str() {
        Some("-") => std::io::stdin().read_to_string(&mut text).map(drop),
        _ => std::fs::read_to_string(path).map(|content| text = content),
    };
    read.map_err(|e| Error::io(path, e))?;
    rows(&text).map_err(|fault| Error::invalid(fault.in_file(path)))
}
