//! Files that are cut, changed, or say of themselves what is not so: refused, in one line, without a panic and without
//! asking for the memory that they declare.

use std::path::Path;

use nisp_data::Cloud;

use crate::samples::{POINTS, counted, npy_with, npz, pcd_ascii, pcd_binary, ply, ply_ascii, ply_binary};

#[track_caller]
fn refusal(name: &str, bytes: &[u8]) -> String {
    let message = match Cloud::parse(Path::new(name), bytes) {
        Ok(cloud) => panic!("{name} was read: {cloud:?}"),
        Err(error) => error.to_string(),
    };
    assert!(!message.contains('\n') && message.starts_with(name), "{message}");
    message
}

/// The file with the first `old` replaced.
fn with(bytes: &[u8], old: &str, new: &str) -> Vec<u8> {
    let at = bytes.windows(old.len()).position(|window| window == old.as_bytes()).unwrap();
    [&bytes[..at], new.as_bytes(), &bytes[at + old.len()..]].concat()
}

#[test]
fn whole_files_are_read() {
    for (name, bytes) in counted() {
        assert_eq!(Cloud::parse(Path::new(name), &bytes).unwrap().points, POINTS, "{name}");
    }
}

#[test]
fn a_file_that_ends_early_gives_no_other_points() {
    for (name, bytes) in counted() {
        for length in 0..bytes.len() {
            // Without its last line break a text is whole.
            if let Ok(cloud) = Cloud::parse(Path::new(name), &bytes[..length]) {
                assert_eq!(cloud.points, POINTS, "{name} cut to {length} of {}", bytes.len());
            }
        }
    }
}

#[test]
fn one_more_of_anything_is_refused() {
    for (name, bytes) in counted() {
        let more: &[u8] = if name.starts_with("ascii") { b"1 1 1 1\n" } else { &[1; 20] };
        // An archive's table of contents stands at its end.
        if !name.ends_with("npz") {
            refusal(name, &[&bytes, more].concat());
        }
    }
}

#[test]
fn a_changed_byte_never_panics_and_is_noticed_where_there_is_a_checksum() {
    for (name, bytes) in counted() {
        for at in 0..bytes.len() {
            for change in [1, 0x20, 0x80, 0xff] {
                let mut changed = bytes.clone();
                changed[at] ^= change;
                let read = Cloud::parse(Path::new(name), &changed);
                if let (Ok(cloud), true) = (read, name.ends_with("npz")) {
                    assert_eq!(cloud.points, POINTS, "{name}: byte {at} changed by {change:#x}");
                }
            }
        }
    }
}

#[test]
fn numpy_shapes_that_do_not_fit() {
    let refused = |shape: &str| refusal("a.npy", &npy_with("'<f8'", shape));
    assert_eq!(Cloud::parse(Path::new("a.npy"), &npy_with("'<f8'", "(3, 3)")).unwrap().points, POINTS);
    // Times three it is 2 in 64 bits.
    let message = refused("(6148914691236517206, 3)");
    assert!(message.contains("(6148914691236517206, 3), more than the file holds"), "{message}");
    refused("(18446744073709551615, 18446744073709551615)");
    refused("(0, 18446744073709551615, 18446744073709551615)");
    refused("(99999999999999999999999, 3)");
    assert!(refused("(2, 3)").contains("declares 48 bytes of numbers and holds 72"));
    refused("(4, 3)");
    refused("(9,)");
    refused("(0, 3)");
    refused("(-3, 3)");
    refused("()");
    // A name that hides what it says from a glance at the header.
    refusal("a.npy", &with(&npy_with("'<f8'", "(6148914691236517206, 3)"), "'shape'", "'\\x73hape'"));
    assert!(refusal("a.npy", &npy_with("'|O'", "(3, 3)")).contains("not of numbers"));
    refusal("a.npy", &npy_with("'<f18446744073709551615'", "(3, 3)"));
    refusal("a.npy", &npy_with(&"(".repeat(9000), "(3, 3)"));
    assert!(refusal("a.npy", &npy_with("'<i8'", "(3, 3)")).contains("float32 or float64"));
    // Four gigabytes of header.
    refusal("a.npy", b"\x93NUMPY\x02\x00\xff\xff\xff\xff{'descr'");
}

