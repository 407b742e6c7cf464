//! Marks that part thousands: `1.234` may be a little more than one, or a thousand and more.

/// What the cells of a column say of such marks.
#[derive(Debug, Clone, Default)]
pub(super) struct Thousands {
    /// The first cell that may hold a mark of thousands, and its line.
    first: Option<(usize, String)>,
    /// The largest of such cells, with the mark taken for a decimal one.
    largest: f64,
    /// The largest of cells without a mark.
    whole: f64,
    /// True once a cell can only have a decimal mark, or none where thousands would have one.
    is_decimal: bool,
}

impl Thousands {
    /// Looks at a cell, which is a number.
    pub(super) fn see(&mut self, line: usize, cell: &str, value: f64) {
        let digits = cell.trim_start_matches(['-', '+']);
        match digits.split_once(['.', ',']) {
            Some((before, after)) if are_thousands(before, after) => {
                self.first.get_or_insert_with(|| (line, cell.to_string()));
                self.largest = self.largest.max(value.abs());
            }
            None if value.fract() == 0.0 && value.abs() < 1e3 => self.whole = self.whole.max(value.abs()),
            _ => self.is_decimal = true,
        }
    }

    /// A line and what to say of it where marks part thousands in all likelihood: numbers would fall from hundreds to ones.
    pub(super) fn doubt(&self) -> Option<(usize, String)> {
        let (line, cell) = self.first.as_ref().filter(|_| !self.is_decimal && self.largest < 0.1 * self.whole)?;
        let (without, decimal) = (cell.replace(['.', ','], ""), cell.replace(',', "."));
        let said = format!(
            "`{cell}` stands in a column of whole numbers up to {}: write {without} if its mark parts thousands, and {decimal}0 if not",
            self.whole
        );
        Some((*line, said))
    }
}

/// True of `1` and `234`.
fn are_thousands(before: &str, after: &str) -> bool {
    let are_digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    (1..=3).contains(&before.len())
        && !before.starts_with('0')
        && after.len() == 3
        && are_digits(before)
        && are_digits(after)
}
