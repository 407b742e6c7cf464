//! The studies: what is varied, on what, and what the paper found (its appendix of ablations).

use nisp::local::{Local, Patches};
use nisp::network::{Architecture, Fourier, Inputs, Kind};
use nisp::{Carrier, Settings};

use crate::measure::Measure;

/// Variations of one setting.
pub(super) struct Study {
    pub(super) name: &'static str,
    pub(super) title: &'static str,
    pub(super) equation: &'static str,
    pub(super) data: Data,
    /// Parameters in their declared units.
    pub(super) parameters: &'static [(&'static str, f64)],
    /// A network trained by Adam on a cloud, as the paper has it.
    pub(super) network: bool,
    pub(super) measures: &'static [Measure],
    pub(super) variations: Vec<Variation>,
}

/// What a study is run on.
pub(super) enum Data {
    /// What comes with the program.
    Example,
    /// Tables over time measured anew, with noise of seeds from `seed` on.
    Copies { noise: f64, seed: u64 },
    /// Samples of the repository.
    Samples { folder: &'static str, names: &'static [&'static str], truth: &'static str },
}

/// One setting changed.
pub(super) struct Variation {
    pub(super) name: String,
    pub(super) scene: Option<&'static str>,
    pub(super) cloud: Option<usize>,
    pub(super) change: Box<dyn Fn(&mut Settings)>,
    /// What the paper has for it.
    pub(super) paper: &'static str,
}

impl Study {
    /// Sizes and budgets, for below the title.
    pub(super) fn about(&self, samples: usize, budget: f64, network_budget: f64, width: usize) -> String {
        let runs = match &self.data {
            Data::Example => "the program's example".into(),
            Data::Copies { noise, seed } => {
                format!("{samples} runs of `data/{}`, noise {noise}, seeds from {seed}", self.equation)
            }
            Data::Samples { names, .. } => format!("`{}`", names[..samples.min(names.len())].join("`, `")),
        };
        match self.network {
            true => format!("{runs}; network of 4 x {width}, Adam in f32, {network_budget} s a run."),
            false => format!("{runs}; {budget} s a run at most."),
        }
    }
}

/// The names, for the command line.
pub(super) fn names() -> clap::builder::PossibleValuesParser {
    studies().into_iter().map(|study| study.name).collect::<Vec<_>>().into()
}

fn vary(name: impl Into<String>, paper: &'static str, change: impl Fn(&mut Settings) + 'static) -> Variation {
    Variation { name: name.into(), scene: None, cloud: None, change: Box::new(change), paper }
}

fn inputs(inputs: Inputs) -> impl Fn(&mut Settings) {
    move |settings| settings.architecture.inputs = inputs
}

fn prior(change: impl Fn(&mut Local) + 'static) -> impl Fn(&mut Settings) + 'static {
    move |settings| {
        if let Carrier::Local(local) = &mut settings.carrier {
            change(local);
        }
    }
}

/// Frequencies of about one wave over the domain, as in the reference code.
const MAPPING: Inputs = Inputs::Fourier(Fourier { frequencies: 32, deviation: 1.0 });

const PRESSED: Data =
    Data::Samples { folder: "data/membrane", names: &["flower_1", "cylinder_1", "90_curve_1"], truth: "_truth.csv" };
const INFLATED: Data =
    Data::Samples { folder: "data/membrane", names: &["inflated_1", "inflated_2"], truth: "_truth.csv" };
/// Modulus of both inflated samples, in pascals.
const MODULUS: f64 = 341_260.0;
/// Where the modulus starts: not at the truth.
const START: f64 = 400_000.0;

/// All of them.
pub(super) fn studies() -> Vec<Study> {
    vec![
        mapping(),
        architecture(),
        membrane(),
        ratio("ratio-membrane"),
        ratio("ratio-sponge"),
        noise(),
        inplane(),
        identify(),
        patches(),
    ]
}

fn mapping() -> Study {
    Study {
        name: "mapping",
        title: "Input mapping, pendulum",
        equation: "pendulum",
        data: Data::Copies { noise: 0.01, seed: 2026 },
        parameters: &[],
        network: false,
        measures: &[Measure::Error("f", "N"), Measure::Error("q", "m"), Measure::Error("psi", "rad")],
        variations: vec![
            vary("ours: time and its logarithm", "-", inputs(Inputs::Automatic)),
            vary("time alone", "f 1.63e-2", inputs(Inputs::Coordinates)),
            vary("Fourier mapping", "f 3.20e-2", inputs(MAPPING)),
        ],
    }
}

fn architecture() -> Study {
    let plain = |settings: &mut Settings| settings.architecture.kind = Kind::Plain;
    let plain_mapped = move |settings: &mut Settings| {
        settings.architecture = Architecture { inputs: MAPPING, ..settings.architecture };
    };
    Study {
        name: "architecture",
        title: "Architecture, plate",
        equation: "plate",
        data: Data::Example,
        parameters: &[],
        network: false,
        measures: &[Measure::Error("w", "mm")],
        variations: vec![
            vary("gated", "0.2", |_| ()),
            vary("plain", "36.7", plain),
            vary("gated, Fourier mapping", "30", plain_mapped),
        ],
    }
}

fn membrane() -> Study {
    let mut variations = vec![
        vary("gated", ".661 .780 .667", |_| ()),
        vary("gated, Fourier mapping", ".538 .606 .399", inputs(MAPPING)),
        vary("plain", "-", |settings: &mut Settings| settings.architecture.kind = Kind::Plain),
    ];
    // One final layer per output is one matrix with a row per output: the same functions, drawn otherwise at first.
    for seed in 1..3 {
        let paper = "one final layer: .498 .504 .298";
        variations.push(vary(format!("gated, weights drawn anew (seed {seed})"), paper, move |s| s.seed = seed));
    }
    Study {
        name: "membrane",
        title: "Network on the membrane",
        equation: "membrane",
        data: PRESSED,
        parameters: &[],
        network: true,
        measures: &[Measure::Overlap, Measure::Force],
        variations,
    }
}

fn ratio(name: &'static str) -> Study {
    let membrane = name == "ratio-membrane";
    let paper =
        if membrane { [".630", ".592", ".603", ".480", ".310"] } else { ["46.3", "25.6", "14.9", "55.1", "55.7"] };
    let ratios = [500.0, 100.0, 50.0, 10.0, 1.0].into_iter().zip(paper);
    let variations =
        ratios.map(|(ratio, paper)| vary(format!("{ratio}"), paper, move |s| s.data_first = ratio)).collect();
    let sponge =
        Data::Samples { folder: "data/sponge", names: &["plane_1", "edge_1", "ridge_1"], truth: "_bottom.csv" };
    Study {
        name,
        title: if membrane { "Ratio of loss weights, membrane" } else { "Ratio of loss weights, sponge" },
        equation: if membrane { "membrane" } else { "sponge" },
        data: if membrane { PRESSED } else { sponge },
        parameters: &[],
        network: true,
        measures: if membrane { &[Measure::Overlap] } else { &[Measure::Distance, Measure::Overlap] },
        variations,
    }
}

fn noise() -> Study {
    let steps = ["0 mm", "0.1 mm", "1 mm", "2 mm", "3 mm"].into_iter();
    let paper = [".710", ".703", ".696", ".624", ".240"];
    let variation = |(cloud, (name, paper)): (usize, (&str, &'static str))| Variation {
        cloud: Some(cloud),
        ..vary(name, paper, |_| ())
    };
    Study {
        name: "noise",
        title: "Noise of the depth, membrane",
        equation: "membrane",
        data: PRESSED,
        parameters: &[],
        network: false,
        measures: &[Measure::Overlap, Measure::Force],
        variations: steps.zip(paper).enumerate().map(variation).collect(),
    }
}

/// A scene, and one without in-plane equilibrium, which the paper's equations lack.
fn with_and_without(scene: &'static str, without: &'static str) -> Vec<Variation> {
    let of = |(cloud, name, scene)| Variation { scene: Some(scene), cloud: Some(cloud), ..vary(name, "-", |_| ()) };
    let all = [
        (0, "exact cloud", scene),
        (0, "exact cloud, without", without),
        (2, "1 mm", scene),
        (2, "1 mm, without (the paper's equations)", without),
    ];
    all.map(of).into()
}

fn inplane() -> Study {
    Study {
        name: "inplane",
        title: "In-plane equilibrium, contact",
        equation: "membrane",
        data: PRESSED,
        parameters: &[],
        network: false,
        measures: &[Measure::Overlap, Measure::Force],
        variations: with_and_without("contact", "contact_no_inplane"),
    }
}

fn identify() -> Study {
    Study {
        name: "identify",
        title: "In-plane equilibrium, identification",
        equation: "membrane",
        data: INFLATED,
        parameters: &[("E", START)],
        network: false,
        measures: &[Measure::Learned("E", MODULUS)],
        variations: with_and_without("identify", "identify_no_inplane"),
    }
}

fn patches() -> Study {
    let part = |change: fn(&mut Patches)| prior(move |local: &mut Local| local.patches.iter_mut().for_each(change));
    let of = |name, change: Box<dyn Fn(&mut Settings)>| Variation {
        cloud: Some(2),
        ..vary(name, "-", move |settings| change(settings))
    };
    Study {
        name: "patches",
        title: "Prior of the patches, membrane at 1 mm",
        equation: "membrane",
        data: PRESSED,
        parameters: &[],
        network: false,
        measures: &[Measure::Overlap, Measure::Force],
        variations: vec![
            of("edges and area", Box::new(|_| ())),
            of("edges only", Box::new(part(|patches| patches.area = 0.0))),
            of("area only", Box::new(part(|patches| patches.edges = 0.0))),
            of("none", Box::new(prior(|local| local.patches = None))),
            of("no coarse start", Box::new(prior(|local| local.coarser = 1))),
        ],
    }
}
