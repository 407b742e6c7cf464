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
    /// The mark of such a cell.
    decimal: Option<char>,
}

/// Decimal marks of a table: those that some column has for certain, and those that one may have.
#[derive(Debug, Default)]
pub(super) struct Marks {
    certain: Vec<char>,
    possible: Vec<char>,
}

impl Marks {
    pub(super) fn of<'a>(columns: impl Iterator<Item = &'a Thousands> + Clone) -> Self {
        let possible = columns.clone().filter_map(|own| mark(&own.first.as_ref()?.1));
        Self { certain: columns.filter_map(|own| own.decimal).collect(), possible: possible.collect() }
    }

    /// True where other columns have another decimal mark, or may have.
    fn are_others(&self, mark: char) -> bool {
        match self.certain.is_empty() {
            true => self.possible.iter().any(|other| *other != mark),
            false => !self.certain.contains(&mark),
        }
    }
}

/// The mark in a number.
fn mark(cell: &str) -> Option<char> {
    cell.chars().find(|mark| matches!(mark, '.' | ','))
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
            _ => {
                self.is_decimal = true;
                self.decimal = mark(digits).or(self.decimal);
            }
        }
    }

    /// A line and what to say of it where marks part thousands in all likelihood: numbers would fall from hundreds to ones, or other columns of
    /// the table have another decimal mark.
    pub(super) fn doubt(&self, marks: &Marks) -> Option<(usize, String)> {
        let (line, cell) = self.first.as_ref().filter(|_| !self.is_decimal)?;
        let why = if self.largest < 0.1 * self.whole {
            format!("stands in a column of whole numbers up to {}", self.whole)
        } else if marks.are_others(mark(cell)?) {
            "has another mark than another column".into()
        } else {
            return None;
        };
        let (without, decimal) = (cell.replace(['.', ','], ""), cell.replace(',', "."));
        Some((*line, format!("`{cell}` {why}: write {without} if its mark parts thousands, and {decimal}0 if not")))
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

#[cfg(test)]
mod tests {
    use crate::Table;

    /// One mark of a table parts thousands where another column has the other one for its decimals.
    #[test]
    fn a_mark_that_another_column_contradicts_is_doubted() {
        let of = |text: &str, name: &str| {
            Table::parse("a.csv".as_ref(), text.as_bytes()).unwrap().column(name).map(<[f64]>::to_vec)
        };
        let certain = "t;T\n1.000;293,0\n1.010;293,1\n1.020;293,25\n";
        assert!(of(certain, "t").unwrap_err().to_string().contains("line 2"));
        assert_eq!(of(certain, "T").unwrap(), [293.0, 293.1, 293.25]);
        let either = "t;T\n0;293,153\n2.000;293,591\n4.000;294,001\n";
        assert!(of(either, "t").is_err() && of(either, "T").is_err());
        let alike = "t;T\n1,000;293,0\n1,010;293,1\n1,020;293,2\n";
        assert_eq!(of(alike, "t").unwrap(), [1.0, 1.01, 1.02]);
        let points = "t;T\n1.000;293.153\n1.010;293.154\n1.020;293.155\n";
        assert_eq!(of(points, "t").unwrap(), [1.0, 1.01, 1.02]);
    }
}
