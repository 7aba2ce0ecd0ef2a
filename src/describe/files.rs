//! The files that a scene names. A scene may read its own folder, and nothing else unless the user allows it.
//!
//! A scene may come from an untrusted source, and the content of a file may end up in a picture or a message. Paths are therefore
//! relative and stay within the scene file's folder, unless the user says `--allow-outside`.

use std::collections::BTreeMap;
use std::io::{BufReader, Cursor, Read};
use std::path::{Path, PathBuf};

use super::camera::{Camera, Lens, Realistic};
use super::curves_file::{self, CurvePoints};
use super::file::open;
use super::identity::of_bytes as hash_of;
use super::ies;
use super::lens_file;
use super::light::Light;
use super::medium::{Density, Medium, MediumRef};
use super::mesh;
use super::mesh::points::{self, InstancePoint};
use super::picture;
use super::scene::Scene;
use super::shape::Shape;
use super::volume::{self, Volume};
use super::{Material, MaterialRef};
use crate::camera::realistic::LensTable;
use crate::format::{Channel, Encoding, Texture, Textured};
use crate::light::IntensityProfile;
use crate::math::hash::Hash;
use crate::reader::escaped;
use crate::shape::MeshData;
use crate::texture::image::Pixels;
use crate::{Error, Fault, Result};

/// The longest path that any system accepts, in bytes.
const LONGEST: usize = 4096;

/// The place of a scene's files, and what the scene may read.
#[derive(Clone, Debug, Default)]
pub struct Files {
    /// The folder that relative paths start from.
    pub folder: PathBuf,
    /// Whether the scene may name files that lie elsewhere.
    pub allow_outside: bool,
    /// The contents by name of files in memory that came with the scene. They take precedence over those in the folder.
    pub made: BTreeMap<String, Vec<u8>>,
}

impl Files {
    /// The files in a folder; the scene may name no others.
    pub fn within(folder: impl Into<PathBuf>) -> Files {
        Files { folder: folder.into(), ..Files::default() }
    }

    /// Reads the mesh of that name, as [`mesh::load`] does.
    ///
    /// # Errors
    /// Those of [`mesh::load`].
    pub fn mesh(&self, name: &str) -> Result<(MeshData, Vec<String>)> {
        match self.made.get(name) {
            Some(bytes) => mesh::read(Cursor::new(bytes), name),
            None => mesh::load(&self.folder.join(name), name),
        }
    }

    /// Reads the points of instances in the file of that name, as [`points::read`] does.
    ///
    /// # Errors
    /// Those of [`points::read`].
    pub fn points(&self, name: &str) -> Result<(Vec<InstancePoint>, Vec<String>)> {
        match self.made.get(name) {
            Some(bytes) => points::read(Cursor::new(bytes), name),
            None => points::read(BufReader::new(open(&self.folder.join(name), name)?), name),
        }
    }

    /// Reads the curves in the file of that name, as [`curves_file::read`] does, and the hash of the file.
    ///
    /// # Errors
    /// Those of [`curves_file::read`] and of [`Files::bytes`].
    pub fn curves(&self, name: &str) -> Result<(CurvePoints, Hash)> {
        let content = self.bytes(name)?;
        Ok((curves_file::read(&content, name)?, hash_of(&content)))
    }

    /// Reads the whole file of that name.
    ///
    /// # Errors
    /// `Invalid` where the file is missing or not regular, or [may not be named](Files::why_not); `Io` where it cannot be read.
    pub fn bytes(&self, name: &str) -> Result<Vec<u8>> {
        if let Some(bytes) = self.made.get(name) {
            return Ok(bytes.clone());
        }
        if let Some(why) = self.why_not(name) {
            return Err(Error::invalid(Fault::new(why)));
        }
        let mut bytes = vec![];
        open(&self.folder.join(name), name)?.read_to_end(&mut bytes).map_err(|e| Error::io(name, e))?;
        Ok(bytes)
    }

