//! Which header answers to a name. For `q` in metres: `q`, `q [m]`, `q (m)` or `q_m`; anything longer must be asked for by its
//! exact header, because guessing between `q_m_sigma0` and `q_m_sigma0.01` would be a quiet wrong answer.

use nisp_units::frame::Number;
use nisp_units::{Conversion, conversion, is_unit};

use super::headers::{answers, base, claimed, fits, found, in_brackets, is_plain, misspelt, starts_with_name};
use super::{Column, Kind, Table};
use crate::DataError;
use crate::names::likeness;

/// Headers less like a name are not meant by it, unless they begin with it.
const ALIKE: f64 = 0.85;

impl Table {
    /// The column that answers to `name`: an exact header, or the only one of the forms `name [unit]`, `name (unit)` and
    /// `name_unit`. Its numbers are as they stand in the file, whatever unit the header names.
    pub fn column(&self, name: &str) -> Result<&[f64], DataError> {
        self.checked(self.find(name, None)?)
    }

    /// As [`Table::column`], but in `unit`: a header that names a multiple of it (`t_ms` for seconds) is converted, and
    /// one that names another unit does not answer.
    pub fn quantity(&self, name: &str, unit: &str) -> Result<Vec<f64>, DataError> {
        self.converted(self.find(name, Some(unit))?, (name, unit), Table::checked)
    }

    /// As [`Table::quantity`], with NaN for cells that are empty or `nan`: nothing was measured there.
    pub fn measured(&self, name: &str, unit: &str) -> Result<Vec<f64>, DataError> {
        self.converted(self.find(name, Some(unit))?, (name, unit), Table::with_gaps)
    }

    /// The column with a header that the user chose for `name`, in `unit`, converted as in [`Table::quantity`]. A header whose
    /// brackets hold another unit is refused. `pos [mm]` may be chosen where the header is `pos` alone: its numbers are millimetres.
    pub fn chosen(&self, name: &str, header: &str, unit: &str) -> Result<Vec<f64>, DataError> {
        self.chosen_by((name, header, unit), Table::checked)
    }

    /// As [`Table::chosen`], with NaN for cells that are empty or `nan`: nothing was measured there.
    pub fn chosen_measured(&self, name: &str, header: &str, unit: &str) -> Result<Vec<f64>, DataError> {
        self.chosen_by((name, header, unit), Table::with_gaps)
    }

