//! Shading normals as colours.

use std::sync::Arc;

use pt::film::FilmSpec;
use pt::integrator::{CameraSample, Context, Estimator, Integrator};
use pt::math::Spectrum;
use pt::scene::Scene;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Shading normal at the first hit, as a colour; black where the camera ray hits nothing.
#[derive(Clone, Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(default)]
#[schemars(deny_unknown_fields)]
pub struct Normals {
    /// Mapping of coordinates from −1 to 1 to colours.
    pub encoding: Encoding,
}

/// Mapping of the coordinates of a normal n to colours.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(inline)]
pub enum Encoding {
    /// |n|
    #[default]
    Absolute,
    /// (n + 1) / 2
    Signed,
}

impl Integrator for Normals {
    fn prepare(&self, scene: Arc<dyn Scene>, _film: &FilmSpec) -> Box<dyn Estimator> {
        Box::new(View { scene, encoding: self.encoding })
    }
}

struct View {
    scene: Arc<dyn Scene>,
    encoding: Encoding,
}

impl Estimator for View {
    fn li(&self, camera: &CameraSample, _: &mut Context) -> Spectrum {
        let Some(hit) = camera.hit(&*self.scene) else { return Spectrum::BLACK };
        let n = self.scene.surface(&camera.ray, &hit).frame.z;
        let color = match self.encoding {
            Encoding::Absolute => n.abs(),
            Encoding::Signed => 0.5 * n + 0.5,
        };
        Spectrum::rgb(color.x, color.y, color.z)
    }
}
