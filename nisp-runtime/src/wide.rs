//! Plain loops compiled for the widest vectors of the machine.
//!
//! Nothing here is fused or reassociated, so all paths give the same bits; only their speed differs.

use crate::real::Real;

/// Defines a function that runs `$body`, an `#[inline(always)]` function with the same arguments, compiled for the
/// instruction set found at run time.
macro_rules! widest {
    ($(#[$doc:meta])* $vis:vis fn $name:ident $(<$e:ident: $bound:ident>)? ($($arg:ident: $type:ty),* $(,)?) $(-> $out:ty)? = $body:ident) => {
        $(#[$doc])*
        $vis fn $name $(<$e: $bound>)? ($($arg: $type),*) $(-> $out)? {
            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx512f,avx512dq,avx512vl")]
                fn avx512 $(<$e: $bound>)? ($($arg: $type),*) $(-> $out)? {
                    $body($($arg),*)
                }
                #[target_feature(enable = "avx2")]
                fn avx2 $(<$e: $bound>)? ($($arg: $type),*) $(-> $out)? {
                    $body($($arg),*)
                }
                if is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512dq")
                    && is_x86_feature_detected!("avx512vl")
                {
                    // SAFETY: the machine has the features.
                    return unsafe { avx512($($arg),*) };
                }
                if is_x86_feature_detected!("avx2") {
                    // SAFETY: the machine has the feature.
                    return unsafe { avx2($($arg),*) };
                }
            }
            $body($($arg),*)
        }
    };
}

pub(crate) use widest;

widest! {
    pub(crate) fn add_rows<E: Real>(sums: &mut [E], rows: &[E], distance: usize) = add_rows_loop
}

/// `sums += row` for each row, one after the other; rows begin `distance` apart.
#[inline(always)]
fn add_rows_loop<E: Real>(sums: &mut [E], rows: &[E], distance: usize) {
    for row in rows.chunks(distance) {
        sums.iter_mut().zip(row).for_each(|(sum, &x)| *sum += x);
    }
}

widest! {
    pub(crate) fn subtract<E: Real>(values: &mut [E], others: &[E]) = subtract_loop
}

/// `values -= others`
#[inline(always)]
fn subtract_loop<E: Real>(values: &mut [E], others: &[E]) {
    values.iter_mut().zip(others).for_each(|(value, &x)| *value -= x);
}
