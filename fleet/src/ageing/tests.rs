//! What evidence is worth where the model is the truth.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

use super::filter::Filter;
use super::series::Observation;
use super::spread::Spread;
use super::states::Common;
use super::threshold::false_alarms;

fn normal(draws: &mut ChaCha8Rng) -> f64 {
    let mut uniform = || ((draws.next_u64() >> 11) as f64 + 0.5) / (1_u64 << 53) as f64;
    (-2.0 * uniform().ln()).sqrt() * (std::f64::consts::TAU * uniform()).cos()
}

/// Series drawn from the model itself: how often the best ramp comes to be beyond h is what
/// [`false_alarms`] says, within a factor of two.
#[test]
fn ramps_are_seen_by_chance_as_often_as_the_threshold_reckons() {
    const SERIES: usize = 400;
    const DAYS: i64 = 365;
    let spread = Spread::before(0.01);
    let mut draws = ChaCha8Rng::seed_from_u64(31);
    let mut beyond = [0_usize; 3];
    let bounds = [3.0, 3.5, 4.0];
    for _ in 0..SERIES {
        let mut filter = Filter::new(&spread, true);
        let (drift, slope) = (
            normal(&mut draws) * spread.drift.sqrt(),
            normal(&mut draws) * spread.slope.sqrt(),
        );
        let curvature = normal(&mut draws) * spread.curvature.sqrt();
        let (mut level, mut wander) = (1.0, normal(&mut draws) * spread.wander.sqrt());
        let mut before: f64 = 0.0;
        for day in 0..DAYS {
            level += drift + normal(&mut draws) * spread.walk.sqrt();
            wander = 0.75 * wander
                + (1.0 - 0.75_f64 * 0.75).sqrt() * spread.wander.sqrt() * normal(&mut draws);
            let warmth = (day as f64 / 58.0).sin() + 0.3 * normal(&mut draws);
            let noise = 0.01 * normal(&mut draws);
            let own = Observation {
                day,
                value: level + slope * warmth + curvature * warmth * warmth + wander + noise,
                std_error: 0.01,
                warmth,
            };
            let common = Common {
                value: 0.0,
                variance: 0.0,
            };
            filter.predict(day, &spread);
            filter.update(&own, common, &spread);
            let score = filter.best().map_or(0.0, |best| best.ramp.score.abs());
            for (count, bound) in beyond.iter_mut().zip(bounds) {
                *count += usize::from(score >= bound && before < bound);
            }
            before = score;
        }
    }
    for (count, bound) in beyond.iter().zip(bounds) {
        let expected = false_alarms(SERIES, bound) * DAYS as f64 / 365.25;
        println!("beyond {bound}: {count}, reckoned {expected:.1}");
        let share = *count as f64 / expected;
        assert!(
            (0.5..2.0).contains(&share),
            "beyond {bound}: {count}, reckoned {expected:.1}"
        );
    }
}
