//! Natural sizes from units, domain and data, so that no user rescales a modulus by hand.
//!
//! Observed heads take offset and scale from their data. The others take theirs from the balance of an equation: the
//! size that makes their term as large as the rest of it; sources that only occur together, each that size. Rows are then
//! divided by the sum of their terms' sizes.

use super::probe::{Data, Probe};
use crate::ends::ranges;
use crate::engine::Scaling;
use crate::kernel::SceneRef;
use crate::levels::without_levels;
use crate::network::Inputs;
use crate::schema::{self, Origin, TermKind};

/// What [`scales`] finds.
pub(super) struct Scales {
    pub(super) scaling: Scaling,
    /// By group and term.
    pub(super) sizes: Vec<Vec<f64>>,
}

/// Finds natural sizes; fills in the scalars that hold them.
pub(super) fn scales(scene: &SceneRef, scalars: &mut [f64], data: Data<'_>, inputs: Inputs) -> Scales {
    let schema = scene.schema;
    let (centre, whole) = extents(schema, data.coordinates);
    // Derivatives are sized by the steepest change that is expected, not by the whole range.
    let steepness = inputs.steepness(whole.len());
    let half: Vec<f64> = whole.iter().map(|half| half / steepness).collect();
    let probes: Vec<Probe> = scene
        .double()
        .into_iter()
        .zip(schema.groups)
        .enumerate()
        .map(|(at, (kernel, group))| Probe::new(kernel, group, data, at, half.len()))
        .collect();
    // Between two bounds there is nothing to find.
    let between = |head: &schema::Head| head.lower.and(head.upper).map(|_| (0.0, 1.0));
    let mut heads: Vec<Option<(f64, f64)>> = schema.heads.iter().map(between).collect();
    for (probe, clouds) in probes.iter().zip(data.clouds) {
        probe.observe(schema, scalars, clouds, &mut heads);
    }
    // One that is missing alone first: elsewhere it may be one of several.
    for together in [false, true] {
        // Every pass settles at least one head or is the last.
        for _ in 0..schema.heads.len() {
            for probe in &probes {
                probe.balance(schema, scalars, &half, together, &mut heads);
            }
        }
    }
    let found: Vec<(f64, f64)> = heads.iter().map(|h| h.unwrap_or((0.0, 1.0))).collect();
    for (scalar, value) in schema.scalars.iter().zip(scalars.iter_mut()) {
        if let Origin::HeadScale(head) = scalar.origin {
            *value = found[head].1;
        }
    }
    for (slot, scalar) in schema.scalars.iter().enumerate() {
        if let Origin::SideScale { group, term, .. } = scalar.origin {
            scalars[slot] = probes[group].side(schema, scalars, slot, (group, term), &half, &found);
        }
    }
    let sizes = probes.iter().map(|probe| probe.sizes(schema, scalars, &half, &found)).collect();
    let free = |head: usize, value: f64, otherwise: f64| if schema.heads[head].transformed { otherwise } else { value };
    let scaling = Scaling {
        centre,
        half: whole,
        offset: found.iter().enumerate().map(|(h, s)| free(h, s.0, 0.0)).collect(),
        scale: found.iter().enumerate().map(|(h, s)| free(h, s.1, 1.0)).collect(),
    };
    Scales { scaling, sizes }
}

/// Middle and half extent of every coordinate; the extent is shared within a scale group.
fn extents(schema: &schema::Scene, coordinates: &[Vec<f64>]) -> (Vec<f64>, Vec<f64>) {
    let inputs = schema.coordinates.len();
    let ranges = ranges(coordinates, inputs);
    let half = |i: usize| {
        let group = schema.coordinates[i].scale_group;
        let tied = (0..inputs).filter(|&j| schema.coordinates[j].scale_group == group);
        let half = tied.map(|j| (ranges[j].1 - ranges[j].0) / 2.0).fold(0.0, f64::max);
        if half > 0.0 { half } else { 1.0 }
    };
    (ranges.iter().map(|(low, high)| (low + high) / 2.0).collect(), (0..inputs).map(half).collect())
}

