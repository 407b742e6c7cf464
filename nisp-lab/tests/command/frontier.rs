//! `nisp-lab frontier` prints a table, and writes it and a plot.

use std::fs::{read_dir, read_to_string};

use crate::Place;

#[test]
fn the_frontier_is_a_table_and_a_plot_with_rivals() {
    let place = Place::new();
    let repository = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
    let line = "frontier rlc --budgets 0.05 --widths 4,6 --optimizers lbfgs,lm --noise 0.01 --repository";
    let ran = place.run(&format!("{line} {repository} --out out"));
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    for row in [
        "| lbfgs f32 |",
        "| lbfgs |",
        "| lm |",
        "| 0.05 s, width 6 |",
        "| f = 0 |",
        "| collocation |",
        "seeds from 2026",
    ] {
        assert!(ran.stdout.contains(row), "{row}: {}", ran.stdout);
    }
    assert!(!ran.stdout.contains("lm f32"));
    assert!(place.path("out/frontier.svg").exists());
    assert_eq!(read_dir(place.path("out")).unwrap().count(), 2);
    // Two widths of three methods, and four rivals, below the header.
    assert_eq!(read_to_string(place.path("out/frontier.csv")).unwrap().lines().count(), 13);
    let lost = place.run("frontier rlc --repository nowhere --out lost");
    assert_eq!((lost.code, lost.stderr.lines().count()), (Some(2), 1), "{}", lost.stderr);
    assert!(lost.stderr.contains("--repository") && !place.path("lost").exists());
}
