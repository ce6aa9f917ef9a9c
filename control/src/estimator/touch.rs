//! Whether something is touched, and how the tip slides on it: what the splits in the
//! plane and in space remember.

use super::EstimatorParameters;

/// How far behind a surface's front the tip is still taken to push it \[m\].
pub(super) const REACH: f64 = 0.1;

/// Where no surface is known, a force of so many times that of a contact is one [-],
const UNKNOWN_SURFACE: f64 = 3.0;
/// when it lasts so long [s]: of an arm that is jerked the estimate is off for as long as its
/// filters take.
const UNKNOWN_TIME: f64 = 0.05;
/// A contact there ends when less than a contact's force lasts so long [s]: what the tip goes
/// along with may push less for a while.
const FAINT_TIME: f64 = 0.2;

/// How many times the filter's delay a turn of the tip is seen in the forces.
const TURN_DELAYS: f64 = 5.0;

/// The force along a surface's normal from which on that is touched \[N\]; `before`: it was already.
pub(super) fn threshold(parameters: &EstimatorParameters, before: bool) -> f64 {
    match before {
        true => parameters.contact_off,
        false => parameters.contact_on,
    }
}

/// For how long forces have told of something that no surface is known of.
#[derive(Clone, Debug, Default)]
pub(super) struct Touch {
    /// It has pushed for so long \[s\].
    unknown_for: f64,
    /// It has pushed less than a contact does for so long \[s\].
    faint_for: f64,
}

impl Touch {
    /// Whether something is touched `dt` \[s\] after it was (`before`) or was not, by a force of
    /// `size` \[N\]. `near`: of a known surface near the tip, whether that is touched. A force of
    /// `contact_on` \[N\] along a known surface is a contact.
    pub(super) fn step(
        &mut self,
        contact_on: f64,
        dt: f64,
        size: f64,
        near: Option<bool>,
        before: bool,
    ) -> bool {
        let lasts = |is: bool, so_far: f64| if is { so_far + dt } else { 0.0 };
        let unknown = near.is_none() && size > UNKNOWN_SURFACE * contact_on;
        self.unknown_for = lasts(unknown, self.unknown_for);
        self.faint_for = lasts(size <= contact_on, self.faint_for);
        match near {
            Some(touched) => touched,
            None if before => self.faint_for < FAINT_TIME,
            None => self.unknown_for >= UNKNOWN_TIME,
        }
    }
}

/// How far and how long the tip has slid since it last turned or rested.
#[derive(Clone, Debug, Default)]
pub(super) struct Slide {
    /// \[m\]
    travel: f64,
    /// \[s\]
    time: f64,
}

impl Slide {
    /// Begins anew.
    pub(super) fn end(&mut self) {
        *self = Slide::default();
    }

    /// The tip slides at `speed` \[m/s\] for `dt` \[s\].
    pub(super) fn go_on(&mut self, speed: f64, dt: f64) {
        self.travel += speed * dt;
        self.time += dt;
    }

    /// Forces that are `delay` \[s\] late still tell of a turn: first arm and surface wind up
    /// the other way, then the filters follow.
    pub(super) fn turned_lately(&self, parameters: &EstimatorParameters, delay: f64) -> bool {
        self.travel <= parameters.rest_travel || self.time <= TURN_DELAYS * delay
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CONTACT_ON: f64 = 1.0;

    /// Whether something is touched, after each millisecond with a force of `size` \[N\] and a
    /// surface near by that is touched, or not.
    fn touched(touch: &mut Touch, steps: u32, size: f64, near: Option<bool>, before: bool) -> bool {
        (0..steps).fold(before, |before, _| {
            touch.step(CONTACT_ON, 1e-3, size, near, before)
        })
    }

    #[test]
    fn what_is_nowhere_near_is_touched_by_a_larger_force_that_lasts() {
        let size = 2.0 * UNKNOWN_SURFACE * CONTACT_ON;
        let mut touch = Touch::default();
        let steps = (1e3 * UNKNOWN_TIME) as u32;
        assert!(!touched(&mut touch, steps - 2, size, None, false));
        assert!(touched(&mut touch, 4, size, None, false));
        // It may push less for a while.
        assert!(touched(&mut touch, 150, 0.0, None, true));
        assert!(!touched(&mut touch, 100, 0.0, None, true));
    }

    #[test]
    fn a_surface_that_is_left_is_not_touched_any_more_while_it_is_near() {
        let mut touch = Touch::default();
        assert!(touched(&mut touch, 10, 5.0, Some(true), false));
        assert!(!touched(&mut touch, 1, 0.5, Some(false), true));
        // And for a while where the tip left what is near.
        assert!(touched(&mut touch, 10, 5.0, Some(true), false));
        assert!(touched(&mut touch, 100, 0.0, None, true));
        assert!(!touched(&mut touch, 150, 0.0, None, true));
    }
}
