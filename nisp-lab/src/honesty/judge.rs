//! Whether what was said of an answer is true.

/// Largest share of the true values that may be beyond two standard deviations; a twentieth is expected.
const BEYOND_TWO: f64 = 0.2;
/// The same beyond four, where next to nothing is expected.
const BEYOND_FOUR: f64 = 0.05;
/// Error of an unknown function without error bars, over its own mean magnitude, above which an answer is wrong.
const OFF_FUNCTION: f64 = 0.5;
/// The same of an unknown parameter.
const OFF_PARAMETER: f64 = 0.25;
/// Errors below this share of an unknown's size are rounding, whatever the bars say.
const ROUNDING: f64 = 1e-6;

/// What an answer says of an unknown, and what is true.
#[derive(Clone, Debug)]
pub(super) struct Unknown {
    pub(super) name: &'static str,
    pub(super) values: Vec<f64>,
    /// Standard deviations, where they are given.
    pub(super) deviations: Option<Vec<f64>>,
    pub(super) truth: Vec<f64>,
    /// What an error is compared with where the truth is zero.
    pub(super) size: f64,
    /// Relative error without bars above which it is wrong, if not that of all unknowns.
    pub(super) limit: Option<f64>,
}

/// How far an unknown is off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Off {
    /// Mean error over the mean magnitude of the truth.
    pub(super) error: f64,
    /// Shares of the truth beyond two and four deviations, where there are any.
    pub(super) beyond: Option<[f64; 2]>,
    /// What is wrong with it, if anything.
    wrong: Option<Wrong>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Wrong {
    /// The error is large, and no bars say so.
    Value,
    /// The bars do not cover the truth.
    Bars,
}

impl Unknown {
    pub(super) fn off(&self) -> Off {
        let count = self.truth.len().max(1) as f64;
        let mean = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / count;
        let own = mean(&mut self.truth.iter().map(|truth| truth.abs()));
        let size = if own > 0.0 { own } else { self.size };
        let errors: Vec<f64> =
            self.values.iter().zip(&self.truth).map(|(value, truth)| (value - truth).abs()).collect();
        let error = mean(&mut errors.iter().copied()) / size;
        let beyond = self.deviations.as_ref().map(|deviations| {
            [2.0, 4.0].map(|times| {
                let is_beyond = |(error, deviation): &(&f64, &f64)| {
                    // An error that is not a number is covered by nothing.
                    !(**error <= times * **deviation || **error <= ROUNDING * size)
                };
                errors.iter().zip(deviations).filter(is_beyond).count() as f64 / count
            })
        });
        let is_parameter = self.truth.len() == 1;
        let wrong = match beyond {
            // One number is beyond two deviations once in twenty.
            Some([two, four]) => ((two > BEYOND_TWO && !is_parameter) || four > BEYOND_FOUR).then_some(Wrong::Bars),
            None => {
                let limit = self.limit.unwrap_or(if is_parameter { OFF_PARAMETER } else { OFF_FUNCTION });
                (error.is_nan() || error > limit).then_some(Wrong::Value)
            }
        };
        Off { error, beyond, wrong }
    }
}

/// What is to be thought of a case.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Judgement {
    /// What is untrue of what was said, if anything.
    pub(super) lie: Option<String>,
    /// A right answer from right data that was not called right.
    pub(super) false_alarm: bool,
}

/// Judges what was said: whether the answer was called `converged`, its unknowns, the conditions that it does not meet, and
/// whether the data were right.
pub(super) fn judge(converged: bool, unknowns: &[(Unknown, Off)], unmet: &[String], sound: bool) -> Judgement {
    let of = |(unknown, off): &(Unknown, Off)| match off.wrong? {
        Wrong::Bars => Some(format!("the bars of {} do not cover it", unknown.name)),
        Wrong::Value if converged => Some(format!("{} is wrong", unknown.name)),
        Wrong::Value => None,
    };
    let condition = unmet.first().filter(|_| converged).map(|unmet| format!("unmet: {unmet}"));
    let lie = condition.or_else(|| unknowns.iter().find_map(of));
    let is_right = unmet.is_empty() && unknowns.iter().all(|(_, off)| off.wrong.is_none());
    Judgement { false_alarm: sound && is_right && !unknowns.is_empty() && !converged, lie }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An unknown that is one everywhere, off by `error` at a `share` of a hundred points.
    fn unknown(error: f64, share: usize, deviation: Option<f64>) -> (Unknown, Off) {
        let values = (0..100).map(|i| if i < share { 1.0 + error } else { 1.0 }).collect();
        let deviations = deviation.map(|deviation| vec![deviation; 100]);
        let unknown = Unknown { name: "f", values, deviations, truth: vec![1.0; 100], size: 1.0, limit: None };
        let off = unknown.off();
        (unknown, off)
    }

    fn is_lie(converged: bool, unknown: (Unknown, Off)) -> bool {
        judge(converged, &[unknown], &[], false).lie.is_some()
    }

    #[test]
    fn errors_are_means_over_the_size_of_the_truth() {
        let (_, off) = unknown(0.4, 50, Some(0.15));
        assert!((off.error - 0.2).abs() < 1e-12);
        assert_eq!(off.beyond, Some([0.5, 0.0]));
    }

    #[test]
    fn bars_that_do_not_cover_are_a_lie_whatever_the_status() {
        assert!(is_lie(false, unknown(0.3, 21, Some(0.1))));
        assert!(!is_lie(true, unknown(0.3, 19, Some(0.1))));
        assert!(is_lie(true, unknown(0.5, 6, Some(0.1))));
        assert!(!is_lie(true, unknown(0.5, 4, Some(0.1))));
    }

    #[test]
    fn a_large_error_without_bars_is_a_lie_where_it_is_called_right() {
        assert!(is_lie(true, unknown(2.0, 30, None)));
        assert!(!is_lie(false, unknown(2.0, 30, None)));
        assert!(!is_lie(true, unknown(2.0, 20, None)));
        assert!(is_lie(true, unknown(f64::NAN, 1, None)));
    }

    #[test]
    fn a_parameter_is_wrong_beyond_four_deviations() {
        let parameter = |deviation: f64| {
            let unknown = Unknown {
                name: "k",
                values: vec![1.3],
                deviations: Some(vec![deviation]),
                truth: vec![1.0],
                size: 1.0,
                limit: None,
            };
            let off = unknown.off();
            (unknown, off)
        };
        assert!(!is_lie(true, parameter(0.1)) && is_lie(true, parameter(0.07)));
    }

    #[test]
    fn a_condition_that_is_not_met_is_a_lie_where_the_answer_is_called_right() {
        let unmet = ["f at 0".to_string()];
        assert!(judge(true, &[unknown(0.0, 0, None)], &unmet, true).lie.is_some());
        let doubted = judge(false, &[unknown(0.0, 0, None)], &unmet, true);
        assert_eq!((doubted.lie, doubted.false_alarm), (None, false));
    }

    #[test]
    fn a_false_alarm_takes_right_data_and_a_right_answer() {
        assert!(judge(false, &[unknown(0.1, 100, None)], &[], true).false_alarm);
        assert!(!judge(true, &[unknown(0.1, 100, None)], &[], true).false_alarm);
        assert!(!judge(false, &[unknown(0.1, 100, None)], &[], false).false_alarm);
        assert!(!judge(false, &[unknown(0.9, 100, None)], &[], true).false_alarm);
        assert!(!judge(false, &[], &[], true).false_alarm);
    }
}
