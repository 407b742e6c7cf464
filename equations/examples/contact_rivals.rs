//! What classical ways find of every contact in `data`: `cargo run --release -p nisp-equations --example contact_rivals`.

use std::error::Error;
use std::path::{Path, PathBuf};

use nisp_equations::contact::{Against, ContactScore};
use nisp_equations::{Entry, PrepareError, Request, catalogue};

/// Samples of a folder that have this truth, in order.
fn samples(folder: &Path, truth: &str) -> std::io::Result<Vec<PathBuf>> {
    let paths = std::fs::read_dir(folder)?.map(|entry| entry.map(|entry| entry.path()));
    let mut paths = paths.collect::<Result<Vec<_>, _>>()?;
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "toml") && beside(path, truth).exists());
    paths.sort();
    Ok(paths)
}

/// The file of a sample with this ending.
fn beside(sample: &Path, ending: &str) -> PathBuf {
    sample.with_file_name(format!("{}{ending}", sample.file_stem().unwrap_or_default().display()))
}

/// The score of an entry's rival on a sample's cloud; nothing where it has no answer.
fn score(entry: &Entry, sample: &Path, cloud: usize, truth: &str) -> Result<Option<ContactScore>, PrepareError> {
    let (sample, truth) = (Some(sample.to_path_buf()), Some(beside(sample, truth)));
    let prepared = entry.prepare(&Request { sample, cloud: Some(cloud), truth, ..Request::default() })?;
    let Some(contact) = &prepared.contact else { return Ok(None) };
    let Some(rival) = &contact.rival else { return Ok(None) };
    let values = |name: &str, at: &[f64]| (contact.pressure == Some(name)).then(|| (rival.pressure)(at));
    Ok(contact.score(&values, prepared.truth.as_ref()))
}

fn mean(scores: &[Against], of: impl Fn(&Against) -> f64) -> f64 {
    scores.iter().map(of).sum::<f64>() / scores.len() as f64
}

fn main() -> Result<(), Box<dyn Error>> {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data");
    for entry in catalogue() {
        let (truth, clouds) = match entry.name {
            "membrane" => ("_truth.csv", 5),
            "sponge" => ("_bottom.csv", 2),
            _ => continue,
        };
        let mut samples = samples(&data.join(entry.name), truth)?;
        // Nothing touches the inflated ones.
        samples.retain(|path| !path.file_name().unwrap_or_default().display().to_string().starts_with("inflated"));
        for cloud in 0..clouds {
            let scores = samples.iter().map(|sample| score(&entry, sample, cloud, truth));
            let scores: Vec<Against> = scores
                .collect::<Result<Vec<_>, _>>()?
                .into_iter()
                .flatten()
                .filter_map(|score| score.against)
                .collect();
            let (iou, force) = (mean(&scores, |score| score.iou), mean(&scores, |score| score.force_error));
            let count = scores.len();
            println!(
                "{}, cloud {cloud}, {count} samples: IoU {iou:.3}, error of the net force {force:.3} N",
                entry.name
            );
        }
    }
    Ok(())
}
