//! The files of a contact: pressure, state, a map of the patch, and the deformed surface for other programs.

use nisp::schema::Head;
use nisp::{Estimate, Solution};
use nisp_data::DataError;
use nisp_data::colour::ColourScale;
use nisp_data::export::Mesh;
use nisp_data::picture::{Grid, MapPanel, Picture, Quantity, SurfaceView, surface_view};
use nisp_equations::{Contact, Prepared};

use super::{Answer, maps};

/// Files that show the deformed surface.
pub(super) const SURFACE: [&str; 3] = ["surface.svg", "surface.vtu", "surface.ply"];

/// Everything that is said of a contact.
pub(super) fn answer(prepared: &Prepared, contact: &Contact, solution: &mut Solution) -> Result<Answer, DataError> {
    let estimates = super::evaluate(solution, &prepared.points);
    let head = shown(contact, solution)?;
    let plot = pressure(prepared, contact, solution, head, &estimates).map(|plot| plot.svg().into());
    let mut answer = Answer::new(prepared, estimates)?;
    answer.show(super::PLOT, plot);
    let surface = match surface(prepared, contact, solution, head) {
        Ok(surface) => surface,
        Err(error) => {
            answer.show(SURFACE[0], Err(error));
            return Ok(answer);
        }
    };
    answer.show(SURFACE[0], surface_view(&surface).map(|view| view.svg().into()));
    match mesh(contact, solution, head.name, &surface) {
        Ok(mesh) => {
            answer.show(SURFACE[1], Ok(mesh.vtu_bytes()));
            answer.show(SURFACE[2], mesh.ply_bytes(Some((head.name, surface.scale))));
        }
        Err(error) => answer.show(SURFACE[1], Err(error)),
    }
    Ok(answer)
}

/// A map of the pressure, or of the height where nothing presses.
pub(crate) fn map(prepared: &Prepared, contact: &Contact, solution: &mut Solution) -> Result<Picture, DataError> {
    let estimates = solution.evaluate(&prepared.points);
    pressure(prepared, contact, solution, shown(contact, solution)?, &estimates)
}

/// The head that pictures show.
fn shown(contact: &Contact, solution: &Solution) -> Result<&'static Head, DataError> {
    let shown = contact.pressure.unwrap_or(contact.displacement[2]);
    let missing = || DataError::Invalid(format!("the scene has no `{shown}` to draw"));
    solution.scene().heads.iter().find(|head| head.name == shown).ok_or_else(missing)
}

/// The deformed surface with every head on it.
fn mesh(contact: &Contact, solution: &Solution, shown: &str, surface: &SurfaceView) -> Result<Mesh, DataError> {
    let mut mesh = Mesh::new(surface.points.clone(), surface.triangles.clone())?;
    for estimate in solution.evaluate(&contact.surface.points) {
        let values = if estimate.name == shown { surface.values.clone() } else { estimate.values };
        mesh.push(estimate.name, estimate.unit.text, values)?;
    }
    Ok(mesh)
}

/// The deformed surface with a head's values; a pressure is zero where none can act.
fn surface(prepared: &Prepared, contact: &Contact, solution: &Solution, head: &Head) -> Result<SurfaceView, DataError> {
    let body = &contact.surface;
    let estimates = solution.evaluate(&body.points);
    let of = |name: &str| estimates.iter().find(|estimate| estimate.name == name).map(|estimate| &estimate.values[..]);
    let [Some(x), Some(y), Some(z)] = contact.displacement.map(of) else {
        return Err(DataError::Invalid("the scene moves its surface by fields that it does not have".into()));
    };
    let values = of(head.name).unwrap_or(&[]).iter().zip(&body.loaded);
    let values: Vec<f64> = values.map(|(value, loaded)| if !head.source || *loaded { *value } else { 0.0 }).collect();
    Ok(SurfaceView {
        title: super::title(solution),
        subtitle: super::subtitle(prepared, solution),
        points: contact.deformed(&body.points, [x, y, z]),
        triangles: body.triangles.clone(),
        value: Quantity::new(head.name, head.unit.text),
        scale: if head.source { ColourScale::load(&values) } else { ColourScale::sequential(&values) },
        values,
        eye: contact.eye,
    })
}

/// The estimate, and beside it truth and error where the truth is known, with the outlines of the patches.
fn pressure(
    prepared: &Prepared,
    contact: &Contact,
    solution: &Solution,
    head: &Head,
    estimates: &[Estimate],
) -> Result<Picture, DataError> {
    let scene = solution.scene();
    let dim = scene.coordinates.len();
    let plane = |points: &[f64]| -> Vec<[f64; 2]> { points.chunks_exact(dim).map(|p| [p[0], p[1]]).collect() };
    let Some(estimate) = estimates.iter().find(|estimate| estimate.name == head.name) else {
        return Err(DataError::Invalid(format!("the scene has no `{}` to draw", head.name)));
    };
    let found = &estimate.values;
    let places = plane(&prepared.points);
    let grid = Grid::from_points(&places, found)?;
    let mut outlines = Vec::new();
    if contact.pressure.is_some() {
        outlines.push(("estimated patch".to_string(), grid.clone(), contact.rule.threshold(found)));
    }
    let panels = match prepared.truth.as_ref().and_then(|truth| Some((truth, truth.of(head.name)?))) {
        None => {
            let value = Quantity::new(head.name, head.unit.text);
            let panel = maps::panel("estimate", value, grid, ColourScale::from_zero(found));
            vec![MapPanel { contours: outlines, ..panel }]
        }
        Some((truth, real)) => {
            let at = plane(&truth.points);
            let mask = contact.truth.as_ref().map(|truth| Grid::from_mask(&at, &truth.mask)).transpose()?;
            let own: Vec<_> = mask.into_iter().map(|mask| ("true patch".to_string(), mask, 0.5)).collect();
            let both = [outlines, own.clone()].concat();
            let truth = (truth.points.as_slice(), at.as_slice(), real);
            let [shown, real, error] =
                maps::compared(solution, (estimate, &places), truth, ColourScale::from_zero(real))?;
            vec![
                MapPanel { contours: both.clone(), ..shown },
                MapPanel { contours: own, ..real },
                MapPanel { contours: both, ..error },
            ]
        }
    };
    maps::map(prepared, solution, [0, 1], panels)
}
