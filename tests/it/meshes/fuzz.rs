//! Corrupt files: any input gives a valid mesh or an error, never a panic or an internal error.

use proptest::prelude::*;

use super::*;

const OBJ: &str = "# a cube's corner\r\nmtllib a.mtl\nv 0 0 0\nv 1.5e0 0 0 1 0 0\nv 1 1 -.25\nv 0 1 0 1.0\nvt 0 0\nvt 1\nvn 0 0 1\nvn nan 0 0\n\
g left\nusemtl glass\nf 1/1/1 2/2/1 3/1/2\nf 1 2 \\\n 3 -1\no \u{e4}\ns off\nf 2//1 3//1 4//2\nl 1 2 3\n";

const ASCII: &str = "ply\nformat ascii 1.0\ncomment fuzz\nelement vertex 4\nproperty double x\nproperty float y\nproperty int z\nproperty float nx\n\
property float ny\nproperty float nz\nproperty uchar red\nproperty float s\nproperty float t\nelement face 2\nproperty list uchar int vertex_indices\n\
property list uchar float texcoord\nelement edge 1\nproperty int vertex1\nend_header\n0 0 0 0 0 1 255 0 0\n1 0 0 0 0 1 255 1 0\n1 1 0 0 0 0 9 1 1\n\
0 1 2 0 0 1 9 0 1\n4 0 1 2 3 0\n3 1 2 3 2 .5 1\n7\n";

fn binary() -> Vec<u8> {
    let mut file = Vec::new();
    mesh_of(OBJ).write_ply_binary(&mut file).expect("memory takes it");
    file
}

/// The file of [`binary`] in big-endian byte order.
fn big_endian() -> Vec<u8> {
    let file = binary();
    let end = file.windows(11).position(|w| w == b"end_header\n").expect("a header") + 11;
    let mesh = mesh_of(&file);
    let floats = 3 + if mesh.normals.is_empty() { 0 } else { 3 } + if mesh.uvs.is_empty() { 0 } else { 2 };
    let (header, body) = file.split_at(end);
    let (vertices, faces) = body.split_at(mesh.positions.len() * floats * 4);
    let mut out = String::from_utf8_lossy(header).replace("little", "big").into_bytes();
    vertices.chunks(4).for_each(|number| out.extend(number.iter().rev()));
    for face in faces.chunks(13) {
        out.push(face[0]);
        face[1..].chunks(4).for_each(|index| out.extend(index.iter().rev()));
    }
    out
}

fn seeds() -> [Vec<u8>; 4] {
    [OBJ.into(), ASCII.into(), binary(), big_endian()]
}

fn survives(bytes: &[u8]) {
    match read(bytes) {
        Ok((mesh, _)) => assert_sound(&mesh),
        Err(pt::Error::Invalid(faults)) => assert!(!faults.is_empty() && faults.len() <= pt::MAX_FAULTS),
        Err(pt::Error::Limit(_)) => {}
        Err(error) => panic!("neither mesh nor fault: {error}\n{}", String::from_utf8_lossy(bytes)),
    }
}

#[test]
fn the_seeds_are_right_and_agree() {
    let [obj, ascii, little, big] = seeds().map(mesh_of);
    assert_eq!((obj.triangles.len(), ascii.triangles.len()), (3, 3));
    assert_eq!((&little.positions, &little.triangles), (&obj.positions, &obj.triangles));
    assert_eq!(little, big);
}

#[test]
fn files_cut_at_every_byte() {
    for file in seeds() {
        (0..file.len()).for_each(|end| survives(&file[..end]));
    }
}

/// One change to a file.
#[derive(Debug, Clone)]
enum Edit {
    Set(usize, u8),
    Flip(usize, u8),
    Insert(usize, &'static str),
    Remove(usize, usize),
    Repeat(usize, usize),
}

const TOKENS: [&str; 24] = [
    "-",
    "/",
    "//",
    "\\\n",
    "\n",
    "\r",
    " ",
    "#",
    "1e39",
    "nan",
    "-1.#IND00",
    "0",
    "-9223372036854775808",
    "4294967296",
    "f ",
    "v ",
    "vn 0 0 0\n",
    "f 1 2 3\n",
    "l 1 2 3\n",
    "usemtl \u{1f9}\n",
    "element x 9\n",
    "property list int int vertex_index\n",
    "\0",
    "list char ",
];

fn edits() -> impl Strategy<Value = Vec<Edit>> {
    let at = || 0..4096_usize;
    let edit = prop_oneof![
        (at(), any::<u8>()).prop_map(|(i, b)| Edit::Set(i, b)),
        (at(), 0..8_u8).prop_map(|(i, bit)| Edit::Flip(i, 1 << bit)),
        (at(), proptest::sample::select(&TOKENS[..])).prop_map(|(i, token)| Edit::Insert(i, token)),
        (at(), 1..40_usize).prop_map(|(i, n)| Edit::Remove(i, n)),
        (at(), 1..40_usize).prop_map(|(i, n)| Edit::Repeat(i, n)),
    ];
    proptest::collection::vec(edit, 1..6)
}

fn apply(edit: &Edit, file: &mut Vec<u8>) {
    let len = file.len().max(1);
    match *edit {
        _ if file.is_empty() => file.push(b'p'),
        Edit::Set(i, byte) => file[i % len] = byte,
        Edit::Flip(i, bit) => file[i % len] ^= bit,
        Edit::Insert(i, token) => drop(file.splice(i % len..i % len, token.bytes())),
        Edit::Remove(i, n) => drop(file.drain(i % len..(i % len + n).min(len))),
        Edit::Repeat(i, n) => {
            let piece = file[i % len..(i % len + n).min(len)].to_vec();
            drop(file.splice(i % len..i % len, piece));
        }
    }
}

proptest! {
    #![proptest_config(cases(20_000))]

    #[test]
    fn changed_obj_files(edits in edits()) {
        let mut file = OBJ.as_bytes().to_vec();
        edits.iter().for_each(|edit| apply(edit, &mut file));
        survives(&file);
    }

    #[test]
    fn changed_ply_files(edits in edits(), which in 1..4_usize) {
        let mut file = seeds()[which].clone();
        edits.iter().for_each(|edit| apply(edit, &mut file));
        survives(&file);
    }

    #[test]
    fn random_bytes(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        survives(&bytes);
        survives(&[b"ply\n", &bytes[..]].concat());
    }
}
