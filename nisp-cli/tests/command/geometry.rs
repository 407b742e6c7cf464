//! Domains, clouds and sources of some coordinates in text files.

use std::f64::consts::PI;
use std::fs;

use serde_json::Value;

use crate::common::{Place, Ran};

fn object(ran: &Ran) -> Value {
    serde_json::from_str(&ran.stdout).unwrap_or_else(|_| panic!("{}", ran.stderr))
}

const STEADY: &str = "
    units: off;
    coordinates: x, t: time;
    fields: u;
    sources: q(x);
    domains: bar = 0 .. 1 times 0 .. 0.3;
    on inside in bar { balance: d(u, t) - d(u, x, 2) == q; }
    on ends boundary of bar { held: u == 0; }
    on begin start of bar { rest: u == 0; }
    on probes { observe u; }
";

/// `u = (1 - exp(-pi^2 t)) sin(pi x)` belongs to `q = pi^2 sin(pi x)`.
#[test]
fn a_steady_source_is_the_same_at_all_times() {
    let place = Place::new();
    place.put("bar.pde", STEADY);
    let cell = |i: usize, j: usize| {
        let (x, t) = ((i as f64 + 0.5) / 15.0, 0.3 * (j as f64 + 1.0) / 8.0);
        format!("{x},{t},{}\n", (1.0 - (-PI * PI * t).exp()) * (PI * x).sin())
    };
    let table: String = (0..15).flat_map(|i| (0..8).map(move |j| cell(i, j))).collect();
    place.put("u.csv", &format!("x,t,u\n{table}"));
    assert!(place.run("check bar.pde").stdout.contains("source     q(x)"));
    let ran = place.run("solve bar.pde --data u.csv --grid 11x4 --budget 40 --json");
    assert!(matches!(ran.code, Some(0 | 3)), "{}", ran.stderr);
    let found = place.rows("nisp-out/source.csv");
    assert_eq!(found.len(), 44);
    for (at, row) in found.iter().enumerate() {
        let (x, q) = (row[0], row[2]);
        assert!((q - found[at % 11][2]).abs() <= 1e-9 * PI * PI, "{row:?} is not {:?}", found[at % 11]);
        assert!((q - PI * PI * (PI * x).sin()).abs() < 0.03 * PI * PI, "{row:?}");
    }
    // Its derivative by time is zero, and not computed.
    let asked = place.run("eval nisp-out/answer.nisp --grid 3x2 --of d(q,t),d(q,x)");
    let values: Vec<Vec<f64>> =
        asked.stdout.lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
    assert!(values.len() == 6 && values.iter().all(|row| row[2] == 0.0), "{}{}", asked.stdout, asked.stderr);
}

/// A membrane under even load between two circles, the inner one held higher: a parabola and a logarithm of the radius.
#[test]
fn a_ring_is_a_disc_minus_a_disc() {
    let place = Place::new();
    let text = "coordinates: x [m], y [m]; fields: w [mm]; parameters: k [mm/m^2] = 4;
        domains: ring = disc(0, 0, 2) minus disc(0, 0, 1), hole = disc(0, 0, 1), round = disc(0, 0, 2);
        on inside in ring with 600 points { balance: -laplacian(w) == k; }
        on inner boundary of hole { high: w == 5 [mm]; }
        on outer boundary of round { low: w == 0; }";
    place.put("ring.pde", text);
    let checked = place.run("check ring.pde");
    assert_eq!(checked.code, Some(0), "{}", checked.stderr);
    place.put("at.csv", "x_m,y_m\n1.5,0\n0,-1.2\n1.2,1.2\n");
    let ran = place.run("solve ring.pde --at at.csv --budget 25 --points inner=90 --json");
    assert_eq!(ran.code, Some(0), "{}{}", ran.stdout, ran.stderr);
    for row in place.rows("nisp-out/state.csv") {
        let r = row[0].hypot(row[1]);
        let exact = 4.0 - r * r + 2.0 * (2.0 / r).ln() / 2.0_f64.ln();
        assert!((row[2] - exact).abs() < 0.01, "{row:?} instead of {exact}");
    }
    let groups = object(&ran)["groups"].clone();
    let points = |name: &str| {
        let all = groups.as_array().unwrap().iter();
        all.filter(|group| group["name"] == name).map(|group| group["points"].as_u64().unwrap()).next()
    };
    assert_eq!((points("inside"), points("inner")), (Some(600), Some(90)), "{groups}");
    let ran = place.run("solve ring.pde --points inward=90");
    assert!(ran.code == Some(2) && ran.stderr.contains("did you mean `inner`?"), "{}", ran.stderr);
}

