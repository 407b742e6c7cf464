//! Rows that stand alone, come at odd places, tell nothing, or are few.

use nisp::{LagSettings, LiveError, Smoothed};

use crate::{drive, driven, fed, motion, noise, outflow, record, smoothed, smoother};

/// Values of one row in fifty are far off, 30 to 90 deviations to either side, in the first rows, in later ones, and beside each other.
#[test]
fn strays_are_left_out_and_told() {
    let (mut rows, mut strays) = (record(3000, 0.05, 0.01), Vec::new());
    for (number, at) in (20..2990).step_by(50).map(|at| at + at * 7 % 11).enumerate() {
        rows[at].1 += (0.3 + 0.1 * (number % 7) as f64) * if number % 2 == 0 { 1.0 } else { -1.0 };
        strays.push(at);
    }
    let beside = strays[30] + 1;
    rows[beside].1 += 0.5 * (motion(rows[strays[30]].0) - rows[strays[30]].1).signum();
    strays.insert(31, beside);
    for lag in [None, Some(0.1), Some(1.0), Some(5.0)] {
        let settings = LagSettings { lag, ..LagSettings::default() };
        let found = smoothed(&mut smoother(driven::scene("recover"), settings), &rows);
        let is_right = |found: &Smoothed| (found.heads[1].0 - drive(found.at, 0.0)).abs() < 5.0 * found.heads[1].1;
        let off = found.iter().filter(|found| !is_right(found)).count();
        assert!(off == 0, "{lag:?}: {off} rows are off");
        if lag != Some(0.1) {
            assert!(found.iter().all(Smoothed::is_sound), "{lag:?}");
            let told: Vec<usize> = (0..found.len()).filter(|&row| found[row].is_stray).collect();
            assert_eq!(told, strays, "{lag:?}");
        }
    }
}

/// One value in twenty is far off, wherever chance puts them: side by side, several in a few rows, among the first rows. Exact records have
/// the same, and then no deviations.
#[test]
fn many_strays_are_left_out_and_told() {
    for sigma in [0.0, 0.01] {
        let (mut rows, mut strays, mut chance) = (record(2000, 0.05, sigma), Vec::new(), noise(21));
        for (at, row) in rows.iter_mut().enumerate() {
            let (draw, side) = (chance(), chance());
            if draw > 1.645 {
                row.1 += (0.3 + 0.1 * (at % 7) as f64) * side.signum();
                strays.push(at);
            }
        }
        let found = smoothed(&mut smoother(driven::scene("recover"), LagSettings::default()), &rows);
        let told = |row: &usize| found[*row].is_stray;
        let missed = strays.iter().filter(|row| !told(row)).count();
        let wrong = (0..rows.len()).filter(|row| told(row) && !strays.contains(row)).count();
        let unsound = found.iter().filter(|found| !found.is_sound()).count();
        assert!(
            strays.len() > 80 && missed <= 2 && wrong == 0,
            "{missed} missed and {wrong} wrong of {}",
            strays.len()
        );
        assert!(unsound <= 20, "{unsound} rows are unsound with noise of {sigma}");
        assert!(sigma > 0.0 || found.iter().all(|found| found.heads[1].1.is_nan()));
        let off = |found: &&Smoothed| {
            let most = if sigma > 0.0 { 5.0 * found.heads[1].1 } else { 0.01 };
            found.is_sound() && (found.heads[1].0 - drive(found.at, 0.0)).abs() > most
        };
        let off = found.iter().filter(off).count();
        assert!(off <= 4, "{off} rows are off with noise of {sigma}");
    }
}

/// When the first 400 rows are asked for noise and smoothness, nothing says yet whether the last of them is a stray.
#[test]
fn a_stray_at_the_end_of_a_stretch_makes_no_bars_longer() {
    let plain = record(800, 0.05, 0.01);
    let mut spoiled = plain.clone();
    spoiled[399].1 += 0.8;
    let [plain, spoiled] =
        [plain, spoiled].map(|rows| smoothed(&mut smoother(driven::scene("recover"), LagSettings::default()), &rows));
    assert!(spoiled[399].is_stray);
    for (row, (spoiled, plain)) in spoiled.iter().zip(&plain).enumerate().take(700).skip(500) {
        let share = spoiled.heads[1].1 / plain.heads[1].1;
        assert!((0.8..1.25).contains(&share), "row {row}: bars are {share} times as long");
    }
}

