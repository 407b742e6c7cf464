//! Clouds: every format gives the same points, and no bytes make a reader panic.

mod damaged;
mod depth;
mod samples;
mod thin;

use std::path::Path;

use nisp_data::Cloud;
use nisp_data::cloud::{LengthUnit, Surface, View};
use proptest::prelude::*;
use samples::{POINTS, flat, npy, npz, pcd_ascii, pcd_binary, pcd_head, ply, ply_ascii, ply_binary};

fn read(name: &str, bytes: &[u8]) -> Cloud {
    Cloud::parse(Path::new(name), bytes).unwrap()
}

fn refusal(name: &str, bytes: &[u8]) -> String {
    let message = Cloud::parse(Path::new(name), bytes).unwrap_err().to_string();
    assert!(!message.contains('\n'), "{message}");
    message
}

#[test]
fn ply_of_all_kinds() {
    let mut big = Vec::new();
    for [x, y, z] in POINTS {
        big.extend((x as f32).to_be_bytes());
        big.push(7);
        big.extend(y.to_be_bytes());
        big.extend((z as f32).to_be_bytes());
    }
    big.extend([3, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 2]);
    let (ascii, little) = (ply_ascii(), ply_binary());
    for (format, body) in [("ascii", ascii), ("binary_little_endian", little), ("binary_big_endian", big)] {
        assert_eq!(read("a.ply", &ply(format, &body)).points, POINTS, "{format}");
    }
    assert!(refusal("a.ply", &ply("binary_little_endian", &[1, 2, 3])).contains("not a readable PLY"));
    assert!(
        refusal(
            "a.ply",
            b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n1 2\n"
        )
        .contains("no property `z`")
    );
}

#[test]
fn pcd_ascii_and_binary() {
    let binary = pcd_binary();
    assert_eq!(read("a.pcd", &pcd_ascii()).points, POINTS);
    assert_eq!(read("a.pcd", &binary).points, POINTS);
    assert!(refusal("a.pcd", &binary[..binary.len() - 4]).contains("holds 2 points and declares 3"));
    assert!(refusal("a.pcd", pcd_head("binary_compressed").as_bytes()).contains("save it as binary or ascii"));
}

#[test]
fn text_with_and_without_header() {
    assert_eq!(read("a.xyz", b"# frame 1\n0.5 -1.25 2 99\n0\t4\t-8 1\n\n 1  2 3 1\n").points, POINTS);
    assert_eq!(read("a.csv", b"z_m,x_m,y_m\n2,0.5,-1.25\n-8,0,4\n3,1,2\n").points, POINTS);
    let holes = read("a.csv", b"x,y,z\n1,2,nan\n1,2,3\ninf,0,0\n");
    assert_eq!(holes.points, [[1.0, 2.0, 3.0]]);
    assert_eq!(holes.warnings, ["a.csv: 2 of 3 points were not finite and left out"]);
    let copied = read("a.csv", b"x,y,z\n1,2,3\n0,4,5\n1,2,3\n-0,4,5\n");
    assert_eq!(copied.points, [[1.0, 2.0, 3.0], [0.0, 4.0, 5.0]]);
    assert_eq!(copied.warnings, ["a.csv: 2 of 4 points are copies of others and left out"]);
    assert!(refusal("a.csv", b"x,y,w\n1,2,3\n4,5,6\n").contains("no column for `z`"));
    assert!(refusal("a.xyz", b"1 2 3\n1 2\n").contains("line 2: 2 cells where the rows above have 3"));
    assert!(refusal("a.xyz", b"nan nan nan\n").contains("none of the 1 points is finite"));
    assert!(refusal("a.xyz", b"# nothing\n").contains("no points"));
    assert!(refusal("a.xyz", b"").contains("empty"));
    assert!(refusal("a.docx", b"hello").contains("unknown kind of file `.docx`"));
}

#[test]
fn numpy_arrays_in_both_orders() {
    let rows: Vec<f64> = flat().collect();
    let columns = (0..9).map(|i| rows[(i % 3) * 3 + i / 3]);
    let array = npy(npyz::Order::C, flat());
    assert_eq!(read("a.npy", &array).points, POINTS);
    assert_eq!(read("a.npy", &npy(npyz::Order::Fortran, columns)).points, POINTS);
    for method in [zip::CompressionMethod::Stored, zip::CompressionMethod::Deflated] {
        assert_eq!(read("a.npz", &npz(&[("cloud.npy", &array)], method)).points, POINTS);
    }
}

#[test]
fn stl_ascii_and_binary() {
    let ascii = b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 2 0 0\nvertex 0 2 0\nendloop\nendfacet\nendsolid a\n";
    let surface = Surface::parse(Path::new("a.stl"), ascii).unwrap();
    assert_eq!((surface.triangles.len(), surface.area()), (1, 2.0));
    let mut binary = vec![0; 80];
    binary.extend(1u32.to_le_bytes());
    for value in [0f32, 0.0, 1.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 2.0, 0.0] {
        binary.extend(value.to_le_bytes());
    }
    binary.extend([0, 0]);
    assert_eq!(Surface::parse(Path::new("a.stl"), &binary).unwrap().area(), 2.0);
    assert!(Surface::parse(Path::new("a.stl"), &binary[..100]).is_err());
}

