//! Textures: pictures by index, one channel or all, and their coordinates.

use glam::Vec2;

use super::buffer::{file_name, of_data};
use super::document::{Document, Picture};
use crate::describe::picture::{READ, unread_format};
use crate::import::json_cursor::JsonCursor;
use crate::reader::Node;

/// Map from the texture coordinates of the file to those of pt.
///
/// (u′, v′) = offset + R scale (u, v), and then v upwards: 1 − v′. R (u, v) = (c u + s v, c v − s u): counter-clockwise in a
/// picture whose v runs down.
///
/// Source: Khronos, *KHR_texture_transform*, by its text; its listing rotates in the other direction, which is a known mistake
/// (KhronosGroup/glTF, issue 1563).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mapping {
    /// Index of the set: TEXCOORD_⟨set⟩.
    pub set: u32,
    offset: [f64; 2],
    rotation: f64,
    scale: [f64; 2],
}

impl Default for Mapping {
    fn default() -> Mapping {
        Mapping { set: 0, offset: [0.0; 2], rotation: 0.0, scale: [1.0; 2] }
    }
}

impl Mapping {
    /// Map of a reference to a texture.
    pub fn of(info: &JsonCursor) -> Mapping {
        let transform = info.get(&["extensions"]).and_then(|all| all.get(&["KHR_texture_transform"]));
        let set = |of: &JsonCursor| of.get(&["texCoord"]).and_then(|set| set.whole()).and_then(|set| u32::try_from(set).ok());
        let pair = |key, default| transform.as_ref().and_then(|t| t.get(&[key])).and_then(|at| numbers(&at)).unwrap_or(default);
        Mapping {
            set: transform.as_ref().and_then(set).or_else(|| set(info)).unwrap_or(0),
            offset: pair("offset", [0.0; 2]),
            rotation: transform.as_ref().and_then(|t| t.get(&["rotation"])).and_then(|at| at.number()).unwrap_or(0.0),
            scale: pair("scale", [1.0; 2]),
        }
    }

    /// Converts coordinates to those of pt.
    pub fn upwards(&self, uv: Vec2) -> Vec2 {
        let (s, c) = self.rotation.sin_cos();
        let [u, v] = [f64::from(uv.x) * self.scale[0], f64::from(uv.y) * self.scale[1]];
        let [u, v] = [self.offset[0] + c * u + s * v, self.offset[1] + c * v - s * u];
        Vec2::new(u as f32, (1.0 - v) as f32)
    }
}

/// `N` numbers in a list; `None` with a fault noted.
pub fn numbers<const N: usize>(at: &JsonCursor) -> Option<[f64; N]> {
    let items = at.items()?;
    let numbers: Option<Vec<f64>> = items.iter().map(JsonCursor::number).collect();
    let numbers = numbers?.try_into().ok();
    if numbers.is_none() {
        at.fault(format!("expected {N} numbers, found {}", items.len()));
    }
    numbers
}

/// Meaning of a picture's numbers.
#[derive(Clone, Copy, PartialEq)]
pub enum Kind {
    /// Colour.
    Color,
    /// Emission.
    Emission,
    /// Normal map.
    Normal,
    /// One channel: "r", "g", "b" or "a".
    Share(&'static str),
}

impl Kind {
    /// Effect of a missing picture of this kind, for notes.
    fn without(self) -> &'static str {
        match self {
            Kind::Color => "a plain colour shows in its place",
            Kind::Emission => "the surface does not emit",
            Kind::Normal => "the surface is smooth there",
            Kind::Share(_) => "its factor alone is used",
        }
    }
}

impl<'a> Document<'a> {
    /// pt's texture for the one that `info` refers to; `None` if there is none, with a note or a fault.
    pub fn texture(&self, info: &JsonCursor<'a>, kind: Kind) -> Option<Node> {
        let index = info.need(&["index"])?;
        let number = index.whole()?;
        let Some(texture) = self.gltf.textures().nth(usize::try_from(number).ok()?) else {
            index.fault(format!("texture {number}, but there are {}", self.gltf.textures().len()));
            return None;
        };
        let at = self.item("textures", texture.index());
        let file = self.first_picture(&at, kind)?;
        let mut members = vec![("type", info.make_text("image")), ("file", info.make_text(file))];
        match kind {
            Kind::Color | Kind::Emission => {}
            Kind::Normal => members.push(("encoding", info.make_text("linear"))),
            Kind::Share(channel) => members.extend([("encoding", info.make_text("linear")), ("channel", info.make_text(channel))]),
        }
        members.extend(self.sampler(&at, &texture, info));
        Some(info.make_object(members))
    }

