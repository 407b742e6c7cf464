//! What was read of a saved answer, as a table and as a JSON object.

use nisp::Estimate;
use nisp_data::{DataError, Table};
use serde_json::{Value, json};

use super::Evaluated;

impl Evaluated {
    /// The values of a coordinate at all points.
    fn axis(&self, at: usize) -> Vec<f64> {
        self.points.iter().skip(at).step_by(self.answer.scene().coordinates.len()).copied().collect()
    }

    /// A column for each coordinate, and two for each quantity that has deviations.
    pub(super) fn table(&self) -> Result<Table, DataError> {
        let mut table = Table::empty();
        for (at, coordinate) in self.answer.scene().coordinates.iter().enumerate() {
            table.push(coordinate.name, coordinate.unit.text, &self.axis(at))?;
        }
        for estimate in &self.estimates {
            table.push(estimate.name, estimate.unit.text, &estimate.values)?;
            if let Some(deviations) = &estimate.deviations {
                table.push(&format!("{}_sd", estimate.name), estimate.unit.text, deviations)?;
            }
        }
        Ok(table)
    }

    /// The object of `--json`, on one line.
    pub(super) fn json(&self) -> String {
        let coordinates = self.answer.scene().coordinates.iter().enumerate();
        let coordinate = |(at, c): (usize, &nisp::schema::Coordinate)| json!({ "name": c.name, "unit": c.unit.text, "values": self.axis(at) });
        let parameters = self.saved.parameters().into_iter().map(|p| {
            json!({ "name": p.name, "unit": p.unit, "learned": p.learned, "value": p.value, "deviation": p.deviation })
        });
        let object = json!({
            "equation": self.saved.module(),
            "scene": self.saved.scene(),
            "status": self.saved.status(),
            "carrier": self.saved.carrier(),
            "parameters": parameters.collect::<Vec<_>>(),
            "warnings": self.warnings,
            "coordinates": coordinates.map(coordinate).collect::<Vec<_>>(),
            "values": self.estimates.iter().map(values).collect::<Vec<_>>(),
        });
        format!("{object}\n")
    }
}

fn values(estimate: &Estimate) -> Value {
    let Estimate { name, unit, values, deviations, .. } = estimate;
    json!({ "name": name, "unit": unit.text, "values": values, "deviations": deviations })
}

/// A table as text.
pub(super) fn csv(table: &Table) -> String {
    let mut bytes = Vec::new();
    // A vector takes everything.
    let _ = table.write_to(&mut bytes);
    String::from_utf8_lossy(&bytes).into_owned()
}
