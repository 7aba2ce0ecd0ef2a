//! Data for the JERI viewer: a tree of views, and the pictures in it.
//!
//! ```text
//! root ─ scene ─ picture ─ Reference, methods …
//!              ─ one render ─ Reference, methods …
//!              ─ MRSE, MAPE, SMAPE, L1, L2, SSIM ─ methods …      loss of the picture against the reference
//!              ─ standard error ─ Reference, methods …            one channel
//! ```
//!
//! A method has the same title in every branch, so that JERI keeps it selected when the branch is changed.
//!
//! Source: Disney Research, JERI 2.0.

use serde_json::{Value, json};

use super::{Files, names};
use crate::compare::Comparison;
use crate::error::{Error, Result};
use crate::film::{Channel, Image};
use crate::output::exr;

/// Names of JERI's error measures. Its MRSE is d²/(r² + 10⁻⁴), which is not our relMSE.
const LOSSES: [&str; 6] = ["MRSE", "MAPE", "SMAPE", "L1", "L2", "SSIM"];

/// Returns the files of the tree.
pub fn files(comparison: &Comparison) -> Result<Files> {
    let mut files = Files::new();
    let mut put = |name: &str, image: &Image, channels: &[&str]| -> Result<()> {
        files.push((format!("jeri/{name}").into(), exr::encode(&only(image, channels), &vec![])?));
        Ok(())
    };
    let titles = std::iter::once(names::REFERENCE.to_owned()).chain(names::titles(comparison));
    let stems = std::iter::once("reference".to_owned()).chain(names::stems(comparison));
    let images = std::iter::once((&comparison.reference.image, &comparison.reference.image))
        .chain(comparison.methods.iter().map(|method| (&method.image, &method.sample)));

    let [mut pictures, mut renders, mut errors] = [vec![], vec![], vec![]];
    let mut losses = LOSSES.map(|_| vec![]);
    for (i, ((title, stem), (image, sample))) in titles.zip(stems).zip(images).enumerate() {
        let file = format!("{stem}.exr");
        put(&file, image, &["R", "G", "B"])?;
        pictures.push(json!({"title": title, "image": file}));
        if i == 0 {
            renders.push(json!({"title": title, "image": file}));
        } else {
            let file = format!("{stem}.render.exr");
            put(&file, sample, &["R", "G", "B"])?;
            renders.push(json!({"title": title, "image": file}));
            for (function, leaves) in LOSSES.iter().zip(&mut losses) {
                let loss = json!({"function": function, "imageA": format!("{stem}.exr"), "imageB": "reference.exr"});
                leaves.push(json!({"title": title, "tonemapGroup": function, "lossMap": loss}));
            }
        }
        if let Some(error) = mean_error(image) {
            let file = format!("{stem}.stderr.exr");
            put(&file, &error, &["Y"])?;
            errors.push(json!({"title": title, "tonemapGroup": "standard error", "image": file}));
        }
    }

    let mut branches = vec![node("picture", pictures), node("one render", renders)];
    branches.extend(LOSSES.iter().zip(losses).map(|(function, leaves)| node(function, leaves)));
    branches.push(node("standard error", errors));
    // JERI requires children in every node.
    branches.retain(|branch| branch["children"].as_array().is_some_and(|children| !children.is_empty()));
    let tree = node("root", vec![node(&comparison.scene, branches)]);
    let text = serde_json::to_string_pretty(&tree).map_err(|e| Error::Internal(format!("cannot write JSON: {e}")))?;
    files.push(("jeri/data.json".into(), format!("{text}\n").into_bytes()));
    files.push(("jeri/data.js".into(), format!("const data = {text};\n").into_bytes()));
    Ok(files)
}

fn node(title: &str, children: Vec<Value>) -> Value {
    json!({"title": title, "children": children})
}

/// Channels of these names, with zeros for missing ones: JERI refuses pictures without R, G and B.
fn only(image: &Image, names: &[&str]) -> Image {
    let pixels = (image.size.x * image.size.y) as usize;
    let channel = |name: &&str| {
        let values = image.channel(name).map_or_else(|| vec![0.0; pixels], <[f32]>::to_vec);
        Channel { name: (*name).to_owned(), values }
    };
    Image { channels: names.iter().map(channel).collect(), ..image.clone() }
}

/// Mean of the standard errors of the colours, as one channel, which JERI shows in false colours.
fn mean_error(image: &Image) -> Option<Image> {
    let [r, g, b] = [image.channel("StdErr.R")?, image.channel("StdErr.G")?, image.channel("StdErr.B")?];
    let values = r.iter().zip(g).zip(b).map(|((r, g), b)| (r + g + b) / 3.0).collect();
    Some(Image { channels: vec![Channel { name: "Y".into(), values }], ..image.clone() })
}
