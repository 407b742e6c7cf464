//! What a user may have got wrong. Each message is one line and says what to do next.

use std::path::{Path, PathBuf};

use nisp::{BindError, LiveError};
use nisp_data::DataError;

/// Why a scene cannot be prepared.
#[derive(Debug, thiserror::Error)]
pub enum PrepareError {
    /// A scene that cannot be smoothed row by row.
    #[error(transparent)]
    Live(#[from] LiveError),
    /// A condition that a stream does not come to.
    #[error(
        "group `{group}` lies at an edge of the record, which a stream does not know: choose a scene without it (--scene), or solve \
         the record as a whole with `nisp solve`"
    )]
    Endless {
        /// The group.
        group: &'static str,
    },
    /// The table.
    #[error(transparent)]
    Data(#[from] DataError),
    /// A table without a coordinate that has columns to spare.
    #[error("{fault}; if each column is a sensor's, its header may say where that is, as `T({axis}=0.1)`")]
    Gauges {
        /// What is wrong with the table.
        fault: String,
        /// The coordinate that it lacks.
        axis: String,
    },
    /// The binding.
    #[error(transparent)]
    Bind(#[from] BindError),
    /// A scene that the entry does not have.
    #[error("`{entry}` has no scene `{scene}`{hint}; it has: {have}")]
    Scene {
        /// The entry.
        entry: &'static str,
        /// The scene asked for.
        scene: String,
        /// The scene that may have been meant.
        hint: String,
        /// The scenes there are.
        have: String,
    },
    /// A name in `--column` that nothing observes.
    #[error("--column {name}=...: the scene observes no `{name}`{hint}; it observes: {have}")]
    Column {
        /// The name given.
        name: String,
        /// The name that may have been meant.
        hint: String,
        /// The names there are.
        have: String,
    },
    /// A number of points for a group whose points are not drawn.
    #[error(
        "--points {group}=...: no points are drawn for `{group}`{hint}; points are drawn for groups in domains: {have}"
    )]
    Points {
        /// The name given.
        group: String,
        /// The name that may have been meant.
        hint: String,
        /// The groups there are.
        have: String,
    },
    /// A file for a group that there is not.
    #[error("--data {group}={}: the scene has no group `{group}`{hint}; it has: {have}", .path.display())]
    Group {
        /// The group named.
        group: String,
        /// Its file.
        path: PathBuf,
        /// The group that may have been meant.
        hint: String,
        /// The groups there are.
        have: String,
    },
    /// A group whose measurements nobody gave.
    #[error("group `{group}` wants measurements of {columns}; give a table: --data {group}=FILE")]
    Unmeasured {
        /// The group.
        group: &'static str,
        /// Its columns.
        columns: String,
    },
    /// A column of an edge that seems to be its normal.
    #[error(
        "`{column}` of group `{group}` is a vector that no table has: if it is meant for the normal of the boundary, name it `normal`, \
         as in `columns: normal: vector [1]`"
    )]
    Normal {
        /// The group.
        group: &'static str,
        /// The column.
        column: String,
    },
    /// A surface of which nobody gave a cloud.
    #[error(
        "`{term}` of `{group}` wants a cloud; give its file: --data {group}.{term}=FILE (PLY, PCD, NPY, NPZ, CSV or XYZ)"
    )]
    Unseen {
        /// The group.
        group: &'static str,
        /// The term.
        term: &'static str,
    },
    /// Several things at once, one a line.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
    Several(Vec<PrepareError>),
    /// A group whose points nobody gave.
    #[error(
        "nothing says where `{group}` lies; declare a domain in the equation and write `on {group} in DOMAIN`, or give its \
         points as a table of {coordinates}: --data {group}=FILE"
    )]
    Nowhere {
        /// The group.
        group: &'static str,
        /// The coordinates.
        coordinates: String,
    },
    /// Pairs whose partners nothing says.
    #[error(
        "group `{group}`: nothing says which points are partners; write `on {group} boundary of DOMAIN pairs`, of an interval or a \
         box, for those on opposite sides, or `on {group} start of DOMAIN pairs` for the start and the end"
    )]
    Unpaired {
        /// The group.
        group: &'static str,
    },
    /// A grid of another dimension.
    #[error("--grid has {given} numbers; give one for each of {coordinates}, for instance 61x61 for two")]
    Grid {
        /// How many numbers were given.
        given: usize,
        /// The coordinates.
        coordinates: String,
    },
    /// An option that an entry has no use for.
    #[error("`{entry}` takes no --{option}; {instead}")]
    Option {
        /// The entry.
        entry: &'static str,
        /// The option.
        option: &'static str,
        /// What to give instead.
        instead: &'static str,
    },
    /// Options that speak of different clouds.
    #[error("--cloud {index} chooses among a sample's clouds; {instead}")]
    Cloud {
        /// The number asked for.
        index: usize,
        /// What to do.
        instead: String,
    },
    /// A parameter that nobody gave.
    #[error(
        "parameter `{name}` has no value; give it with --set {name}=VALUE in {unit}, or name a sample with --sample"
    )]
    Missing {
        /// The parameter.
        name: &'static str,
        /// Its declared unit.
        unit: &'static str,
    },
    /// A sample without a number that the scene needs.
    #[error("{}: no `{key}`, from which `{name}` is taken; add it, or give --set {name}=VALUE in {unit}", .path.display())]
    SampleKey {
        /// The sample.
        path: PathBuf,
        /// Table and key.
        key: &'static str,
        /// The parameter.
        name: &'static str,
        /// Its declared unit.
        unit: &'static str,
    },
    /// A parameter with which the scene makes no sense.
    #[error("`{name}` is {value} {unit}; {must}")]
    Range {
        /// The parameter.
        name: &'static str,
        /// Its value in its declared unit.
        value: f64,
        /// The unit.
        unit: &'static str,
        /// What it must be, and how to mend it.
        must: &'static str,
    },
    /// A cloud that is somewhere else.
    #[error(
        "{}: only {share:.0} % of the points lie where the {body} can be, {place}: is it a cloud of another object, or in \
         another frame?",
        .path.display()
    )]
    Elsewhere {
        /// The cloud.
        path: PathBuf,
        /// Points where they can be, in per cent.
        share: f64,
        /// What was observed.
        body: &'static str,
        /// Where it can be.
        place: String,
    },
    /// A scene that asks for the terrain.
    #[error(
        "scene `{scene}` needs the terrain under the face, which no cloud of the sides tells; bind its clearance in a \
         program, or choose --scene unknown_terrain"
    )]
    Terrain {
        /// The scene.
        scene: &'static str,
    },
    /// Two tables where one is taken.
    #[error(
        "--data is given twice{}: {} and {}; give one table, with the rows of both in one file if they are one record",
        .group.as_ref().map_or_else(String::new, |group| format!(" for group `{group}`")), .first.display(), .second.display()
    )]
    Twice {
        /// The group, if one is named.
        group: Option<String>,
        /// The table that came first.
        first: PathBuf,
        /// The other one.
        second: PathBuf,
    },
    /// A file of parameters that cannot be read.
    #[error("{}: {reason}", .path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// A measurement so large that its square is no number.
    #[error("`{name}` goes up to {largest:e} {unit}; check its column and its unit")]
    Size {
        /// What was measured.
        name: &'static str,
        /// Its largest magnitude.
        largest: f64,
        /// Its declared unit.
        unit: &'static str,
    },
    /// Measurements that look like those of another unit, under a header that says none.
    #[error(
        "{question}; if it is in {unit}, say that instead: `{name} [{unit}]` (or --column '{name}=HEADER [{unit}]')"
    )]
    Unlabelled {
        /// What is asked.
        question: String,
        /// What was measured.
        name: &'static str,
        /// Its declared unit.
        unit: &'static str,
    },
    /// A truth at times of which the data say nothing.
    #[error(
        "{}: the truth's times, {} to {} s, are all outside those of the data, {} to {} s; check the file and the unit of \
         its times",
        .path.display(), .truth[0], .truth[1], .data[0], .data[1]
    )]
    TruthRange {
        /// The truth's file.
        path: PathBuf,
        /// Its first and last time.
        truth: [f64; 2],
        /// The data's.
        data: [f64; 2],
    },
    /// A truth that has nothing to score.
    #[error(
        "{}: no column answers to any of {heads}; name one like the quantity, with its unit, as in `f [N]` or `f_N` \
         (columns: {columns})",
        .path.display()
    )]
    TruthHeads {
        /// The truth's file.
        path: PathBuf,
        /// What could be scored.
        heads: String,
        /// The headers there are.
        columns: String,
    },
}

impl PrepareError {
    /// True where the record of this name is at fault, so that another of the same body may do.
    pub fn is_of(&self, source: &Path) -> bool {
        matches!(self, Self::File { path, .. } | Self::Elsewhere { path, .. } if path == source)
    }

    /// One error of several, each said once.
    pub(crate) fn all(faults: Vec<PrepareError>) -> PrepareError {
        let mut flat: Vec<PrepareError> = Vec::new();
        for fault in faults {
            let parts = if let PrepareError::Several(parts) = fault { parts } else { vec![fault] };
            for part in parts {
                if flat.iter().all(|known| known.to_string() != part.to_string()) {
                    flat.push(part);
                }
            }
        }
        if flat.len() == 1 { flat.remove(0) } else { PrepareError::Several(flat) }
    }
}
