//! The terms that a search begins from, each with its column: functions of one signal
//! and products of two, with their constants on a coarse grid; of three signals over which
//! there is a map, products of three of the plainest.

use super::rows::{Channel, Kind, Rows, square};
use super::shape::Shape;
use super::term::{Factor, Term, VELOCITY};

/// Terms, and what of their columns is their own, of length one.
pub(super) struct Dictionary {
    pub(super) terms: Vec<Term>,
    /// One after the other, each as long as there are rows.
    pub(super) columns: Vec<f32>,
}

/// Shares of the largest size that scales are tried at, …
const SCALES: [f64; 3] = [0.04, 0.15, 0.5];
/// … of signals about zero, …
const SCALES_ABOUT: [f64; 2] = [0.15, 0.5];
/// … and shares of the range, of places in it, …
const PLACES: [f64; 5] = [0.15, 0.32, 0.5, 0.68, 0.85];
/// … of steps and spots, …
const WIDTHS: [f64; 2] = [0.07, 0.25];
/// … and turns over the range, of waves.
const TURNS: [f64; 6] = [0.5, 1.0, 1.5, 2.0, 3.0, 5.0];

/// The factors of a signal by itself, and those of them that enter products.
struct Factors {
    alone: Vec<Factor>,
    in_products: Vec<Factor>,
}

/// Functions of one signal.
fn factors(number: usize, channel: &Channel) -> Factors {
    let [low, high] = channel.range;
    let largest = low.abs().max(high.abs());
    let width = high - low;
    let make = |shape: Shape, place: f64, scale: f64| Factor {
        signal: number,
        shape,
        constants: [place, scale],
    };
    let plain = |shapes: &[Shape]| -> Vec<Factor> {
        shapes
            .iter()
            .map(|shape| make(*shape, 0.0, largest))
            .collect()
    };
    let scaled = |shapes: &[Shape], shares: &[f64]| -> Vec<Factor> {
        let each = shapes.iter();
        each.flat_map(|shape| shares.iter().map(|s| make(*shape, 0.0, s * largest)))
            .collect()
    };
    let middle = low + 0.5 * width;
    if !(largest > 0.0 && width > 1e-9 * largest) {
        return Factors {
            alone: Vec::new(),
            in_products: Vec::new(),
        };
    }
    match channel.kind {
        Kind::Velocity => {
            let mut all = plain(&[
                Shape::Linear,
                Shape::Size,
                Shape::Square,
                Shape::SignedSquare,
                Shape::Cube,
                Shape::Root,
                Shape::SignedRoot,
            ]);
            let bent = [
                Shape::Tanh,
                Shape::SizeTanh,
                Shape::Decay,
                Shape::SignedDecay,
                Shape::Bell,
                Shape::SignedBell,
            ];
            all.extend(scaled(&bent, &SCALES));
            let logarithms = [Shape::Logarithm, Shape::SignedLogarithm];
            all.extend(scaled(&logarithms, &SCALES[..1]));
            Factors {
                in_products: all.clone(),
                alone: all,
            }
        }
        Kind::About => {
            let mut all = plain(&[
                Shape::Linear,
                Shape::Size,
                Shape::Square,
                Shape::SignedSquare,
                Shape::Root,
                Shape::SignedRoot,
            ]);
            all.extend(scaled(&[Shape::Tanh, Shape::Bell], &SCALES_ABOUT));
            let in_products = all.clone();
            all.push(make(Shape::Cube, 0.0, largest));
            all.extend(scaled(&[Shape::SizeTanh, Shape::Decay], &SCALES_ABOUT));
            for share in PLACES {
                let place = low + share * width;
                all.push(make(Shape::Bend, place, 1.0));
                all.push(make(Shape::Step, place, WIDTHS[1] * width));
            }
            Factors {
                alone: all,
                in_products,
            }
        }
        Kind::Place => {
            let mut all = vec![
                make(Shape::Linear, 0.0, 1.0),
                make(Shape::Shifted, middle, 1.0),
                make(Shape::Bowl, middle, 1.0),
            ];
            for share in [0.32, 0.5, 0.68] {
                let place = low + share * width;
                all.push(make(Shape::Bend, place, 1.0));
                all.push(make(Shape::Step, place, 0.15 * width));
                all.push(make(Shape::Spot, place, 0.2 * width));
            }
            let mut in_products = all.clone();
            in_products.remove(0);
            for share in PLACES {
                let place = low + share * width;
                for width in WIDTHS.map(|own| own * width) {
                    all.push(make(Shape::Step, place, width));
                    all.push(make(Shape::Spot, place, width));
                }
            }
            for turns in TURNS {
                let scale = width / (std::f64::consts::TAU * turns);
                let waves = [Shape::Sine, Shape::Cosine].map(|shape| make(shape, 0.0, scale));
                all.extend(waves);
                if turns <= 2.0 {
                    in_products.extend(waves);
                }
            }
            Factors {
                alone: all,
                in_products,
            }
        }
        Kind::Slow => {
            let at = |shape: Shape, share: f64, scale: f64| make(shape, low + share * width, scale);
            let mut in_products = vec![
                at(Shape::Shifted, 0.5, 1.0),
                at(Shape::Shifted, -0.5, 1.0),
                make(Shape::Growth, 0.0, -width),
            ];
            in_products.extend([0.3, 0.5, 0.7].map(|share| at(Shape::Step, share, 0.2 * width)));
            in_products.extend([0.3, 0.6].map(|share| at(Shape::Above, share, 1.0)));
            in_products.extend([0.4, 0.7].map(|share| at(Shape::Below, share, 1.0)));
            in_products.extend([0.25, 0.5, 0.75].map(|share| at(Shape::Spot, share, 0.25 * width)));
            Factors {
                alone: vec![at(Shape::Shifted, 0.5, 1.0)],
                in_products,
            }
        }
    }
}

