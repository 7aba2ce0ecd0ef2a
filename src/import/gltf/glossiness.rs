//! Conversion of KHR_materials_pbrSpecularGlossiness to metalness and roughness: factors as numbers, textures pixel by pixel.
//!
//! A reflectance of 4 % is that of plastic. A material that reflects more is in part a metal, by a share m for which the perceived
//! brightness and the share of light that is not reflected stay the same.
//!
//! Source: Khronos, *KHR_materials_pbrSpecularGlossiness*, its example convert-between-workflows, `ConvertToMetallicRoughness`.

use glam::DVec3;
use image::{ImageFormat, RgbaImage};

use super::material::Reader;
use super::texture::{Kind, numbers};
use crate::describe::{Channel, Encoding, picture};
use crate::import::json_cursor::JsonCursor;
use crate::output::tonemap::srgb;
use crate::reader::Node;
use crate::texture::image::Pixels;

/// Reflectance of plastic at normal incidence.
const PLASTIC: f64 = 0.04;

/// Factors of the file, without textures.
struct Factors {
    diffuse: DVec3,
    specular: DVec3,
    glossiness: f64,
}

/// Decoded texture of the file.
struct Layer {
    color: Pixels,
    alpha: Pixels,
}

/// Base colour, metalness and roughness.
struct Converted {
    base: DVec3,
    metallic: f64,
    roughness: f64,
}

impl<'a> Reader<'_, 'a> {
    /// Base colour, metalness and roughness of a material with specular and glossiness; `None` for other materials.
    pub(super) fn of_glossiness(&self) -> Option<[Node; 3]> {
        let at = self.glossy.as_ref()?;
        self.document.note(at, "specular and glossiness become metalness and roughness, as Khronos converts them: colours shift a little");
        let vector = |key: &str| at.get(&[key]).and_then(|at| numbers::<3>(&at)).map_or(DVec3::ONE, DVec3::from);
        let [r, g, b, _] = at.get(&["diffuseFactor"]).and_then(|at| numbers::<4>(&at)).unwrap_or([1.0; 4]);
        let glossiness = at.get(&["glossinessFactor"]).map_or(Some(1.0), |at| at.number())?;
        let factors = Factors { diffuse: DVec3::new(r, g, b), specular: vector("specularFactor"), glossiness };
        let infos = ["diffuseTexture", "specularGlossinessTexture"].map(|key| at.get(&[key]));
        let layers = infos.each_ref().map(|info| info.as_ref().and_then(|info| self.layer(info)));
        let nodes = match (&layers, infos.into_iter().flatten().next()) {
            ([None, None], _) | (_, None) => {
                let Converted { base, metallic, roughness } = factors.at(&[None, None], [0.0; 2]);
                [at.make_numbers(base.to_array()), at.make_number(metallic), at.make_number(roughness)]
            }
            (_, Some(info)) => self.baked(at, &info, &factors, &layers)?,
        };
        let [base, metallic, roughness] = nodes;
        Some([self.colored(base), metallic, roughness])
    }

    /// Picture of a texture; `None` if there is none, with a note or a fault.
    fn layer(&self, info: &JsonCursor<'a>) -> Option<Layer> {
        let node = self.document.texture(info, Kind::Color)?;
        let file = node.child("file")?.as_str()?;
        let read = |channel| {
            let bytes = info.context().bytes(file).map_err(|error| info.fault(error.to_string())).ok()?;
            let decoded = picture::read(&bytes, file, Encoding::Auto, channel);
            decoded.map_err(|error| info.fault(error.to_string())).ok().map(|(pixels, _)| pixels)
        };
        Some(Layer { color: read(None)?, alpha: read(Some(Channel::A))? })
    }

    /// Two pictures that come with the scene, and the three channels that are read from them.
    fn baked(&self, at: &JsonCursor<'a>, info: &JsonCursor<'a>, factors: &Factors, layers: &[Option<Layer>; 2]) -> Option<[Node; 3]> {
        let sizes = layers.iter().flatten().map(|layer| layer.color.size());
        let size = sizes.reduce(|a, b| a.max(b))?;
        let (mut color, mut shares) = (RgbaImage::new(size.x, size.y), RgbaImage::new(size.x, size.y));
        let level = |share: f64| (255.0 * share).round().clamp(0.0, 255.0) as u8;
        for (x, y, texel) in color.enumerate_pixels_mut() {
            let location = [(f64::from(x) + 0.5) / f64::from(size.x), (f64::from(y) + 0.5) / f64::from(size.y)];
            let Converted { base, metallic, roughness } = factors.at(layers, location);
            let [r, g, b] = base.to_array().map(|c| level(f64::from(srgb(c as f32))));
            *texel = image::Rgba([r, g, b, 255]);
            shares.put_pixel(x, y, image::Rgba([0, level(roughness), level(metallic), 255]));
        }
        let stem = at.pointer.split('/').nth(2).unwrap_or("0");
        let [color, shares] = [(color, "color"), (shares, "shares")].map(|(picture, what)| {
            let mut bytes = std::io::Cursor::new(vec![]);
            picture.write_to(&mut bytes, ImageFormat::Png).ok()?;
            let file = self.document.made_name(&format!("material-{stem}-{what}"), "png");
            at.context().make(&*file, bytes.into_inner());
            Some(file)
        });
        let (color, shares) = (color?, shares?);
        let plain = self.document.texture(info, Kind::Color)?;
        let image = |file: &str, channel: Option<&str>| {
            let kept = ["wrap", "filter"].into_iter().filter_map(|key| Some((key, plain.child(key)?.clone())));
            let linear = channel.map(|channel| [("encoding", info.make_text("linear")), ("channel", info.make_text(channel))]);
            let named = [("type", info.make_text("image")), ("file", info.make_text(file))];
            info.make_object(named.into_iter().chain(linear.into_iter().flatten()).chain(kept))
        };
        Some([image(&color, None), image(&shares, Some("b")), image(&shares, Some("g"))])
    }
}

