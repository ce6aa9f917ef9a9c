//! Laws that no catalogue has, drawn by a grammar of their own: a product of functions
//! of one, two or three quantities, or the sum of two products.
//!
//! To be judged by: whoever searches for a formula knows neither these functions nor
//! how they are put together.

mod function;

use ferntast_emulation::random::Random;

use super::effect::{Effect, Friction, State};
use super::{Bench, BenchConfig, BenchError, BenchRecording};
use crate::bench::{Stream, about, random};
use function::Function;

/// Own part of a law at full strength over the filtered sensor noise, as most
/// effects of the catalogue have it.
const VISIBILITY: f64 = 8.0;
/// Smallest share of a law that equation (4) does not take over, as rms: what
/// looks like its terms is not outside the catalogue.
const MIN_OWN_SHARE: f64 = 0.45;
/// Laws drawn until one is far enough from equation (4), at most.
const DRAWS: usize = 60;
/// Laws that are tried until one stands out as far as it should, at most.
const LAWS: usize = 6;
/// How often a law is made smaller or larger until it stands out as far as it should …
const MAX_TRIES: usize = 8;
/// … within this, as the logarithm of a ratio.
const NEAR: f64 = 0.2;
/// Below this no sign of the velocity is known \[rad/s\].
const REST: f64 = 0.01;

/// What a law is about, with its usual size. No acceleration: what friction makes of that comes back
/// into it within a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Quantity {
    Velocity,
    Load,
    Position,
    Temperature,
}

use Quantity::{Load, Position, Temperature, Velocity};

impl Quantity {
    /// Its value over its usual size.
    fn of(self, state: &State) -> f64 {
        match self {
            Velocity => state.velocity / 0.7,
            Load => state.load / 15.0,
            Position => (state.position + 0.12) / 0.7,
            Temperature => (state.temperature + 10.0) / 36.0,
        }
    }

    const fn word(self) -> &'static str {
        match self {
            Velocity => "velocity",
            Load => "load",
            Position => "position",
            Temperature => "temperature",
        }
    }
}

/// A product of functions, each of one quantity.
#[derive(Clone, Debug, PartialEq)]
struct Product {
    size: f64,
    /// Whether bristles carry it, so that it opposes motion.
    opposes: bool,
    functions: Vec<(Quantity, Function)>,
}

impl Product {
    fn draw(random: &mut Random) -> Self {
        let first = match (random.uniform() * 10.0) as usize {
            0..3 => Velocity,
            3..6 => Load,
            _ => Position,
        };
        let mut about = vec![first];
        if random.chance(0.75) {
            let second = match (random.uniform() * 8.0) as usize {
                0..2 => Velocity,
                2..4 => Load,
                4..6 => Position,
                _ => Temperature,
            };
            if second != first {
                about.push(second);
            }
        }
        let turns = about.contains(&Velocity);
        let opposes = !turns && random.chance(0.5);
        let mut functions = Vec::new();
        for quantity in about {
            let placed = matches!(quantity, Position | Temperature);
            let odd = !placed && (quantity == Velocity || random.chance(0.4));
            functions.push((quantity, Function::draw(odd, placed, random)));
        }
        Self {
            size: 0.5 + random.uniform(),
            opposes,
            functions,
        }
    }

    fn value(&self, state: &State) -> f64 {
        let functions = self.functions.iter();
        let product: f64 = functions
            .map(|(quantity, function)| function.value(quantity.of(state)))
            .product();
        self.size * product
    }
}

/// A law that no catalogue has.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Law {
    /// \[Nm\]
    size: f64,
    products: Vec<Product>,
}

