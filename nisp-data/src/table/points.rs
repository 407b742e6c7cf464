//! Points of a cloud from a table.

use nisp_units::frame::Number;

use super::lookup::list;
use super::{Column, Kind, Table};
use crate::DataError;
use crate::components::Components;

impl Table {
    /// The components of points, and true where their headers say the unit, which makes metres of them. Cells that are no finite
    /// numbers pass, as NaN or infinity. What a point has less than three of is zero.
    pub(crate) fn points(&self, components: Components<'_>) -> Result<(Vec<[f64; 3]>, bool), DataError> {
        let columns = self.columns_of(components)?;
        let mut sizes = Vec::with_capacity(columns.len());
        for (name, column) in &columns {
            sizes.push(self.conversion_of(column, (name, "m"))?);
        }
        if sizes.iter().any(Option::is_some) && sizes.iter().any(Option::is_none) {
            let headers = list(columns.iter().map(|(_, column)| column.header.as_str()));
            let what = format!("{headers}: some say their unit and others do not; write it in all of them or in none");
            return Err(DataError::Column { path: self.path.clone(), what });
        }
        let mut points = vec![[0.0; 3]; self.rows()];
        for (axis, ((_, column), size)) in columns.iter().zip(&sizes).enumerate() {
            let metres = |x: f64| size.map_or(x, |size| size.of(Number::file(x)).as_declared());
            points.iter_mut().zip(self.raw(column)?).for_each(|(point, &x)| point[axis] = metres(x));
        }
        Ok((points, sizes.iter().any(Option::is_some)))
    }

    /// The columns of a point's components: those with their names, or else x, y and z of points in space, and all in their order of others
    /// where there are as many and none has the name of another component.
    fn columns_of<'a>(&'a self, components: Components<'a>) -> Result<Vec<(&'a str, &'a Column)>, DataError> {
        let found = |name: &'a str| self.find(name, None).ok().map(|column| (name, column));
        if let Some(all) = components.names().map(found).collect() {
            return Ok(all);
        }
        if components.count() == 3 {
            return ["x", "y", "z"].into_iter().map(|name| Ok((name, self.find(name, None)?))).collect();
        }
        let all = || components.names().zip(&self.columns);
        let is_own =
            |(name, column): (&'a str, &'a Column)| found(name).is_none_or(|(_, found)| std::ptr::eq(found, column));
        if self.columns.len() == components.count() && all().all(is_own) {
            return Ok(all().collect());
        }
        let headers = list(self.columns.iter().map(|column| column.header.as_str()));
        let what = format!(
            "the points are {}, and the columns are {headers}: give them these headers, or give these columns alone in their order",
            components.said()
        );
        Err(DataError::Column { path: self.path.clone(), what })
    }

    fn raw<'a>(&'a self, column: &'a Column) -> Result<&'a [f64], DataError> {
        match &column.fault {
            Some(fault) if matches!(fault.kind, Kind::Word | Kind::Empty) => self.checked(column),
            _ => Ok(&column.values),
        }
    }
}
