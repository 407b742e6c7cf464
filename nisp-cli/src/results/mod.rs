//! The files of a solved problem: source and state as CSV, a plot, and the answer itself.

mod contact;
mod misfits;

pub(crate) use contact::map as contact_map;

use std::path::Path;

use crate::interrupt;
use nisp::solve::driver::Status;
use nisp::{Estimate, Solution};
use nisp_data::colour::ColourScale;
use nisp_data::export::Mesh;
use nisp_data::out_dir::Content;
use nisp_data::picture::{
    Curve, FieldMap, Grid, LinePanel, LinePlot, MapPanel, Picture, Quantity, field_map, line_plot,
};
use nisp_data::{DataError, Table};
use nisp_equations::Prepared;

/// Points of a map at least.
const FEWEST: usize = 4;

/// Points of a curve: a layer between two measurements shows too.
const CURVE: usize = 600;

/// Names of the files that will be written.
pub(crate) fn names(prepared: &Prepared) -> Vec<&'static str> {
    let surface = prepared.contact.as_ref().map(|_| contact::SURFACE);
    let mut names = vec![SOURCE, STATE, PLOT, SAVED, VOLUME];
    names.extend(misfits::FILES);
    names.extend(surface.into_iter().flatten());
    names
}

const SOURCE: &str = "source.csv";
const STATE: &str = "state.csv";
const PLOT: &str = "plot.svg";
/// Over three coordinates, for other programs.
const VOLUME: &str = "volume.vtu";
/// What `nisp eval` reads.
pub(crate) const SAVED: &str = "answer.nisp";

/// What is said of a solved problem, and the files that say it.
pub(crate) struct Answer {
    /// Names and contents, to be written together.
    pub(crate) files: Vec<Content>,
    /// Every head at the points of [`Prepared`].
    pub(crate) estimates: Vec<Estimate>,
    /// What could not be drawn, and why.
    pub(crate) warnings: Vec<String>,
}

impl Answer {
    /// With the tables; pictures are added.
    fn new(prepared: &Prepared, estimates: Vec<Estimate>) -> Result<Self, DataError> {
        let files = vec![(SOURCE, table(prepared, &estimates, true)?), (STATE, table(prepared, &estimates, false)?)];
        Ok(Self { files, estimates, warnings: Vec::new() })
    }

    /// Adds the answer itself: that it cannot be kept is no reason to lose the tables.
    fn keep(&mut self, solution: &mut Solution) {
        match solution.saved() {
            Ok(saved) => self.files.push((SAVED, saved.to_bytes())),
            Err(error) => self.warnings.push(format!("{SAVED} is not written: {error}")),
        }
    }

    /// Adds a file that shows what the tables say: that it cannot be made is no reason to lose them.
    fn show(&mut self, name: &'static str, content: Result<Vec<u8>, DataError>) {
        match content {
            Ok(bytes) => self.files.push((name, bytes)),
            Err(error) => self.warnings.push(format!("{name} is not drawn: {error}")),
        }
    }
}

/// The answer at the points of [`Prepared`], and the answer itself. Where the user has asked to stop it has no error bars: they
/// take time, and do not hold for a state that the method left halfway. Points that the user has `asked` for in a file have no
/// value where the answer does not hold.
pub(crate) fn answer(prepared: &Prepared, solution: &mut Solution, asked: Option<&Path>) -> Result<Answer, DataError> {
    let mut answer = shown(prepared, solution, asked)?;
    // What a run that was cut short leaves says little of the data.
    if prepared.contact.is_none() && solution.status == Status::Inconsistent {
        misfits::show(&mut answer, solution);
    }
    answer.keep(solution);
    Ok(answer)
}