impl Law {
    /// One that no catalogue has, with its RMS in these states \[Nm\]; the farthest of many from
    /// equation (4), or the first that is far enough.
    fn far_from_equation_4(states: &[State], random: &mut Random) -> Option<(f64, Law)> {
        let mut best: Option<(f64, f64, Law)> = None;
        for _ in 0..DRAWS {
            let law = Law::draw(random);
            if law.is_in_catalogue() {
                continue;
            }
            let torques: Vec<f64> = states.iter().map(|state| law.sliding(state)).collect();
            let whole = rms(&torques);
            let own = rms(&beyond_equation_4(states, torques)) / whole.max(1e-12);
            let is_far = own > MIN_OWN_SHARE;
            if whole > 1e-6 && best.as_ref().is_none_or(|(most, ..)| own > *most) {
                best = Some((own, whole, law));
            }
            if is_far {
                break;
            }
        }
        best.map(|(_, whole, law)| (whole, law))
    }

    fn draw(random: &mut Random) -> Self {
        let count = if random.chance(0.25) { 2 } else { 1 };
        Self {
            size: if random.chance(0.5) { 1.0 } else { -1.0 },
            products: (0..count).map(|_| Product::draw(random)).collect(),
        }
    }

    /// Its torque where bristles are bent as far as the direction says \[Nm\].
    fn sliding(&self, state: &State) -> f64 {
        let sign = state.velocity.signum();
        let each = self.products.iter().map(|own| {
            let value = own.value(state);
            if own.opposes { sign * value } else { value }
        });
        self.size * each.sum::<f64>()
    }

    /// Whether the lab's catalogue has a law of this kind: more friction at one place,
    /// a pull or friction that is one of speed and temperature, a cable, weight.
    fn is_in_catalogue(&self) -> bool {
        let [only] = self.products.as_slice() else {
            return false;
        };
        let about: Vec<Quantity> = only.functions.iter().map(|own| own.0).collect();
        match about.as_slice() {
            [Position] => true,
            [Velocity] => true,
            [first, second] => {
                [*first, *second].contains(&Temperature) && about.contains(&Velocity)
            }
            _ => false,
        }
    }

    fn words(&self) -> String {
        let each = self.products.iter().map(|own| {
            let functions = own.functions.iter();
            let functions = functions.map(|(quantity, function)| function.of(quantity.word()));
            let words: Vec<String> = functions.collect();
            let opposes = if own.opposes { ", against motion" } else { "" };
            format!("{}{opposes}", words.join(" times "))
        });
        each.collect::<Vec<_>>().join("; and ")
    }
}

impl Effect for Law {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![("size", self.size, "Nm")]
    }

    fn friction(&self, state: &State, friction: &mut Friction) {
        for own in &self.products {
            let torque = self.size * own.value(state);
            match own.opposes {
                true => friction.level += torque,
                false => friction.torque += torque,
            }
        }
    }

    fn boxed(&self) -> Box<dyn Effect> {
        Box::new(self.clone())
    }
}

impl Bench {
    /// A bench that hides a law that no catalogue has, drawn from the seed of
    /// `config`; and the law in words. Beside it nothing is hidden, and all of
    /// equation (4) is believed. At full strength it stands out from the filtered
    /// noise by about 8, and no less than 45 % of it is not like equation (4).
    ///
    /// # Errors
    ///
    /// A value is out of bounds, or the joint runs away.
    pub fn with_law(config: &BenchConfig) -> Result<(Self, String), BenchError> {
        let mut bench = Self::new(&BenchConfig {
            hidden: Vec::new(),
            ..config.clone()
        })?;
        let plain = bench.record()?;
        let states = states(&plain);
        let mut random = random(config.seed, Stream::Effect, usize::from(u16::MAX));
        let mut nearest: Option<(f64, Law)> = None;
        for _ in 0..LAWS {
            let Some((whole, mut law)) = Law::far_from_equation_4(&states, &mut random) else {
                continue;
            };
            let aim = config.strength * about(VISIBILITY, &mut random);
            law.size *= aim * plain.noise_rms() / whole;
            let (off, law) = bench.standing_out(law, aim);
            if nearest.as_ref().is_none_or(|(least, _)| off < *least) {
                nearest = Some((off, law));
            }
            // With some the joint sticks or slips, and jumps past what is asked for.
            if off < NEAR {
                break;
            }
        }
        let Some((_, law)) = nearest else {
            return Ok((bench, String::new()));
        };
        let words = law.words();
        bench.effects = vec![law.boxed()];
        Ok((bench, words))
    }