/// A level that flows out as its root, `y = 0.3 + 0.1 sin(t / 2)`. No root is that of a value below zero, and the equation cannot be evaluated
/// about one such value. The record goes on behind it.
#[test]
fn a_row_that_cannot_be_evaluated_does_not_end_a_record() {
    let mut noise = noise(5);
    let level = |t: f64| 0.3 + 0.1 * (0.5 * t).sin();
    let mut rows: Vec<(f64, f64)> =
        (0..1500).map(|i| 0.05 * f64::from(i)).map(|t| (t, level(t) + 0.003 * noise())).collect();
    rows[700].1 = -3.0;
    let found = smoothed(&mut smoother(outflow::scene("recover"), LagSettings::default()), &rows);
    let places: Vec<f64> = found.iter().map(|found| found.at).collect();
    assert!(places.len() == rows.len() && places.is_sorted(), "every row has an answer");
    assert!(found[700].is_stray || !found[700].is_sound());
    let is_wrong = |found: &&Smoothed| {
        let inflow = 0.05 * (0.5 * found.at).cos() + 0.5 * level(found.at).sqrt();
        found.is_sound() && (found.heads[1].0 - inflow).abs() > 4.0 * found.heads[1].1
    };
    assert_eq!(found.iter().filter(is_wrong).count(), 0);
    let sound = found.iter().filter(|found| found.is_sound()).count();
    assert!(sound > 1350, "{sound} of 1500 rows are sound");
}

/// The oscillator's answer to a drive of one that begins at zero.
fn answer(t: f64) -> f64 {
    let frequency = (4.0_f64 - 0.04).sqrt();
    let swing = (frequency * t).cos() + 0.2 / frequency * (frequency * t).sin();
    if t > 0.0 { (1.0 - (-0.2 * t).exp() * swing) / 4.0 } else { 0.0 }
}

/// A quiet drive that steps: the window smears the step over some rows, and the misfits of these are hardly larger than the noise.
#[test]
fn a_smeared_step_is_not_called_sound() {
    let (begins, sigma) = (15.01, 0.01);
    let mut noise = noise(7);
    let times = (0..900).map(|i| 0.025 * f64::from(i));
    let rows: Vec<(f64, f64)> =
        times.map(|t| (t, 0.1 * motion(t) + 3.0 * answer(t - begins) + sigma * noise())).collect();
    let found = smoothed(&mut smoother(driven::scene("recover"), LagSettings::default()), &rows);
    let is_far = |found: &&Smoothed| {
        let exact = 0.1 * drive(found.at, 0.0) + if found.at > begins { 3.0 } else { 0.0 };
        (found.heads[1].0 - exact).abs() > 8.0 * found.heads[1].1
    };
    let far: Vec<&Smoothed> = found.iter().filter(is_far).collect();
    let sound = far.iter().filter(|found| found.is_sound()).count();
    assert!(far.len() > 10 && sound == 0, "{sound} of {} rows that are far off are sound", far.len());
    assert!(found[..500].iter().all(Smoothed::is_sound));
}

/// A source can follow a value that no longer changes.
#[test]
fn a_sensor_that_fails_is_not_called_sound() {
    let mut rows = record(900, 0.05, 0.01);
    let last = rows[600].1;
    rows[600..].iter_mut().for_each(|(_, y)| *y = last);
    let found = smoothed(&mut smoother(driven::scene("recover"), LagSettings::default()), &rows);
    assert_eq!(found.iter().position(|found| found.is_held), Some(600));
    assert!(found[600..].iter().all(|found| found.is_held && !found.is_sound()));
    assert!(found[..590].iter().filter(|found| !found.is_sound()).count() < 6);
}

