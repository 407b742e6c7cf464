//! A record smoothed as it comes takes no more memory the longer it is.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use nisp::{FixedLagSmoother, LagSettings, Problem, scene};

nisp::pde! {
    /// A mass that an unknown force pushes.
    mod pushed {
        units: off;
        coordinates: t;
        fields: y;
        sources: u;
        on motion { balance: d(y, t, 2) == u; }
        on samples { observe y; }
        scene recover { }
    }
}

struct Counting;

static BYTES: AtomicUsize = AtomicUsize::new(0);
static MOST: AtomicUsize = AtomicUsize::new(0);

// SAFETY: everything is passed on to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        MOST.fetch_max(BYTES.fetch_add(layout.size(), Relaxed) + layout.size(), Relaxed);
        // SAFETY: the caller's promise.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        BYTES.fetch_sub(layout.size(), Relaxed);
        // SAFETY: the caller's promise.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Most bytes while rows are taken, those of later stretches on their thread included.
#[test]
fn memory_does_not_grow_with_the_rows() {
    let mut smoother =
        FixedLagSmoother::new(Problem::new(scene::<pushed::recover::Scene>()), LagSettings::default()).unwrap();
    let mut most = |rows: std::ops::Range<u32>| {
        MOST.store(BYTES.load(Relaxed), Relaxed);
        for i in rows {
            let t = 0.05 * f64::from(i);
            // Multiples of the golden ratio stand for noise.
            let noise = 0.01 * ((f64::from(i) * 0.618_033_988_75).fract() - 0.5);
            smoother.push(t, &[t.sin() + noise]).unwrap();
        }
        MOST.load(Relaxed)
    };
    let early = most(0..20_000);
    let late = most(20_000..100_000);
    assert!(late < early + early / 10, "{early} bytes in the first rows, {late} in later ones");
}
