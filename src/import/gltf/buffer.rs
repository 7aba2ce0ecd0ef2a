//! Buffers: in the container, in files beside the scene, or in the JSON (`data:`).

use base64::Engine;
use base64::engine::general_purpose::{STANDARD, STANDARD_NO_PAD};

use super::extension::is_compressed;
use crate::error::{Error, Result};
use crate::import::json_cursor::JsonCursor;

/// Bytes of each buffer.
pub struct Buffers(Vec<Vec<u8>>);

impl Buffers {
    /// Reads all buffers; `None` if one is missing or too short, which is noted.
    ///
    /// # Errors
    /// `Io`: a file that cannot be read.
    pub fn read(gltf: &gltf::Document, binary: Option<&[u8]>, root: &JsonCursor) -> Result<Option<Buffers>> {
        let mut all = vec![];
        for buffer in gltf.buffers() {
            let Some(at) = root.get(&["buffers"]).and_then(|list| list.get(&[&buffer.index().to_string()])) else { continue };
            let bytes = match at.get(&["uri"]) {
                Some(uri) => of_uri(&uri)?,
                None => own_bytes(&at, binary.filter(|_| buffer.index() == 0), buffer.index()),
            };
            if let Some(bytes) = bytes.as_ref().filter(|bytes| bytes.len() < buffer.length()) {
                at.fault(format!("{} bytes are promised, found {}", buffer.length(), bytes.len()));
            }
            all.extend(bytes.filter(|bytes| bytes.len() >= buffer.length()));
        }
        Ok((all.len() == gltf.buffers().len()).then_some(Buffers(all)))
    }

    /// Bytes of a view; `None` if it extends beyond its buffer.
    pub fn view(&self, view: &gltf::buffer::View) -> Option<&[u8]> {
        let end = view.offset().checked_add(view.length())?;
        self.0.get(view.buffer().index())?.get(view.offset()..end)
    }
}

/// Bytes of a buffer without a uri, which are those of the container; `None` with a fault noted.
fn own_bytes(at: &JsonCursor, binary: Option<&[u8]>, index: usize) -> Option<Vec<u8>> {
    if binary.is_none() && !is_compressed(at) {
        let why = if index == 0 {
            "expected a uri, or a .glb with a binary chunk"
        } else {
            "expected a uri: only the first buffer can lie in a .glb"
        };
        at.fault(why);
    }
    binary.map(<[u8]>::to_vec)
}

/// Bytes that a uri contains or names; `None` with a fault noted.
fn of_uri(uri: &JsonCursor) -> Result<Option<Vec<u8>>> {
    let Some(text) = uri.text() else { return Ok(None) };
    if text.starts_with("data:") {
        return Ok(of_data(uri, text));
    }
    let Some(name) = file_name(uri, text) else { return Ok(None) };
    match uri.context().files.bytes(&name) {
        Ok(bytes) => Ok(Some(bytes)),
        Err(Error::Invalid(faults)) => {
            faults.iter().for_each(|fault| {
                uri.fault(if fault.message.starts_with(&name) { fault.message.clone() } else { format!("{name}: {}", fault.message) })
            });
            Ok(None)
        }
        Err(other) => Err(other),
    }
}

/// Bytes of `data:…;base64,…`; `None` with a fault noted.
pub fn of_data(uri: &JsonCursor, text: &str) -> Option<Vec<u8>> {
    let Some(coded) = text.split_once(";base64,").map(|(_, coded)| coded.as_bytes()) else {
        uri.fault("expected a data uri in base64");
        return None;
    };
    STANDARD.decode(coded).or_else(|_| STANDARD_NO_PAD.decode(coded)).map_err(|error| uri.fault(format!("no base64: {error}"))).ok()
}

/// File name of a relative uri, with `%` codes decoded; `None` with a fault noted.
pub fn file_name(uri: &JsonCursor, text: &str) -> Option<String> {
    let name = percent_decoded(text);
    if text.contains("://") {
        uri.fault("expected the name of a file beside the scene, found an address");
        return None;
    }
    if let Some(why) = uri.context().files.why_not(&name) {
        uri.fault(why);
        return None;
    }
    Some(name)
}

/// Decodes `%` codes (RFC 3986, §2.1). Anything that is not a code stays.
fn percent_decoded(text: &str) -> String {
    let mut bytes = vec![];
    let mut rest = text.as_bytes();
    while let [first, after @ ..] = rest {
        let code = after.get(..2).and_then(|two| str::from_utf8(two).ok()).filter(|two| two.bytes().all(|b| b.is_ascii_hexdigit()));
        match code.and_then(|two| u8::from_str_radix(two, 16).ok()).filter(|_| *first == b'%') {
            Some(byte) => {
                bytes.push(byte);
                rest = &after[2..];
            }
            None => {
                bytes.push(*first);
                rest = after;
            }
        }
    }
    String::from_utf8(bytes).unwrap_or_else(|_| text.to_owned())
}
