use proptest::prelude::*;

use super::*;

fn blocks(rows: &[f64]) -> LeftOut {
    LeftOut {
        blocks: rows.chunks(10).map(<[f64]>::to_vec).collect(),
    }
}

/// Noise, and a part that a second model explains.
fn before(part: f64) -> (Vec<f64>, Vec<f64>) {
    let noise = |i: usize| (1.7 * (i * i) as f64).sin();
    let explained = |i: usize| part * (0.9 * i as f64).cos();
    let all = (0..200).map(|i| noise(i) + explained(i)).collect();
    (all, (0..200).map(noise).collect())
}

#[test]
fn what_is_explained_is_certain_and_nothing_is_not() {
    let (all, rest) = before(1.0);
    let decrease = blocks(&rest).decrease_from(&blocks(&all));
    assert!(decrease.is_certain(), "{decrease:?}");
    // cos² has a mean of a half.
    assert!(
        (decrease.mean_square - 0.5).abs() < 3.0 * decrease.std_error,
        "{decrease:?}"
    );
    assert!(!blocks(&all).decrease_from(&blocks(&all)).is_certain());
    assert!(!blocks(&all).decrease_from(&blocks(&rest)).is_certain());
}

#[test]
fn a_decrease_in_one_block_alone_is_not_certain() {
    let (all, _) = before(0.0);
    let mut one = all.clone();
    one.iter_mut()
        .take(10)
        .for_each(|residual| *residual *= 0.5);
    one.iter_mut()
        .skip(10)
        .for_each(|residual| *residual *= 1.001);
    let decrease = blocks(&one).decrease_from(&blocks(&all));
    assert!(
        decrease.after < decrease.before && decrease.std_error > 0.0,
        "{decrease:?}"
    );
}

proptest! {
    /// The decrease is the difference of the two errors that are printed.
    #[test]
    fn it_is_the_difference_of_what_is_printed(
        before in prop::collection::vec(-3.0..3.0f64, 40..90),
        scale in 0.2..1.6f64,
    ) {
        let after: Vec<f64> = before.iter().map(|r| scale * r + 0.1).collect();
        let (before, after) = (blocks(&before), blocks(&after));
        let decrease = after.decrease_from(&before);
        let printed = before.rms().powi(2) - after.rms().powi(2);
        prop_assert!((decrease.mean_square - printed).abs() < 1e-9);
        prop_assert_eq!((decrease.before, decrease.after), (before.rms(), after.rms()));
        prop_assert!(decrease.std_error >= 0.0);
    }
}
