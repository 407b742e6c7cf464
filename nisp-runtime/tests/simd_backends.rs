//! Every instruction set of this machine computes what plain arithmetic computes, lane by lane.

use nisp_runtime::real::Real;
use nisp_runtime::simd::{Element, Isa, Kernel, Simd, dispatch};

/// Inputs with every sign, some equal, and numbers that are not finite.
fn samples<E: Element>() -> Vec<E> {
    let special = [0.0, -0.0, 1.0, -1.0, 2.5, -2.5, 3.5, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, 1e-30, -7.25];
    let plain = (0..116).map(|i| f64::from(i * i % 89 - 40) * 0.37);
    special.into_iter().chain(plain).map(E::from_f64).collect()
}

struct Check;

/// Equal, or both NaN, within `ulps` rounding errors.
fn same<E: Element>(got: E, want: f64, ulps: f64, what: &str) {
    let (got, bound) = (got.to_f64(), ulps * E::EPSILON.to_f64() * want.abs());
    let equal = got == E::from_f64(want).to_f64() || (got.is_nan() && want.is_nan()) || (got - want).abs() <= bound;
    assert!(equal, "{what}: {got} instead of {want}");
}

/// Runs `vector` over all lanes of the three inputs and compares with `scalar`.
#[inline(always)]
fn lanes<V: Simd>(
    what: &str,
    inputs: [&[V::Elem]; 3],
    vector: impl Fn(V, V, V) -> V,
    scalar: impl Fn(f64, f64, f64) -> f64,
    ulps: f64,
) {
    let mut out = vec![V::Elem::ZERO; V::LANES];
    for at in (0..inputs[0].len() - V::LANES).step_by(V::LANES) {
        // SAFETY: LANES elements remain from `at`, and `out` has as many.
        unsafe {
            let [a, b, c] = inputs.map(|x| V::load(x[at..at + V::LANES].as_ptr()));
            vector(a, b, c).store(out.as_mut_ptr());
        }
        for (lane, &got) in out.iter().enumerate() {
            let [a, b, c] = inputs.map(|x| x[at + lane].to_f64());
            same(got, scalar(a, b, c), ulps, &format!("{what}({a}, {b}, {c})"));
        }
    }
}

impl<E: Element> Kernel<E> for Check {
    type Output = ();
    #[inline(always)]
    fn run<V: Simd<Elem = E>>(self) {
        let a = samples::<E>();
        let b: Vec<E> = a.iter().rev().copied().collect();
        let c: Vec<E> = a.iter().cycle().skip(7).take(a.len()).copied().collect();
        let all = [&*a, &*b, &*c];
        lanes::<V>("splat", all, |_, _, _| V::lit(2.5), |_, _, _| 2.5, 0.0);
        lanes::<V>("add", all, |a, b, _| a.add(b), |a, b, _| a + b, 0.5);
        lanes::<V>("sub", all, |a, b, _| a.sub(b), |a, b, _| a - b, 0.5);
        lanes::<V>("mul", all, |a, b, _| a.mul(b), |a, b, _| a * b, 0.5);
        lanes::<V>("div", all, |a, b, _| a.div(b), |a, b, _| a / b, 0.5);
        lanes::<V>("neg", all, |a, _, _| a.neg(), |a, _, _| -a, 0.0);
        lanes::<V>("abs", all, |a, _, _| a.abs(), |a, _, _| a.abs(), 0.0);
        lanes::<V>("sqrt", all, |a, _, _| a.sqrt(), |a, _, _| a.sqrt(), 0.5);
        lanes::<V>("min", all, |a, b, _| a.min(b), |a, b, _| if a < b { a } else { b }, 0.0);
        lanes::<V>("max", all, |a, b, _| a.max(b), |a, b, _| if a > b { a } else { b }, 0.0);
        lanes::<V>("copysign", all, |a, b, _| a.copysign(b), |a, b, _| a.copysign(b), 0.0);
        lanes::<V>("select", all, |a, b, c| V::select(a.less(b), b, c), |a, b, c| if a < b { b } else { c }, 0.0);
        lanes::<V>("map", all, |a, _, _| a.map(f64::sin), |a, _, _| a.sin(), 0.5);
        let finite = |x: &[E]| -> Vec<E> { x.iter().map(|x| if x.is_finite() { *x } else { E::ONE }).collect() };
        let (a, b, c) = (finite(&a), finite(&b), finite(&c));
        let all = [&*a, &*b, &*c];
        lanes::<V>("round", all, |a, _, _| a.round(), |a, _, _| a.round_ties_even(), 0.0);
        lanes::<V>("scale2", all, |a, b, _| a.scale2(b.round()), |a, b, _| a * b.round_ties_even().exp2(), 0.0);
        multiply_adds::<V>(all);
        sums::<V>(&a);
    }
}

