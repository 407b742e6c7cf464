//! The files of a solved problem: source and state as CSV, a plot, and the answer itself.

mod contact;
mod curves;
mod maps;
mod misfits;

pub(crate) use contact::map as contact_map;

use std::path::Path;

use crate::interrupt;
use nisp::schema::Scene;
use nisp::solve::driver::Status;
use nisp::{Estimate, Solution};
use nisp_data::export::Mesh;
use nisp_data::out_dir::Content;
use nisp_data::{DataError, Table};
use nisp_equations::Prepared;

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
    fn keep(&mut self, prepared: &Prepared, solution: &mut Solution) {
        match solution.saved() {
            Ok(saved) => {
                let saved = match prepared.begin {
                    Some(begin) => saved.counted_from(begin),
                    None => saved,
                };
                self.files.push((SAVED, saved.to_bytes()));
            }
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
    answer.keep(prepared, solution);
    Ok(answer)
}

/// The answer in tables and pictures.
fn shown(prepared: &Prepared, solution: &mut Solution, asked: Option<&Path>) -> Result<Answer, DataError> {
    if let Some(contact) = &prepared.contact {
        return contact::answer(prepared, contact, solution);
    }
    let scene = solution.scene();
    let (points, axes) = (&prepared.points, scene.coordinates.len());
    let outside = asked.map(|path| Outside::of(path, solution, points));
    let axis = curves::axis(scene);
    let fine = match axis {
        Some(axis) => curves::points(prepared, scene, axis),
        None => maps::points(prepared, scene),
    };
    // Together, because the factorisation behind the error bars is the dear part.
    let mut estimates = evaluate(solution, &[points.as_slice(), &fine].concat());
    let drawn: Vec<_> = estimates.iter_mut().map(|estimate| split(estimate, points.len() / axes)).collect();
    outside.iter().for_each(|outside| outside.mask(&mut estimates));
    let plot = match axis {
        Some(axis) => curves::draw(prepared, solution, axis, (&fine, &drawn)),
        None => maps::draw(prepared, solution, &estimates, (&fine, &drawn)),
    };
    let volume = (axes == 3).then(|| volume(prepared, &estimates));
    let mut answer = Answer::new(prepared, estimates)?;
    answer.show(PLOT, plot.map(|plot| plot.svg().into()));
    if let Some(volume) = volume {
        answer.show(VOLUME, volume);
    }
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

/// The least and the greatest value of a coordinate among the points of [`Prepared`].
fn range(prepared: &Prepared, scene: &Scene, axis: usize) -> [f64; 2] {
    let values = prepared.points.iter().skip(axis).step_by(scene.coordinates.len());
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &x| [low.min(x), high.max(x)])
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
