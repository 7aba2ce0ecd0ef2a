//! Advice for files that no dialect matches and that are not JSON: their first bytes tell what they are.

use super::context::Content;

/// Scene files that pt reads, for messages.
const READ: &str = "pt reads its own JSON, glTF, OBJ, PLY and STL, and what `pt list dialects` names";

/// Description of bytes that are neither text nor a known format.
const NOISE: &str = "no text, and no file of a kind that pt knows";

/// Advice for programs that can write glTF.
const EXPORT: &str = "export it as glTF (.glb)";

/// Number of bytes that are examined.
const LOOK: usize = 1 << 16;

/// Binary files by their first bytes: what they are, and advice.
const BINARY: &[(&[u8], &str, &str)] = &[
    (b"BLENDER", "a Blender file", EXPORT),
    (b"Kaydara FBX Binary", "an FBX model", EXPORT),
    (b"PXR-USDC", "a USD scene", EXPORT),
    (b"Ogawa", "an Alembic scene", EXPORT),
    (b"PK\x03\x04", "a ZIP archive (.zip, .usdz, .3mf)", "unpack it, or export the scene as glTF (.glb)"),
    (b"\x1F\x8B", "a gzip archive", "unpack it"),
    (b"\x28\xB5\x2F\xFD", "a Zstandard archive (Blender compresses its files so)", EXPORT),
    (b"\x89PTC", "a part of a render", "see pt merge --help"),
];

/// Text files by the start of their first line.
const TEXT: &[(&str, &str, &str)] = &[
    ("#usda", "a USD scene", EXPORT),
    ("; FBX", "an FBX model", EXPORT),
    ("#VRML", "a VRML scene", EXPORT),
    ("newmtl", "a library of materials (MTL)", "name the .obj file that it belongs to"),
    ("OFF", "an OFF model", READ),
];

/// XML files by the name of their first element and an attribute of it.
const XML: &[(&str, &str, &str, &str)] = &[
    ("scene", "version", "a Mitsuba scene", READ),
    ("scene", "", "a Nori or Mitsuba scene", READ),
    ("collada", "", "a COLLADA scene", EXPORT),
    ("x3d", "", "an X3D scene", EXPORT),
    ("svg", "", "an SVG drawing", READ),
    ("html", "", "a web page", READ),
];

/// Statements that a file of pbrt's format may begin with (*pbrt-v4 File Format*).
const PBRT: &[&str] = &[
    "Accelerator",
    "AreaLightSource",
    "AttributeBegin",
    "Attribute",
    "Camera",
    "ColorSpace",
    "ConcatTransform",
    "CoordSysTransform",
    "CoordinateSystem",
    "Film",
    "Identity",
    "Import",
    "Include",
    "Integrator",
    "LightSource",
    "LookAt",
    "MakeNamedMaterial",
    "MakeNamedMedium",
    "Material",
    "MediumInterface",
    "NamedMaterial",
    "ObjectBegin",
    "Option",
    "PixelFilter",
    "Renderer",
    "ReverseOrientation",
    "Rotate",
    "Sampler",
    "Scale",
    "Shape",
    "SurfaceIntegrator",
    "Texture",
    "Transform",
    "TransformTimes",
    "Translate",
    "VolumeIntegrator",
    "WorldBegin",
];

/// Returns what the file is and what to do about it; `None` for what may be JSON with a mistake.
pub fn explained(content: &Content) -> Option<String> {
    let start = &content.bytes[..content.bytes.len().min(LOOK)];
    let (what, advice) = binary(start).or_else(|| text(&String::from_utf8_lossy(start)))?;
    let clause = if what == NOISE { "" } else { ", which pt does not render" };
    Some(format!("{what}{clause}: {advice}"))
}

fn binary(start: &[u8]) -> Option<(&'static str, &'static str)> {
    let magic = BINARY.iter().find(|(magic, ..)| start.starts_with(magic) && !start.is_ascii());
    if let Some((_, what, advice)) = magic {
        return Some((what, advice));
    }
    if image::guess_format(start).is_ok() {
        return Some(("a picture", "see pt image --help"));
    }
    // UTF-16 is text, and the JSON parser reports it.
    let is_wide = start.starts_with(b"\xFF\xFE") || start.starts_with(b"\xFE\xFF") || start.iter().take(2).any(|b| *b == 0);
    let is_control = |b: &u8| *b < 0x20 && !matches!(b, b'\t' | b'\n' | b'\r' | 0x0C | 0x1B);
    (!is_wide && start.iter().any(is_control)).then_some((NOISE, READ))
}

/// Name and attributes of the first element of an XML file, after its declaration, its document type and comments. Empty if there is none.
fn first_element(mut rest: &str) -> (&str, &str) {
    loop {
        rest = rest.trim_start();
        let end = if rest.starts_with("<?") {
            "?>"
        } else if rest.starts_with("<!--") {
            "-->"
        } else if rest.starts_with("<!") {
            // A document type may contain declarations in brackets.
            let bracket_or_end = rest.find(['[', '>']).map(|at| &rest[at..]);
            if bracket_or_end.is_some_and(|rest| rest.starts_with('[')) { "]>" } else { ">" }
        } else {
            break;
        };
        let Some((_, after)) = rest.split_once(end) else { return ("", "") };
        rest = after;
    }
    let tag = rest.strip_prefix('<').and_then(|tag| tag.split('>').next()).unwrap_or("");
    tag.split_once(|c: char| c.is_whitespace() || c == '/').unwrap_or((tag, ""))
}

fn text(start: &str) -> Option<(&'static str, &'static str)> {
    let start = start.trim_start_matches('\u{feff}').trim_start();
    let named = TEXT.iter().find(|(first, ..)| start.starts_with(first));
    if let Some((_, what, advice)) = named {
        return Some((what, advice));
    }
    if start.starts_with('<') {
        let (name, attributes) = first_element(start);
        let known = XML.iter().find(|(known, attribute, ..)| name.eq_ignore_ascii_case(known) && attributes.contains(attribute));
        return Some(known.map_or(("an XML file", READ), |(.., what, advice)| (what, advice)));
    }
    let mut statements = start.lines().map(str::trim_start).filter(|line| !line.is_empty() && !line.starts_with('#'));
    let first = statements.next()?.split(|c: char| !c.is_ascii_alphabetic()).next()?;
    PBRT.contains(&first).then_some(("a pbrt scene", READ))
}
