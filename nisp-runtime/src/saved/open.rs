//! A saved answer with its scene: values and deviations anywhere, without the data.

use super::extent::Extent;
use super::kept::restored;
use super::{SavedAnswer, SavedError, fingerprint};
use crate::bounds::are_derived;
use crate::carrier::{Estimate, Kept, Outputs};
use crate::engine::{Learned, LearnedMap, Scaling};
use crate::kernel::SceneRef;
use crate::problem::{Frame, UnitSystem};
use crate::schema::{self, Origin};
use crate::solve::fault::Fault;
use crate::solve::state::State;
use crate::units::Number;

/// An answer that can be asked for values.
pub struct OpenAnswer {
    frame: Frame,
    kept: Box<dyn Kept>,
    extent: Extent,
}

impl SavedAnswer {
    /// The answer with its scene, which may be compiled or read from [`SavedAnswer::equation`].
    ///
    /// # Errors
    /// Another scene, or one whose quantities have changed since; a file whose numbers do not belong together.
    pub fn open(&self, scene: SceneRef) -> Result<OpenAnswer, SavedError> {
        let schema = scene.schema;
        if (self.module(), self.scene()) != (schema.module, schema.name) {
            let given = format!("{}, scene {}", schema.module, schema.name);
            return Err(SavedError::Scene { saved: format!("{}, scene {}", self.module(), self.scene()), given });
        }
        if self.state.counter("fingerprint").ok() != Some(fingerprint(schema)) {
            return Err(SavedError::Changed(self.module().into()));
        }
        let damaged = |_: Fault| SavedError::Damaged;
        let frame = restored_frame(&self.state, scene).map_err(damaged)?;
        let kept = restored(&self.state, &frame).map_err(damaged)?;
        let extent = Extent::restored(&self.state, schema).map_err(damaged)?;
        Ok(OpenAnswer { frame, kept, extent })
    }
}

impl OpenAnswer {
    /// The scene, whose outputs are what [`OpenAnswer::evaluate`] gives.
    pub fn scene(&self) -> &'static schema::Scene {
        self.frame.scene.schema
    }

    /// The text of its equation.
    pub fn text(&self) -> &'static str {
        self.frame.scene.text
    }

    /// The same answer asked for more: `scene` has the same quantities and further rows among its outputs.
    ///
    /// # Errors
    /// Rows that read what the answer does not have, or derivatives that its carrier does not have.
    pub fn asked(mut self, scene: SceneRef) -> Result<Self, SavedError> {
        self.frame = asked_frame(&self.frame, scene)?;
        let (schema, degrees) = (scene.schema, self.kept.degrees());
        for term in schema.outputs.terms {
            for jet in term.jets.iter().map(|&at| &schema.outputs.jets[at]) {
                let head = &schema.heads[jet.head];
                let order = jet.operator.iter().flat_map(|(by, _)| by.iter().copied().max()).max().unwrap_or(0).into();
                let (name, called) = (term.name.to_string(), head.name.to_string());
                match degrees.as_ref().map(|degrees| degrees[jet.head]) {
                    Some(_) if order > 0 && head.transformed && head.source => {
                        return Err(SavedError::Kink { name, head: called });
                    }
                    Some(_) if head.transformed && !are_derived(&schema.outputs, schema) => {
                        return Err(SavedError::Bounded { name, head: called });
                    }
                    Some(degree) if order > 0 && order >= degree => {
                        return Err(SavedError::Order { name, head: called, order, degree });
                    }
                    _ => {}
                }
            }
        }
        Ok(self)
    }

    /// Lower and upper end of each coordinate over the points that the answer was found from, in declared units.
    pub fn ranges(&self) -> &[[f64; 2]] {
        &self.extent.ranges
    }

    /// True for a point, in declared units, that lies among those that the answer was found from: within the range of every
    /// coordinate and the convex hull over every two. What is read elsewhere is extrapolated and means nothing.
    pub fn contains(&self, point: &[f64]) -> bool {
        self.extent.contains(point)
    }

    /// Every head, and what was asked for beside, at points given in declared units, point by point, with standard deviations
    /// where the answer has any.
    pub fn evaluate(&self, points: &[f64]) -> Vec<Estimate> {
        let schema = self.scene();
        let Outputs { values, deviations } = self.kept.outputs(&self.frame, &self.frame.inward(points));
        let count = points.len() / schema.coordinates.len().max(1);
        let rows = schema
            .outputs
            .terms
            .iter()
            .flat_map(|term| (term.first..term.first + term.rows).map(move |row| (term, row)));
        let estimate = |(term, row): (&schema::Term, usize)| {
            let outward = self.frame.system.outward(&term.unit);
            let outward = |x: &f64| outward.of(Number::engine(*x)).as_declared();
            let own = |all: &[f64]| all[row * count..][..count].iter().map(outward).collect::<Vec<f64>>();
            let head = schema.heads.get(row).filter(|head| head.name == term.name);
            Estimate {
                name: term.name,
                unit: term.unit,
                source: head.is_some_and(|head| head.source),
                values: own(&values),
                deviations: deviations.as_deref().map(own),
                by_prior: None,
            }
        };
        rows.map(estimate).collect()
    }
}

