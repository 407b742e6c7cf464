//! Depth images, against points that are projected by hand.

use std::path::Path;

use nisp_data::cloud::{Camera, View};
use png::{BitDepth, ColorType, Encoder};

const WIDTH: usize = 40;
const HEIGHT: usize = 30;

/// A camera at 0.3 m above the origin that looks down: its rows run along -y, its depth along -z.
fn above() -> Camera {
    Camera {
        focal: [50.0, 60.0],
        center: [19.5, 14.5],
        scale: None,
        rotation: [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]],
        position: [0.01, 0.02, 0.3],
    }
}

/// Depth in millimetres of the plane z = 0.1 + 0.2 x of the body's frame; nothing in the first row. On the ray through a pixel
/// x = 0.01 + a d and z = 0.3 - d, so that d = (0.2 - 0.002) / (1 + 0.2 a).
fn depth(column: usize, row: usize) -> f64 {
    let a = (column as f64 - 19.5) / 50.0;
    if row == 0 { 0.0 } else { 1e3 * 0.198 / (1.0 + 0.2 * a) }
}

fn depths() -> impl Iterator<Item = f64> {
    (0..HEIGHT * WIDTH).map(|index| depth(index % WIDTH, index / WIDTH))
}

fn greys(color: ColorType, bits: BitDepth, bytes: &[u8]) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = Encoder::new(&mut file, WIDTH as u32, HEIGHT as u32);
    encoder.set_color(color);
    encoder.set_depth(bits);
    encoder.write_header().unwrap().write_image_data(bytes).unwrap();
    file
}

fn npy(kind: &str, order: &str, bytes: &[u8]) -> Vec<u8> {
    array((kind, order), &format!("{HEIGHT}, {WIDTH}"), bytes)
}

fn array((kind, order): (&str, &str), shape: &str, bytes: &[u8]) -> Vec<u8> {
    let mut header = format!("{{'descr': '{kind}', 'fortran_order': {order}, 'shape': ({shape}), }}");
    header.push_str(&" ".repeat(63 - (10 + header.len()) % 64));
    header.push('\n');
    [b"\x93NUMPY\x01\x00", &(header.len() as u16).to_le_bytes()[..], header.as_bytes(), bytes].concat()
}

/// All pixels but those of the first row lie on the plane, and where their rays go.
fn assert_plane(points: &[[f64; 3]], tolerance: f64) {
    assert_eq!(points.len(), (HEIGHT - 1) * WIDTH);
    for (index, [x, y, z]) in points.iter().enumerate() {
        assert!((z - (0.1 + 0.2 * x)).abs() < tolerance, "{x} {y} {z}");
        let (column, row, depth) = (index % WIDTH, 1 + index / WIDTH, 0.3 - z);
        assert!((x - (0.01 + (column as f64 - 19.5) / 50.0 * depth)).abs() < 1e-12);
        assert!((y - (0.02 - (row as f64 - 14.5) / 60.0 * depth)).abs() < 1e-12);
    }
}

#[test]
fn depth_images_are_points_of_the_body() {
    let view = View { camera: Some(above()), ..View::default() };
    let whole: Vec<u16> = depths().map(|depth| depth.round() as u16).collect();
    let big: Vec<u8> = whole.iter().flat_map(|grey| grey.to_be_bytes()).collect();
    let little: Vec<u8> = whole.iter().flat_map(|grey| grey.to_le_bytes()).collect();
    let metres: Vec<u8> = depths().flat_map(|depth| (1e-3 * depth).to_le_bytes()).collect();
    let by_columns: Vec<u8> =
        (0..HEIGHT * WIDTH).flat_map(|index| (1e-3 * depth(index / HEIGHT, index % HEIGHT)).to_le_bytes()).collect();
    let half = 0.6e-3;
    for (name, file, tolerance) in [
        ("a.png", greys(ColorType::Grayscale, BitDepth::Sixteen, &big), half),
        ("a.npy", npy("<u2", "False", &little), half),
        ("a.npy", npy("<f8", "False", &metres), 1e-12),
        ("a.npy", npy("<f8", "True", &by_columns), 1e-12),
    ] {
        let cloud = view.parse(Path::new(name), &file).unwrap();
        assert_plane(&cloud.points, tolerance);
        assert!(cloud.is_in_metres && cloud.warnings.is_empty(), "{:?}", cloud.warnings);
        let message = View::default().parse(Path::new(name), &file).unwrap_err().to_string();
        assert!(message.contains("say with --camera FILE"), "{message}");
    }

    let fine = View { camera: Some(Camera { scale: Some(1e-4), ..above() }), ..View::default() };
    let cloud = fine.parse(Path::new("a.png"), &greys(ColorType::Grayscale, BitDepth::Sixteen, &big)).unwrap();
    assert!((cloud.points[0][2] - (0.3 - 1e-4 * depth(0, 1).round())).abs() < 1e-12);

    let picture = greys(ColorType::Rgb, BitDepth::Eight, &vec![7; 3 * WIDTH * HEIGHT]);
    let message = view.parse(Path::new("a.png"), &picture).unwrap_err().to_string();
    assert!(message.contains("greys of 16 bit"), "{message}");
    assert!(view.parse(Path::new("a.png"), &picture[..60]).is_err());
}

#[test]
fn organised_clouds_are_clouds() {
    let bytes: Vec<u8> = (0..18).flat_map(|x| f64::from(x).to_le_bytes()).collect();
    let read = |order| View::default().parse(Path::new("a.npy"), &array(("<f8", order), "3, 2, 3", &bytes));
    let cloud = read("False").unwrap();
    assert_eq!((cloud.points.len(), cloud.points[4]), (6, [12.0, 13.0, 14.0]));
    assert!(read("True").unwrap_err().to_string().contains("(n, 3) is needed"));
}

#[test]
fn clouds_of_a_camera_are_moved_into_the_body() {
    let view = View { camera: Some(above()), ..View::default() };
    let cloud = view.parse(Path::new("a.csv"), b"x_mm,y_mm,z_mm\n1,2,250\n0,0,300\n").unwrap();
    for (found, wanted) in cloud.points[0].iter().zip([0.011, 0.018, 0.05]) {
        assert!((found - wanted).abs() < 1e-15);
    }
}

#[test]
fn cameras_that_are_none_are_refused() {
    let fault = |camera: Camera| camera.check().unwrap_err().to_string();
    above().check().unwrap();
    assert!(fault(Camera { focal: [50.0, 0.0], ..above() }).contains("`fy` is 0"));
    let mirrored = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]];
    assert!(fault(Camera { rotation: mirrored, ..above() }).contains("right-handed"));
    assert!(fault(Camera { rotation: [[f64::NAN; 3]; 3], ..above() }).contains("rotation"));
}