    /// The law of the size with which it stands out by `aim`, and how far off that it is, as the
    /// logarithm of a ratio. It changes the motion, and so how far it stands out; friction that is
    /// negative somewhere may run a joint away: less of it then.
    fn standing_out(&mut self, mut law: Law, aim: f64) -> (f64, Law) {
        let mut nearest = (f64::INFINITY, law.clone());
        for _ in 0..MAX_TRIES {
            self.effects = vec![law.boxed()];
            let off = self.record().map(|own| aim / own.visibility().max(1e-12));
            if let Ok(off) = off
                && off.ln().abs() < nearest.0
            {
                nearest = (off.ln().abs(), law.clone());
            }
            if nearest.0 < NEAR {
                break;
            }
            law.size *= off.map_or(0.5, |off| off.clamp(0.25, 2.0));
        }
        nearest
    }
}

/// The states of a recording in which the joint slides.
fn states(recording: &BenchRecording) -> Vec<State> {
    let sessions = recording.sessions.iter();
    let each = sessions.flat_map(|session| {
        let truth = &session.truth;
        (0..session.time.len()).step_by(7).map(move |at| State {
            time: session.time[at],
            temperature: truth.temperature[at],
            position: truth.position[at],
            velocity: truth.velocity[at],
            load: truth.joint_torque[at],
            ..State::default()
        })
    });
    each.filter(|state| state.velocity.abs() > REST).collect()
}

/// What is left of `torques` when the terms of equation (4) have taken what they can.
fn beyond_equation_4(states: &[State], mut torques: Vec<f64>) -> Vec<f64> {
    let terms: [fn(&State) -> f64; 5] = [
        |s| s.velocity.signum(),
        |s| s.load.abs() * s.velocity.signum(),
        |s| s.velocity,
        |s| s.velocity * s.velocity.abs(),
        |s| s.velocity.powi(3),
    ];
    let along = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let take_out = |basis: &[Vec<f64>], of: &mut Vec<f64>| {
        for own in basis {
            let share = along(own, of);
            of.iter_mut()
                .zip(own)
                .for_each(|(x, own)| *x -= share * own);
        }
    };
    for term in terms {
        let mut column: Vec<f64> = states.iter().map(term).collect();
        take_out(&basis, &mut column);
        let length = along(&column, &column).sqrt().max(1e-300);
        column.iter_mut().for_each(|x| *x /= length);
        basis.push(column);
    }
    take_out(&basis, &mut torques);
    torques
}

fn rms(values: &[f64]) -> f64 {
    crate::bench::rms(values.iter().copied())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recorded(seed: u64) -> (BenchRecording, String) {
        let config = BenchConfig {
            seed,
            sessions: 2,
            ..BenchConfig::default()
        };
        let (bench, words) = Bench::with_law(&config).unwrap();
        (bench.record().unwrap(), words)
    }

    #[test]
    fn a_law_stands_out_as_far_as_it_says() {
        for seed in 1..5 {
            let (recording, words) = recorded(seed);
            let visibility = recording.visibility();
            assert!((5.0..12.5).contains(&visibility), "{words}: {visibility}");
            // Taken out by what was logged of it, little is left.
            let without = recording.without_hidden().visibility();
            assert!(without < 0.2 * visibility, "{words}: {without}");
        }
    }

    #[test]
    fn seeds_draw_different_laws_and_the_same_seed_the_same() {
        let (first, again, other) = (recorded(3), recorded(3), recorded(4));
        assert_eq!(first, again);
        assert_ne!(first.1, other.1);
    }
}
