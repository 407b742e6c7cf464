//! Tables of simulated measurements.

/// A table of exact measurements.
#[derive(Clone, Default)]
pub(super) struct Samples {
    pub(super) columns: Vec<Column>,
}

/// A column of a table.
#[derive(Clone)]
pub(super) struct Column {
    pub(super) name: &'static str,
    pub(super) values: Vec<f64>,
    /// False for places and times, which have no noise.
    pub(super) measured: bool,
    /// Standard deviation of its noise; without one, the experiment's share of its spread.
    pub(super) noise: Option<f64>,
}

impl Samples {
    /// With a column of places or times.
    pub(super) fn at(mut self, name: &'static str, values: Vec<f64>) -> Self {
        self.columns.push(Column { name, values, measured: false, noise: None });
        self
    }

    /// With a measured column.
    pub(super) fn of(mut self, name: &'static str, values: Vec<f64>) -> Self {
        self.columns.push(Column { name, values, measured: true, noise: None });
        self
    }

    pub(super) fn rows(&self) -> usize {
        self.columns.first().map_or(0, |column| column.values.len())
    }

    /// The place of a column, which is there by construction of the cases.
    pub(super) fn index(&self, name: &str) -> usize {
        self.columns.iter().position(|column| column.name == name).unwrap_or_default()
    }

    pub(super) fn change(&mut self, name: &str, change: impl Fn(f64) -> f64) {
        let at = self.index(name);
        self.columns[at].values.iter_mut().for_each(|value| *value = change(*value));
    }

    pub(super) fn keep(&mut self, keep: impl Fn(usize) -> bool) {
        for column in &mut self.columns {
            let mut row = 0;
            column.values.retain(|_| {
                row += 1;
                keep(row - 1)
            });
        }
    }

    /// Places or times, row by row.
    pub(super) fn places(&self) -> Vec<f64> {
        let places: Vec<&Column> = self.columns.iter().filter(|column| !column.measured).collect();
        (0..self.rows()).flat_map(|row| places.iter().map(move |column| column.values[row])).collect()
    }

    /// Measured columns.
    pub(super) fn measured(&self) -> Vec<Vec<f64>> {
        self.columns.iter().filter(|column| column.measured).map(|column| column.values.clone()).collect()
    }
}