    fn chosen_by<'a>(
        &'a self,
        (name, header, unit): (&str, &str, &str),
        read: fn(&'a Table, &'a Column) -> Result<&'a [f64], DataError>,
    ) -> Result<Vec<f64>, DataError> {
        let bare = base(header);
        let plain = || self.single(name, &self.matching(|own| own == bare));
        let (Some(own), true, Some(column)) = (in_brackets(header), self.answering(header, None).is_empty(), plain()?)
        else {
            return self.converted(self.under(name, header)?, (name, unit), read);
        };
        let values = read(self, column)?;
        match conversion(own, unit) {
            Some(conversion) => Ok(values.iter().map(|&x| conversion.of(Number::file(x)).as_declared()).collect()),
            None => Err(self.other_unit(header, name, unit).unwrap_or_else(|| self.absent(name, header))),
        }
    }

    /// The column with a header that the user chose for a name.
    fn under(&self, name: &str, header: &str) -> Result<&Column, DataError> {
        self.single(name, &self.answering(header, None))?.ok_or_else(|| self.absent(name, header))
    }

    /// True if the header that was found or chosen for a quantity says in which unit its numbers are.
    pub fn says_unit(&self, name: &str, chosen: Option<&str>, unit: &str) -> bool {
        let says = |header: &str| header != name && (claimed(header).is_some() || found(header, unit).is_some());
        let own = || self.find(chosen.unwrap_or(name), None).is_ok_and(|column| says(&column.header));
        chosen.is_some_and(says) || own()
    }

    /// True if no header is, or may be meant to be, that of a quantity. Those of other quantities are not meant.
    pub fn lacks<'a>(&self, name: &str, others: impl Iterator<Item = &'a str>) -> bool {
        let taken: Vec<&str> = others
            .filter(|own| *own != name)
            .flat_map(|own| self.answering(own, None))
            .map(|c| c.header.as_str())
            .collect();
        self.answering(name, None).is_empty()
            && self.matching(|header| starts_with_name(header, name)).is_empty()
            && self.nearest(name, &|header| !taken.contains(&header)).is_none()
    }

    fn converted<'a>(
        &'a self,
        column: &'a Column,
        (name, unit): (&str, &str),
        read: fn(&'a Table, &'a Column) -> Result<&'a [f64], DataError>,
    ) -> Result<Vec<f64>, DataError> {
        let values = read(self, column)?;
        Ok(match self.conversion_of(column, (name, unit))? {
            Some(conversion) => values.iter().map(|&value| conversion.of(Number::file(value)).as_declared()).collect(),
            None => values.to_vec(),
        })
    }

    /// How numbers in the unit that the header of a column says become numbers in another; nothing where it says none.
    pub(super) fn conversion_of(
        &self,
        column: &Column,
        (name, unit): (&str, &str),
    ) -> Result<Option<Conversion>, DataError> {
        if column.is_dated() {
            let what = format!("`{}` holds dates, where `{name}` is in {unit}; choose another column", column.header);
            return column.dated(unit).map(Some).ok_or(DataError::Column { path: self.path.clone(), what });
        }
        if column.header == name {
            return Ok(None);
        }
        self.other_unit(&column.header, name, unit).map_or_else(|| Ok(found(&column.header, unit)), Err)
    }

    /// What is wrong with a header that says that it is in another unit.
    fn other_unit(&self, header: &str, name: &str, unit: &str) -> Option<DataError> {
        let own = claimed(header).or_else(|| misspelt(header)).filter(|own| !fits(own, unit))?;
        let wanted = if is_plain(unit) { "a number without unit".into() } else { format!("in {unit}") };
        let instead = match own.trim() {
            unit if is_unit(unit) => "choose another column, or correct the header".into(),
            unit if is_unit(&unit.to_lowercase()) => format!("is `{}` meant? correct the header", unit.to_lowercase()),
            "in" => "is `inch` meant? correct the header".into(),
            unit => {
                format!("no such unit is known: put it into one that is, or correct the header if `{unit}` is none")
            }
        };
        let what = format!("`{header}` is in {own}, where `{name}` is {wanted}: {instead}");
        Some(DataError::Column { path: self.path.clone(), what })
    }

    /// Whether a header may be chosen, with a unit in brackets if it says none itself.
    pub fn offers(&self, header: &str) -> bool {
        let is_bare = || in_brackets(header).is_some() && !self.matching(|own| own == base(header)).is_empty();
        !self.answering(header, None).is_empty() || is_bare()
    }

    /// Whether some header answers to `name`.
    pub fn has(&self, name: &str) -> bool {
        self.find(name, None).is_ok()
    }

    /// The values of a column, NaN where nothing was measured.
    fn with_gaps<'a>(&'a self, column: &'a Column) -> Result<&'a [f64], DataError> {
        match &column.fault {
            Some(fault) if matches!(fault.kind, Kind::Infinite | Kind::Word) => self.checked(column),
            _ => Ok(&column.values),
        }
    }

    pub(super) fn checked<'a>(&'a self, column: &'a Column) -> Result<&'a [f64], DataError> {
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
        self.single(name, &self.answering(name, unit))?.ok_or_else(|| self.missing(name, unit))
    }

    /// The columns of this very header or, if there are none, those that answer to it as a name.
    fn answering(&self, name: &str, unit: Option<&str>) -> Vec<&Column> {
        let exact = self.matching(|header| header == name);
        if exact.is_empty() { self.matching(|header| answers(header, name, unit)) } else { exact }
    }

    /// The one column that was found for `name`, if any was; several are an error.
    fn single<'a>(&self, name: &str, found: &[&'a Column]) -> Result<Option<&'a Column>, DataError> {
        let what = match found {
            [] => return Ok(None),
            [one] => return Ok(Some(one)),
            [first, ..] => self.twice(found).unwrap_or_else(|| {
                let headers = list(found.iter().map(|column| column.header.as_str()));
                format!("several columns answer to `{name}`: {headers}; {}", choose(name, Some(&first.header)))
            }),
        };
        Err(DataError::Column { path: self.path.clone(), what })
    }

    /// Which of the columns have one header and cannot be told apart.
    fn twice(&self, found: &[&Column]) -> Option<String> {
        let same = |header: &str| -> Vec<usize> {
            let all = (1..).zip(&self.columns);
            all.filter(|(_, column)| column.header == header).map(|(number, _)| number).collect()
        };
        let (header, numbers) =
            found.iter().map(|column| (&column.header, same(&column.header))).find(|(_, all)| all.len() > 1)?;
        let (last, others) = numbers.split_last()?;
        let both = if others.len() == 1 { "both " } else { "" };
        let others: Vec<String> = others.iter().map(usize::to_string).collect();
        Some(format!("columns {} and {last} are {both}named `{header}`; rename one of them", others.join(", ")))
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
        let other = unit.and_then(|unit| longer.iter().find_map(|column| self.other_unit(&column.header, name, unit)));
        if let Some(other) = other {
            return other;
        }
        // What is suggested must not be refused for its unit.
        let is_date = |header: &str| self.columns.iter().any(|own| own.header == header && own.is_dated());
        let passes = |header: &str| {
            let suits = |unit| {
                self.other_unit(header, name, unit).is_none() && (!is_date(header) || conversion("s", unit).is_some())
            };
            unit.is_none_or(suits)
        };
        // A time is what dates say.
        let dated = || self.headers().find(|header| is_date(header) && passes(header));
        let nearest = longer.first().map(|column| column.header.as_str());
        let only = || self.headers().find(|header| self.columns.len() == 1 && passes(header));
        let nearest = nearest.or_else(dated).or_else(|| self.nearest(name, &passes)).or_else(only);
        self.no_column(&wanted, &format!("; {}", choose(name, nearest)))
    }

    /// What is said of a header that the user chose for a name and that is not there.
    pub fn absent(&self, name: &str, header: &str) -> DataError {
        let hint =
            self.nearest(header, &|_| true).map(|near| format!("; the nearest is `{near}`: {}", option(name, near)));
        self.no_column(&format!("`{header}`"), &hint.unwrap_or_default())
    }

    fn no_column(&self, wanted: &str, hint: &str) -> DataError {
        let all = list(self.headers());
        // A single header of several words may be a row that nothing separates.
        let is_word = |header: &str| base(header).chars().all(|mark| mark.is_alphanumeric() || mark == '_');
        let what = if self.columns.len() == 1 && !is_word(&all) {
            format!(
                "no column for {wanted}; the file has one column, `{all}`: separate cells by commas, semicolons or tabs"
            )
        } else {
            format!("no column for {wanted}{hint} (columns: {all})")
        };
        DataError::Column { path: self.path.clone(), what }
    }

    /// The header most like the name among those that pass, if it may be meant: `psi` is not meant by `phi`, but `time` by `t`, and
    /// `room T` by `T`. A letter in the other case is another quantity, and meant only where nothing else is.
    fn nearest(&self, name: &str, passes: &dyn Fn(&str) -> bool) -> Option<&str> {
        let likeness = |header: &str| likeness(base(header), name);
        let meant = |header: &&str| {
            header.to_lowercase().starts_with(&name.to_lowercase())
                || base(header).split(|mark: char| !mark.is_alphanumeric()).any(|word| word == name)
                || likeness(header) >= ALIKE
        };
        let is_other = |header: &str| base(header).len() == 1 && base(header) != name;
        let by_likeness = |a: &&str, b: &&str| is_other(b).cmp(&is_other(a)).then(likeness(a).total_cmp(&likeness(b)));
        self.headers().filter(meant).filter(|header| passes(header)).max_by(by_likeness)
    }
}

fn choose(name: &str, example: Option<&str>) -> String {
    match example {
        Some(header) => format!("choose one, for instance with {}", option(name, header)),
        None => format!("choose one, with {}", option(name, "HEADER")),
    }
}

/// How to choose a header on the command line.
fn option(name: &str, header: &str) -> String {
    if header.contains([' ', '[', '(', '*']) {
        format!("--column '{name}={header}'")
    } else {
        format!("--column {name}={header}")
    }
}

pub(super) fn list<'a>(headers: impl Iterator<Item = &'a str>) -> String {
    headers.collect::<Vec<_>>().join(", ")
}
