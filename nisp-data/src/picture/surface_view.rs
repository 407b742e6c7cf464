//! A surface in space, coloured by a value and lit, without perspective.

use super::canvas::{Anchor, Canvas, Frame, Stroke};
use super::style::{GAP, INK, MARGIN, TICK, WIDTH};
use super::{Picture, Quantity, bar, heading, raster, ticks};
use crate::DataError;
use crate::colour::ColourScale;

/// A surface and where it is seen from.
#[derive(Debug, Clone)]
pub struct SurfaceView {
    /// One line above everything.
    pub title: String,
    /// A smaller line below it.
    pub subtitle: String,
    /// Corners, in metres.
    pub points: Vec<[f64; 3]>,
    /// Triangles between them.
    pub triangles: Vec<[usize; 3]>,
    /// What is coloured.
    pub value: Quantity,
    /// Its values, one for each corner.
    pub values: Vec<f64>,
    /// Its colours.
    pub scale: ColourScale,
    /// Where the eye is: degrees from x towards y, and degrees above the plane of both (below, if negative).
    pub eye: [f64; 2],
}

/// Pixels along the longer side of the image.
const PIXELS: f64 = 1400.0;
/// The largest part of the page that the surface may be high.
const TALLEST: f64 = 0.62;
/// Share of the light that comes from everywhere.
const AMBIENT: f64 = 0.35;

/// Directions on the page, towards the eye, and of the light.
struct Camera {
    right: [f64; 3],
    up: [f64; 3],
    towards: [f64; 3],
    light: [f64; 3],
}

impl Camera {
    fn new([azimuth, elevation]: [f64; 2]) -> Camera {
        let ((sa, ca), (se, ce)) = (azimuth.to_radians().sin_cos(), elevation.to_radians().sin_cos());
        let (right, up, towards) = ([-sa, ca, 0.0], [-se * ca, -se * sa, ce], [ce * ca, ce * sa, se]);
        // Over the viewer's left shoulder; from below for who looks from below.
        let high = 0.5 * se.signum();
        let light = normal(std::array::from_fn(|axis| towards[axis] + high * up[axis] - 0.7 * right[axis]));
        Camera { right, up, towards, light }
    }
}

/// Draws the surface.
pub fn surface_view(view: &SurfaceView) -> Result<Picture, DataError> {
    let fits = view.values.len() == view.points.len();
    let inside = view.triangles.iter().flatten().all(|&corner| corner < view.points.len());
    let finite = view.points.iter().flatten().all(|x| x.is_finite());
    if !fits || !inside || !finite || view.triangles.is_empty() {
        return Err(DataError::invalid("a surface needs triangles between finite points, and a value for each point"));
    }
    let camera = Camera::new(view.eye);
    let placed: Vec<[f64; 3]> = view
        .points
        .iter()
        .map(|point| [dot(point, &camera.right), dot(point, &camera.up), dot(point, &camera.towards)])
        .collect();
    let range = |axis: usize| {
        placed.iter().map(|p| p[axis]).fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)))
    };
    let ((left, right), (low, high)) = (range(0), range(1));
    let (wide, tall) = (right - left, high - low);
    if wide.max(tall) <= 0.0 {
        return Err(DataError::invalid("all points of the surface coincide"));
    }

    let mut canvas = Canvas::new();
    let top = MARGIN + heading::draw(&mut canvas, [MARGIN, MARGIN], WIDTH - 2.0 * MARGIN, &view.title, &view.subtitle);
    let scale = ((WIDTH - 2.0 * MARGIN) / wide).min(TALLEST * WIDTH / tall);
    let frame =
        Frame { left: 0.5 * (WIDTH - scale * wide), top: top + 2.0 * GAP, width: scale * wide, height: scale * tall };
    canvas.image(frame, &paint(view, &camera, &placed, [left, low], [wide, tall])?);
    let y = draw_length(&mut canvas, [MARGIN, frame.bottom() + 2.0 * GAP], wide, scale);
    bar::draw(&mut canvas, [0.25 * WIDTH, y + GAP], 0.5 * WIDTH, &view.value, &view.scale)?;
    Ok(canvas.finish(WIDTH, y + GAP + bar::height() + MARGIN, &view.title))
}