/// The answer in tables and pictures.
fn shown(prepared: &Prepared, solution: &mut Solution, asked: Option<&Path>) -> Result<Answer, DataError> {
    if let Some(contact) = &prepared.contact {
        return contact::answer(prepared, contact, solution);
    }
    let times = &prepared.points;
    let outside = asked.map(|path| Outside::of(path, solution, times));
    if solution.scene().coordinates.len() > 1 {
        let mut estimates = evaluate(solution, times);
        outside.iter().for_each(|outside| outside.mask(&mut estimates));
        let draw = if prepared.planes.is_empty() { maps } else { planes };
        let plot = draw(prepared, solution, &estimates).map(|plot| plot.svg().into());
        let volume = (solution.scene().coordinates.len() == 3).then(|| volume(prepared, &estimates));
        let mut answer = Answer::new(prepared, estimates)?;
        answer.show(PLOT, plot);
        if let Some(volume) = volume {
            answer.show(VOLUME, volume);
        }
        answer.warnings.extend(outside.and_then(|outside| outside.said()));
        return Ok(answer);
    }
    let (first, last) = (times[0], times[times.len() - 1]);
    let fine: Vec<f64> = (0..CURVE).map(|i| first + (last - first) * i as f64 / (CURVE - 1) as f64).collect();
    // Together, because the factorisation behind the error bars is the dear part.
    let mut estimates = evaluate(solution, &[times.as_slice(), &fine].concat());
    let curves: Vec<_> = estimates.iter_mut().map(|estimate| split(estimate, times.len())).collect();
    outside.iter().for_each(|outside| outside.mask(&mut estimates));
    let plot = plot(prepared, solution, &fine, &curves).map(|plot| plot.svg().into());
    let mut answer = Answer::new(prepared, estimates)?;
    answer.show(PLOT, plot);
    answer.warnings.extend(outside.and_then(|outside| outside.said()));
    Ok(answer)
}

/// Points of a file at which the answer does not hold.
struct Outside<'a> {
    path: &'a Path,
    holds: Vec<bool>,
}

impl<'a> Outside<'a> {
    fn of(path: &'a Path, solution: &Solution, points: &[f64]) -> Self {
        Self { path, holds: solution.holds_at(points) }
    }

    /// Takes the values away there.
    fn mask(&self, estimates: &mut [Estimate]) {
        for estimate in estimates {
            let columns = [Some(&mut estimate.values), estimate.deviations.as_mut()];
            for column in columns.into_iter().flatten() {
                let outside = column.iter_mut().zip(&self.holds).filter(|(_, holds)| !**holds);
                outside.for_each(|(value, _)| *value = f64::NAN);
            }
        }
    }

    /// What the user should know of it.
    fn said(&self) -> Option<String> {
        let (outside, all) = (self.holds.iter().filter(|holds| !**holds).count(), self.holds.len());
        let said = "lie outside of those that the answer was found from, and have no value";
        (outside > 0).then(|| format!("{outside} of {all} points of {} {said}", self.path.display()))
    }
}

/// Every head at points, with error bars unless the user has asked to stop.
fn evaluate(solution: &mut Solution, points: &[f64]) -> Vec<Estimate> {
    if interrupt::asked() { solution.evaluate(points) } else { solution.evaluate_with_errors(points) }
}

/// Cuts an estimate after its first `count` points and returns the rest.
fn split(estimate: &mut Estimate, count: usize) -> Estimate {
    let values = estimate.values.split_off(count);
    let deviations = estimate.deviations.as_mut().map(|deviations| deviations.split_off(count));
    Estimate { values, deviations, ..estimate.clone() }
}

/// Sources or fields over the coordinates, each with its standard deviation where there is one.
fn table(prepared: &Prepared, estimates: &[Estimate], source: bool) -> Result<Vec<u8>, DataError> {
    let mut table = Table::empty();
    let coordinates = prepared.problem.scene().schema.coordinates;
    for (at, coordinate) in coordinates.iter().enumerate() {
        let values: Vec<f64> = prepared.points.iter().skip(at).step_by(coordinates.len()).copied().collect();
        table.push(coordinate.name, coordinate.unit.text, &values)?;
    }
    for estimate in estimates.iter().filter(|estimate| estimate.source == source) {
        table.push(estimate.name, estimate.unit.text, &estimate.values)?;
        if let Some(deviations) = &estimate.deviations {
            table.push(&format!("{}_sd", estimate.name), estimate.unit.text, deviations)?;
        }
    }
    let mut bytes = Vec::new();
    // A vector takes everything.
    let _ = table.write_to(&mut bytes);
    Ok(bytes)
}

