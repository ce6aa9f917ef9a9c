//! Torques that are in another unit than Nm: currents, torques before the gear, mNm.
//!
//! The weight of the links, as the URDF has it, is the yardstick. A tool, or links that weigh otherwise
//! than the file says, change what a joint carries by less than a unit does, and by no more than
//! they weigh: a torque far below is in another unit, and one above is only where no load could be so heavy.

use std::ops::RangeInclusive;

use nalgebra::{Matrix4, Vector4};

use super::reading::Reading;
use super::samples::{Samples, Seen};

/// How much of what the links need may be read as their torque without its being in another unit.
const POSSIBLE: RangeInclusive<f64> = 1.0 / 3.0..=30.0;
/// At most this share of a torque is left where it is the links', in whichever unit …
const LEFT: f64 = 1.0 / 3.0;
/// … and they are at least this share of it, not friction.
const CARRIED: f64 = 0.5;
/// What the links need varies by this share of itself: else it may as well be an offset of the torque.
const VARIES: f64 = 0.1;
/// Of the joints that carry weight at least this share has to be in another unit: else a link is wrong.
const SHARE: f64 = 0.5;

/// What 1 of each joint's torque is, as it is read \[Nm\]: `Some` where that is not 1.
/// The second list says of which joints it can be told at all.
pub fn gains(samples: &Samples<'_>) -> (Vec<Option<f64>>, Vec<bool>) {
    let as_read: Vec<Reading> = (0..samples.joints).map(Reading::plain).collect();
    let mut fits = vec![Fit::default(); samples.joints];
    samples.each(&as_read, |at, seen| fits[at].add(seen));
    let shares: Vec<Option<f64>> = fits.iter().map(Fit::share).collect();
    let is_told: Vec<bool> = shares.iter().map(Option::is_some).collect();
    let gain = |share: &Option<f64>| {
        let share = share.filter(|own| !POSSIBLE.contains(own))?;
        Some(share.recip())
    };
    let gains: Vec<Option<f64>> = shares.iter().map(gain).collect();
    let in_another = gains.iter().flatten().count();
    let told = shares.iter().flatten().count();
    match in_another > 0 && in_another as f64 >= SHARE * told as f64 {
        true => (gains, is_told),
        false => (vec![None; samples.joints], is_told),
    }
}

/// Least squares of a joint's torque by what its links need, of any size and sign, and what goes with
/// its motion besides.
#[derive(Clone, Default)]
struct Fit {
    columns: Matrix4<f64>,
    with: Vector4<f64>,
    square: f64,
    known: f64,
    count: f64,
}

impl Fit {
    fn add(&mut self, seen: &Seen) {
        let own = Vector4::new(seen.known, seen.free.x, seen.free.y, seen.free.z);
        self.columns += own * own.transpose();
        self.with += own * seen.torque;
        self.square += seen.torque * seen.torque;
        self.known += seen.known;
        self.count += 1.0;
    }

    /// How much of what the links need the torque is, whatever its sign; `None` where it is not the
    /// links' in the main.
    fn share(&self) -> Option<f64> {
        let mut columns = self.columns;
        // An inertia that is known has no column, nor has the speed of a joint at rest.
        for at in 0..4 {
            if columns[(at, at)] <= 0.0 {
                columns[(at, at)] = 1.0;
            }
        }
        let fitted = columns.try_inverse()? * self.with;
        let share = fitted[0].abs();
        let count = self.count.max(1.0);
        let root_mean = |sum: f64| (sum.max(0.0) / count).sqrt();
        let (links, torque) = (root_mean(self.columns[(0, 0)]), root_mean(self.square));
        let varies = root_mean(self.columns[(0, 0)] - self.known * self.known / count);
        let left = root_mean(self.square - fitted.dot(&self.with));
        let is_told = left <= LEFT * torque && share * links >= CARRIED * torque;
        (is_told && varies >= VARIES * links).then_some(share)
    }
}