/// What [`restored_frame`] reads, beside what the state has already.
pub(crate) fn save_frame(frame: &Frame, state: State) -> State {
    let map = |learned: &Learned| match learned.map {
        LearnedMap::Positive(start) => [0.0, start, 0.0, 0.0],
        LearnedMap::Linear(start, scale) => [1.0, start, scale, 0.0],
        LearnedMap::Between(lower, upper, shift) => [2.0, lower, upper, shift],
    };
    let maps: Vec<f64> = frame.learned.iter().flat_map(map).collect();
    let Scaling { centre, half, offset, scale } = &frame.scaling;
    state
        .with("units", frame.system.logs())
        .with("frame centre", centre)
        .with("frame half", half)
        .with("frame offset", offset)
        .with("frame scale", scale)
        .with("scalars", &frame.scalars)
        .with("learned maps", &maps)
        .with_counter("fingerprint", fingerprint(frame.scene.schema))
}

fn restored_frame(state: &State, scene: SceneRef) -> Result<Frame, Fault> {
    let schema = scene.schema;
    let (inputs, heads) = (schema.coordinates.len(), schema.heads.len());
    let scaling = Scaling {
        centre: state.sized("frame centre", inputs)?,
        half: state.sized("frame half", inputs)?,
        offset: state.sized("frame offset", heads)?,
        scale: state.sized("frame scale", heads)?,
    };
    let slots = learned_slots(schema);
    let maps = state.sized::<f64>("learned maps", 4 * slots.len())?;
    let learned = slots.into_iter().zip(maps.as_chunks::<4>().0).map(|(slot, &[kind, a, b, c])| {
        let map = match kind as u8 {
            0 => LearnedMap::Positive(a),
            1 => LearnedMap::Linear(a, b),
            2 => LearnedMap::Between(a, b, c),
            _ => return Err(Fault::state("learned maps")),
        };
        Ok(Learned { slot, map })
    });
    Ok(Frame {
        scene,
        system: UnitSystem::of_logs(state.scalars("units")?),
        scaling,
        scalars: state.sized("scalars", schema.scalars.len())?,
        learned: learned.collect::<Result<_, Fault>>()?,
    })
}

/// The frame for a scene with more outputs: its scalars may stand in another order, and more of them may be read.
fn asked_frame(frame: &Frame, scene: SceneRef) -> Result<Frame, SavedError> {
    let (own, schema) = (frame.scene.schema, scene.schema);
    let names = |schema: &schema::Scene| schema.heads.iter().map(|head| head.name).collect::<Vec<_>>();
    if let Some(reads) = names(schema).into_iter().find(|name| !names(own).contains(name)) {
        let head = schema.heads.iter().position(|head| head.name == reads);
        let reader = schema
            .outputs
            .terms
            .iter()
            .rev()
            .find(|term| term.jets.iter().any(|&jet| Some(schema.outputs.jets[jet].head) == head));
        return Err(SavedError::Absent { name: reader.map_or(reads, |term| term.name).into(), reads: reads.into() });
    }
    let same = |scalar: &schema::Scalar| {
        let known = own.scalars.iter().position(|other| match scalar.origin {
            Origin::HeadScale(_) | Origin::SideScale { .. } => other.origin == scalar.origin,
            _ => !scalar.name.is_empty() && other.name == scalar.name,
        });
        match (known, scalar.origin) {
            (Some(slot), _) => Ok(frame.scalars[slot]),
            (None, Origin::Literal(value) | Origin::Given(Some(value))) => {
                Ok(frame.system.size(&scalar.unit).back(value).as_engine())
            }
            (None, Origin::SideScale { .. }) => Ok(1.0),
            (None, Origin::HeadScale(head)) => Ok(frame.scaling.scale[head]),
            (None, Origin::Given(None) | Origin::Learned { .. }) => Err(SavedError::NoValue(scalar.name.into())),
        }
    };
    let scalars = schema.scalars.iter().map(same).collect::<Result<Vec<f64>, SavedError>>()?;
    let slots = learned_slots(schema);
    if slots.len() != frame.learned.len() {
        return Err(SavedError::Changed(schema.module.into()));
    }
    let learned = slots.into_iter().zip(&frame.learned).map(|(slot, learned)| Learned { slot, ..learned.clone() });
    Ok(Frame { scene, scalars, learned: learned.collect(), ..frame.clone() })
}

/// Slots of the learned scalars.
fn learned_slots(schema: &schema::Scene) -> Vec<usize> {
    let is_learned = |slot: &usize| matches!(schema.scalars[*slot].origin, Origin::Learned { .. });
    (0..schema.scalars.len()).filter(is_learned).collect()
}
