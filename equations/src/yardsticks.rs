//! What every result is compared with: the answer zero and the classical rivals, over several samples.

use std::time::Instant;

use nisp_data::overlap::intersection_over_union;

use crate::prepared::Prepared;
use crate::rivals::{mean_abs_error, zero_error};

/// How well, and how fast, a simpler way does.
#[derive(Clone, Debug, PartialEq)]
pub struct Yardstick {
    /// Its name in tables.
    pub name: String,
    /// Mean absolute error of the source in its declared unit: the mean over samples.
    pub error: f64,
    /// Intersection over union of the touched points, where the source is the pressure of a contact: the mean over samples.
    pub overlap: Option<f64>,
    /// Seconds a sample.
    pub seconds: f64,
}

/// The yardsticks of samples whose truth is known.
pub fn yardsticks(samples: &[Prepared]) -> Vec<Yardstick> {
    let mut found: Vec<Yardstick> = Vec::new();
    let mut add = |new: Yardstick| match found.iter_mut().find(|own| own.name == new.name) {
        Some(own) => {
            own.error += new.error;
            own.overlap = own.overlap.zip(new.overlap).map(|(own, new)| own + new);
            own.seconds += new.seconds;
        }
        None => found.push(new),
    };
    for sample in samples {
        let heads = sample.problem.scene().schema.heads;
        for head in heads.iter().filter(|head| head.source) {
            let known = sample.truth.as_ref().and_then(|truth| Some((&truth.points, truth.of(head.name)?)));
            let Some((at, truth)) = known else { continue };
            let contact = sample.contact.as_ref().filter(|contact| contact.pressure == Some(head.name));
            let overlap = |pressure: &[f64]| {
                let (rule, real) = contact.and_then(|contact| Some((contact.rule, contact.truth.as_ref()?)))?;
                intersection_over_union(&rule.mask(pressure), &real.mask).ok()
            };
            let nothing = overlap(&vec![0.0; truth.len()]);
            add(Yardstick {
                name: format!("{} = 0", head.name),
                error: zero_error(truth),
                overlap: nothing,
                seconds: 0.0,
            });
            // Rivals that cannot answer have no row in a table.
            for answer in sample.contest(at, truth).unwrap_or_default() {
                let error = mean_abs_error(&answer.source, truth);
                add(Yardstick { name: answer.name.into(), error, overlap: None, seconds: answer.wall_s });
            }
            if let Some(way) = contact.and_then(|contact| contact.rival.as_ref()) {
                let start = Instant::now();
                let pressure = (way.pressure)(at);
                let seconds = start.elapsed().as_secs_f64();
                let error = mean_abs_error(&pressure, truth);
                add(Yardstick { name: way.name.into(), error, overlap: overlap(&pressure), seconds });
            }
        }
    }
    let count = samples.len() as f64;
    for own in &mut found {
        own.error /= count;
        own.overlap = own.overlap.map(|sum| sum / count);
        own.seconds /= count;
    }
    found
}
