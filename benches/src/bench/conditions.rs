//! Date and temperature of sessions.

use ferntast_emulation::random::Random;

pub(crate) const SECONDS_A_DAY: f64 = 86_400.0;

/// When and how warm a session is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Conditions {
    /// Since the first session's start \[s\].
    pub(crate) start: f64,
    /// \[degC\] at the start.
    pub(crate) temperature: f64,
    /// How much warmer it gets in the end \[K\].
    pub(crate) warming: f64,
}

/// Range of temperatures of the paper's experiments \[degC\].
const COLDEST: f64 = -10.0;
const WARMEST: f64 = 26.0;

impl Conditions {
    /// Of each of `count` sessions. `same_date`: hours apart, else days to
    /// months; `same_temperature`: within 1 K, else spread over the whole
    /// range in random order, so that date and temperature do not go together.
    pub(crate) fn draw(
        count: usize,
        same_date: bool,
        same_temperature: bool,
        random: &mut Random,
    ) -> Vec<Conditions> {
        let mut order: Vec<usize> = (0..count).collect();
        for index in (1..count).rev() {
            let other = (random.uniform() * (index + 1) as f64) as usize;
            order.swap(index, other.min(index));
        }
        // Whole session lengths and a break fit between sessions of one date.
        let (least, typical) = if same_date {
            (900.0, 900.0)
        } else {
            (0.3 * SECONDS_A_DAY, 45.0 * SECONDS_A_DAY)
        };
        let mut start = 0.0;
        order
            .into_iter()
            .map(|place| {
                let share = (place as f64 + random.uniform()) / count as f64;
                let conditions = Conditions {
                    start,
                    temperature: if same_temperature {
                        8.0 + share
                    } else {
                        COLDEST + share * (WARMEST - COLDEST)
                    },
                    warming: if same_date {
                        8.0
                    } else {
                        0.5 + 0.3 * random.uniform()
                    },
                };
                start += least + typical * random.exponential().min(4.0);
                conditions
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_rise_and_temperatures_spread() {
        let sessions = Conditions::draw(8, false, false, &mut Random::new(3));
        assert_eq!(sessions[0].start, 0.0);
        assert!(
            sessions
                .windows(2)
                .all(|w| w[1].start - w[0].start > 86_400.0 * 0.3)
        );
        let coldest = sessions.iter().map(|s| s.temperature).fold(99.0, f64::min);
        let warmest = sessions.iter().map(|s| s.temperature).fold(-99.0, f64::max);
        assert!(warmest - coldest > 24.0);
        let sessions = Conditions::draw(8, true, false, &mut Random::new(3));
        assert!(sessions[7].start < 86_400.0);
        let sessions = Conditions::draw(8, false, true, &mut Random::new(3));
        assert!(
            sessions
                .iter()
                .all(|s| (8.0..=9.0).contains(&s.temperature))
        );
    }
}