impl Factors {
    /// Converted values at a point of the pictures, from the upper left corner. If the pictures differ in size, the nearest pixels
    /// are used.
    fn at(&self, [diffuse, specular]: &[Option<Layer>; 2], location: [f64; 2]) -> Converted {
        let color = |layer: &Option<Layer>| layer.as_ref().map_or(DVec3::ONE, |layer| nearest(&layer.color, location));
        let glossiness = specular.as_ref().map_or(1.0, |layer| nearest(&layer.alpha, location).x) * self.glossiness;
        let (base, metallic) = converted(self.diffuse * color(diffuse), self.specular * color(specular));
        Converted { base, metallic, roughness: 1.0 - glossiness.clamp(0.0, 1.0) }
    }
}

fn nearest(pixels: &Pixels, [x, y]: [f64; 2]) -> DVec3 {
    let size = pixels.size();
    let index = |share: f64, n: u32| ((share * f64::from(n)) as usize).min(n as usize - 1);
    let value = pixels.values()[index(y, size.y) * size.x as usize + index(x, size.x)];
    DVec3::from(value.map(f64::from))
}

/// Converts a diffuse and a specular colour to a base colour and a metalness.
fn converted(diffuse: DVec3, specular: DVec3) -> (DVec3, f64) {
    let kept = 1.0 - specular.max_element();
    let metallic = metalness(brightness(diffuse), brightness(specular), kept);
    let of_diffuse = diffuse * kept / (1.0 - PLASTIC) / (1.0 - metallic).max(1e-6);
    let of_specular = (specular - PLASTIC * (1.0 - metallic)) / metallic.max(1e-6);
    let base = of_diffuse.lerp(of_specular, metallic * metallic);
    (base.clamp(DVec3::ZERO, DVec3::ONE), metallic)
}

/// Root of a quadratic equation in the metalness; 0 for a reflectance of at most that of plastic.
fn metalness(diffuse: f64, specular: f64, kept: f64) -> f64 {
    if specular < PLASTIC {
        return 0.0;
    }
    let (a, b) = (PLASTIC, diffuse * kept / (1.0 - PLASTIC) + specular - 2.0 * PLASTIC);
    let c = PLASTIC - specular;
    ((-b + (b * b - 4.0 * a * c).max(0.0).sqrt()) / (2.0 * a)).clamp(0.0, 1.0)
}

/// Perceived brightness (HSP).
fn brightness(color: DVec3) -> f64 {
    (DVec3::new(0.299, 0.587, 0.114) * color * color).element_sum().sqrt()
}
