//! OpenEXR: every channel, 32-bit float, lossless.

use std::io::Cursor;
use std::path::Path;

use exr::prelude::*;
use glam::UVec2;

use super::Attributes;
use crate::error::{Error, Fault, Result as PtResult};
use crate::film::{Channel, Image};

/// Data window = the rendered part, display window = the whole picture; ZIP over 16 rows.
pub fn encode(image: &Image, attributes: &Attributes) -> PtResult<Vec<u8>> {
    let channel = |c: &Channel| AnyChannel::new(utf8(&c.name), FlatSamples::F32(c.values.clone()));
    let channels = AnyChannels::sort(image.channels.iter().map(channel).collect());
    let mut about = LayerAttributes { software_name: Some("pt".into()), ..LayerAttributes::default() };
    about.layer_position = Vec2(image.origin.x as i32, image.origin.y as i32);
    for (name, value) in attributes {
        about.other.insert(utf8(name), AttributeValue::Text(utf8(value)));
    }
    let encoding = Encoding { compression: Compression::ZIP16, ..Encoding::SMALL_LOSSLESS };
    let layer = Layer::new((image.size.x as usize, image.size.y as usize), about, encoding, channels);
    let full = (image.full_size.x as usize, image.full_size.y as usize);
    let display = IntegerBounds::new((0, 0), full);
    let file = exr::image::Image::empty(ImageAttributes::new(display)).with_layer(layer);
    let mut bytes = Cursor::new(vec![]);
    file.write().to_buffered(&mut bytes).map_err(|e| Error::Internal(format!("cannot encode EXR: {e}")))?;
    Ok(bytes.into_inner())
}

/// The bytes of EXR's text are of no declared encoding: here UTF-8.
fn utf8(text: &str) -> Text {
    Text::from_slice_unchecked(text.as_bytes())
}

fn from_utf8(text: &Text) -> String {
    String::from_utf8_lossy(text.bytes()).into_owned()
}

/// All channels of the first layer as f32, and its text attributes.
///
/// # Errors
/// `Invalid` for what is no EXR file; `Io` where it cannot be read.
pub fn read(path: &Path) -> PtResult<(Image, Attributes)> {
    let bytes = std::fs::read(path).map_err(|e| Error::io(path, e))?;
    let reader = exr::prelude::read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer().all_attributes();
    let broken = |e: exr::error::Error| Error::invalid(Fault::new(format!("not a readable EXR picture: {e}")).in_file(path));
    let file = reader.from_buffered(Cursor::new(bytes)).map_err(broken)?;
    let layer = file.layer_data;
    let unsigned = |v: i32| v.max(0) as u32;
    let channel = |c: &AnyChannel<FlatSamples>| Channel { name: from_utf8(&c.name), values: c.sample_data.values_as_f32().collect() };
    let text = |(name, value): (&Text, &AttributeValue)| match value {
        AttributeValue::Text(text) => Some((from_utf8(name), from_utf8(text))),
        _ => None,
    };
    let display = file.attributes.display_window.size;
    let image = Image {
        full_size: UVec2::new(display.x() as u32, display.y() as u32),
        origin: UVec2::new(unsigned(layer.attributes.layer_position.x()), unsigned(layer.attributes.layer_position.y())),
        size: UVec2::new(layer.size.x() as u32, layer.size.y() as u32),
        channels: layer.channel_data.list.iter().map(channel).collect(),
    };
    Ok((image, layer.attributes.other.iter().filter_map(text).collect()))
}
