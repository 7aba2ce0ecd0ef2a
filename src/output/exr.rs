//! OpenEXR files: every channel, 32-bit float, lossless.

use std::io::Cursor;
use std::path::Path;

use exr::meta::MetaData;
use exr::meta::header::Header;
use exr::prelude::*;
use glam::UVec2;

use super::decode_error::DecodeError;
use super::open::bytes;
use super::{Attributes, Value};
use crate::error::{Error, Result as PtResult};
use crate::film::{Channel, Image};

/// Encodes a picture. The data window is the rendered part, the display window the whole picture; compression is ZIP over 16 rows.
pub fn encode(image: &Image, attributes: &Attributes) -> PtResult<Vec<u8>> {
    let channel = |c: &Channel| AnyChannel::new(utf8(&c.name), FlatSamples::F32(c.values.clone()));
    let channels = AnyChannels::sort(image.channels.iter().map(channel).collect());
    let mut about = LayerAttributes { software_name: Some("pt".into()), ..LayerAttributes::default() };
    about.layer_position = Vec2(image.origin.x as i32, image.origin.y as i32);
    let full = (image.full_size.x as usize, image.full_size.y as usize);
    let mut shared = ImageAttributes::new(IntegerBounds::new((0, 0), full));
    attributes.iter().for_each(|(name, value)| describe(&mut about, &mut shared, name, value));
    let encoding = Encoding { compression: Compression::ZIP16, ..Encoding::SMALL_LOSSLESS };
    let layer = Layer::new((image.size.x as usize, image.size.y as usize), about, encoding, channels);
    let file = exr::image::Image::empty(shared).with_layer(layer);
    let mut bytes = Cursor::new(vec![]);
    file.write().to_buffered(&mut bytes).map_err(|e| Error::Internal(format!("cannot encode EXR: {e}")))?;
    Ok(bytes.into_inner())
}

const TO_CAMERA: &str = "worldToCamera";
const TO_NDC: &str = "worldToNDC";
const SCREEN_WIDTH: &str = "screenWindowWidth";
const SCREEN_CENTER: &str = "screenWindowCenter";
const ON_AXIS: Vec2<f32> = Vec2(0.0, 0.0);
/// Value of a required attribute if it is unknown.
const NO_SCREEN_WIDTH: f32 = 1.0;
const PIXEL_ASPECT: &str = "pixelAspectRatio";
const SQUARE: f32 = 1.0;

/// Adds an attribute. The crate stores some of OpenEXR's own attributes separately.
fn describe(about: &mut LayerAttributes, shared: &mut ImageAttributes, name: &str, value: &Value) {
    let other = match (name, value) {
        (TO_CAMERA, Value::Matrix(matrix)) => return about.world_to_camera = Some(*matrix),
        (TO_NDC, Value::Matrix(matrix)) => return about.world_to_normalized_device = Some(*matrix),
        (SCREEN_WIDTH, Value::Number(width)) => return about.screen_window_width = *width,
        (SCREEN_CENTER, Value::Point([x, y])) => return about.screen_window_center = Vec2(*x, *y),
        // The format has no others.
        (PIXEL_ASPECT, Value::Number(ratio)) if !(1e-6..=1e6).contains(ratio) => return,
        (PIXEL_ASPECT, Value::Number(ratio)) => return shared.pixel_aspect = *ratio,
        (_, Value::Text(text)) => AttributeValue::Text(utf8(text)),
        (_, Value::Integer(number)) => AttributeValue::I32(*number),
        (_, Value::Number(number)) => AttributeValue::F32(*number),
        (_, Value::Point([x, y])) => AttributeValue::FloatVec2(Vec2(*x, *y)),
        (_, Value::Matrix(matrix)) => AttributeValue::Matrix4x4(*matrix),
    };
    about.other.insert(utf8(name), other);
}

/// Attributes that [`describe`] could have written, by name.
fn described(about: &LayerAttributes, shared: &ImageAttributes) -> Attributes {
    let other = about.other.iter().filter_map(|(name, value)| Some((from_utf8(name), known(value)?)));
    let matrices = [(TO_CAMERA, about.world_to_camera), (TO_NDC, about.world_to_normalized_device)];
    let matrices = matrices.into_iter().filter_map(|(name, matrix)| Some((name.to_owned(), Value::Matrix(matrix?))));
    let width = Some(about.screen_window_width).filter(|width| *width != NO_SCREEN_WIDTH);
    let width = width.map(|width| (SCREEN_WIDTH.to_owned(), Value::Number(width)));
    let center = Some(about.screen_window_center).filter(|center| *center != ON_AXIS);
    let center = center.map(|Vec2(x, y)| (SCREEN_CENTER.to_owned(), Value::Point([x, y])));
    let ratio = Some(shared.pixel_aspect).filter(|ratio| *ratio != SQUARE);
    let ratio = ratio.map(|ratio| (PIXEL_ASPECT.to_owned(), Value::Number(ratio)));
    let mut all: Attributes = other.chain(matrices).chain(width).chain(center).chain(ratio).collect();
    all.sort_by(|a, b| a.0.cmp(&b.0));
    all
}

