//! What every result is compared with: the answer zero and the classical rivals, over several samples.

use std::time::Instant;

use crate::catalogue::Prepared;
use crate::rivals::{mean_abs_error, zero_error};

/// How well, and how fast, a simpler way does.
#[derive(Clone, Debug, PartialEq)]
pub struct Yardstick {
    /// Its name in tables.
    pub name: String,
    /// Mean absolute error of the source in its declared unit: the mean over samples.
    pub error: f64,
    /// Seconds a sample.
    pub seconds: f64,
}

/// The yardsticks of samples whose truth is known.
pub fn yardsticks(samples: &[Prepared]) -> Vec<Yardstick> {
    let mut found: Vec<Yardstick> = Vec::new();
    let mut add = |name: String, error: f64, seconds: f64| match found.iter_mut().find(|own| own.name == name) {
        Some(own) => (own.error, own.seconds) = (own.error + error, own.seconds + seconds),
        None => found.push(Yardstick { name, error, seconds }),
    };
    for sample in samples {
        let heads = sample.problem.scene().schema.heads;
        for head in heads.iter().filter(|head| head.source) {
            let known = sample.truth.as_ref().and_then(|truth| Some((&truth.points, truth.of(head.name)?)));
            let Some((at, truth)) = known else { continue };
            add(format!("{} = 0", head.name), zero_error(truth), 0.0);
            for answer in sample.contest(at, truth) {
                add(answer.name.into(), mean_abs_error(&answer.source, truth), answer.wall_s);
            }
            let contact = sample.contact.as_ref().filter(|contact| contact.pressure == Some(head.name));
            if let Some(way) = contact.and_then(|contact| contact.rival.as_ref()) {
                let start = Instant::now();
                let pressure = (way.pressure)(at);
                add(way.name.into(), mean_abs_error(&pressure, truth), start.elapsed().as_secs_f64());
            }
        }
    }
    let count = samples.len() as f64;
    found.iter_mut().for_each(|own| (own.error, own.seconds) = (own.error / count, own.seconds / count));
    found
}
