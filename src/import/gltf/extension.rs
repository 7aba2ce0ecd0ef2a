//! Extensions: which are read, and what is said of the others.

use crate::import::json_cursor::JsonCursor;

/// Extensions that are read. Parts that are left out are noted where they stand.
pub const READ: &[&str] = &[
    "EXT_mesh_gpu_instancing",
    "EXT_texture_webp",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_texture_basisu",
    "KHR_texture_transform",
];

/// Advice for data that is compressed in a way that pt does not read.
const UNPACK: &str = ": save the file without compression";

/// Returns whether an extension holds this data in compressed form, and notes that as a fault.
pub fn is_compressed(at: &JsonCursor) -> bool {
    let extensions = at.get(&["extensions"]).and_then(|all| all.members()).unwrap_or_default();
    let Some((name, location)) = extensions.into_iter().find(|(name, _)| name.ends_with("_compression")) else { return false };
    location.fault(format!("compressed by {}, which pt does not read{UNPACK}", shown(name)));
    true
}

/// Reason why a required extension cannot be left out. Draco and meshopt hold triangles that are nowhere else.
pub fn needed(name: &str) -> String {
    let advice = if name.ends_with("_compression") { UNPACK } else { "" };
    format!("the file needs the extension {name}, which pt does not read{advice}")
}

/// Name from the file, shortened for messages.
pub fn shown(name: &str) -> String {
    name.chars().filter(|c| !c.is_control()).take(60).collect()
}
