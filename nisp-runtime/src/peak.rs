//! The machine's ceiling, measured: what shares of the peak are shares of.

use crate::simd::{Element, Isa, Kernel, Simd, dispatch};
use std::time::{Duration, Instant};

/// Independent multiply-add chains: enough to hide the latency of two units, few enough for sixteen registers.
const CHAINS: usize = 12;
/// Multiply-adds of each chain between two looks at the clock.
const ROUNDS: usize = 20_000;
/// How long the ceiling is looked for.
const BUDGET: Duration = Duration::from_millis(60);

/// Highest rate of floating-point operations (a multiply-add is two), per second, that `threads` threads together reach
/// with vectors of `isa` held in registers. Takes about 60 ms.
///
/// # Panics
/// If `threads` is zero.
pub fn fma_peak<E: Element>(isa: Isa, threads: usize) -> f64 {
    assert!(threads > 0, "a rate needs a thread");
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(move || best_rate::<E>(isa))).collect();
        workers.into_iter().map(|worker| worker.join().expect("plain arithmetic does not panic")).sum()
    })
}

fn best_rate<E: Element>(isa: Isa) -> f64 {
    let operations = (2 * CHAINS * ROUNDS * isa.lanes::<E>()) as f64;
    let begin = Instant::now();
    let mut best = f64::INFINITY;
    while begin.elapsed() < BUDGET {
        let start = Instant::now();
        std::hint::black_box(dispatch::<E, _>(isa, Chains));
        best = best.min(start.elapsed().as_secs_f64());
    }
    operations / best
}

struct Chains;

impl<E: Element> Kernel<E> for Chains {
    type Output = E;
    #[inline(always)]
    fn run<V: Simd<Elem = E>>(self) -> E {
        // The fixed point of x -> a x + b with these numbers is one: nothing overflows or becomes denormal.
        let (a, b) = std::hint::black_box((E::from_f64(0.5), E::from_f64(0.5)));
        let (a, b) = (V::splat(a), V::splat(b));
        let mut chains = [V::splat(std::hint::black_box(E::ONE)); CHAINS];
        for _ in 0..ROUNDS {
            for x in &mut chains {
                *x = x.mul_add(a, b);
            }
        }
        let mut sum = V::splat(E::ZERO);
        for x in chains {
            sum = sum.add(x);
        }
        sum.sum()
    }
}
