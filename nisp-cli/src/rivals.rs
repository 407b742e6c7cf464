//! What classical methods find of the same data, where `--rivals` asks for them.

use nisp_equations::contact::ContactScore;
use nisp_equations::rivals::{RivalError, mean_abs_error};
use nisp_equations::{Contact, Prepared, Truth};

/// What classical methods find.
#[derive(Default)]
pub(crate) struct Rivals {
    /// Of sources whose truth is known.
    pub(crate) errors: Vec<Error>,
    /// Of a contact: the method and its score.
    pub(crate) contact: Option<(&'static str, ContactScore)>,
    /// Why there is none.
    pub(crate) none: Option<String>,
}

/// A method's mean absolute error of a source.
pub(crate) struct Error {
    pub(crate) source: &'static str,
    pub(crate) method: &'static str,
    pub(crate) mean_abs: f64,
}

impl Rivals {
    /// Asks all that know the scene.
    pub(crate) fn of(prepared: &Prepared) -> Self {
        let found = match (&prepared.contact, &prepared.rival) {
            (Some(contact), _) => Self::of_contact(contact, prepared.truth.as_ref()),
            (None, Some(_)) => Self::of_sources(prepared),
            (None, None) => Err(RivalError::Unknown.to_string()),
        };
        found.unwrap_or_else(|why| Self { none: Some(why), ..Self::default() })
    }

    fn of_contact(contact: &Contact, truth: Option<&Truth>) -> Result<Self, String> {
        let (source, way) = contact.pressure.zip(contact.rival.as_ref()).ok_or("none knows this contact")?;
        let values = |name: &str, points: &[f64]| (name == source).then(|| (way.pressure)(points));
        let real = truth.and_then(|truth| Some((truth, truth.of(source)?)));
        let error = real.map(|(truth, real)| {
            let mean_abs = mean_abs_error(&(way.pressure)(&truth.points), real);
            Error { source, method: way.name, mean_abs }
        });
        let score = contact.score(&values, truth).map(|score| (way.name, score));
        Ok(Self { errors: error.into_iter().collect(), contact: score, none: None })
    }

    fn of_sources(prepared: &Prepared) -> Result<Self, String> {
        let truth = prepared.truth.as_ref().ok_or("they are scored against a truth; give it with --truth FILE")?;
        let mut errors = Vec::new();
        for head in prepared.problem.scene().schema.heads.iter().filter(|head| head.source) {
            let Some(real) = truth.of(head.name) else { continue };
            let answers = prepared.contest(&truth.points, real).map_err(|why| why.to_string())?;
            errors.extend(answers.into_iter().map(|answer| Error {
                source: head.name,
                method: answer.name,
                mean_abs: mean_abs_error(&answer.source, real),
            }));
        }
        errors.retain(|error| error.mean_abs.is_finite());
        Ok(Self { errors, ..Self::default() })
    }
}