    /// Reads the picture of that name, as [`picture::load`] does.
    ///
    /// # Errors
    /// Those of [`picture::load`].
    pub fn picture(&self, name: &str, encoding: Encoding, channel: Option<Channel>) -> Result<(Pixels, Vec<String>)> {
        match self.made.get(name) {
            Some(bytes) => picture::read(bytes, name, encoding, channel),
            None => picture::load(&self.folder.join(name), name, encoding, channel),
        }
    }

    /// Reads the measured intensities in the IES file of that name, as [`ies::read`] does, and the hash of the file.
    ///
    /// # Errors
    /// Those of [`ies::read`] and of [`Files::bytes`].
    pub fn profile(&self, name: &str) -> Result<(IntensityProfile, Vec<String>, Hash)> {
        let content = self.bytes(name)?;
        let (profile, warnings) = ies::read(&content, name)?;
        Ok((profile, warnings, hash_of(&content)))
    }

    /// Reads the table of a lens in the file of that name, as [`lens_file::read`] does, and the hash of the file.
    ///
    /// # Errors
    /// Those of [`lens_file::read`] and of [`Files::bytes`].
    pub fn lens(&self, name: &str) -> Result<(LensTable, Hash)> {
        let content = self.bytes(name)?;
        Ok((lens_file::read(&content, name)?, hash_of(&content)))
    }

    /// Reads the grid of numbers in the file of that name, as [`volume::read`] does, and the hash of the file.
    ///
    /// # Errors
    /// Those of [`volume::read`] and of [`Files::bytes`].
    pub fn volume(&self, name: &str, request: volume::Request) -> Result<(Volume, Hash)> {
        let content = self.bytes(name)?;
        Ok((volume::read(&content, name, request)?, hash_of(&content)))
    }

    /// Says what is wrong with the name of a file; `None` if the scene may read it.
    ///
    /// The text of the path is checked first, so that no message tells what exists outside of the folder. Then the file system is
    /// asked, because links can lead out of the folder too.
    pub fn why_not(&self, name: &str) -> Option<String> {
        no_name(name).or_else(|| if self.allow_outside { None } else { outside(name, &self.folder) })
    }

    /// Says what is wrong with the name of a file, or that the file is missing or not regular. The content is not checked.
    fn unusable(&self, name: &str) -> Option<String> {
        self.why_not(name).or_else(|| {
            let found = if self.made.contains_key(name) { Ok(()) } else { open(&self.folder.join(name), name).map(drop) };
            match found {
                Err(Error::Invalid(faults)) => faults.first().map(|fault| format!("{name}: {}", fault.message)),
                // Other errors of the system are reported when the file is read.
                _ => None,
            }
        })
    }

    /// Returns the JSON pointers of all names of files that cannot be used, with what is wrong with each.
    pub(super) fn all_unusable(&self, scene: &Scene) -> Vec<(String, String)> {
        files_of(scene).into_iter().filter_map(|(pointer, file)| Some((pointer, self.unusable(file)?))).collect()
    }

    /// Returns the JSON pointers of all names of files that the scene may not read, with what is wrong with each.
    pub(crate) fn refused(&self, scene: &Scene) -> Vec<(String, String)> {
        files_of(scene).into_iter().filter_map(|(pointer, file)| Some((pointer, self.why_not(file)?))).collect()
    }
}