/// The surface as an image, with nothing where it is not.
fn paint(
    view: &SurfaceView,
    camera: &Camera,
    placed: &[[f64; 3]],
    [left, low]: [f64; 2],
    [wide, tall]: [f64; 2],
) -> Result<String, DataError> {
    let pixel = wide.max(tall) / PIXELS;
    let (width, height) = ((wide / pixel).ceil().max(1.0) as usize, (tall / pixel).ceil().max(1.0) as usize);
    let mut rgba = vec![0; 4 * width * height];
    let mut nearest = vec![f64::NEG_INFINITY; width * height];
    let lights = lights(view, camera);
    for corners in &view.triangles {
        let [a, b, c] = corners.map(|corner| [(placed[corner][0] - left) / pixel, (placed[corner][1] - low) / pixel]);
        let double = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        if double == 0.0 {
            continue;
        }
        let span = |axis: usize, most: usize| {
            let (low, high) = (a[axis].min(b[axis]).min(c[axis]), a[axis].max(b[axis]).max(c[axis]));
            (low.floor().max(0.0) as usize)..((high.ceil() as usize).min(most - 1) + 1)
        };
        for row in span(1, height) {
            for column in span(0, width) {
                let (x, y) = (column as f64 + 0.5, row as f64 + 0.5);
                let second = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / double;
                let third = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / double;
                let shares = [1.0 - second - third, second, third];
                if shares.iter().any(|&share| share < -1e-9) {
                    continue;
                }
                let mix = |of: &dyn Fn(usize) -> f64| (0..3).map(|k| shares[k] * of(corners[k])).sum::<f64>();
                let depth = mix(&|corner| placed[corner][2]);
                // Rows of an image run downwards.
                let at = (height - 1 - row) * width + column;
                if depth > nearest[at] {
                    nearest[at] = depth;
                    let light = mix(&|corner| lights[corner]);
                    let colour = view.scale.colour(mix(&|corner| view.values[corner]));
                    let lit = colour.map(|part| (f64::from(part) * light).round() as u8);
                    rgba[4 * at..4 * at + 4].copy_from_slice(&[lit[0], lit[1], lit[2], 255]);
                }
            }
        }
    }
    raster::encode(width, height, &rgba)
}

/// How bright each corner is, from the mean normal of its triangles; both sides are lit alike.
fn lights(view: &SurfaceView, camera: &Camera) -> Vec<f64> {
    let mut normals = vec![[0.0; 3]; view.points.len()];
    for corners in &view.triangles {
        let [p, q, r] = corners.map(|corner| view.points[corner]);
        let (a, b): ([f64; 3], [f64; 3]) =
            (std::array::from_fn(|axis| q[axis] - p[axis]), std::array::from_fn(|axis| r[axis] - p[axis]));
        let across = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
        corners.iter().for_each(|&corner| (0..3).for_each(|axis| normals[corner][axis] += across[axis]));
    }
    normals.into_iter().map(|own| AMBIENT + (1.0 - AMBIENT) * dot(&normal(own), &camera.light).abs()).collect()
}

/// A line of a round length, since without perspective every length across the view has one scale. Returns where it ends.
fn draw_length(canvas: &mut Canvas, [x, y]: [f64; 2], wide: f64, scale: f64) -> f64 {
    let length = ticks::linear(0.0, wide, 6.0).get(1).copied().unwrap_or(wide);
    let ends = ([x, y + 0.5 * TICK], [x + scale * length, y + 0.5 * TICK]);
    canvas.line(ends.0, ends.1, Stroke::solid(INK, 2.4));
    let text = format!("{:.3}", 1e3 * length);
    let text = format!("{} mm", text.trim_end_matches('0').trim_end_matches('.'));
    canvas.text([ends.1[0] + GAP, y + 0.85 * TICK], TICK, Anchor::Start, &text);
    y + 1.3 * TICK
}

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn normal(vector: [f64; 3]) -> [f64; 3] {
    let size = dot(&vector, &vector).sqrt();
    if size > 0.0 { vector.map(|x| x / size) } else { vector }
}
