//! A generic dense jet: truncated Taylor arithmetic over all monomials up to an order, driven by tables.
//!
//! It runs in the same engine, on the same tiles and matrix products as generated code, so that what differs is the
//! rules alone. Channels are Taylor coefficients: `1 / alpha!` times the partial derivative.

#![allow(clippy::needless_range_loop, reason = "indices are those of monomials, in several arrays at once")]

use nisp::__private::{Rules, Simd};

/// Monomials of `S` variables up to some order, `K` in number, lowest order first, and the products that stay within it.
struct Tables<const K: usize, const S: usize> {
    exponents: [[usize; S]; K],
    degrees: [usize; K],
    /// For each monomial but the first, a variable in it and the monomial without one of it.
    parents: [(usize, usize); K],
    /// `products[a][b]` is the monomial of the product, or `K` if it is beyond the order.
    products: [[usize; K]; K],
    /// Number of monomials up to each degree.
    up_to: [usize; 16],
}

impl<const K: usize, const S: usize> Tables<K, S> {
    const fn new(order: usize) -> Self {
        let mut tables = Self {
            exponents: [[0; S]; K],
            degrees: [0; K],
            parents: [(0, 0); K],
            products: [[K; K]; K],
            up_to: [K; 16],
        };
        let mut count = 1;
        let mut parent = 0;
        // Every monomial extends its parent by a variable that is not before the parent's last.
        while parent < count {
            let mut variable = S;
            while variable > 0 && tables.exponents[parent][variable - 1] == 0 {
                variable -= 1;
            }
            let mut variable = if variable == 0 { 0 } else { variable - 1 };
            while variable < S && tables.degrees[parent] < order {
                tables.exponents[count] = tables.exponents[parent];
                tables.exponents[count][variable] += 1;
                tables.degrees[count] = tables.degrees[parent] + 1;
                tables.parents[count] = (variable, parent);
                count += 1;
                variable += 1;
            }
            parent += 1;
        }
        assert!(count == K);
        let mut k = K;
        while k > 0 {
            k -= 1;
            if tables.degrees[k] > 0 {
                tables.up_to[tables.degrees[k] - 1] = k;
            }
        }
        let mut a = 0;
        while a < K {
            let mut b = 0;
            while b < K {
                let mut sum = tables.exponents[a];
                let mut i = 0;
                while i < S {
                    sum[i] += tables.exponents[b][i];
                    i += 1;
                }
                tables.products[a][b] = tables.find(sum);
                b += 1;
            }
            a += 1;
        }
        tables
    }

    const fn find(&self, exponents: [usize; S]) -> usize {
        let mut at = 0;
        while at < K {
            let mut i = 0;
            while i < S && self.exponents[at][i] == exponents[i] {
                i += 1;
            }
            if i == S {
                return at;
            }
            at += 1;
        }
        K
    }
}

/// Where the monomial with these exponents stands among the `K` up to `order`.
pub(crate) const fn channel<const K: usize, const S: usize>(order: usize, exponents: [usize; S]) -> usize {
    Tables::<K, S>::new(order).find(exponents)
}

/// Rules of the dense jet with `K` channels; the order is `D - 2`.
pub(crate) struct Dense<const K: usize, const D: usize, const S: usize>;

const FACTORIALS: [f64; 10] = [1.0, 1.0, 2.0, 6.0, 24.0, 120.0, 720.0, 5040.0, 40320.0, 362_880.0];

impl<const K: usize, const D: usize, const S: usize> Dense<K, D, S> {
    const TABLES: &Tables<K, S> = &Tables::new(D - 2);

    /// Adds `f g` up to degree `top`, leaving out the monomials of `g` before `from`.
    #[inline(always)]
    fn add_product<V: Simd>(out: &mut [V; K], f: &[V; K], g: &[V; K], from: usize, top: usize) {
        let t = Self::TABLES;
        for b in from..t.up_to[top] {
            for a in 0..t.up_to[top - t.degrees[b]] {
                let c = t.products[a][b];
                out[c] = f[a].mul_add(g[b], out[c]);
            }
        }
    }

    /// Adds the adjoints of both factors.
    #[inline(always)]
    fn add_product_adjoint<V: Simd>(
        [f, g]: [&[V; K]; 2],
        seed: &[V; K],
        [f_bar, g_bar]: [&mut [V; K]; 2],
        from: usize,
        top: usize,
    ) {
        let t = Self::TABLES;
        for b in from..t.up_to[top] {
            for a in 0..t.up_to[top - t.degrees[b]] {
                let c = t.products[a][b];
                f_bar[a] = seed[c].mul_add(g[b], f_bar[a]);
                g_bar[b] = seed[c].mul_add(f[a], g_bar[b]);
            }
        }
    }