/// Returns the files that a scene names, each with its JSON pointer.
pub fn files_of(scene: &Scene) -> Vec<(String, &str)> {
    let mut files = Named(vec![]);
    if let Camera::Realistic(Realistic { lens: Lens::File(file), .. }) = &scene.camera {
        files.0.push(("/camera/lens".to_owned(), file));
    }
    scene.textures.iter().for_each(|(name, texture)| files.texture(&format!("/textures{}", escaped(name)), texture));
    scene.materials.iter().for_each(|(name, material)| files.material(&format!("/materials{}", escaped(name)), material));
    scene.media.iter().for_each(|(name, medium)| files.medium(&format!("/media{}", escaped(name)), medium));
    files.medium_ref("/medium", scene.medium.as_ref());
    scene.groups.iter().for_each(|(name, shapes)| files.shapes(&format!("/groups{}", escaped(name)), shapes));
    files.shapes("/shapes", &scene.shapes);
    for (i, light) in scene.lights.iter().enumerate() {
        let named = match light {
            Light::Point(point) => ("profile", point.profile.as_deref()),
            Light::Spot(spot) => ("image", spot.image.as_deref()),
            Light::Directional(_) => continue,
        };
        files.0.extend(named.1.map(|file| (format!("/lights/{i}/{}", named.0), file)));
    }
    if let Some(image) = scene.background.as_ref().and_then(|background| background.image.as_deref()) {
        files.0.push(("/background/image".to_owned(), image));
    }
    files.0
}

/// Says what is wrong with a name that is empty, too long or not printable.
fn no_name(file: &str) -> Option<String> {
    if file.is_empty() {
        return Some("an empty file name".to_owned());
    }
    let too_long = (file.len() > LONGEST).then(|| format!("a file name of {} bytes, expected at most {LONGEST}", file.len()));
    too_long.or_else(|| file.contains(char::is_control).then(|| "a file name with control characters".to_owned()))
}

fn outside(file: &str, folder: &Path) -> Option<String> {
    let why = if is_absolute(file) {
        "is no path from the scene file's folder"
    } else if climbs_out(file) {
        "leads out of the scene file's folder"
    } else if is_linked_out(file, folder) {
        "is a link out of the scene file's folder"
    } else {
        return None;
    };
    Some(format!("{file}: {why}; if it may, say --allow-outside"))
}

/// Whether the path is absolute on any system, so that all systems refuse the same scenes.
fn is_absolute(file: &str) -> bool {
    let has_drive = file.as_bytes().first().is_some_and(u8::is_ascii_alphabetic) && file[1..].starts_with(':');
    file.starts_with(['/', '\\', '~']) || has_drive || Path::new(file).is_absolute()
}

/// Whether any step of the path leaves the folder, even if a later step returns to it.
fn climbs_out(file: &str) -> bool {
    let mut depth = 0i32;
    file.split(['/', '\\']).any(|step| {
        depth += match step {
            "" | "." => 0,
            ".." => -1,
            _ => 1,
        };
        depth < 0
    })
}

/// Whether the path leads out of the folder through a link. A path that does not exist does not.
fn is_linked_out(file: &str, folder: &Path) -> bool {
    let folder = if folder == Path::new("") { Path::new(".") } else { folder };
    let real = |path: &Path| path.canonicalize().ok();
    Option::zip(real(folder), real(&folder.join(file))).is_some_and(|(folder, file)| !file.starts_with(folder))
}

/// The files that were found so far, with their JSON pointers.
struct Named<'s>(Vec<(String, &'s str)>);

