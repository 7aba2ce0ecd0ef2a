//! Words of other programs, with pt's words for the same things.

/// Words that other programs use, each with pt's words of which one may stand in its place.
pub const SYNONYMS: &[(&str, &[&str])] = &[
    ("origin", &["from", "look_at", "center"]),
    ("eye", &["from", "look_at"]),
    ("position", &["from", "look_at", "center"]),
    ("target", &["to", "look_at"]),
    ("lookat", &["look_at"]),
    ("vfov", &["fov"]),
    ("focal_distance", &["focus_distance"]),
    ("fstop", &["f_number"]),
    ("f_stop", &["f_number"]),
    ("aperture_blades", &["aperture"]),
    ("image", &["film"]),
    ("resolution", &["width"]),
    ("samples", &["spp"]),
    ("objects", &["shapes"]),
    ("surfaces", &["shapes"]),
    ("primitives", &["shapes"]),
    ("cube", &["box"]),
    ("cuboid", &["box"]),
    ("plane", &["quad"]),
    ("rectangle", &["quad"]),
    ("rect", &["quad"]),
    ("triangle", &["mesh"]),
    ("annulus", &["disk"]),
    ("ring", &["disk"]),
    ("hemisphere", &["sphere"]),
    ("tube", &["cylinder", "curves"]),
    ("curve", &["curves"]),
    ("hair", &["curves"]),
    ("fur", &["curves"]),
    ("bsplinecurve", &["curves"]),
    ("linearcurve", &["curves"]),
    ("bilinearmesh", &["bilinear_patch"]),
    ("bsdf", &["material"]),
    ("lambertian", &["diffuse"]),
    ("lambert", &["diffuse"]),
    ("matte", &["diffuse"]),
    ("glass", &["dielectric"]),
    ("color", &["albedo", "radiance", "intensity", "irradiance"]),
    ("colour", &["albedo", "color"]),
    ("reflectance", &["albedo", "color"]),
    ("ior", &["eta"]),
    ("refractive_index", &["eta"]),
    ("emit", &["emission"]),
    ("power", &["intensity"]),
    ("sun", &["directional"]),
    ("max_bounces", &["max_depth"]),
];

/// Name that pt uses for the meaning of `word`, if it is one of the names in `known`.
pub fn own_word<'k>(word: &str, known: &[&'k str]) -> Option<&'k str> {
    let (_, own) = SYNONYMS.iter().find(|(other, _)| other.eq_ignore_ascii_case(word))?;
    own.iter().find_map(|own| known.iter().copied().find(|known| known == own))
}