/// Cancellation may magnify the rounding of an unfused product: compare with the size of the terms.
#[inline(always)]
fn multiply_adds<V: Simd>(all: [&[V::Elem]; 3]) {
    let size = |a: f64, b: f64, c: f64| (a * b).abs() + c.abs() + 1.0;
    let scaled = |a: V, b: V, c: V, x: V| x.add(a.mul(b).abs().add(c.abs()).add(V::lit(1.0)).mul(V::lit(1024.0)));
    let want = |x: f64, s: f64| x + 1024.0 * s;
    lanes::<V>(
        "mul_add",
        all,
        |a, b, c| scaled(a, b, c, a.mul_add(b, c)),
        |a, b, c| want(a * b + c, size(a, b, c)),
        2.0,
    );
    lanes::<V>(
        "mul_sub",
        all,
        |a, b, c| scaled(a, b, c, a.mul_sub(b, c)),
        |a, b, c| want(a * b - c, size(a, b, c)),
        2.0,
    );
    lanes::<V>(
        "neg_mul_add",
        all,
        |a, b, c| scaled(a, b, c, a.neg_mul_add(b, c)),
        |a, b, c| want(c - a * b, size(a, b, c)),
        2.0,
    );
}

#[inline(always)]
fn sums<V: Simd>(a: &[V::Elem]) {
    for chunk in a.chunks_exact(V::LANES) {
        // SAFETY: the chunk has LANES elements.
        let got = unsafe { V::load(chunk.as_ptr()) }.sum().to_f64();
        let want: f64 = chunk.iter().map(|x| x.to_f64()).sum();
        let size: f64 = chunk.iter().map(|x| x.to_f64().abs()).sum();
        assert!((got - want).abs() <= 4.0 * V::Elem::EPSILON.to_f64() * size, "sum of {chunk:?}: {got}");
    }
}

#[test]
fn every_instruction_set_agrees_with_plain_arithmetic() {
    for isa in Isa::available() {
        dispatch::<f32, _>(isa, Check);
        dispatch::<f64, _>(isa, Check);
    }
}

struct FusedIsFused;

impl<E: Element> Kernel<E> for FusedIsFused {
    type Output = ();
    #[inline(always)]
    fn run<V: Simd<Elem = E>>(self) {
        // (1 + e)^2 - (1 + 2 e) is e^2 if rounded once, zero if the product is rounded.
        let x = V::splat(E::ONE + E::EPSILON);
        let y = V::splat(E::ONE + E::EPSILON + E::EPSILON);
        let square = (E::EPSILON * E::EPSILON).to_f64() * V::LANES as f64;
        let want = if V::FUSED { square } else { 0.0 };
        assert_eq!(x.mul_sub(x, y).sum().to_f64(), want);
        assert_eq!(x.mul_add(x, y.neg()).sum().to_f64(), want);
        assert_eq!(x.neg_mul_add(x, y).sum().to_f64(), -want);
    }
}

#[test]
fn multiply_add_rounds_as_it_says() {
    for isa in Isa::available() {
        dispatch::<f32, _>(isa, FusedIsFused);
        dispatch::<f64, _>(isa, FusedIsFused);
    }
}

#[test]
fn scale2_reaches_below_the_normal_numbers() {
    struct Denormal;
    impl<E: Element> Kernel<E> for Denormal {
        type Output = f64;
        #[inline(always)]
        fn run<V: Simd<Elem = E>>(self) -> f64 {
            let n = if E::NAME == "f32" { -140.0 } else { -1060.0 };
            V::lit(1.5).scale2(V::lit(n)).sum().to_f64() / V::LANES as f64
        }
    }
    for isa in Isa::available() {
        assert_eq!(dispatch::<f32, _>(isa, Denormal), 1.5 * 2.0_f64.powi(-140));
        // The sum of denormals divided by a power of two stays exact: lanes are few.
        assert_eq!(dispatch::<f64, _>(isa, Denormal), 1.5 * 2.0_f64.powi(-1000) * 2.0_f64.powi(-60));
    }
}

#[test]
fn instruction_sets_have_names_and_lengths() {
    let all: Vec<Isa> = Isa::available().collect();
    assert_eq!(all.last(), Some(&Isa::SCALAR));
    assert!(all.contains(&Isa::detect()));
    for isa in all {
        assert_eq!(Isa::from_name(isa.name()), Some(isa));
        let lanes = [isa.lanes::<f32>(), isa.lanes::<f64>()];
        assert!(if isa == Isa::SCALAR { lanes == [1, 1] } else { lanes[0] == 2 * lanes[1] }, "{isa:?} {lanes:?}");
    }
    assert_eq!(Isa::from_name("pdp11"), None);
}