impl Probe {
    /// Offset and scale of heads that a row observes directly: it depends on the head's value and nothing else.
    fn observe(&self, scene: &schema::Scene, scalars: &[f64], clouds: &[Vec<f64>], heads: &mut [Option<(f64, f64)>]) {
        let zero = self.jets(|_| 0.0);
        let rows = self.rows(&zero, scalars, false);
        for (term, cloud) in self.schema.terms.iter().zip(clouds) {
            for (i, row) in (term.first..term.first + term.rows).enumerate() {
                let without = &rows[row * self.stride..][..self.count];
                let measured: Vec<f64> = match term.kind {
                    TermKind::Observation => without.iter().map(|x| -x).collect(),
                    // A coordinate of the surface that is the same everywhere but for the head.
                    TermKind::Chamfer { .. } if without.iter().all(|x| *x == without[0]) => {
                        cloud.iter().skip(i).step_by(term.rows).map(|x| x - without[0]).collect()
                    }
                    _ => Vec::new(),
                };
                let slopes = self.sensitivities(row, &zero, scalars);
                let read: Vec<usize> =
                    (0..self.schema.jets.len()).filter(|&j| self.rms(&slopes[j * self.stride..]) > 0.0).collect();
                let [jet] = read[..] else { continue };
                let head = self.schema.jets[jet].head;
                let is_value = self.schema.jets[jet].is_value();
                if !is_value || heads[head].is_some() || scene.heads[head].transformed {
                    continue;
                }
                if scene.heads[head].hard {
                    // Where the condition holds the output does not count, and could be anything.
                    let square = measured.iter().map(|x| x * x).sum::<f64>() / measured.len().max(1) as f64;
                    let scale = square.sqrt() / self.rms(&slopes[jet * self.stride..]);
                    heads[head] = (scale > 0.0 && scale.is_finite()).then_some((0.0, scale));
                    continue;
                }
                let slope = |at: usize| slopes[jet * self.stride + at % self.count];
                let values = measured.iter().enumerate().map(|(at, x)| x / slope(at)).filter(|x| x.is_finite());
                heads[head] = spread(values);
            }
        }
    }

    /// Scales of heads that are the only unknown of some row, or sources that are its unknowns together.
    fn balance(
        &self,
        scene: &schema::Scene,
        scalars: &[f64],
        half: &[f64],
        together: bool,
        heads: &mut [Option<(f64, f64)>],
    ) {
        for term in self.schema.terms.iter().filter(|t| matches!(t.kind, TermKind::Residual | TermKind::Observation)) {
            for row in term.first..term.first + term.rows {
                let jets = |unknown: f64| {
                    self.jets(|jet| match heads[jet.head] {
                        Some(_) if scene.heads[jet.head].transformed => typical(jet, half, (0.0, 1.0)),
                        Some(found) => typical(jet, half, found),
                        None => unknown,
                    })
                };
                let scales = |unknown: f64| -> Vec<f64> {
                    let scale = |(scalar, &value): (&schema::Scalar, &f64)| match scalar.origin {
                        Origin::HeadScale(head) => heads[head].map_or(unknown, |found| found.1),
                        _ => value,
                    };
                    scene.scalars.iter().zip(scalars).map(scale).collect()
                };
                let slopes = self.sensitivities(row, &jets(1e-3), &scales(1.0));
                let pull = |head: usize| -> f64 {
                    let jets = self.schema.jets.iter().enumerate().filter(|(_, jet)| jet.head == head);
                    jets.map(|(j, jet)| self.rms(&slopes[j * self.stride..]) * typical(jet, half, (0.0, 1.0))).sum()
                };
                let unknown: Vec<(usize, f64)> = (0..heads.len())
                    .filter(|&head| heads[head].is_none())
                    .map(|head| (head, pull(head)))
                    .filter(|&(_, pull)| pull > 0.0 && pull.is_finite())
                    .collect();
                let is_source = |&(head, _): &(usize, f64)| scene.heads[head].source;
                if unknown.is_empty() || unknown.len() > 1 && !(together && unknown.iter().all(is_source)) {
                    continue;
                }
                let known = |head: usize| match heads[head] {
                    Some(_) if scene.heads[head].transformed => (0.0, 1.0),
                    found => found.unwrap_or((0.0, 0.0)),
                };
                let rest = self.size(row, &scales(0.0), half, known);
                if rest > 0.0 && rest.is_finite() {
                    unknown.into_iter().for_each(|(head, pull)| heads[head] = Some((0.0, rest / pull)));
                }
            }
        }
    }