/// A pulse of the drive, and values that are off together, are no strays.
#[test]
fn what_moves_several_rows_is_no_stray() {
    let mut rows = record(900, 0.05, 0.01);
    for (t, y) in &mut rows {
        *y += 30.0 * (answer(*t - 20.0) - answer(*t - 20.3)) + 10.0 * answer(*t - 30.0);
    }
    let plain = smoothed(&mut smoother(driven::scene("recover"), LagSettings::default()), &rows);
    assert!(plain.iter().all(|found| !found.is_stray));
    (700..704).for_each(|row| rows[row].1 += 0.5);
    let glitch = smoothed(&mut smoother(driven::scene("recover"), LagSettings::default()), &rows);
    assert!(glitch.iter().all(|found| !found.is_stray));
    assert!(glitch[700..704].iter().all(|found| !found.is_sound()));
}

#[test]
fn rows_that_cannot_be_taken_are_left_out() {
    let rows = record(600, 0.1, 0.02);
    let settings = LagSettings { lag: Some(1.0), ..LagSettings::default() };
    let plain = smoothed(&mut smoother(driven::scene("recover"), settings), &rows);
    let mut spoiled = smoother(driven::scene("recover"), settings);
    let mut found = Vec::new();
    for (at, (t, y)) in rows.iter().enumerate() {
        found.extend(spoiled.push(*t, &[*y]).unwrap());
        if at < 3 {
            assert!(matches!(spoiled.push(*t, &[*y]), Err(LiveError::Backwards { .. })));
        }
        if at % 50 == 49 {
            assert!(matches!(spoiled.push(*t - 0.05, &[*y]), Err(LiveError::Backwards { .. })));
            assert!(matches!(spoiled.push(*t, &[*y]), Err(LiveError::Backwards { .. })));
            assert!(matches!(spoiled.push(f64::NAN, &[*y]), Err(LiveError::NotFinite { .. })));
            assert!(matches!(spoiled.push(*t + 0.01, &[f64::INFINITY]), Err(LiveError::NotFinite { .. })));
            assert!(matches!(spoiled.push(*t + 0.01, &[]), Err(LiveError::Columns { .. })));
        }
    }
    found.extend(spoiled.finish().unwrap());
    assert_eq!(plain, found);
}

/// One absurd place among the first rows, one among later ones, and one at the end: the record is as it would be without them.
#[test]
fn a_place_far_ahead_is_left_out_if_the_next_row_is_not() {
    let rows = record(600, 0.1, 0.02);
    let plain = smoothed(&mut smoother(driven::scene("recover"), LagSettings::default()), &rows);
    let mut spoiled = smoother(driven::scene("recover"), LagSettings::default());
    let (mut found, mut left_out) = (Vec::new(), Vec::new());
    for (at, (t, y)) in rows.iter().enumerate() {
        found.extend(spoiled.push(*t, &[*y]).unwrap());
        left_out.extend(spoiled.left_out());
        if [0, 1, 60, 400, 599].contains(&at) {
            found.extend(spoiled.push(1e6 + *t, &[*y]).unwrap());
        }
    }
    found.extend(spoiled.finish().unwrap());
    left_out.extend(spoiled.left_out());
    assert_eq!(plain, found);
    assert_eq!(left_out, [0, 1, 60, 400, 599].map(|at| 1e6 + rows[at].0));
}

/// A sensor that says nothing for a while, and one that is at rest: later rows tell.
#[test]
fn first_rows_that_tell_nothing_wait_for_others() {
    let mut noise = noise(12);
    // It is at rest for the time of 300 rows; then it is `1 - cos 3 s` for the time `s` after that.
    let since = |t: f64| (t - 15.0).max(0.0);
    let rows: Vec<(f64, f64)> =
        (0..1200).map(|i| 0.05 * f64::from(i)).map(|t| (t, 1.0 - (3.0 * since(t)).cos())).collect();
    let resting: Vec<(f64, f64)> =
        rows.iter().map(|&(t, y)| (t, y + if t < 15.0 { 0.0 } else { 0.01 * noise() })).collect();
    let silent: Vec<(f64, f64)> = resting.iter().map(|&(t, y)| (t, if t < 15.0 { f64::NAN } else { y })).collect();
    for rows in [resting, silent] {
        let found = smoothed(&mut smoother(driven::scene("recover"), LagSettings::default()), &rows);
        assert_eq!(found.len(), rows.len());
        let is_right = |found: &&Smoothed| {
            let s = since(found.at);
            let drive = 4.0 + 5.0 * (3.0 * s).cos() + 1.2 * (3.0 * s).sin();
            (found.heads[1].0 - drive).abs() < 4.0 * found.heads[1].1
        };
        let right = found[400..1190].iter().filter(is_right).count();
        assert!(right > 750, "{right} of 790 rows are right");
    }
}

