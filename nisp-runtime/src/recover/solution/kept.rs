//! The answer for a file.

use super::{LearnedValue, Solution};
use crate::saved::{Extent, SavedAnswer, SavedError, save_frame};
use crate::schema::Origin;
use crate::units::Number;

impl Solution {
    /// The answer for a file: the equation, what was given and learned, what carries the heads with what deviations follow from,
    /// and what is said of it. Reading it takes no data.
    ///
    /// # Errors
    /// Numbers that are not finite; a scene that does not know the text of its equation.
    pub fn saved(&mut self) -> Result<SavedAnswer, SavedError> {
        let scene = self.bound.problem.scene();
        if scene.text.is_empty() {
            return Err(SavedError::NoText);
        }
        let frame = self.bound.frame();
        let state = self.carried.kept(self.has_bars()).save();
        let mut state = Extent::of(&frame, &self.bound.coordinates).save(save_frame(&frame, state));
        let words = [
            ("equation", scene.text),
            ("module", scene.schema.module),
            ("scene", scene.schema.name),
            ("status", self.status.name()),
            ("version", env!("CARGO_PKG_VERSION")),
        ];
        let failed = self.verdict.failed().map(|check| ("failed", check.message.as_str()));
        let warnings = self.warnings.iter().map(|warning| ("warning", warning.message.as_str()));
        let said = words.into_iter().chain(failed).chain(warnings);
        let mut texts: Vec<(String, String)> = said.map(|(name, text)| (name.into(), text.into())).collect();
        for (slot, scalar) in scene.schema.scalars.iter().enumerate() {
            if matches!(scalar.origin, Origin::Given(_)) {
                let key = format!("given {}", scalar.name);
                let value = frame.system.outward(&scalar.unit).of(Number::engine(frame.scalars[slot]));
                state = state.with(&key, &[value.as_declared()]);
                texts.push((key, scalar.unit.text.into()));
            }
        }
        for LearnedValue { name, unit, value, deviation } in self.learned() {
            let numbers: Vec<f64> = [value].into_iter().chain(deviation).collect();
            let key = format!("learned {name}");
            state = state.with(&key, &numbers);
            texts.push((key, unit.text.into()));
        }
        SavedAnswer::new(texts, state)
    }
}