    /// Size of a row where heads have these offsets and scales: of all that it adds up, without levels that cancel.
    fn size(&self, row: usize, scalars: &[f64], half: &[f64], found: impl Fn(usize) -> (f64, f64)) -> f64 {
        let own = |rows: &[f64]| self.rms(&rows[row * self.stride..]);
        let jets = self.jets(|jet| typical(jet, half, found(jet.head)));
        let at_levels = self.jets(|jet| if jet.is_value() { found(jet.head).0 } else { 0.0 });
        let slopes = self.sensitivities(row, &jets, scalars);
        let varied = self
            .schema
            .jets
            .iter()
            .enumerate()
            .map(|(j, jet)| self.rms(&slopes[j * self.stride..]) * typical(jet, half, (0.0, found(jet.head).1)));
        let varying = own(&self.rows(&at_levels, scalars, false)) + varied.sum::<f64>();
        without_levels(own(&self.rows(&jets, scalars, true)), varying)
    }

    /// Natural size of one side of a complementarity: with the other side out of the way, the magnitude of
    /// `a + b - sqrt(a^2 + b^2)` is twice the side over its scale.
    fn side(
        &self,
        scene: &schema::Scene,
        scalars: &[f64],
        slot: usize,
        place: (usize, usize),
        half: &[f64],
        heads: &[(f64, f64)],
    ) -> f64 {
        // Far from the tiny number that keeps the root off its kink, too.
        const AWAY: f64 = 1e30;
        let mut scalars = scalars.to_vec();
        for (at, scalar) in scene.scalars.iter().enumerate() {
            match scalar.origin {
                Origin::SideScale { group, term, .. } if (group, term) == place => scalars[at] = AWAY,
                _ => {}
            }
        }
        scalars[slot] = 1.0 / AWAY;
        let jets = self.jets(|jet| typical(jet, half, network(scene, heads, jet.head)));
        let row = self.schema.terms[place.1].first;
        let size = self.rms(&self.rows(&jets, &scalars, true)[row * self.stride..]) / (2.0 * AWAY);
        if size > 0.0 && size.is_finite() { size } else { 1.0 }
    }

    /// Natural sizes of the group's terms.
    fn sizes(&self, scene: &schema::Scene, scalars: &[f64], half: &[f64], heads: &[(f64, f64)]) -> Vec<f64> {
        let jets = self.jets(|jet| typical(jet, half, network(scene, heads, jet.head)));
        let size = |term: &schema::Term| -> f64 {
            let square: f64 = (term.first..term.first + term.rows)
                .map(|row| match term.kind {
                    // Data may sit far from zero; what counts is how far they spread.
                    TermKind::Observation | TermKind::Chamfer { .. } => {
                        let slopes = self.sensitivities(row, &jets, scalars);
                        let parts = self.schema.jets.iter().enumerate().map(|(j, jet)| {
                            let scale = network(scene, heads, jet.head).1;
                            self.rms(&slopes[j * self.stride..]) * typical(jet, half, (0.0, scale))
                        });
                        parts.sum::<f64>()
                    }
                    // Conditions on values state the level themselves.
                    _ if self.schema.is_of_values(term) => {
                        self.rms(&self.rows(&jets, scalars, true)[row * self.stride..])
                    }
                    _ => self.size(row, scalars, half, |head| network(scene, heads, head)),
                })
                .map(|size| size * size)
                .sum();
            let size = (square / term.rows.max(1) as f64).sqrt();
            if size > 0.0 && size.is_finite() { size } else { 1.0 }
        };
        self.schema.terms.iter().map(size).collect()
    }
}

/// What a head's own output looks like: transformed heads are of the order of one.
fn network(scene: &schema::Scene, heads: &[(f64, f64)], head: usize) -> (f64, f64) {
    if scene.heads[head].transformed { (0.0, 1.0) } else { heads[head] }
}

/// Typical magnitude of a jet of a head with this offset and scale.
fn typical(jet: &schema::Jet, half: &[f64], (offset, scale): (f64, f64)) -> f64 {
    let shrink: f64 = jet.degree.iter().zip(half).map(|(&n, half)| half.powi(i32::from(n))).product();
    if jet.is_value() { offset.abs() + scale } else { scale / shrink }
}

/// Mean and standard deviation; constant data take their own size as scale.
fn spread(values: impl Iterator<Item = f64> + Clone) -> Option<(f64, f64)> {
    let count = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / count;
    let deviation = (values.map(|x| (x - mean) * (x - mean)).sum::<f64>() / count).sqrt();
    let scale = if deviation > 1e-12 * mean.abs() { deviation } else { mean.abs() };
    (count > 0.0 && scale > 0.0 && scale.is_finite()).then_some((mean, scale))
}
