//! Pictures: nonsense is refused, and what is drawn is well-formed.

use nisp_data::colour::ColourScale;
use nisp_data::picture::{
    Curve, FieldMap, Grid, LinePanel, LinePlot, LogLog, MapPanel, Mark, Quantity, Series, SurfaceView, field_map,
    line_plot, log_log, surface_view,
};

fn plot(y: &[f64]) -> LinePlot {
    let x: Vec<f64> = (0..y.len()).map(|i| i as f64).collect();
    let mut panel = LinePanel::new(Quantity::new("f", "N"));
    panel.estimate = Some(Curve::new(&x, y));
    LinePlot { title: "a < b & c".into(), subtitle: "b".into(), x: Quantity::new("t", "s"), panels: vec![panel] }
}

#[test]
fn line_plots_name_units_and_escape_titles() {
    let svg = line_plot(&plot(&[0.0, 0.01, 0.02])).unwrap().svg().to_string();
    assert!(svg.contains("f [mN]") && svg.contains("t [s]") && svg.contains("a &lt; b &amp; c"));
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
}

#[test]
fn constant_and_tiny_curves_are_drawn() {
    for y in [[0.0; 3], [5.0; 3], [1e-300; 3], [-1e300, 0.0, 1e300]] {
        let svg = line_plot(&plot(&y)).unwrap().svg().to_string();
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{y:?}");
    }
}

#[test]
fn nonsense_is_refused() {
    assert!(line_plot(&plot(&[0.0, f64::NAN])).is_err());
    assert!(line_plot(&plot(&[])).is_err());
    let mut uneven = plot(&[0.0, 1.0]);
    uneven.panels[0].deviation = Some(vec![1.0]);
    assert!(line_plot(&uneven).unwrap_err().to_string().contains("the band does not fit the estimate"));
    let quantity = || Quantity::new("e", "N");
    let empty = LogLog {
        title: String::new(),
        subtitle: String::new(),
        x: quantity(),
        y: quantity(),
        series: vec![],
        marks: vec![],
    };
    assert!(log_log(&empty).is_err());
    let series = vec![Series { name: "a".into(), family: 0, points: vec![[0.0, 1.0]], joined: true }];
    assert!(log_log(&LogLog { series, ..empty.clone() }).is_err());
    let one = LogLog {
        series: vec![Series { name: "a".into(), family: 0, points: vec![[1.0, 1.0]], joined: false }],
        marks: vec![Mark::Horizontal("b".into(), 1.0), Mark::Vertical("c".into(), 1.0)],
        ..empty
    };
    assert!(!log_log(&one).unwrap().svg().contains("NaN"));
}

/// A map of points scattered over so much of each axis.
fn scattered([wide, tall]: [f64; 2]) -> FieldMap {
    let places = (0..300).map(f64::from).map(|i| [wide * (i * 0.618).fract(), tall * (i * 0.7548).fract()]);
    let points: Vec<[f64; 2]> = places.collect();
    let values: Vec<f64> = points.iter().map(|p| p[0] * p[1]).collect();
    let grid = Grid::from_points(&points, &values).unwrap();
    let panel = MapPanel {
        title: "estimate".into(),
        value: Quantity::new("f", "Pa"),
        scale: ColourScale::sequential(&values),
        contours: vec![("half".into(), grid.clone(), 0.5 * wide * tall)],
        grid,
    };
    FieldMap {
        title: "a map".into(),
        subtitle: "from a cloud".into(),
        x: Quantity::new("x", "m"),
        y: Quantity::new("y", "m"),
        outline: vec![],
        marks: vec![],
        panels: vec![panel],
    }
}

#[test]
fn maps_of_scattered_points_are_drawn() {
    let map = scattered([1.0, 1.0]);
    let svg = field_map(&map).unwrap().svg().to_string();
    assert!(svg.contains("data:image/png;base64,") && svg.contains("f [Pa]") && !svg.contains("NaN"));
    assert!(!svg.contains("measured"));
    let marked = field_map(&FieldMap { marks: vec![[0.01, 0.01]], ..map.clone() }).unwrap().svg().to_string();
    assert!(marked.contains("measured"));
    assert!(field_map(&FieldMap { panels: vec![], ..map }).is_err());
}

/// Two tenths of a metre over a hundred seconds fill the map as a square metre does: axes that share no scale have one each.
#[test]
fn maps_over_quantities_of_two_kinds_fill_their_frame() {
    let share = |spans: [f64; 2]| {
        let svg = field_map(&scattered(spans)).unwrap().svg().to_string();
        let image = &svg[svg.find("<image").unwrap()..];
        let number = |name: &str| -> f64 {
            let text = &image[image.find(name).unwrap() + name.len()..];
            text[..text.find('"').unwrap()].parse().unwrap()
        };
        (number(" width=\""), number(" height=\""))
    };
    let (side, _) = share([1.0, 1.0]);
    for spans in [[0.2, 100.0], [100.0, 0.2]] {
        let (width, height) = share(spans);
        assert!(width > 0.9 * side && height > 0.6 * side, "{width} {height} beside {side}");
    }
}

/// Marks every 2.5 have longer texts than those every 5, which a lower map has.
#[test]
fn a_label_stands_clear_of_its_marks() {
    let svg = field_map(&scattered([30.0, 24.0])).unwrap().svg().to_string();
    let texts = || svg.split("<text ").skip(1).map(|text| text.split_once("</text>").unwrap().0);
    let x = |text: &str| -> f64 { text.split('"').nth(1).unwrap().parse().unwrap() };
    // A figure is 5/9 of its size wide in the usual fonts, a point half of that.
    let width = |text: &str| text.chars().map(|c| if c == '.' { 0.28 } else { 0.56 } * 15.0).sum::<f64>();
    let marks = texts().filter(|text| text.contains("anchor=\"end\""));
    let nearest = marks.map(|text| x(text) - width(text.rsplit('>').next().unwrap())).fold(f64::INFINITY, f64::min);
    let label = x(texts().find(|text| text.contains("rotate(-90")).unwrap());
    // Brackets hang a quarter of the label's size below its base line.
    assert!(nearest > label + 17.0 / 4.0, "{nearest} {label}");
}

#[test]
fn surfaces_are_drawn_with_a_scale() {
    let view = SurfaceView {
        title: "a tent".into(),
        subtitle: "lit".into(),
        points: vec![[0.0, 0.0, 0.0], [0.06, 0.0, 0.0], [0.06, 0.04, 0.0], [0.0, 0.04, 0.0], [0.03, 0.02, 0.02]],
        triangles: vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
        value: Quantity::new("f", "Pa"),
        values: vec![0.0, 0.0, 0.0, 0.0, 2e4],
        scale: ColourScale::Sequential { low: 0.0, high: 2e4 },
        eye: [-60.0, 30.0],
    };
    let svg = surface_view(&view).unwrap().svg().to_string();
    assert!(svg.contains("data:image/png;base64,") && svg.contains("f [kPa]") && svg.contains(" mm</"), "{svg:.300}");
    assert!(surface_view(&SurfaceView { values: vec![], ..view.clone() }).is_err());
    assert!(surface_view(&SurfaceView { triangles: vec![[0, 1, 9]], ..view.clone() }).is_err());
    assert!(surface_view(&SurfaceView { points: vec![[0.0; 3]; 5], ..view }).is_err());
}