    /// `w^alpha / alpha!` for every monomial.
    #[inline(always)]
    fn monomials<V: Simd>(w: &[V; S]) -> [V; K] {
        let mut monomials = [V::lit(1.0); K];
        for k in 1..K {
            let (variable, parent) = Self::TABLES.parents[k];
            let power = Self::TABLES.exponents[k][variable];
            monomials[k] = monomials[parent].mul(w[variable]).mul(V::lit(1.0 / power as f64));
        }
        monomials
    }
}

impl<const K: usize, const D: usize, const S: usize> Rules<K, D, S> for Dense<K, D, S> {
    const READ: [bool; K] = [true; K];

    #[inline(always)]
    fn compose<V: Simd>(phi: &[V; D], a: &[V; K]) -> [V; K] {
        // What is left to be multiplied n times by a series without constant needs the lower degrees alone.
        let mut sum = [V::lit(0.0); K];
        for n in (0..D - 1).rev() {
            let mut next = [V::lit(0.0); K];
            Self::add_product(&mut next, &sum, a, 1, D - 2 - n);
            next[0] = phi[n].mul(V::lit(1.0 / FACTORIALS[n]));
            sum = next;
        }
        sum
    }

    #[inline(always)]
    fn compose_adjoint<V: Simd>(phi: &[V; D], a: &[V; K], seed: &[V; K]) -> [V; K] {
        let zero = [V::lit(0.0); K];
        let mut sums = [zero; D];
        for n in (0..D - 1).rev() {
            let mut next = zero;
            Self::add_product(&mut next, &sums[n + 1], a, 1, D - 2 - n);
            next[0] = phi[n].mul(V::lit(1.0 / FACTORIALS[n]));
            sums[n] = next;
        }
        let (mut bar, mut sum_bar) = (zero, *seed);
        let mut value = V::lit(0.0);
        for n in 0..D - 1 {
            value = sum_bar[0].mul_add(phi[n + 1].mul(V::lit(1.0 / FACTORIALS[n])), value);
            sum_bar[0] = V::lit(0.0);
            let mut next = zero;
            Self::add_product_adjoint([&sums[n + 1], a], &sum_bar, [&mut next, &mut bar], 1, D - 2 - n);
            sum_bar = next;
        }
        bar[0] = value;
        bar
    }

    #[inline(always)]
    fn affine<V: Simd>(phi: &[V; D], w: &[V; S]) -> [V; K] {
        let mut y = Self::monomials(w);
        for k in 0..K {
            y[k] = y[k].mul(phi[Self::TABLES.degrees[k]]);
        }
        y
    }

    #[inline(always)]
    fn affine_adjoint<V: Simd>(phi: &[V; D], w: &[V; S], seed: &[V; K]) -> (V, [V; S]) {
        let monomials = Self::monomials(w);
        let mut bars = *seed;
        let mut value = V::lit(0.0);
        for k in 0..K {
            let degree = Self::TABLES.degrees[k];
            value = seed[k].mul(monomials[k]).mul_add(phi[degree + 1], value);
            bars[k] = seed[k].mul(phi[degree]);
        }
        let mut w_bar = [V::lit(0.0); S];
        for k in (1..K).rev() {
            let (variable, parent) = Self::TABLES.parents[k];
            let bar = bars[k].mul(V::lit(1.0 / Self::TABLES.exponents[k][variable] as f64));
            w_bar[variable] = bar.mul_add(monomials[parent], w_bar[variable]);
            bars[parent] = bar.mul_add(w[variable], bars[parent]);
        }
        (value, w_bar)
    }

    #[inline(always)]
    fn product<V: Simd>(f: &[V; K], g: &[V; K]) -> [V; K] {
        let mut product = [V::lit(0.0); K];
        Self::add_product(&mut product, f, g, 0, D - 2);
        product
    }

    #[inline(always)]
    fn product_adjoint<V: Simd>(f: &[V; K], g: &[V; K], seed: &[V; K]) -> ([V; K], [V; K]) {
        let (mut f_bar, mut g_bar) = ([V::lit(0.0); K], [V::lit(0.0); K]);
        Self::add_product_adjoint([f, g], seed, [&mut f_bar, &mut g_bar], 0, D - 2);
        (f_bar, g_bar)
    }
}