/// A tetrahedron as ASCII STL, in millimetres, and its outline.
#[test]
fn regions_are_read_from_files_beside_the_text() {
    let place = Place::new();
    fs::create_dir(place.path("part")).unwrap();
    let corner = |p: [f64; 3]| format!("vertex {} {} {}\n", p[0], p[1], p[2]);
    let [o, x, y, z] = [[0.0; 3], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]];
    let faces = [[o, y, x], [o, x, z], [o, z, y], [x, y, z]];
    let face = |face: [[f64; 3]; 3]| {
        format!("facet normal 0 0 0\nouter loop\n{}endloop\nendfacet\n", face.map(corner).concat())
    };
    let stl = |faces: &[[[f64; 3]; 3]]| {
        format!("solid part\n{}endsolid part\n", faces.iter().map(|own| face(*own)).collect::<String>())
    };
    place.put("part/part.stl", &stl(&faces));
    let text = "coordinates: x [m], y [m], z [m]; fields: u [K]; parameters: g [K/m] = 1;
        domains: part = solid(\"part.stl\" [mm]);
        on inside in part with 200 points { flat: laplacian(u) == 0; }
        on skin boundary of part with 300 points { columns: normal: vector [1]; flux: dot(grad(u), normal) == g * normal[z]; }";
    place.put("part/part.pde", text);
    let checked = place.run("check part/part.pde --data skin=skin.csv");
    assert!(checked.code == Some(2) && checked.stderr.contains("skin.csv"), "{}", checked.stderr);
    let ran = place.run("solve part/part.pde --iterations 2 --grid 5x5x5 --json");
    assert_eq!(ran.code, Some(3), "{}", ran.stderr);
    let points = place.rows("nisp-out/state.csv");
    // One point of the grid is within x + y + z <= 2 mm, 34 are on its faces: whether these are inside is left open.
    assert!((1..=35).contains(&points.len()), "{}", ran.stdout);
    assert!(points.iter().all(|row| row[0] + row[1] + row[2] <= 2e-3 * (1.0 + 1e-9)), "{points:?}");
    let volume = fs::read_to_string(place.path("nisp-out/volume.vtu")).unwrap();
    let header = format!("NumberOfPoints=\"{}\"", points.len());
    assert!(volume.contains("Name=\"u [K]\"") && volume.contains(&header), "{volume}");

    place.put("part/part.stl", &stl(&faces[1..]));
    let ran = place.run("solve part/part.pde");
    assert!(
        ran.code == Some(2) && ran.stderr.contains("part.stl") && ran.stderr.contains("not closed"),
        "{}",
        ran.stderr
    );

    place.put(
        "plate.pde",
        "coordinates: x [m], y [m]; fields: u [K]; domains: plate = polygon(\"outline.csv\");
        on inside in plate { flat: laplacian(u) == 0; } on edge boundary of plate { held: u == 1 [K]; }",
    );
    place.put("outline.csv", "x [mm],y [mm]\n0,0\n1000,0\n1000,500\n0,500\n");
    let ran = place.run("solve plate.pde --iterations 2 --grid 3x3 --out plate");
    assert!(place.rows("plate/state.csv").iter().all(|row| row[0] <= 1.0 && row[1] <= 0.5), "{}", ran.stderr);
}

