//! The same three points as a file of every kind.

use std::io::{Cursor, Write};

use npyz::WriterBuilder;

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

/// A NumPy array.
pub(crate) fn npy(order: npyz::Order, values: impl IntoIterator<Item = f64>) -> Vec<u8> {
    let mut bytes = Vec::new();
    let options = npyz::WriteOptions::<f64>::new().default_dtype().shape(&[3, 3]).order(order);
    let mut writer = options.writer(&mut bytes).begin_nd().unwrap();
    writer.extend(values).unwrap();
    writer.finish().unwrap();
    bytes
}

/// A NumPy array of the points with a header of one's own.
pub(crate) fn npy_with(descr: &str, shape: &str) -> Vec<u8> {
    let header = format!("{{'descr': {descr}, 'fortran_order': False, 'shape': {shape}, }}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(flat().flat_map(f64::to_le_bytes));
    bytes
}

/// An archive of files, packed or not.
pub(crate) fn npz(files: &[(&str, &[u8])], method: zip::CompressionMethod) -> Vec<u8> {
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in files {
        let options = zip::write::SimpleFileOptions::default().compression_method(method);
        archive.start_file(*name, options).unwrap();
        archive.write_all(bytes).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

/// Every kind of file whose length is fixed by what it says of itself, with its name.
pub(crate) fn counted() -> Vec<(&'static str, Vec<u8>)> {
    let array = npy(npyz::Order::C, flat());
    let files: [(&str, &[u8]); 2] = [("time.npy", &npy_one()), ("cloud.npy", &array)];
    vec![
        ("ascii.ply", ply("ascii", &ply_ascii())),
        ("binary.ply", ply("binary_little_endian", &ply_binary())),
        ("ascii.pcd", pcd_ascii()),
        ("binary.pcd", pcd_binary()),
        ("stored.npz", npz(&files, zip::CompressionMethod::Stored)),
        ("packed.npz", npz(&files, zip::CompressionMethod::Deflated)),
        ("array.npy", array),
    ]
}

/// An array that is no cloud.
fn npy_one() -> Vec<u8> {
    let mut bytes = Vec::new();
    let options = npyz::WriteOptions::<f64>::new().default_dtype().shape(&[2]);
    let mut writer = options.writer(&mut bytes).begin_nd().unwrap();
    writer.extend([0.5, 1.5]).unwrap();
    writer.finish().unwrap();
    bytes
}
