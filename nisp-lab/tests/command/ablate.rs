//! `nisp-lab ablate` prints a table of every study that is asked for.

use crate::Place;

#[test]
fn a_study_is_a_table_beside_the_papers_numbers() {
    let place = Place::new();
    let ran = place.run("ablate --studies architecture --budget 0.5 --threads 1");
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    assert!(ran.stdout.starts_with("### Architecture, plate\n"), "{}", ran.stdout);
    let rows: Vec<Vec<&str>> = ran
        .stdout
        .lines()
        .filter(|line| line.starts_with("| "))
        .map(|line| line.split('|').map(str::trim).collect())
        .collect();
    assert_eq!(rows[0], ["", "", "mean error of w [mm]", "seconds", "paper", ""]);
    let names: Vec<&str> = rows[1..].iter().map(|row| row[1]).collect();
    assert_eq!(names, ["gated", "plain", "gated, Fourier mapping"]);
    let errors: Vec<f64> = rows[1..].iter().map(|row| row[2].parse().unwrap()).collect();
    // The plate is deflected by 12 mm on average; Fourier features of it take their time.
    assert!(errors.iter().all(|error| *error > 0.0) && errors[0] < 6.0 && errors[1] < 6.0, "{errors:?}");
}

#[test]
fn faults_are_said_in_one_line() {
    let place = Place::new();
    let ran = place.run("ablate --studies nonsense");
    assert_eq!((ran.code, ran.stderr.lines().count()), (Some(2), 1), "{}", ran.stderr);
    assert!(ran.stderr.contains("nonsense") && ran.stderr.contains("mapping"), "{}", ran.stderr);
    let ran = place.run("ablate --studies noise");
    assert_eq!(ran.code, Some(2), "{}", ran.stdout);
    assert!(ran.stderr.contains("--repository"), "{}", ran.stderr);
}
