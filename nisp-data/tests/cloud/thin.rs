//! Thinning: as many points in every cube, and the noise as it was.

use nisp_data::Cloud;

/// A plane of 100 by 100 squares of a centimetre, with 40 points in each.
fn plane() -> Cloud {
    let within = [0.1, 0.3, 0.5, 0.7, 0.9];
    let square = |i: i32, j: i32| {
        let at = move |k: usize, x: f64| [f64::from(i) + within[k], f64::from(j) + x, 0.5].map(|x| 0.01 * x);
        (0..5).flat_map(move |k| (0..8).map(move |l| at(k, 0.06 + 0.12 * f64::from(l))))
    };
    let points = (-50..50).flat_map(|i| (-50..50).flat_map(move |j| square(i, j))).collect();
    Cloud { points, ..Cloud::default() }
}

#[test]
fn every_cube_keeps_its_share() {
    let mut cloud = plane();
    cloud.thin(0.01, 4);
    assert_eq!(cloud.points.len(), 40_000, "one of ten of 400 000");
    let mut counts = std::collections::HashMap::new();
    for point in &cloud.points {
        *counts.entry(point.map(|x| (x / 0.01).floor() as i64)).or_insert(0) += 1;
    }
    assert_eq!(counts.len(), 10_000);
    assert!(counts.values().all(|&count| count == 4));
    assert_eq!(
        cloud.warnings,
        [
            "40000 of the cloud's 400000 points are used, one of 10 in each of 10000 cubes, which the answer is as fine as"
        ]
    );
}

#[test]
fn a_cloud_that_is_not_much_too_dense_stays_as_it_is() {
    for (side, each) in [(0.01, 21), (0.001, 4), (0.0, 4), (f64::NAN, 4), (1e-300, 4)] {
        let mut cloud = plane();
        cloud.thin(side, each);
        assert_eq!(cloud, plane(), "{side}, {each}");
    }
}

/// One point of a hundred is thrown off by ten centimetres: so many are among those that are kept, too.
#[test]
fn outliers_are_as_frequent_as_before() {
    let mut cloud = plane();
    cloud.points.iter_mut().step_by(100).for_each(|point| point[2] += 0.1);
    cloud.thin(0.1, 100);
    let far = cloud.points.iter().filter(|point| point[2] > 0.05).count();
    let share = far as f64 / cloud.points.len() as f64;
    assert!((share - 0.01).abs() < 1e-3, "{share} of {}", cloud.points.len());
}

#[test]
fn every_cube_keeps_the_point_nearest_to_its_middle() {
    let points = vec![[0.1, 0.1, 0.1], [0.4, 0.5, 0.6], [-0.5, 0.5, 0.5], [1.5, 0.0, 0.0], [0.9, 0.9, 0.9]];
    let cloud = Cloud { points, ..Cloud::default() };
    assert_eq!(cloud.one_of_each_cube(1.0, 1).points, [[0.4, 0.5, 0.6], [-0.5, 0.5, 0.5], [1.5, 0.0, 0.0]]);
    assert_eq!(cloud.one_of_each_cube(1.0, 3).points, [[0.4, 0.5, 0.6]]);
}

/// A metre along its sides, and a few points ten metres away.
#[test]
fn strays_do_not_make_a_cloud_longer() {
    let mut cloud = plane();
    cloud.points.iter_mut().step_by(100).for_each(|point| point[2] += 10.0);
    assert!((cloud.length() - 1.0).abs() < 0.01, "{}", cloud.length());
    assert_eq!(Cloud::default().length(), 0.0);
}