fn known(value: &AttributeValue) -> Option<Value> {
    match value {
        AttributeValue::Text(text) => Some(Value::Text(from_utf8(text))),
        AttributeValue::I32(number) => Some(Value::Integer(*number)),
        AttributeValue::F32(number) => Some(Value::Number(*number)),
        AttributeValue::FloatVec2(Vec2(x, y)) => Some(Value::Point([*x, *y])),
        AttributeValue::Matrix4x4(matrix) => Some(Value::Matrix(*matrix)),
        _ => None,
    }
}

/// Text of an EXR has no declared encoding; UTF-8 is used here.
fn utf8(text: &str) -> Text {
    Text::from_slice_unchecked(text.as_bytes())
}

fn from_utf8(text: &Text) -> String {
    String::from_utf8_lossy(text.bytes()).into_owned()
}

/// Reads all channels of the first part as f32, and its attributes that are text, numbers, points or matrices, by name.
///
/// # Errors
/// The errors of [`super::read()`].
pub fn read(path: &Path) -> PtResult<(Image, Attributes)> {
    decode(&bytes(path)?).map_err(|refusal| refusal.of(path))
}

/// Decodes the bytes of a file.
pub(super) fn decode(bytes: &[u8]) -> PtResult<(Image, Attributes), DecodeError> {
    let broken = |e: exr::error::Error| DecodeError::Invalid(format!("not a readable EXR picture: {e}"));
    check_size(&MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(broken)?)?;
    let reader = exr::prelude::read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer().all_attributes();
    let file = reader.from_buffered(Cursor::new(bytes)).map_err(broken)?;
    let (shared, layer) = (file.attributes, file.layer_data);
    let display = shared.display_window;
    let channel = |c: &AnyChannel<FlatSamples>| Channel { name: from_utf8(&c.name), values: c.sample_data.values_as_f32().collect() };
    let [x, y] = [|v: Vec2<i32>| v.x(), |v: Vec2<i32>| v.y()]
        .map(|of| i64::from(of(layer.attributes.layer_position)) - i64::from(of(display.position)));
    let [width, height] = [layer.size.x() as i64, layer.size.y() as i64];
    if x < 0 || y < 0 || x + width > display.size.x() as i64 || y + height > display.size.y() as i64 {
        let message = format!("the data window, {width} × {height} from ({x}, {y}), reaches beyond the display window");
        return Err(DecodeError::Invalid(message));
    }
    let image = Image {
        full_size: UVec2::new(display.size.x() as u32, display.size.y() as u32),
        origin: UVec2::new(x as u32, y as u32),
        size: UVec2::new(width as u32, height as u32),
        channels: layer.channel_data.list.iter().map(channel).collect(),
    };
    Ok((image, described(&layer.attributes, &shared)))
}

/// Refuses a picture that is too large, before it is decoded.
fn check_size(meta: &MetaData) -> PtResult<(), DecodeError> {
    let bytes = |header: &Header| header.layer_size.x() as u128 * header.layer_size.y() as u128 * header.channels.list.len() as u128 * 4;
    match meta.headers.iter().map(bytes).max() {
        Some(most) if most > super::decode::MOST_MEMORY.into() => Err(DecodeError::TooLarge),
        _ => Ok(()),
    }
}

/// Storage of a picture, one fact per line: parts, compression, types of channels, and all attributes with their values.
pub(super) fn facts(bytes: &[u8]) -> Vec<(String, String)> {
    let Ok(meta) = MetaData::read_from_buffered(Cursor::new(bytes), false) else { return vec![] };
    let mut facts = vec![];
    let mut fact = |name: &str, value: Option<String>| facts.extend(value.map(|value| (name.to_owned(), value)));
    fact("parts", (meta.headers.len() > 1).then(|| format!("{}, of which the first is read", meta.headers.len())));
    let Some(header) = meta.headers.first() else { return facts };
    let types = header.channels.list.iter().map(|c| format!("{:?}", c.sample_type).to_lowercase());
    let mut types: Vec<String> = types.collect();
    types.sort();
    types.dedup();
    fact("compression", Some(format!("{:?}", header.compression)));
    fact("samples", Some(types.join(", ")));
    let (own, shared) = (&header.own_attributes, &header.shared_attributes);
    let texts = [
        ("software", &own.software_name),
        ("layer", &own.layer_name),
        ("owner", &own.owner),
        ("comments", &own.comments),
        ("capture date", &own.capture_date),
    ];
    texts.into_iter().for_each(|(name, text)| fact(name, text.as_ref().map(from_utf8)));
    fact("chromaticities", shared.chromaticities.map(|c| format!("{c:?}")));
    let unknown = shared.other.iter().chain(own.other.iter().filter(|(_, value)| known(value).is_none()));
    let mut others: Vec<(String, String)> = unknown.map(|(name, value)| (from_utf8(name), shown(value))).collect();
    others.extend(described(own, shared).into_iter().map(|(name, value)| (name, value.to_string())));
    others.sort();
    others.into_iter().for_each(|(name, value)| fact(&name, Some(value)));
    facts
}

fn shown(value: &AttributeValue) -> String {
    known(value).map_or_else(|| format!("{value:?}"), |value| value.to_string())
}
