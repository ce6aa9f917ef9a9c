//! What the hand feels of what the arm touches, and how far hand and tip are apart.
//!
//! Looked at now and then, which is enough for what lasts: the hand and the force on it as
//! the arm has them, x_0 + s_x x and F / s_F.

use ferntast_bus::{Bus, CreateError, Depth, Subscriber};
use ferntast_control::delay::Mapping;
use ferntast_model::rigid_body::Vector3;
use ferntast_msgs::{
    Time,
    sample::{ContactStateSample, PoseSample, WrenchSample},
    topics,
};

use super::felt_stiffness::{FeltStiffness, Look};

/// A hand, or a tip, that stays within this \[m\]
const REST: f64 = 2e-4;
/// for so long, or for a round trip where that is longer, rests \[s\].
const RESTING: f64 = 0.25;

/// A tip slower than this has the contact force that is estimated a hundredth of a second later \[m/s\].
const SLOW: f64 = 5e-3;

/// How long something has been where it is.
#[derive(Clone, Copy, Debug)]
struct Place {
    at: Vector3<f64>,
    since: Time,
}

impl Place {
    /// Of what is at `at` now; `before` is where it was.
    fn new(now: Time, at: Vector3<f64>, before: Option<Place>) -> Place {
        match before {
            Some(before) if (at - before.at).norm() < REST => before,
            _ => Place { at, since: now },
        }
    }

    fn rests(&self, now: Time, duration: f64) -> bool {
        now.seconds_since(self.since) >= duration
    }
}

/// Looks at hand and tip.
pub(super) struct TouchMeter {
    mapping: Mapping,
    hand: Subscriber<PoseSample>,
    tip: Subscriber<PoseSample>,
    hand_force: Subscriber<WrenchSample>,
    /// Where hand and tip are.
    places: [Option<Place>; 2],
    /// When the tip was looked at last, and where it was.
    last: Option<(Time, Vector3<f64>)>,
    drift: Option<f64>,
    felt: FeltStiffness,
}

impl TouchMeter {
    pub(super) fn new(bus: &Bus, mapping: Mapping) -> Result<TouchMeter, CreateError> {
        Ok(TouchMeter {
            mapping,
            hand: bus.subscriber(topics::LEADER_SETPOINT_CP, Depth::Newest)?,
            tip: bus.subscriber(topics::FOLLOWER_MEASURED_CP, Depth::Newest)?,
            hand_force: bus.subscriber(topics::LEADER_SERVO_CF, Depth::Newest)?,
            places: [None; 2],
            last: None,
            drift: None,
            felt: FeltStiffness::default(),
        })
    }

    /// Forgets what was: what counts begins now.
    pub(super) fn begin(&mut self) {
        self.places = [None; 2];
        self.last = None;
        self.drift = None;
        self.felt.clear();
    }

    /// Looks, while the contact is as `contact` says and the arm follows; over a link that
    /// takes `round_trip` \[s\], forth and back: NaN before that was measured.
    pub(super) fn update(
        &mut self,
        now: Time,
        contact: Option<&ContactStateSample>,
        follows: bool,
        round_trip: f64,
    ) {
        let hand = self.hand.newest(now).map(|own| own.message.position);
        let tip = self.tip.newest(now).map(|own| own.message.position);
        let force = self.hand_force.newest(now).map(|own| own.message.force);
        let (Some(hand), Some(tip), Some(contact)) = (hand, tip, contact) else {
            return;
        };
        let mapping = &self.mapping;
        let offset = Vector3::from(mapping.workspace_offset);
        let hand = offset + Vector3::from(hand) * mapping.position_scale;
        let tip = Vector3::from(tip);
        let [hand_place, tip_place] = self.places;
        let hand_place = Place::new(now, hand, hand_place);
        let tip_place = Place::new(now, tip, tip_place);
        self.places = [Some(hand_place), Some(tip_place)];
        let last = self.last.replace((now, tip));
        let tip_is_slow = last
            .is_some_and(|(then, before)| (tip - before).norm() < SLOW * now.seconds_since(then));
        let valid = contact.valid == 1;
        let resting = match round_trip.is_nan() {
            true => f64::INFINITY,
            false => round_trip.max(RESTING),
        };
        let hand_rests = hand_place.rests(now, resting);
        let both_rest = hand_rests && tip_place.rests(now, resting);
        if valid && contact.touches == 0 && follows && both_rest {
            let apart = (hand - tip).norm();
            self.drift = Some(self.drift.map_or(apart, |own| own.max(apart)));
        }
        if let Some(force) = force
            && valid
            && contact.touches == 1
            && mapping.force_scale > 0.0
        {
            self.felt.add(Look {
                hand,
                hand_force: Vector3::from(force) / mapping.force_scale,
                hand_rests,
                tip,
                contact_force: contact.normal_force,
                tip_is_slow,
            });
        }
    }

    /// Farthest that hand and tip were apart while both rested and nothing was touched \[mm\].
    pub(super) fn drift_mm(&self) -> Option<f64> {
        self.drift.map(|own| own * 1e3)
    }

    /// What the hand feels of the first thing that the arm touches \[N/m\], at the tip's scale.
    pub(super) fn stiffness(&self) -> Option<f64> {
        self.felt.stiffness()
    }
}
