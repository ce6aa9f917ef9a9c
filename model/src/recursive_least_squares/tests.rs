use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;

use super::*;

/// Seeded noise, uniform in −1 … 1 (SplitMix64).
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (z ^ (z >> 31)) as f64 / u64::MAX as f64 * 2.0 - 1.0
    }

    /// Nearly normal, of unit variance.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.next()).sum::<f64>() / 2.0
    }
}

fn estimator(priors: &[Prior], forgetting: Forgetting) -> RecursiveLeastSquares {
    RecursiveLeastSquares::new(priors, 0.1, forgetting).unwrap()
}

fn learned(update: Update) -> (f64, f64) {
    match update {
        Update::Learned { error, factor } => (error, factor),
        other => panic!("{other:?}"),
    }
}

const WIDE: Prior = Prior::unbounded(0.0, 100.0);
const VARIABLE: Forgetting = Forgetting::Variable {
    memory: 300.0,
    least: 0.9,
};

/// Without forgetting it is the batch solution with the prior as one more
/// measurement: (ΦᵀΦ + S⁻¹)⁻¹ (Φᵀy + S⁻¹θ₀), covariance included.
#[test]
fn equals_the_batch_solution() {
    let priors = [
        Prior::unbounded(1.0, 2.0),
        Prior::unbounded(-1.0, 0.5),
        Prior::unbounded(0.0, 30.0),
    ];
    let mut rls = estimator(&priors, Forgetting::None);
    let mut noise = Noise(7);
    let mut information = DMatrix::from_diagonal(&DVector::from_fn(3, |i, _| {
        (0.1 / priors[i].std_dev).powi(2)
    }));
    let mut right = DVector::from_fn(3, |i, _| information[(i, i)] * priors[i].value);
    for _ in 0..200 {
        let phi = [1.0, noise.next(), 5.0 * noise.next()];
        let y = 3.0 - 2.0 * phi[1] + 0.4 * phi[2] + 0.1 * noise.normal();
        learned(rls.update(&phi, y));
        let column = DVector::from_row_slice(&phi);
        information += &column * column.transpose();
        right += &column * y;
    }
    let covariance = information.clone().try_inverse().unwrap();
    let batch = &covariance * right;
    for i in 0..3 {
        assert!((rls.estimate()[i] - batch[i]).abs() < 1e-10);
        for j in 0..3 {
            let (here, there) = (rls.covariance.at(i, j), covariance[(i, j)]);
            assert!((here - there).abs() < 1e-12 + 1e-9 * there.abs());
        }
    }
}

/// 100 000 samples at rest: plain forgetting loses all it knew of the slope
/// and its covariance grows without bound, variable forgetting keeps it.
#[test]
fn rest_winds_up_plain_forgetting_only() {
    let run = |forgetting| {
        let mut rls = estimator(&[WIDE, WIDE], forgetting);
        let mut noise = Noise(11);
        for sample in 0..102_000 {
            let velocity = if sample < 2_000 { noise.next() } else { 0.0 };
            rls.update(
                &[1.0, velocity],
                2.0 + 3.0 * velocity + 0.1 * noise.normal(),
            );
        }
        rls
    };
    let plain = run(Forgetting::Exponential { factor: 0.997 });
    assert!(plain.variance(1) > 1e30 || plain.estimate()[1].abs() > 1e3);
    let variable = run(VARIABLE);
    assert!((variable.estimate()[1] - 3.0).abs() < 0.05);
    assert!(variable.std_error(1) < 0.05);
    assert!(variable.excitation(1) > 0.999_9);
}

#[test]
fn a_step_is_followed_and_noise_is_averaged() {
    let mut rls = estimator(&[WIDE, WIDE], VARIABLE);
    let mut noise = Noise(5);
    let mut after_step = 0.0;
    for sample in 0..6_000 {
        let phi = [1.0, noise.next()];
        let slope = if sample < 3_000 { 3.0 } else { 4.0 };
        rls.update(&phi, 2.0 + slope * phi[1] + 0.1 * noise.normal());
        if sample == 3_400 {
            after_step = rls.estimate()[1];
        }
    }
    assert!((after_step - 4.0).abs() < 0.1, "{after_step}");
    assert!((rls.estimate()[1] - 4.0).abs() < 0.04);
    assert!((rls.error_std_dev() - 0.1).abs() < 0.02);
}