/// The functions of every signal that a term can be multiplied by.
pub(super) fn factors_in_products(rows: &Rows) -> Vec<Factor> {
    let channels = rows.channels.iter().enumerate();
    channels
        .flat_map(|(number, channel)| factors(number, channel).in_products)
        .collect()
}

/// Of those that enter products the plainest, which enter products of three, too.
fn plainest(factors: &Factors) -> impl Iterator<Item = &Factor> {
    const PLAIN: [Shape; 6] = [
        Shape::Linear,
        Shape::Size,
        Shape::Shifted,
        Shape::Bowl,
        Shape::Sine,
        Shape::Cosine,
    ];
    let all = factors.in_products.iter();
    all.filter(|own| PLAIN.contains(&own.shape))
}

/// Whether a term with these factors can change its sign with the direction, too:
/// functions of the velocity have a sign of their own.
fn may_turn(factors: &[Factor]) -> bool {
    factors.iter().all(|own| own.signal != VELOCITY)
}

impl Dictionary {
    /// Every term over the signals of `rows` whose column is not the model's own; `triples` are
    /// the numbers of signals over which the residual goes together.
    /// `progress` is called with the share done, 0 … 1.
    pub(super) fn new(rows: &Rows, triples: &[[usize; 3]], progress: &mut dyn FnMut(f64)) -> Self {
        let of_signals: Vec<Factors> = rows
            .channels
            .iter()
            .enumerate()
            .map(|(number, channel)| factors(number, channel))
            .collect();
        let mut dictionary = Self {
            terms: Vec::new(),
            columns: Vec::new(),
        };
        let direction = rows.direction();
        let mut both = |factors: &[Factor], samples: &[&[f64]]| {
            for turns in [false, true] {
                if turns && !may_turn(factors) {
                    continue;
                }
                let mut all = samples.to_vec();
                if turns {
                    all.push(&direction);
                }
                let term = Term {
                    direction: turns,
                    factors: factors.to_vec(),
                };
                dictionary.push(rows, term, &all);
            }
        };
        both(&[], &[]);
        for own in &of_signals {
            for factor in &own.alone {
                let samples = rows.factor(factor);
                both(&[*factor], &[&samples]);
            }
        }
        let count = of_signals.len();
        for second in 0..count {
            let Some(others) = of_signals.get(second) else {
                continue;
            };
            let in_products = others.in_products.iter();
            let seconds: Vec<_> = in_products.map(|own| (own, rows.factor(own))).collect();
            for firsts in of_signals.iter().take(second) {
                for first in &firsts.in_products {
                    let samples = rows.factor(first);
                    for (factor, others) in &seconds {
                        both(&[*first, **factor], &[&samples, others]);
                    }
                }
            }
            progress((second + 1).pow(2) as f64 / count.pow(2) as f64);
        }
        for triple in triples {
            let [Some(first), Some(second), Some(third)] = triple.map(|at| of_signals.get(at))
            else {
                continue;
            };
            let [firsts, seconds, thirds] = [first, second, third].map(|own| {
                let each = plainest(own).map(|factor| (*factor, rows.factor(factor)));
                each.collect::<Vec<_>>()
            });
            for (first, of_first) in &firsts {
                for (second, of_second) in &seconds {
                    for (third, of_third) in &thirds {
                        both(&[*first, *second, *third], &[of_first, of_second, of_third]);
                    }
                }
            }
        }
        dictionary
    }

    fn push(&mut self, rows: &Rows, term: Term, factors: &[&[f64]]) {
        if term.is_inertia() {
            return;
        }
        let Some(column) = rows.column(factors) else {
            return;
        };
        let scale = square(&column).sqrt().recip();
        self.terms.push(term);
        (self.columns).extend(column.into_iter().map(|x| (x * scale) as f32));
    }

    /// The column of term number `at`.
    pub(super) fn column(&self, at: usize) -> &[f32] {
        let rows = self.columns.len() / self.terms.len().max(1);
        self.columns
            .get(at * rows..(at + 1) * rows)
            .unwrap_or_default()
    }
}

/// Bounds of the place and of the scale of a factor, when they are searched.
pub(super) fn bounds(channel: &Channel, which: usize, value: f64) -> [f64; 2] {
    let [low, high] = channel.range;
    let width = (high - low).abs().max(1e-300);
    let largest = low.abs().max(high.abs());
    match (which, channel.kind) {
        (0, Kind::Slow) => [low - 3.0 * width, high + 3.0 * width],
        (0, _) => [low - 0.5 * width, high + 0.5 * width],
        (_, Kind::Place) => [0.02 * width, 3.0 * width],
        (_, Kind::Slow) if value > 0.0 => [0.05 * width, 10.0 * width],
        (_, Kind::Slow) => [-10.0 * width, -0.2 * width],
        _ => [0.01 * largest, 4.0 * largest],
    }
}
