//! Scenes over time: bound to a table with one column for the time and one for each observed field.

use nisp::schema::{Origin, Scene};
use nisp_data::Table;
use std::path::Path;

use crate::copies::noisy_copy;
use crate::entry::{Entry, Given, Series};
use crate::error::PrepareError;
use crate::prepared::Prepared;
use crate::request::Request;
use crate::tables::{self, Clock, Tables};
use crate::truth::{Headers, Truth};

impl Series {
    /// The repository's truths as if measured anew, `count` times from the first on and then from the beginning: number k
    /// with noise of seed `seed + k`. Without noise every truth comes once at most.
    ///
    /// # Errors
    /// No such files in the folder `repository`, or a scene that the entry does not have.
    pub fn copies(
        &self,
        entry: &Entry,
        request: &Request,
        repository: &Path,
        noise: f64,
        seed: u64,
        count: usize,
    ) -> Result<Vec<Prepared>, PrepareError> {
        let schema = entry.scene(request.scene.as_deref())?.schema;
        let copy = |(index, path): (usize, &&str)| {
            let truth = Table::read(repository.join(path))?;
            let copy = noisy_copy(&truth, schema, self.every, noise, seed.wrapping_add(index as u64))?;
            self.bind(entry, request, &copy, Some(&truth))
        };
        let count = if noise == 0.0 { count.min(self.truths.len()) } else { count };
        self.truths.iter().cycle().take(count).enumerate().map(copy).collect()
    }

    /// Reads the data and binds the scene.
    ///
    /// # Errors
    /// A table, a column, a scene or a parameter that does not fit.
    pub fn prepare(&self, entry: &Entry, request: &Request) -> Result<Prepared, PrepareError> {
        let file = request.file(entry.name)?;
        let example = file.is_none();
        let mut table = match file {
            Some(path) => Table::read(path)?,
            None => Table::parse(Path::new(entry.data), self.data)?,
        };
        let mut truth = match &request.truth {
            Some(path) => Some(Table::read(path)?),
            None if example => Some(Table::parse(Path::new(entry.data), self.truth)?),
            None => None,
        };
        let clock = Clock::of([&table]);
        [&mut table].into_iter().chain(&mut truth).for_each(|table| clock.count(table));
        let mut request = request.clone();
        if example {
            let own = self.columns.iter().map(|(name, header)| ((*name).into(), (*header).into()));
            request.columns.splice(0..0, own);
        }
        let mut prepared = self.bind(entry, &request, &table, truth.as_ref())?;
        let said = clock.said(prepared.problem.scene().schema, &table, &request);
        prepared.begin = clock.begin.filter(|_| said.is_some());
        prepared.warnings.extend(said);
        Ok(prepared)
    }

    /// Binds the scene to tables, whatever files the request names.
    ///
    /// # Errors
    /// As [`Series::prepare`].
    pub fn bind(
        &self,
        entry: &Entry,
        request: &Request,
        table: &Table,
        truth: Option<&Table>,
    ) -> Result<Prepared, PrepareError> {
        let scene = entry.scene(request.scene.as_deref())?;
        let schema = scene.schema;
        let found = tables::bind(
            scene,
            &Tables { any: Some(table), own: Vec::new(), clouds: Vec::new(), folder: Path::new("") },
            request,
        )?;
        let span = found.bounds.first().copied();
        let truth = truth.map(|truth| Truth::read(truth, schema, span.as_slice(), Headers::default())).transpose()?;
        let given =
            Given { start: span.map_or(0.0, |[first, _]| first), parameter: &|name| parameter(schema, request, name) };
        let rival = (self.rival)(schema.name, given);
        Ok(Prepared {
            problem: found.problem,
            points: found.places,
            outline: Vec::new(),
            planes: Vec::new(),
            measured: found.measured,
            truth,
            source: table.path().display().to_string(),
            begin: None,
            warnings: found.warnings,
            assumed: tables::assumed(schema, request),
            rival,
            local: None,
            contact: None,
            references: None,
            frames: None,
        })
    }
}

/// What a parameter was set to, or its declared value.
fn parameter(schema: &Scene, request: &Request, name: &str) -> f64 {
    let asked = request.parameters.iter().rev().find(|(n, _)| n == name).map(|(_, value)| *value);
    let declared = schema.scalars.iter().find(|scalar| scalar.name == name).and_then(|scalar| match scalar.origin {
        Origin::Given(value) => value.map(|value| scalar.unit.factor.back(value).as_declared()),
        _ => None,
    });
    asked.or(declared).unwrap_or(f64::NAN)
}
