//! Many steps of every scene: memory does not grow, and the same bits come out on another number of threads.

use nisp::Problem;
use nisp::network::{Architecture, initialise};
use nisp::simd::Isa;
use nisp::solve::adam::{Adam, AdamSettings};
use nisp::solve::method::{Method, Verdict};
use nisp_equations::{Request, catalogue};

use crate::row::{Extent, Row};

/// What a long run left.
struct Soaked {
    /// Bits of the weights after the last step.
    weights: Vec<u64>,
    /// Kilobytes that the process has grown by after the first tenth.
    growth: f64,
    /// Steps that did not move, and weights at the end that are not finite.
    wrong: usize,
}

fn soak(problem: &Problem, threads: usize, steps: usize) -> Soaked {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    pool.install(|| {
        let mut engine = problem.engine::<f64>(Isa::detect(), Architecture::modified(4, 2)).expect("a bound problem");
        let mut method = Adam::new(initialise(engine.layout(), 6), AdamSettings::default());
        let (mut settled, mut wrong) = (0.0, 0);
        for step in 1..=steps {
            let moved = method.step(&mut engine).is_ok_and(|s| matches!(s.verdict, Verdict::Moved | Verdict::Changed));
            wrong += usize::from(!moved);
            if step == steps.div_ceil(10) {
                settled = resident();
            }
        }
        let growth = (resident() - settled).max(0.0);
        let theta = Method::<f64, nisp::engine::Engine<f64>>::theta(&method);
        wrong += theta.iter().filter(|x| !x.is_finite()).count();
        Soaked { weights: theta.iter().map(|x| x.to_bits()).collect(), growth, wrong }
    })
}

/// Kilobytes of this process in memory; zero where the system does not say.
fn resident() -> f64 {
    const PAGE: f64 = 4.0;
    let text = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    text.split_whitespace().nth(1).and_then(|pages| pages.parse::<f64>().ok()).unwrap_or(0.0) * PAGE
}

pub(crate) fn rows(extent: Extent) -> Vec<Row> {
    let steps = extent.pick(40, 100_000);
    let mut rows = Vec::new();
    for entry in catalogue() {
        let request = Request { network: true, ..Request::default() };
        let problem = entry.prepare(&request).expect("the repository's example").problem;
        eprintln!("  {}", entry.name);
        let two = soak(&problem, 2, steps);
        let one = soak(&problem, 1, steps);
        let what = |what: &str| format!("`{}`, Adam, f64, width 4: {what}", entry.name);
        // Beside other tests the memory of the process says nothing.
        if extent == Extent::Full {
            let growth = what("growth of memory after a tenth, KB");
            rows.push(Row::new(growth, format!("2 x {steps} steps"), two.growth.max(one.growth), 1024.0));
        }
        rows.push(Row::count(what("steps refused, weights not finite"), 2 * steps, two.wrong + one.wrong));
        let differing = two.weights.iter().zip(&one.weights).filter(|(a, b)| a != b).count();
        let missing = usize::from(two.weights.is_empty() || two.weights.len() != one.weights.len());
        let samples = format!("{steps} steps on 2 threads and on 1");
        rows.push(Row::new(what("weights that differ by a bit"), samples, (differing + missing) as f64, 0.0));
    }
    rows
}
