//! `nisp check`: what is seen in measurements over several coordinates before anything is solved.

use crate::common::Place;

const ROD: &str = "
    coordinates: x [m], t [s];
    fields: T [K];
    sources: q [K/s];
    domains: rod = 0 .. 2 times 0 .. 60;
    on inside in rod { balance: d(T, t) == 1e-3 [m^2/s] * d(T, x, 2) + q; }
    on probes { observe T; }
";

/// Error of the temperatures: a sine of large numbers, whose root mean square is this.
const NOISE: f64 = 0.05;

/// Places that fill the rod evenly (Roberts 2018), and temperatures there.
fn rows() -> Vec<[f64; 3]> {
    let place = |i: usize| [0.754_877_666_2, 0.569_840_290_9].map(|step| (i as f64 * step).fract());
    let row = |i: usize| {
        let [x, t] = [2.0 * place(i)[0], 60.0 * place(i)[1]];
        let off = 2.0_f64.sqrt() * NOISE * (1e4 * (1.0 + i as f64).sqrt()).sin();
        [x, t, 300.0 + 5.0 * x.sin() * (t / 20.0).cos() + off]
    };
    (1..=600).map(row).collect()
}

/// What is said of the rows under a header.
fn checked(header: &str, rows: &[[f64; 3]]) -> String {
    let place = Place::new();
    place.put("rod.pde", ROD);
    let lines: String = rows.iter().map(|[x, t, temperature]| format!("{x},{t},{temperature}\n")).collect();
    place.put("probes.csv", &format!("{header}\n{lines}"));
    let ran = place.run("check rod.pde --data probes.csv");
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    ran.stdout
}

#[test]
fn right_places_cover_their_domain_and_their_noise_is_found() {
    let said = checked("x,t,T", &rows());
    assert!(said.contains("in a domain of 0 to 2\n") && said.contains("in a domain of 0 to 60\n"), "{said}");
    assert!(said.contains("the rows cover the domain"), "{said}");
    let noise = said.split("noise about ").nth(1).and_then(|rest| rest.lines().next()).unwrap();
    let noise: f64 = noise.parse().unwrap();
    assert!((noise / NOISE - 1.0).abs() < 0.25, "{said}");
    assert!(["alone", "swapped", "header", "outside", "other rows"].iter().all(|word| !said.contains(word)), "{said}");
}

#[test]
fn a_hole_a_stray_and_rows_that_are_there_twice_are_seen() {
    let mut rows = rows();
    rows.retain(|[x, t, _]| (x - 1.0).abs() > 0.5 || (t - 30.0).abs() > 15.0);
    let stray = rows.iter_mut().find(|[x, t, _]| *x > 1.6 && *t > 50.0).unwrap();
    stray[2] = 320.0;
    let again = [rows[3], rows[4]];
    rows.extend(again);
    let said = checked("x,t,T", &rows);
    assert!(said.contains("1 value stands alone, 320 at x = 1."), "{said}");
    assert!(said.contains(&format!("2 of {} rows are at places of other rows", rows.len())), "{said}");
    // The middle of the hole, to half of its width.
    let around = said.split("the largest hole lies around x = ").nth(1).unwrap();
    let numbers: Vec<f64> = around.split([' ', ',']).filter_map(|word| word.parse().ok()).take(2).collect();
    assert!((numbers[0] - 1.0).abs() < 0.25 && (numbers[1] - 30.0).abs() < 7.5, "{said}");
}

#[test]
fn other_units_and_swapped_columns_are_suspected() {
    let of = |row: fn([f64; 3]) -> [f64; 3]| rows().into_iter().map(row).collect::<Vec<_>>();
    let said = checked("x,t,T", &of(|[x, t, value]| [1e3 * x, t, value]));
    assert!(said.contains("is it in mm? say so in the header, as in `x [mm]`"), "{said}");
    let said = checked("x,t,T", &of(|[x, t, value]| [x, t / 60.0, value]));
    assert!(said.contains("is it in min?") && !said.contains("`x` goes"), "{said}");
    // With the unit in the header all is well.
    let said = checked("x [mm],t [min],T", &of(|[x, t, value]| [1e3 * x, t / 60.0, value]));
    assert!(said.contains("the rows cover the domain"), "{said}");
    let said = checked("x,t,T", &of(|[x, t, value]| [t, x, value]));
    assert!(said.contains("`x` and `t` fit each other's range and not their own: are they swapped?"), "{said}");
    let said = checked("x,t,T", &of(|[x, t, value]| [1.2 * x, t, value]));
    // A sixth of the places.
    let outside = rows().iter().filter(|[x, ..]| 1.2 * x > 2.0).count();
    assert!(said.contains(&format!("{outside} of 600 rows lie outside of the domain")), "{said}");
}

/// Minutes under a time in seconds: the rate that the record asks for is beyond its bounds.
#[test]
fn what_is_asked_of_the_places_is_asked_again_where_an_answer_is_doubted() {
    let place = Place::new();
    place.put(
        "decay.pde",
        "
        coordinates: t [s];
        fields: T [K];
        parameters: k [1/s] in 1e-4 .. 1e-2 = 1e-3;
        domains: run = 0 .. 3600;
        on body in run { balance: d(T, t) == -k * T; }
        on samples { observe T; }
        scene rate { learn k; }
        ",
    );
    let table = |header: &str| {
        let rows =
            (0..61).map(|i| format!("{i},{}\n", 100.0 * (-0.06 * f64::from(i)).exp() + 0.1 * f64::from(i * i).sin()));
        place.put("run.csv", &format!("{header}\n{}", rows.collect::<String>()));
        place.run("solve decay.pde --data run.csv")
    };
    let ran = table("t,T");
    assert_eq!(ran.code, Some(3), "{}", ran.stderr);
    assert!((ran.stdout + &ran.stderr).contains("is it in min?"));
    let ran = table("t [min],T");
    assert_eq!(ran.code, Some(0), "{} {}", ran.stdout, ran.stderr);
    assert!(!(ran.stdout + &ran.stderr).contains("is it in"));
}