/// Every head over three coordinates, with its standard deviation where there is one.
fn volume(prepared: &Prepared, estimates: &[Estimate]) -> Result<Vec<u8>, DataError> {
    let (points, _) = prepared.points.as_chunks::<3>();
    let mut mesh = Mesh::volume(points.to_vec());
    for estimate in estimates {
        mesh.push(estimate.name, estimate.unit.text, estimate.values.clone())?;
        if let Some(deviations) = &estimate.deviations {
            mesh.push(&format!("{}_sd", estimate.name), estimate.unit.text, deviations.clone())?;
        }
    }
    Ok(mesh.vtu_bytes())
}

fn plot(prepared: &Prepared, solution: &Solution, fine: &[f64], curves: &[Estimate]) -> Result<Picture, DataError> {
    let scene = solution.scene();
    let mut sorted: Vec<&Estimate> = curves.iter().collect();
    sorted.sort_by_key(|estimate| !estimate.source);
    let panels = sorted.into_iter().map(|estimate| {
        let mut panel = LinePanel::new(Quantity::new(estimate.name, estimate.unit.text));
        let head = scene.heads.iter().find(|head| head.name == estimate.name);
        panel.caption = head.map_or_else(String::new, |head| first_line(head.docs).into());
        let measured = prepared.measured.iter().find(|measured| measured.name == estimate.name);
        let measured = measured.map(|measured| {
            let rows = measured.at.iter().copied().zip(measured.values.iter().copied());
            rows.filter(|(_, value)| !value.is_nan()).unzip::<f64, f64, Vec<f64>, Vec<f64>>()
        });
        panel.measured = measured.as_ref().map(|(times, values)| Curve::new(times, values));
        panel.estimate = Some(Curve::new(fine, &estimate.values));
        panel.deviation.clone_from(&estimate.deviations);
        let truth = prepared.truth.as_ref();
        panel.truth = truth.and_then(|truth| Some(Curve::new(&truth.points, truth.of(estimate.name)?)));
        panel
    });
    let x = Quantity::new(scene.coordinates[0].name, scene.coordinates[0].unit.text);
    line_plot(&LinePlot { title: title(solution), subtitle: subtitle(prepared, solution), x, panels: panels.collect() })
}

/// Sources, or fields if there are none, over a plane domain: a lone one beside its truth where that is known.
fn maps(prepared: &Prepared, solution: &Solution, estimates: &[Estimate]) -> Result<Picture, DataError> {
    let (points, _) = prepared.points.as_chunks::<2>();
    let sources = estimates.iter().any(|estimate| estimate.source);
    let shown: Vec<&Estimate> = estimates.iter().filter(|estimate| estimate.source == sources).take(3).collect();
    let truth = prepared.truth.as_ref();
    let panels = match (shown.as_slice(), truth.and_then(|truth| Some((truth, truth.of(shown.first()?.name)?)))) {
        ([estimate], Some((truth, real))) => {
            let (at, _) = truth.points.as_chunks::<2>();
            let scale = ColourScale::sequential(&shown_with(real, &estimate.values));
            compared(solution, estimate, points, (&truth.points, at, real), scale)?.into()
        }
        _ => {
            let panel = |estimate: &&Estimate| {
                let scale = ColourScale::sequential(&estimate.values);
                let value = Quantity::new(estimate.name, estimate.unit.text);
                Ok(panel("estimate", value, Grid::from_points(points, &estimate.values)?, scale))
            };
            shown.iter().map(panel).collect::<Result<_, DataError>>()?
        }
    };
    map(prepared, solution, panels)
}

/// Values that a scale of colours shows beside a truth: those of the estimate, too, but for wild ones.
fn shown_with(real: &[f64], found: &[f64]) -> Vec<f64> {
    let (low, high) = real.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &x| (x.min(l), x.max(h)));
    let range = high - low;
    real.iter().copied().chain(found.iter().map(|value| value.clamp(low - range, high + range))).collect()
}