#[test]
fn archives_that_do_not_fit() {
    let cloud = npy_with("'<f8'", "(3, 3)");
    let stored = |files: &[(&str, &[u8])]| npz(files, zip::CompressionMethod::Stored);
    assert!(refusal("a.npz", &stored(&[("a.npy", &cloud), ("b.npy", &cloud)])).contains("2 of its arrays (a, b)"));
    assert!(refusal("a.npz", &stored(&[("note.txt", b"hello")])).contains("0 of its arrays"));
    // A few hundred kilobytes that unpack to more than any cloud has.
    let zeros = vec![0; 257 << 20];
    let bomb = npz(&[("a.npy", &zeros)], zip::CompressionMethod::Deflated);
    assert!(bomb.len() < 1 << 20 && refusal("a.npz", &bomb).contains("unpacks to more than 256 MiB"));
}

#[test]
fn ply_headers_that_do_not_fit() {
    let whole = ply("ascii", &ply_ascii());
    for count in ["18446744073709551615", "99999999999999999999999", "-3", "x"] {
        refusal("a.ply", &with(&whole, "vertex 3", &format!("vertex {count}")));
    }
    assert!(refusal("a.ply", &with(&whole, "vertex 3", "vertex 4000000000")).contains("more than the file holds"));
    // Elements without properties take no bytes.
    let empty = with(&whole, "element vertex 3\n", "element nothing 18446744073709551615\nelement vertex 3\n");
    assert!(refusal("a.ply", &empty).contains("`nothing`"));
    // One vertex fewer would take the last for the face.
    refusal("a.ply", &with(&whole, "vertex 3", "vertex 2"));
    refusal("a.ply", &with(&whole, "vertex 3", "vertex 4"));
    assert!(refusal("a.ply", &with(&whole, "uchar red", "float x")).contains("line 6: the second `property`"));
    assert!(refusal("a.ply", &with(&whole, "element face 1", "element vertex 1")).contains("the second `element`"));
    let mut list = ply_binary();
    let at = list.len() - 13;
    list[at] = 255;
    refusal("a.ply", &ply("binary_little_endian", &list));
    let long = with(&ply("binary_little_endian", &ply_binary()), "list uchar", "list uint");
    refusal("a.ply", &long);
}

#[test]
fn pcd_headers_that_do_not_fit() {
    for whole in [pcd_ascii(), pcd_binary()] {
        let refused = |old: &str, new: &str| refusal("a.pcd", &with(&whole, old, new));
        assert!(refused("WIDTH 3", "WIDTH 2").contains("POINTS are 3, and WIDTH times HEIGHT is 2"));
        assert!(refused("WIDTH 3\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3", "POINTS 2").contains("declares 2"));
        refused("WIDTH 3\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3", "POINTS 4");
        refused("WIDTH 3\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3", "VIEWPOINT 0");
        refused("WIDTH 3", "WIDTH 18446744073709551615");
        refused("POINTS 3", "POINTS many");
        refused("POINTS 3", "POINTS 18446744073709551615");
        refused("SIZE 4 4 8 4", "SIZE 4 4 8");
        refused("SIZE 4 4 8 4", "SIZE 4 4 -8 4");
        refused("SIZE 4 4 8 4", "SIZE 4 4 99999999999 4");
        refused("TYPE U F F F\n", "");
        refused("COUNT 1 1 1 1", "COUNT 1 1 1 0");
        refused("VERSION 0.7", "POINTS 3");
        assert!(refused("FIELDS rgb x y z", "FIELDS x x y z").contains("two fields `x`"));
        assert!(refused("FIELDS rgb x y z", "FIELDS rgb x y u").contains("no field `z`"));
    }
    assert!(refusal("a.pcd", &with(&pcd_ascii(), "255 0.5", "255 9 0.5")).contains("5 values"));
    assert!(refusal("a.pcd", &with(&pcd_ascii(), "255 0.5", "0.5")).contains("3 values"));
    refusal("a.pcd", &with(&pcd_ascii(), "0.5", "\u{fffd}"));
}

#[test]
fn texts_that_do_not_fit() {
    let refused = |text: &str| refusal("a.xyz", text.as_bytes());
    assert!(refused("1 2 3\n1 2 3 4\n").contains("line 2: 4 cells where the rows above have 3"));
    // Cells are not moved to close a gap, nor commas of decimals taken for separators.
    assert!(refused("1,2,3,4\n1,,3,4\n").contains("line 2: `` for y"));
    refused("0,5 1,5 2,5\n");
    refused("0,5;1,5;2,5\n");
    assert!(refused("x,y,z,x\n1,2,3,4\n1,2,3,4\n").contains("columns 1 and 4 are both named `x`"));
    assert!(refusal("a.csv", b"x,y,z\n1,2,3\n1,2,\xff\n").contains("not UTF-8 text (byte 16)"));
    refusal("a.csv", b"\xff\xfex\0,\0y\0,\0z\0\n\0");
}