#[test]
fn millimetres_are_noticed() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/membrane/flower_1_cloud_2.ply");
    let mut cloud = Cloud::read(root).unwrap();
    assert_eq!(cloud.points.len(), 2601);
    let (low, high) = ([-0.06, -0.04], [0.06, 0.04]);
    cloud.require_near(&low, &high).unwrap();
    cloud.points.iter_mut().flatten().for_each(|value| *value *= 1e3);
    let message = cloud.require_near(&low, &high).unwrap_err().to_string();
    assert!(message.contains("the domain 0.12 x 0.08 m: is the cloud in millimetres? give --unit mm"), "{message}");
    cloud.take_into_metres("mm".parse::<LengthUnit>().unwrap());
    cloud.require_near(&low, &high).unwrap();
    assert_eq!(cloud.share_within([-0.06, -0.04, -1.0], [0.06, 0.04, 1.0]), 1.0);
    assert_eq!(Cloud { points: vec![[0.0; 3], [2.0; 3]], ..Cloud::default() }.share_within([-1.0; 3], [1.0; 3]), 0.5);
    assert_eq!("cm".parse::<LengthUnit>().unwrap().symbol(), "cm");
    cloud.points.iter_mut().for_each(|point| point[0] += 3.0);
    assert!(cloud.require_near(&low, &high).unwrap_err().to_string().contains("another frame"));
    assert!("furlong".parse::<LengthUnit>().is_err());
}

#[test]
fn headers_say_the_unit_of_a_cloud() {
    let parse = |text: &str| Cloud::parse(Path::new("c.csv"), text.as_bytes());
    let mut cloud = parse("x_mm,y [cm],z (m)\n1,2,3\n4,5,nan\n").unwrap();
    assert_eq!(cloud.points, [[1e-3, 2e-2, 3.0]]);
    // The header goes before the unit that is given.
    cloud.take_into_metres(LengthUnit::Inch);
    assert_eq!(cloud.points, [[1e-3, 2e-2, 3.0]]);
    assert!(cloud.warnings.iter().any(|warning| warning.contains("--unit in is not used")), "{:?}", cloud.warnings);

    let mut plain = parse("x,y,z\n1,2,3\n0,0,0\n").unwrap();
    assert!(!plain.is_in_metres);
    plain.take_into_metres(LengthUnit::Inch);
    assert_eq!(plain.points[0], [0.0254, 2.0 * 0.0254, 3.0 * 0.0254]);

    let fault = |text: &str| parse(text).unwrap_err().to_string();
    assert!(fault("x_mm,y,z_mm\n1,2,3\n4,5,6\n").contains("in all of them or in none"));
    assert!(fault("x [s],y [m],z [m]\n1,2,3\n4,5,6\n").contains("`x [s]` is in s"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn garbage_never_panics(
        start in proptest::sample::select(vec![
            &b""[..], b"ply\nformat ascii 1.0\nelement vertex 2\n", b"ply\nformat binary_little_endian 1.0\n",
            b"# .PCD v0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 2\nDATA binary\n", b"VERSION 0.7\n",
            b"\x93NUMPY\x01\x00", b"PK\x03\x04", b"solid ",
        ]),
        rest in proptest::collection::vec(any::<u8>(), 0..300),
        name in prop_oneof![Just("a.ply"), Just("a.pcd"), Just("a.npy"), Just("a.npz"), Just("a.csv"), Just("a.xyz")],
    ) {
        let bytes = [start, &rest].concat();
        let _ = Cloud::parse(Path::new(name), &bytes);
        let _ = Surface::parse(Path::new("a.stl"), &bytes);
    }

    #[test]
    fn damaged_files_never_panic(at in 0usize..400, byte: u8, cut in 0usize..400) {
        let whole = ply("ascii", b"0.5 7 -1.25 2\n0 7 4 -8\n1 7 2 3\n3 0 1 2\n");
        let mut bytes = whole[..cut.min(whole.len())].to_vec();
        if let Some(place) = bytes.get_mut(at) {
            *place = byte;
        }
        let _ = Cloud::parse(Path::new("a.ply"), &bytes);
    }
}

/// A cloud of a curve `[x, w]`: columns by name, or two in their order; what is not named is refused.
#[test]
fn clouds_of_curves_have_two_columns() {
    let view = View { components: vec!["x".into(), "w".into()], ..View::default() };
    let read = |name: &str, text: &str| view.parse(Path::new(name), text.as_bytes());
    let points = [[1.0, 0.5, 0.0], [2.0, -0.25, 0.0]];
    for text in [
        "x,w\n1,0.5\n2,-0.25\n",
        "x [m],w [mm]\n1,500\n2,-250\n",
        "w,y,x\n0.5,7,1\n-0.25,8,2\n",
        "x,y\n1,0.5\n2,-0.25\n",
        "s,height\n1,0.5\n2,-0.25\n",
        "1,0.5\n2,-0.25\n",
    ] {
        assert_eq!(read("a.csv", text).unwrap().points, points, "{text}");
    }
    // Neither a column that is not named nor one in the place of another is taken.
    for text in ["x,y,z\n1,0,0.5\n2,0,1\n", "w,y\n0.5,1\n1,2\n", "1,0,0.5\n", "1\n"] {
        let said = read("a.csv", text).unwrap_err().to_string();
        assert!(said.contains("`x` and `w`"), "{said}");
    }
    let said = view.parse(Path::new("a.ply"), &ply("ascii", &ply_ascii())).unwrap_err().to_string();
    assert!(said.contains("holds x, y and z, where the points are `x` and `w`"), "{said}");
    // In space the names count before x, y and z.
    let view = View { components: vec!["x".into(), "y".into(), "w".into()], ..View::default() };
    let read = |text: &str| view.parse(Path::new("a.csv"), text.as_bytes()).unwrap().points;
    assert_eq!(read("z,w,y,x\n9,3,2,1\n9,6,5,4\n"), [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
    assert_eq!(read("x,y,z\n1,2,3\n4,5,6\n"), [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
}