    fn sampler(&self, at: &JsonCursor<'a>, texture: &gltf::Texture, info: &JsonCursor) -> Vec<(&'static str, Node)> {
        use gltf::texture::{MagFilter, WrappingMode};
        let sampler = texture.sampler();
        if sampler.wrap_s() != sampler.wrap_t() {
            self.note(at, "different wrapping along u and v is left out: wrapS holds for both");
        }
        let wrap = match sampler.wrap_s() {
            WrappingMode::Repeat => None,
            WrappingMode::MirroredRepeat => Some("mirror"),
            WrappingMode::ClampToEdge => Some("clamp"),
        };
        let filter = (sampler.mag_filter() == Some(MagFilter::Nearest)).then_some("nearest");
        let wrap = wrap.map(|wrap| ("wrap", info.make_text(wrap)));
        wrap.into_iter().chain(filter.map(|filter| ("filter", info.make_text(filter)))).collect()
    }

    /// File of the first picture of a texture that pt can read: its own, then those of extensions. `None` if there is none, with a
    /// fault, or a note about what shows instead.
    fn first_picture(&self, at: &JsonCursor<'a>, kind: Kind) -> Option<String> {
        let extensions = at.get(&["extensions"]).and_then(|all| all.members()).unwrap_or_default();
        let sources = std::iter::once(at.clone()).chain(extensions.into_iter().map(|(_, extension)| extension));
        let mut unread = None;
        for source in sources.filter_map(|of| of.get(&["source"])) {
            match self.picture(usize::try_from(source.whole()?).ok()?)? {
                Picture::File(file) => return Some(file),
                Picture::Unread(format) => unread = unread.or(Some(format)),
            }
        }
        let what = unread.map_or("a texture without a picture is left out".to_owned(), |format| {
            format!("a picture in {format} is left out, pt reads {READ}")
        });
        self.note(at, format!("{what}: {}", kind.without()));
        None
    }

    /// Picture of an index; `None` with a fault noted.
    fn picture(&self, index: usize) -> Option<Picture> {
        if let Some(known) = self.pictures.borrow().get(&index) {
            return known.clone();
        }
        let picture = self.find_picture(index);
        self.pictures.borrow_mut().insert(index, picture.clone());
        picture
    }

    fn find_picture(&self, index: usize) -> Option<Picture> {
        let at = self.item("images", index);
        let Some(image) = self.gltf.as_json().images.get(index) else {
            self.root.fault(format!("picture {index}, but there are {}", self.gltf.images().len()));
            return None;
        };
        let view = image.buffer_view.and_then(|view| self.gltf.views().nth(view.value()));
        let bytes = match (&image.uri, view) {
            (Some(uri), _) => {
                let location = at.get(&["uri"])?;
                if !uri.starts_with("data:") {
                    return Some(self.beside(file_name(&location, uri)?));
                }
                of_data(&location, uri)?
            }
            (None, Some(view)) => match self.buffers.view(&view) {
                Some(bytes) => bytes.to_vec(),
                None => {
                    at.fault(format!("bufferView {} reaches beyond its buffer", view.index()));
                    return None;
                }
            },
            (None, None) => {
                at.fault("a picture needs a uri or a bufferView");
                return None;
            }
        };
        if let Some(format) = unread_format(&bytes) {
            return Some(Picture::Unread(format));
        }
        let extension = match bytes.first() {
            Some(0xFF) => "jpg",
            Some(b'R') => "webp",
            _ => "png",
        };
        let file = self.made_name(&format!("picture-{index}"), extension);
        self.root.context().make(&*file, bytes);
        Some(Picture::File(file))
    }

    /// Picture in a file beside the scene. What is wrong with the file is reported when it is read.
    fn beside(&self, file: String) -> Picture {
        let format = self.root.context().files.bytes(&file).ok().and_then(|bytes| unread_format(&bytes));
        format.map_or(Picture::File(file), Picture::Unread)
    }

    /// Name for a file that comes with the scene, different from those of all pictures beside it.
    pub fn made_name(&self, stem: &str, extension: &str) -> String {
        let mut name = format!("{stem}.{extension}");
        let is_taken = |name: &str| self.gltf.as_json().images.iter().any(|image| image.uri.as_deref() == Some(name));
        while is_taken(&name) {
            name.insert(0, '_');
        }
        name
    }
}