/// Cells without a measurement, rows in bursts, and a gap after which everything begins anew.
#[test]
fn gaps_and_bursts_are_taken_as_they_are() {
    let mut noise = noise(11);
    let place = |i: u32| match i {
        // Bursts of four rows.
        0..600 => 0.2 * f64::from(i / 4) + 0.02 * f64::from(i % 4),
        // A gap of a hundred.
        _ => 130.0 + 0.05 * f64::from(i - 600),
    };
    let mut smoother = smoother(driven::scene("recover"), LagSettings::default());
    let mut found = Vec::new();
    for i in 0..1200 {
        let t = place(i);
        let is_lacking = i % 7 == 3 || (400..416).contains(&i);
        let y = if is_lacking { f64::NAN } else { motion(t) + 0.01 * noise() };
        found.extend(smoother.push(t, &[y]).unwrap());
    }
    found.extend(smoother.finish().unwrap());
    assert_eq!(found.len(), 1200);
    assert!(found.iter().enumerate().all(|(i, found)| (found.at - place(i as u32)).abs() < 1e-9));
    let inside = |found: &&Smoothed| (found.heads[1].0 - drive(found.at, 0.0)).abs() < 2.0 * found.heads[1].1;
    let within = found.iter().filter(inside).count();
    assert!(within > 1100, "{within} of 1200 within two deviations");
}

/// Evenly spaced rows lie where cells meet, and rounding puts them to one side or the other. Each counts once nevertheless, with the equation
/// of its columns.
#[test]
fn answers_do_not_depend_on_where_a_record_begins() {
    let rows = record(1000, 0.02, 0.01);
    let answers = |begins: f64| {
        let settings = LagSettings { lag: Some(1.0), ..LagSettings::default() };
        let mut smoother = smoother(fed::scene("recover"), settings);
        let mut found = Vec::new();
        rows.iter().for_each(|(t, y)| found.extend(smoother.push(begins + t, &[(0.9 * t).sin(), *y]).unwrap()));
        found.extend(smoother.finish().unwrap());
        found
    };
    let plain = answers(0.0);
    for begins in [0.3, -7.7, 1e4] {
        for (row, (found, plain)) in answers(begins).iter().zip(&plain).enumerate() {
            let ((value, deviation), (other, bar)) = (found.heads[1], plain.heads[1]);
            assert!((value - other).abs() < 0.01 * bar, "row {row} from {begins} on: {value} and {other} +- {bar}");
            assert!((deviation / bar - 1.0).abs() < 0.01, "row {row} from {begins} on: +- {deviation} and {bar}");
        }
    }
}

/// Two rows between two gaps are answered too, and those behind the second gap.
#[test]
fn no_row_is_lost_between_gaps() {
    let blocks = [(0.0, 300), (40.0, 2), (80.0, 300)];
    let times = blocks.iter().flat_map(|&(from, rows)| (0..rows).map(move |i| from + 0.1 * f64::from(i)));
    let mut noise = noise(8);
    let rows: Vec<(f64, f64)> = times.map(|t| (t, motion(t) + 0.01 * noise())).collect();
    let found = smoothed(&mut smoother(driven::scene("recover"), LagSettings::default()), &rows);
    let places = |at: f64| rows.iter().filter(|row| (row.0 - at).abs() < 1e-9).count();
    assert_eq!(found.len(), rows.len());
    assert!(found.iter().all(|found| places(found.at) == 1));
}

#[test]
fn few_rows_are_said_to_be_few() {
    let mut smoother = smoother(driven::scene("recover"), LagSettings::default());
    record(5, 0.1, 0.02).iter().for_each(|(t, y)| assert!(smoother.push(*t, &[*y]).unwrap().is_empty()));
    assert!(matches!(smoother.finish(), Err(LiveError::FewRows { rows: 5, .. })));
}