impl<'s> Named<'s> {
    fn shapes(&mut self, pointer: &str, shapes: &'s [Shape]) {
        for (i, shape) in shapes.iter().enumerate() {
            let pointer = format!("{pointer}/{i}");
            if let Some(material) = shape.material() {
                self.material_ref(&format!("{pointer}/material"), material);
            }
            if let Some(texture) = shape.emission().and_then(|emission| emission.texture.as_ref()) {
                self.textured(&format!("{pointer}/emission/texture"), texture);
            }
            self.medium_ref(&format!("{pointer}/medium"), shape.medium());
            match shape {
                Shape::Group(group) => self.shapes(&format!("{pointer}/shapes"), &group.shapes),
                Shape::Mesh(mesh) => {
                    self.0.extend(mesh.file.as_deref().map(|file| (format!("{pointer}/file"), file)));
                    for (name, material) in &mesh.materials {
                        self.material_ref(&format!("{pointer}/materials{}", escaped(name)), material);
                    }
                    let files = mesh.keyframes.iter().enumerate().filter_map(|(i, keyframe)| Some((i, keyframe.file.as_deref()?)));
                    self.0.extend(files.map(|(i, file)| (format!("{pointer}/keyframes/{i}/file"), file)));
                    if let Some(displacement) = &mesh.displacement {
                        self.textured(&format!("{pointer}/displacement/texture"), &displacement.texture);
                    }
                }
                Shape::Curves(curves) => {
                    self.0.extend(curves.file.as_deref().map(|file| (format!("{pointer}/file"), file)));
                }
                Shape::Sdf(sdf) => {
                    for (i, part) in sdf.parts.iter().flatten().enumerate() {
                        if let Some(material) = &part.material {
                            self.material_ref(&format!("{pointer}/parts/{i}/material"), material);
                        }
                        if let Some(texture) = part.emission.as_ref().and_then(|emission| emission.texture.as_ref()) {
                            self.textured(&format!("{pointer}/parts/{i}/emission/texture"), texture);
                        }
                    }
                }
                Shape::Instances(instances) => {
                    self.0.extend(instances.file.as_deref().map(|file| (format!("{pointer}/file"), file)));
                    for (at, material) in instances.materials() {
                        self.material_ref(&format!("{pointer}/{at}"), material);
                    }
                }
                Shape::Sphere(_) | Shape::Quad(_) | Shape::Disk(_) | Shape::Cylinder(_) | Shape::Cone(_) => {}
                Shape::BilinearPatch(_) | Shape::Box(_) => {}
            }
        }
    }

    fn medium_ref(&mut self, pointer: &str, medium: Option<&'s MediumRef>) {
        if let Some(MediumRef::Inline(medium)) = medium {
            self.medium(pointer, medium);
        }
    }

    fn medium(&mut self, pointer: &str, medium: &'s Medium) {
        let file = medium.density().and_then(Density::file);
        self.0.extend(file.map(|file| (format!("{pointer}/density/file"), file)));
        let grids = medium.color_grids().filter_map(|(key, grid)| Some((format!("{pointer}/{key}/file"), grid.file.as_deref()?)));
        self.0.extend(grids);
    }

    fn material_ref(&mut self, pointer: &str, material: &'s MaterialRef) {
        if let MaterialRef::Inline(material) = material {
            self.material(pointer, material);
        }
    }

    fn material(&mut self, pointer: &str, material: &'s Material) {
        material.description().textures().into_iter().for_each(|(key, texture)| self.textured(&format!("{pointer}/{key}"), texture));
        material.description().parts().into_iter().for_each(|(key, part)| self.material_ref(&format!("{pointer}/{key}"), part));
    }

    fn textured(&mut self, pointer: &str, color: &'s Textured) {
        if let Textured::Texture(texture) = color {
            self.texture(pointer, texture);
        }
    }

    fn texture(&mut self, pointer: &str, texture: &'s Texture) {
        if let Texture::Image(image) = texture {
            self.0.push((format!("{pointer}/file"), &image.file));
        }
        texture.parts().into_iter().for_each(|(key, part)| self.textured(&format!("{pointer}/{key}"), part));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_counted_on_every_system() {
        for file in ["a", "./a", "a/../b", "a//b/../../c", "a\\..\\b", "..a/b", "a..", "...", "ab:c/d", "é:x", ""] {
            assert!(!is_absolute(file) && !climbs_out(file), "{file}");
        }
        for file in ["..", "../a", "a/../../b", "./../a", "a/../../scenes/b", "..\\a", "a\\..\\..\\b"] {
            assert!(climbs_out(file) && !is_absolute(file), "{file}");
        }
        for file in ["/a", "//server/share", "\\\\server\\share\\a", "\\a", "~/a", "~user/a", "C:\\a", "c:/a", "c:a"] {
            assert!(is_absolute(file), "{file}");
        }
    }
}
