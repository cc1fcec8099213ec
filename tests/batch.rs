//! Kernels over many states at once give, lane by lane, the bits of the single state.

use piaffe::gaits::{amble, curvet, trot};
use std::array::from_fn;

/// Lanes for every number, drawn from (−size, size).
fn draw<const N: usize, const K: usize>(random: &mut fastrand::Rng, size: f64) -> [[f64; N]; K] {
    from_fn(|_| from_fn(|_| size * (2.0 * random.f64() - 1.0)))
}

fn bits<'a>(values: impl IntoIterator<Item = &'a f64>) -> Vec<u64> {
    values.into_iter().map(|x| x.to_bits()).collect()
}

/// One lane of an array of lanes.
fn lane<const N: usize, const K: usize>(x: &[[f64; N]; K], i: usize) -> [f64; K] {
    from_fn(|k| x[k][i])
}

macro_rules! same_bits {
    ($gait:ident, $lanes:literal, $random:expr) => {{
        let (q, qd) = (draw::<$lanes, _>($random, 1.2), draw::<$lanes, _>($random, 5.0));
        let mut out = $gait::InertiaAndBias { a: [[[0.0; $lanes]; _]; _], h: [[0.0; $lanes]; _] };
        $gait::inertia_and_bias_batch(&q, &qd, &mut out);
        for i in 0..$lanes {
            let single = $gait::inertia_and_bias(&lane(&q, i), &lane(&qd, i));
            assert_eq!(bits(out.a.as_flattened().iter().map(|x| &x[i])), bits(single.a.as_flattened()));
            assert_eq!(bits(out.h.iter().map(|x| &x[i])), bits(&single.h));
        }
        let qdd = draw::<$lanes, _>($random, 60.0);
        let mut out = $gait::Inverse { xdd: [[0.0; $lanes]; _], gamma: [[0.0; $lanes]; _], f: [[0.0; $lanes]; _] };
        $gait::inverse1_batch(&q, &qd, &qdd, &mut out);
        for i in 0..$lanes {
            let single = $gait::inverse1(&lane(&q, i), &lane(&qd, i), &lane(&qdd, i));
            assert_eq!(bits(out.xdd.iter().map(|x| &x[i])), bits(&single.xdd));
            assert_eq!(bits(out.gamma.iter().map(|x| &x[i])), bits(&single.gamma));
            assert_eq!(bits(out.f.iter().map(|x| &x[i])), bits(&single.f));
        }
    }};
}

#[test]
fn batches_have_the_bits_of_single_states() {
    let random = &mut fastrand::Rng::with_seed(7);
    for _ in 0..200 {
        same_bits!(trot, 8, random);
        same_bits!(curvet, 8, random);
        same_bits!(amble, 8, random);
        same_bits!(trot, 3, random);
        same_bits!(amble, 1, random);
    }
}
