//! What is written can be read back, and says what it must.

use nisp_data::Cloud;
use nisp_data::colour::ColourScale;
use nisp_data::export::{Mesh, triangulate};

fn square() -> Mesh {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let points = corners.iter().map(|&[x, y]| [x, y, 0.1]).collect();
    let mut mesh = Mesh::new(points, triangulate(&corners, None).unwrap()).unwrap();
    mesh.push("f", "Pa", vec![0.0, 1.0 / 3.0, 2.0, 3.0]).unwrap();
    mesh.push("u", "m", vec![0.5; 12]).unwrap();
    mesh
}

#[test]
fn ply_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ply");
    square().write_ply(&path, Some(("f", ColourScale::sequential(&[0.0, 3.0])))).unwrap();
    let back = Cloud::read(&path).unwrap();
    assert_eq!(back.points[2], [1.0, 1.0, 0.1]);
    let bytes = square().ply_bytes(Some(("f", ColourScale::sequential(&[0.0, 3.0])))).unwrap();
    assert!(bytes == std::fs::read(&path).unwrap());
    let missing = square().write_ply(&path, Some(("g", ColourScale::sequential(&[])))).unwrap_err();
    assert_eq!(missing.to_string(), "no array `g` to colour by (arrays: f)");
}

#[test]
fn vtu_names_arrays_with_units() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vtu");
    square().write_vtu(&path).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(square().vtu_bytes() == text.as_bytes());
    for part in [
        "NumberOfPoints=\"4\" NumberOfCells=\"2\"",
        "Name=\"f [Pa]\" NumberOfComponents=\"1\" format=\"ascii\">\n0 0.3333333333333333 2 3\n",
        "Name=\"u [m]\" NumberOfComponents=\"3\"",
        "Name=\"types\" NumberOfComponents=\"1\" format=\"ascii\">\n5 5\n",
    ] {
        assert!(text.contains(part), "{part}\nnot in\n{text}");
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    assert!(Mesh::new(vec![[0.0; 3]], vec![[0, 1, 0]]).is_err());
    assert!(square().push("g", "", vec![1.0; 3]).is_err());
}