/// Over 300 seeds the error in units of its standard error has a spread of
/// about one, with white noise and with noise that is correlated (ρ = 0.6).
#[test]
fn standard_errors_are_honest() {
    for correlation in [0.0, 0.6] {
        let mut sum = 0.0;
        for seed in 0..300 {
            let mut noise = Noise(1000 + seed);
            let mut rls = estimator(&[WIDE], Forgetting::None);
            let mut e = 0.0;
            for _ in 0..1_500 {
                e = correlation * e + (1.0_f64 - correlation * correlation).sqrt() * noise.normal();
                rls.update(&[1.0], 2.0 + 0.1 * e);
            }
            sum += ((rls.estimate()[0] - 2.0) / rls.std_error(0)).powi(2);
        }
        let spread = (sum / 300.0_f64).sqrt();
        assert!((0.85..1.15).contains(&spread), "{correlation}: {spread}");
    }
}

/// What the truth wants beyond the bound is held there, and the others are the
/// best there are with it held: y = 2 + 3x, slope at most 1, x even about 0.5.
#[test]
fn bounds_hold_and_the_rest_follows() {
    let bounded = Prior {
        value: 0.0,
        std_dev: 100.0,
        lower: -1.0,
        upper: 1.0,
    };
    let mut rls = estimator(&[WIDE, bounded], Forgetting::None);
    let mut noise = Noise(2);
    for _ in 0..4_000 {
        let x = 0.5 + 0.5 * noise.next();
        rls.update(&[1.0, x], 2.0 + 3.0 * x);
    }
    assert_eq!(rls.estimate()[1], 1.0);
    assert!(rls.at_bound(1) && !rls.at_bound(0));
    assert!(
        (rls.estimate()[0] - 3.0).abs() < 0.05,
        "{:?}",
        rls.estimate()
    );
}

#[test]
fn what_is_not_a_number_changes_nothing() {
    let mut rls = estimator(&[WIDE, WIDE], VARIABLE);
    rls.update(&[1.0, 2.0], 3.0);
    let before = rls.estimate().to_vec();
    for (phi, y) in [
        (&[f64::NAN, 1.0][..], 1.0),
        (&[1.0, 1.0], f64::INFINITY),
        (&[1.0], 1.0),
        (&[1.0, 1e300], 1.0),
    ] {
        assert_eq!(rls.update(phi, y), Update::Refused);
    }
    assert_eq!(rls.estimate(), before);
}

#[test]
fn unusable_priors_are_named() {
    let none = RecursiveLeastSquares::new(&[], 1.0, Forgetting::None);
    assert_eq!(none.unwrap_err(), PriorError::Empty);
    let silent = RecursiveLeastSquares::new(&[WIDE], 0.0, Forgetting::None);
    assert_eq!(silent.unwrap_err(), PriorError::Noise(0.0));
    let outside = Prior {
        value: 2.0,
        std_dev: 1.0,
        lower: 0.0,
        upper: 1.0,
    };
    let error = RecursiveLeastSquares::new(&[WIDE, outside], 1.0, Forgetting::None);
    assert!(error.unwrap_err().to_string().contains("parameter 1"));
}

proptest! {
    /// Whatever comes, the estimate is finite, within its bounds, no less
    /// certain than the prior, and the covariance positive.
    #[test]
    fn stays_sane(
        seed in any::<u64>(),
        scales in prop::collection::vec(-6.0..6.0_f64, 4),
        memory in 2.0..1e4_f64,
    ) {
        let least = 0.9;
        let forgetting = Forgetting::Variable { memory, least };
        let prior = Prior { value: 0.0, std_dev: 10.0, lower: -50.0, upper: 50.0 };
        let mut rls = estimator(&[prior; 4], forgetting);
        let mut noise = Noise(seed);
        for sample in 0..3_000 {
            let quiet = (sample / 500) % 2 == 1;
            let phi: Vec<f64> = scales
                .iter()
                .enumerate()
                .map(|(i, s)| if quiet && i > 0 { 0.0 } else { 10f64.powf(*s) * noise.next() })
                .collect();
            rls.update(&phi, 100.0 * noise.next());
            for i in 0..4 {
                prop_assert!(rls.estimate()[i].abs() <= 50.0);
                let variance = rls.variance(i);
                prop_assert!(variance >= 0.0 && variance <= rls.start[i] * (1.0 + 1e-6), "{}", variance);
                prop_assert!(rls.std_error(i).is_finite());
            }
        }
    }
}
