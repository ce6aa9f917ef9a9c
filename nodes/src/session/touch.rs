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

/// A hand, or a tip, that went less than this from one look to the next rests \[m\].
const REST: f64 = 2e-4;
/// So many looks in a row have to find it at rest.
const LOOKS: u32 = 3;
/// A force on the tip below this is nothing that is pressed against \[N\].
const FELT: f64 = 2.0;
/// Forces further apart than that are of another surface: cosine of 30°.
const ALIKE: f64 = 0.866;
/// The hand has to go so far for a stiffness to be told \[m\].
const WAY: f64 = 5e-4;
/// Further to the side than this it slides \[m\].
const ASIDE: f64 = 1e-3;
/// Looks that are kept.
const MOST: usize = 20_000;

/// Looks at hand and tip.
pub(super) struct TouchMeter {
    mapping: Mapping,
    hand: Subscriber<PoseSample>,
    tip: Subscriber<PoseSample>,
    hand_force: Subscriber<WrenchSample>,
    before: Option<[Vector3<f64>; 2]>,
    rested: u32,
    drift: Option<f64>,
    /// Hand \[m\] and force on it \[N\], both at the tip's scale, while it presses.
    pressed: Vec<[Vector3<f64>; 2]>,
}

impl TouchMeter {
    pub(super) fn new(bus: &Bus, mapping: Mapping) -> Result<TouchMeter, CreateError> {
        Ok(TouchMeter {
            mapping,
            hand: bus.subscriber(topics::LEADER_SETPOINT_CP, Depth::Newest)?,
            tip: bus.subscriber(topics::FOLLOWER_MEASURED_CP, Depth::Newest)?,
            hand_force: bus.subscriber(topics::LEADER_SERVO_CF, Depth::Newest)?,
            before: None,
            rested: 0,
            drift: None,
            pressed: Vec::new(),
        })
    }

    /// Forgets what was: what counts begins now.
    pub(super) fn begin(&mut self) {
        self.before = None;
        self.rested = 0;
        self.drift = None;
        self.pressed.clear();
    }

    /// Looks, while the contact is as `contact` says and the arm follows.
    pub(super) fn update(
        &mut self,
        now: Time,
        contact: Option<&ContactStateSample>,
        follows: bool,
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
        let before = self.before.replace([hand, tip]);
        let rests = before.is_some_and(|[hand_before, tip_before]| {
            (hand - hand_before).norm() < REST && (tip - tip_before).norm() < REST
        });
        let free = contact.touches == 0 && contact.valid == 1;
        self.rested = if rests && free && follows {
            self.rested + 1
        } else {
            0
        };
        if self.rested >= LOOKS {
            let apart = (hand - tip).norm();
            self.drift = Some(self.drift.map_or(apart, |own| own.max(apart)));
        }
        if let Some(force) = force
            && contact.touches == 1
            && contact.valid == 1
            && mapping.force_scale > 0.0
            && self.pressed.len() < MOST
        {
            let force = Vector3::from(force) / mapping.force_scale;
            if force.norm() > FELT {
                self.pressed.push([hand, force]);
            }
        }
    }

    /// Farthest that hand and tip were apart while both rested and nothing was touched \[mm\].
    pub(super) fn drift_mm(&self) -> Option<f64> {
        self.drift.map(|own| own * 1e3)
    }

    /// How much more the force on the hand is for each metre that the hand goes further into
    /// the first thing touched, both at the tip's scale \[N/m\].
    pub(super) fn stiffness(&self) -> Option<f64> {
        let [place, force] = self.pressed.first()?;
        let first = force.normalize();
        // Where it slides, friction tilts the force.
        let alike = |own: &&[Vector3<f64>; 2]| {
            let way = own[0] - place;
            let aside = way - first * first.dot(&way);
            aside.norm() < ASIDE && own[1].dot(&first) > ALIKE * own[1].norm()
        };
        let alike = || self.pressed.iter().filter(alike);
        let normal = alike().map(|own| own[1]).sum::<Vector3<f64>>().normalize();
        let points: Vec<[f64; 2]> = alike()
            .map(|[hand, force]| [-hand.dot(&normal), force.dot(&normal)])
            .collect();
        let count = points.len() as f64;
        let mean = |axis: usize| points.iter().map(|own| own[axis]).sum::<f64>() / count;
        let [depth, force] = [mean(0), mean(1)];
        let spread: f64 = points.iter().map(|own| (own[0] - depth).powi(2)).sum();
        let slope: f64 = points
            .iter()
            .map(|own| (own[0] - depth) * (own[1] - force))
            .sum();
        let far = |least: f64, most: f64| most - least > WAY;
        let least = points
            .iter()
            .map(|own| own[0])
            .fold(f64::INFINITY, f64::min);
        let most = points
            .iter()
            .map(|own| own[0])
            .fold(f64::NEG_INFINITY, f64::max);
        far(least, most).then(|| slope / spread)
    }
}