/// The first source, or field if there is none, over planes of the first two coordinates.
fn planes(prepared: &Prepared, solution: &Solution, estimates: &[Estimate]) -> Result<Picture, DataError> {
    let scene = solution.scene();
    let shown = estimates.iter().find(|estimate| estimate.source).or(estimates.first());
    let name = shown.map_or("", |estimate| estimate.name);
    let drawn = prepared.planes.iter().map(|(title, points)| {
        let found = solution.evaluate(points).into_iter().find(|estimate| estimate.name == name);
        let places = points.chunks_exact(scene.coordinates.len()).map(|point| [point[0], point[1]]);
        found.map(|estimate| (title, estimate, places.collect::<Vec<_>>()))
    });
    // A plane may only touch the body.
    let drawn: Vec<_> = drawn.flatten().filter(|(_, _, places)| places.len() >= FEWEST).collect();
    let values: Vec<f64> = drawn.iter().flat_map(|(_, estimate, _)| estimate.values.iter().copied()).collect();
    // One scale for all, so that they can be compared.
    let scale = ColourScale::sequential(&values);
    let panels = drawn.iter().map(|(title, estimate, places)| {
        let value = Quantity::new(estimate.name, estimate.unit.text);
        Ok(panel(title, value, Grid::from_points(places, &estimate.values)?, scale))
    });
    let panels = panels.collect::<Result<_, DataError>>()?;
    map(prepared, solution, panels)
}

/// Panels over the first two coordinates.
fn map(prepared: &Prepared, solution: &Solution, panels: Vec<MapPanel>) -> Result<Picture, DataError> {
    let scene = solution.scene();
    let quantity = |at: usize| Quantity::new(scene.coordinates[at].name, scene.coordinates[at].unit.text);
    field_map(&FieldMap {
        title: title(solution),
        subtitle: subtitle(prepared, solution),
        x: quantity(0),
        y: quantity(1),
        outline: prepared.outline.clone(),
        panels,
    })
}

fn panel(title: &str, value: Quantity, grid: Grid, scale: ColourScale) -> MapPanel {
    MapPanel { title: title.into(), value, grid, scale, contours: Vec::new() }
}

/// An estimate, the truth in the same colours, and what the estimate is off by; the truth with its points, flat and in the
/// plane of the picture.
fn compared(
    solution: &Solution,
    estimate: &Estimate,
    places: &[[f64; 2]],
    (points, at, real): (&[f64], &[[f64; 2]], &[f64]),
    scale: ColourScale,
) -> Result<[MapPanel; 3], DataError> {
    let again = solution.evaluate(points).into_iter().find(|again| again.name == estimate.name);
    let found = again.iter().flat_map(|found| &found.values);
    let error: Vec<f64> = found.zip(real).map(|(found, real)| found - real).collect();
    // One wild point must not leave the rest of the error without a colour.
    let most = real.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    let clamped: Vec<f64> = error.iter().map(|error| error.clamp(-most, most)).collect();
    let quantity = |name: &str| Quantity::new(name, estimate.unit.text);
    let difference = quantity(&format!("error of {}", estimate.name));
    Ok([
        panel("estimate", quantity(estimate.name), Grid::from_points(places, &estimate.values)?, scale),
        panel("truth", quantity(estimate.name), Grid::from_points(at, real)?, scale),
        panel("error", difference, Grid::from_points(at, &error)?, ColourScale::diverging(&clamped)),
    ])
}

fn title(solution: &Solution) -> String {
    first_line(solution.scene().docs).trim_end_matches('.').replace('`', "")
}

fn subtitle(prepared: &Prepared, solution: &Solution) -> String {
    let scene = solution.scene();
    let file = prepared.source.rsplit(['/', '\\']).next().unwrap_or(&prepared.source);
    let method = solution.method();
    format!("{}, scene {}; {file}; {method}, {:.1} s", scene.module, scene.name, solution.wall_s)
}

fn first_line(docs: &str) -> &str {
    docs.lines().next().unwrap_or_default().trim()
}