/// A cloud of a paraboloid over a disc: the load that bends a membrane so is even.
#[test]
fn a_text_takes_a_cloud() {
    let place = Place::new();
    let text = "coordinates: x [m], y [m]; fields: w [mm]; sources: p [Pa]; parameters: S [N/m] = 300;
        domains: drum = disc(0, 0, 0.1);
        on skin in drum { balance: S * laplacian(w) == -p; seen: chamfer [x, y, w]; }
        on rim boundary of drum { held: w == 0; }";
    place.put("drum.pde", text);
    let missing = place.run("solve drum.pde");
    assert!(missing.code == Some(2) && missing.stderr.contains("--data skin.seen=FILE"), "{}", missing.stderr);
    let sunflower = |i: usize| {
        let (r, turn) = (100.0 * ((i as f64 + 0.5) / 400.0).sqrt(), i as f64 * 2.399_963);
        format!("{},{},{}\n", r * turn.cos(), r * turn.sin(), 10.0 * (1.0 - r * r / 1e4))
    };
    place.put("scan.csv", &format!("x,y,z\n{}", (0..400).map(sunflower).collect::<String>()));
    let metres = |i: usize| {
        sunflower(i).trim().split(',').map(|x| format!("{},", 1e-3 * x.parse::<f64>().unwrap())).collect::<String>()
    };
    place.put(
        "metres.csv",
        &format!("x,y,z\n{}", (0..400).map(|i| metres(i).trim_end_matches(',').to_string() + "\n").collect::<String>()),
    );
    let checked = place.run("check drum.pde --data metres.csv").stdout;
    // The paraboloid's rim and crown, but for the outermost and the innermost point.
    assert!(checked.contains("cloud of seen [m]: 400 points, -0.09"), "{checked}");
    assert!(checked.contains(" to 0.0099875"), "{checked}");
    let ran = place.run("solve drum.pde --data scan.csv --unit mm --grid 9x9 --budget 20 --json");
    assert!(matches!(ran.code, Some(0 | 3)), "{}", ran.stderr);
    let off = place.rows("nisp-out/state.csv").into_iter().map(|row| {
        let exact = 10.0 * (1.0 - (row[0] * row[0] + row[1] * row[1]) / 0.01);
        (row[2] - exact).abs()
    });
    // A tenth of its height: metres and millimetres are in their places.
    assert!(off.fold(0.0, f64::max) < 1.0, "{}", ran.stdout);
    for name in ["skin", "skin.seen"] {
        let ran = place.run(&format!("solve drum.pde --data {name}=scan.csv --unit mm --iterations 2"));
        assert_eq!(ran.code, Some(3), "{name}: {}", ran.stderr);
    }
}

/// What is wrong with a table's headers is said at once, and no column is suggested that would be refused.
#[test]
fn all_headers_are_looked_at() {
    let place = Place::new();
    let text = "coordinates: t [s]; fields: x [m], y [m], T [K]; sources: f [N]; parameters: m [kg] = 1;
        on motion { a: m * d(x, t, 2) == f; b: m * d(y, t, 2) == f; c: T == 1 [K/m] * x; }
        on samples { columns: load [N]; observe x, y, T; known: f == load; }";
    place.put("two.pde", text);
    place.put("run.csv", "time [s],x [V],height [m],T [K],loads [V]\n0,1,1,1,0\n1,2,2,2,0\n2,3,3,3,0\n");
    let ran = place.run("solve two.pde --data run.csv");
    assert_eq!(ran.code, Some(2));
    for part in ["--column 't=time [s]'", "`x [V]` is in V", "`load` in N; choose one, with --column load=HEADER"] {
        assert!(ran.stderr.contains(part), "{part}: {}", ran.stderr);
    }
}

/// Measurements that the equation cannot explain: where they are off is written.
#[test]
fn a_failed_answer_shows_its_misfits() {
    let place = Place::new();
    let text = "coordinates: t [s]; fields: y [m]; parameters: r [1/s] = 1;
        on decay { balance: d(y, t) == -r * y; } on start { known: y == 1 [m]; } on samples { observe y; }";
    place.put("decay.pde", text);
    let row = |i: usize| {
        let t = 0.05 * i as f64;
        format!("{t},{}\n", (-2.0 * t).exp() + 1e-3 * (37.0 * i as f64).sin())
    };
    place.put("run.csv", &format!("t,y\n{}", (0..60).map(row).collect::<String>()));
    let ran = place.run("solve decay.pde --data run.csv --budget 20 --json");
    assert_eq!(ran.code, Some(3), "{}", ran.stdout);
    let text = fs::read_to_string(place.path("nisp-out/misfits.csv")).unwrap();
    assert!(text.starts_with("t [s],samples.y [m]\n") && text.lines().count() == 61, "{text}");
    assert!(
        fs::read_to_string(place.path("nisp-out/misfits.svg")).unwrap().contains("What is left of the measurements")
    );
}
