//! Scores against a truth that no solver has seen.

use nisp::schema::Origin;
use nisp::{Estimate, LearnedValue, Solution, TermReport};
use nisp_equations::contact::ContactScore;
use nisp_equations::{Prepared, Truth};

/// All that is said of an answer.
pub struct Found {
    /// Against the truth, where it is known.
    pub scores: Vec<Score>,
    /// Of a contact, where the scene has one.
    pub contact: Option<ContactScore>,
    /// Share of the contact's surface that the cloud shows.
    pub seen: Option<f64>,
    /// Standard deviation of the contact's net force in newtons, where the method gives it.
    pub force_deviation: Option<f64>,
    /// What the scene learned.
    pub learned: Vec<LearnedValue>,
    /// Of every source.
    pub sizes: Vec<Size>,
    /// What is left of every equation, condition and observation.
    pub terms: Vec<TermReport>,
}

/// How large a source is, and how large its error bars are: root mean squares over the points of the answer.
pub struct Size {
    /// The source.
    pub name: &'static str,
    /// Its declared unit.
    pub unit: &'static str,
    /// Of its values.
    pub value: f64,
    /// Of its standard deviations, where the method gives them.
    pub deviation: Option<f64>,
}

impl Size {
    fn of(estimate: &Estimate) -> Self {
        let rms = |values: &Vec<f64>| (values.iter().map(|x| x * x).sum::<f64>() / values.len() as f64).sqrt();
        Self {
            name: estimate.name,
            unit: estimate.unit.text,
            value: rms(&estimate.values),
            deviation: estimate.deviations.as_ref().map(rms),
        }
    }
}

impl Found {
    /// What is said of a solution; `estimates` are its values at the points of [`Prepared`].
    pub fn of(solution: &mut Solution, prepared: &Prepared, estimates: &[Estimate]) -> Self {
        let truth = prepared.truth.as_ref();
        let scalars = solution.scene().scalars;
        let learns = scalars.iter().any(|scalar| matches!(scalar.origin, Origin::Learned { .. }));
        // Error bars take a factorisation.
        let learned = if learns { solution.learned() } else { Vec::new() };
        let terms = solution.terms();
        let solution = &*solution;
        let values = |name: &str, points: &[f64]| {
            let estimate = solution.evaluate(points).into_iter().find(|estimate| estimate.name == name);
            estimate.map(|estimate| estimate.values)
        };
        let scored = prepared.contact.as_ref().and_then(|contact| Some((contact, contact.score(&values, truth)?)));
        let force_deviation = scored.as_ref().and_then(|(contact, score)| {
            solution.deviation_of_sum(contact.pressure?, &contact.face.points, &score.per_pascal)
        });
        Self {
            scores: truth.map_or_else(Vec::new, |truth| score(solution, truth)),
            contact: scored.map(|(_, score)| score),
            seen: prepared.contact.as_ref().and_then(|contact| contact.seen(&values)),
            force_deviation,
            learned,
            sizes: estimates.iter().filter(|estimate| estimate.source).map(Size::of).collect(),
            terms,
        }
    }

    /// What could not be measured, and why.
    pub fn warnings(&self) -> Option<String> {
        let against = self.contact.as_ref()?.against.as_ref()?;
        let why = "no point, or no point of the truth, counts as touched: the patches have no distance";
        against.patch_chamfer_mm2.is_none().then(|| why.into())
    }
}

/// Mean absolute errors of one head.
pub struct Score {
    /// The head.
    pub name: &'static str,
    /// Its declared unit.
    pub unit: &'static str,
    /// Of the answer.
    pub mean_abs: f64,
    /// For a source, that of the answer zero.
    pub if_zero: Option<f64>,
}

/// Mean absolute errors of every head that the truth has, over the truth's times; sources first.
pub fn score(solution: &Solution, truth: &Truth) -> Vec<Score> {
    let scored = solution.evaluate(&truth.points).into_iter().filter_map(|estimate| {
        let values = truth.of(estimate.name)?;
        let mean = |of: &dyn Fn(usize) -> f64| (0..values.len()).map(of).sum::<f64>() / values.len() as f64;
        Some(Score {
            name: estimate.name,
            unit: estimate.unit.text,
            mean_abs: mean(&|i| (estimate.values[i] - values[i]).abs()),
            if_zero: estimate.source.then(|| mean(&|i| values[i].abs())),
        })
    });
    let mut scores: Vec<_> = scored.collect();
    scores.sort_by_key(|score| score.if_zero.is_none());
    scores
}
