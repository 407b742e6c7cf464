//! Points in flat storage, as the engine wants them.

/// Points of one dimension, with normals and weights where they have any.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Points {
    /// Coordinates per point.
    pub dim: usize,
    /// Point by point: `coords[i * dim + axis]`.
    pub coords: Vec<f64>,
    /// Outward unit normals, laid out as the coordinates; only on boundaries.
    pub normals: Option<Vec<f64>>,
    /// What each point stands for in an integral.
    pub weights: Option<Vec<f64>>,
}

impl Points {
    /// How many points.
    pub fn len(&self) -> usize {
        self.coords.len().checked_div(self.dim).unwrap_or(0)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Adds a point with its normal and weight.
    pub(super) fn add(&mut self, point: &[f64], normal: &[f64], weight: f64) {
        self.coords.extend(point);
        self.normals.get_or_insert_default().extend(normal);
        self.weights.get_or_insert_default().push(weight);
    }

    /// Point by point.
    pub fn iter(&self) -> std::slice::ChunksExact<'_, f64> {
        self.coords.chunks_exact(self.dim.max(1))
    }

    /// One coordinate of all points.
    pub fn column(&self, axis: usize) -> Vec<f64> {
        self.iter().map(|point| point[axis]).collect()
    }

    /// The normal of a point, where there are normals.
    pub fn normal(&self, index: usize) -> Option<&[f64]> {
        self.normals.as_ref()?.get(index * self.dim..(index + 1) * self.dim)
    }

    /// Those points whose coordinates and normal (empty where there is none) pass the test: one face of a box, say.
    pub fn select(&self, keep: impl Fn(&[f64], &[f64]) -> bool) -> Points {
        let test = |(index, point): (usize, &[f64])| keep(point, self.normal(index).unwrap_or(&[])).then_some(index);
        let chosen: Vec<usize> = self.iter().enumerate().filter_map(test).collect();
        self.take(&chosen)
    }

    /// Adds other points of the same kind behind these.
    pub(super) fn append(&mut self, other: Points) {
        self.coords.extend(other.coords);
        self.normals.get_or_insert_default().extend(other.normals.unwrap_or_default());
        self.weights.get_or_insert_default().extend(other.weights.unwrap_or_default());
    }

    /// The points with these indices, in this order.
    pub fn take(&self, indices: &[usize]) -> Points {
        let dim = self.dim;
        let rows =
            |flat: &Vec<f64>| indices.iter().flat_map(|&i| flat[i * dim..(i + 1) * dim].iter().copied()).collect();
        Points {
            dim,
            coords: rows(&self.coords),
            normals: self.normals.as_ref().map(rows),
            weights: self.weights.as_ref().map(|weights| indices.iter().map(|&i| weights[i]).collect()),
        }
    }
}
