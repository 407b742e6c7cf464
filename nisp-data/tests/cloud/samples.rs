//! The same three points as a file of every kind.

use std::io::Write;

use flate2::Compression;
use flate2::write::DeflateEncoder;
use rawzip::{CompressionMethod, ZipArchiveWriter};

/// What every file holds.
pub(crate) const POINTS: [[f64; 3]; 3] = [[0.5, -1.25, 2.0], [0.0, 4.0, -8.0], [1.0, 2.0, 3.0]];

/// The numbers, row by row.
pub(crate) fn flat() -> impl Iterator<Item = f64> {
    POINTS.into_iter().flatten()
}

/// A PLY file of the vertices `body` and a face.
pub(crate) fn ply(format: &str, body: &[u8]) -> Vec<u8> {
    let head = format!(
        "ply\nformat {format} 1.0\ncomment from a camera\nelement vertex 3\nproperty float x\nproperty uchar red\n\
         property double y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    );
    [head.as_bytes(), body].concat()
}

/// The body of an ascii PLY file.
pub(crate) fn ply_ascii() -> Vec<u8> {
    let rows: String = POINTS.iter().map(|[x, y, z]| format!("{x} 7 {y} {z}\n")).collect();
    (rows + "3 0 1 2\n").into_bytes()
}

/// The body of a binary PLY file of least byte first.
pub(crate) fn ply_binary() -> Vec<u8> {
    let mut bytes = Vec::new();
    for [x, y, z] in POINTS {
        bytes.extend((x as f32).to_le_bytes());
        bytes.push(7);
        bytes.extend(y.to_le_bytes());
        bytes.extend((z as f32).to_le_bytes());
    }
    bytes.extend([3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0]);
    bytes
}

/// The header of a PCD file.
pub(crate) fn pcd_head(data: &str) -> String {
    format!(
        "# .PCD v0.7\nVERSION 0.7\nFIELDS rgb x y z\nSIZE 4 4 8 4\nTYPE U F F F\nCOUNT 1 1 1 1\nWIDTH 3\nHEIGHT 1\n\
         VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3\nDATA {data}\n"
    )
}

/// An ascii PCD file.
pub(crate) fn pcd_ascii() -> Vec<u8> {
    let rows: String = POINTS.iter().map(|[x, y, z]| format!("255 {x} {y} {z}\n")).collect();
    (pcd_head("ascii") + &rows).into_bytes()
}

/// A binary PCD file.
pub(crate) fn pcd_binary() -> Vec<u8> {
    let mut bytes = pcd_head("binary").into_bytes();
    for [x, y, z] in POINTS {
        bytes.extend([1, 2, 3, 4]);
        bytes.extend((x as f32).to_le_bytes());
        bytes.extend(y.to_le_bytes());
        bytes.extend((z as f32).to_le_bytes());
    }
    bytes
}

/// A NumPy array of three rows and columns, whose rows or columns are whole in memory.
pub(crate) fn npy(is_by_columns: bool, values: impl IntoIterator<Item = f64>) -> Vec<u8> {
    let order = if is_by_columns { "True" } else { "False" };
    npy_of(&format!("{{'descr': '<f8', 'fortran_order': {order}, 'shape': (3, 3), }}\n"), values)
}

/// A NumPy array of the points with a header of one's own.
pub(crate) fn npy_with(descr: &str, shape: &str) -> Vec<u8> {
    npy_of(&format!("{{'descr': {descr}, 'fortran_order': False, 'shape': {shape}, }}\n"), flat())
}

fn npy_of(header: &str, values: impl IntoIterator<Item = f64>) -> Vec<u8> {
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(values.into_iter().flat_map(f64::to_le_bytes));
    bytes
}

/// An archive of files, packed or not.
pub(crate) fn npz(files: &[(&str, &[u8])], is_packed: bool) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut archive = ZipArchiveWriter::new(&mut bytes);
    for (name, content) in files {
        let method = if is_packed { CompressionMethod::DEFLATE } else { CompressionMethod::STORE };
        let (mut entry, config) = archive.new_file(name).compression_method(method).start().unwrap();
        let descriptor = if is_packed {
            let mut writer = config.wrap(DeflateEncoder::new(&mut entry, Compression::default()));
            writer.write_all(content).unwrap();
            let (encoder, descriptor) = writer.finish().unwrap();
            encoder.finish().unwrap();
            descriptor
        } else {
            let mut writer = config.wrap(&mut entry);
            writer.write_all(content).unwrap();
            writer.finish().unwrap().1
        };
        entry.finish(descriptor).unwrap();
    }
    archive.finish().unwrap();
    bytes
}

/// Every kind of file whose length is fixed by what it says of itself, with its name.
pub(crate) fn counted() -> Vec<(&'static str, Vec<u8>)> {
    let array = npy(false, flat());
    let files: [(&str, &[u8]); 2] = [("time.npy", &npy_one()), ("cloud.npy", &array)];
    vec![
        ("ascii.ply", ply("ascii", &ply_ascii())),
        ("binary.ply", ply("binary_little_endian", &ply_binary())),
        ("ascii.pcd", pcd_ascii()),
        ("binary.pcd", pcd_binary()),
        ("stored.npz", npz(&files, false)),
        ("packed.npz", npz(&files, true)),
        ("array.npy", array),
    ]
}

/// An array that is no cloud.
fn npy_one() -> Vec<u8> {
    npy_of("{'descr': '<f8', 'fortran_order': False, 'shape': (2,), }\n", [0.5, 1.5])
}
