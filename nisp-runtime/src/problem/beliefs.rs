//! What is believed of learned parameters: a group that is bound by itself.

use super::{Binding, Points, Problem};

impl Problem {
    /// The same problem with the group of beliefs bound: one point, anywhere, where each parameter's given value is
    /// measured. A parameter without a value is reported where all of them are.
    pub(super) fn with_beliefs(mut self) -> Self {
        let schema = self.scene.schema;
        let Some(at) = schema.groups.iter().position(|group| group.is_beliefs()) else { return self };
        let given = |name: &str| {
            let slot = schema.scalars.iter().position(|scalar| scalar.name == name)?;
            Some(schema.scalars[slot].unit.factor.back(self.scalars[slot]?).as_declared())
        };
        let columns = schema.groups[at].columns.iter().map(|column| vec![given(column.name).unwrap_or(0.0)]).collect();
        // Any point will do: beliefs read no coordinate.
        let first =
            self.groups.iter().flatten().find_map(|binding| binding.points.coordinates.get(..schema.coordinates.len()));
        let points = Points::from(first.unwrap_or_default());
        self.groups[at] = Some(Binding { points, columns, ..Binding::default() });
        self
    }
}
