//! Which header answers to a name. For `q` in metres: `q`, `q [m]` or `q_m`; anything longer must be asked for by its
//! exact header, because guessing between `q_m_sigma0` and `q_m_sigma0.01` would be a quiet wrong answer.

use super::{Column, Table};
use crate::DataError;

/// Unit symbols that may follow a name after an underscore (`dq_m_s`, `N_N_per_m`).
const SYMBOLS: [&str; 34] = [
    "m", "mm", "cm", "um", "km", "s", "ms", "us", "min", "h", "kg", "g", "N", "kN", "mN", "Pa", "kPa", "MPa", "GPa",
    "V", "mV", "A", "mA", "K", "C", "rad", "deg", "Hz", "J", "W", "Nm", "mol", "per", "pct",
];

impl Table {
    /// The column that answers to `name`: an exact header, or the only one of the forms `name [unit]` and `name_unit`.
    pub fn column(&self, name: &str) -> Result<&[f64], DataError> {
        self.checked(self.find(name, None)?)
    }

    /// As [`Table::column`], but a unit in the header must be `unit`.
    pub fn quantity(&self, name: &str, unit: &str) -> Result<&[f64], DataError> {
        self.checked(self.find(name, Some(unit))?)
    }

    /// Whether some header answers to `name`.
    pub fn has(&self, name: &str) -> bool {
        self.find(name, None).is_ok()
    }

    /// As [`Table::column`], but cells that are no finite numbers pass, as NaN or infinity.
    pub(crate) fn raw(&self, name: &str) -> Result<&[f64], DataError> {
        let column = self.find(name, None)?;
        match &column.fault {
            Some(fault) if !fault.numeric => self.checked(column),
            _ => Ok(&column.values),
        }
    }

    fn checked<'a>(&self, column: &'a Column) -> Result<&'a [f64], DataError> {
        match &column.fault {
            None => Ok(&column.values),
            Some(fault) => Err(DataError::Cell {
                path: self.path.clone(),
                line: fault.line,
                column: column.header.clone(),
                what: fault.what.clone(),
            }),
        }
    }

    pub(super) fn find(&self, name: &str, unit: Option<&str>) -> Result<&Column, DataError> {
        let exact = self.matching(|header| header == name);
        let found = if exact.is_empty() { self.matching(|header| answers(header, name, unit)) } else { exact };
        match found.as_slice() {
            [one] => Ok(one),
            [] => Err(self.missing(name, unit)),
            many => {
                let headers = list(many.iter().map(|column| column.header.as_str()));
                let what = format!("several columns answer to `{name}`: {headers}; {}", choose(name, &many[0].header));
                Err(DataError::Column { path: self.path.clone(), what })
            }
        }
    }

    fn matching(&self, test: impl Fn(&str) -> bool) -> Vec<&Column> {
        self.columns.iter().filter(|column| test(&column.header)).collect()
    }

    fn missing(&self, name: &str, unit: Option<&str>) -> DataError {
        let wanted = match unit {
            Some(unit) if !is_plain(unit) => format!("`{name}` in {unit}"),
            _ => format!("`{name}`"),
        };
        let longer = self.matching(|header| starts_with_name(header, name));
        let nearest = match longer.first() {
            Some(column) => Some(column.header.as_str()),
            None => self.headers().max_by(|a, b| similarity(a, name).total_cmp(&similarity(b, name))),
        };
        let all = list(self.headers());
        let what = match nearest {
            Some(header) => format!("no column for {wanted}; {} (columns: {all})", choose(name, header)),
            None => format!("no column for {wanted} (columns: {all})"),
        };
        DataError::Column { path: self.path.clone(), what }
    }
}

fn choose(name: &str, header: &str) -> String {
    let quoted =
        if header.contains([' ', '[', '*']) { format!("'{name}={header}'") } else { format!("{name}={header}") };
    format!("choose one, for instance with --column {quoted}")
}

fn list<'a>(headers: impl Iterator<Item = &'a str>) -> String {
    headers.collect::<Vec<_>>().join(", ")
}

fn similarity(header: &str, name: &str) -> f64 {
    strsim::jaro_winkler(&base(header).to_lowercase(), &name.to_lowercase())
}

fn base(header: &str) -> &str {
    header.split('[').next().unwrap_or(header).trim_end()
}

fn starts_with_name(header: &str, name: &str) -> bool {
    header.strip_prefix(name).is_some_and(|rest| rest.starts_with([' ', '_', '[', '.', '-']))
}

/// Whether `header` is `name [unit]` or `name_unit`, for the given unit or for any.
fn answers(header: &str, name: &str, unit: Option<&str>) -> bool {
    let Some(rest) = header.strip_prefix(name) else { return false };
    if let Some(inner) = rest.trim_start().strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
        return unit.is_none_or(|unit| normal(unit) == normal(inner));
    }
    let Some(suffix) = rest.strip_prefix('_') else { return false };
    match unit {
        Some(unit) => !is_plain(unit) && normal(unit) == normal(suffix),
        None => is_unit_suffix(suffix),
    }
}

fn is_plain(unit: &str) -> bool {
    matches!(unit.trim(), "" | "1" | "-")
}

/// One spelling for `m/s^2`, `m s^-2`, `m_s2` and `m_per_s2`: the symbols in order, with their powers' sizes.
fn normal(unit: &str) -> Vec<String> {
    unit.replace(['^', '-', '(', ')'], "")
        .split(['/', '*', '_', '·', ' '])
        .filter(|part| !matches!(*part, "" | "1" | "per"))
        .map(str::to_string)
        .collect()
}

fn is_unit_suffix(suffix: &str) -> bool {
    suffix.split('_').all(|part| SYMBOLS.contains(&part.trim_end_matches(|digit: char| digit.is_ascii_digit())))
}
