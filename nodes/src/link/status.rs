//! What an end says of the link, as a message.

use ferntast_control::link::LinkState;
use ferntast_msgs::{
    Text, Time,
    sample::{Fault, Level, LinkEnd, LinkStatusSample},
};

use crate::node::NodeHealth;

/// How often the status is published \[ns\].
const PERIOD_NANOS: i64 = 10_000_000;

/// Publishes the status of an end, in its time.
pub struct Status {
    which: LinkEnd,
    session: u16,
    due: Time,
}

impl Status {
    pub fn new(which: LinkEnd, session: u16) -> Status {
        Status {
            which,
            session,
            due: Time::INVALID,
        }
    }

    /// The status, when one is due.
    pub fn step(&mut self, now: Time, state: &LinkState) -> Option<LinkStatusSample> {
        if now < self.due {
            return None;
        }
        self.due = now.plus_nanos(PERIOD_NANOS);
        let measured = &state.measured;
        let refused = measured.refused;
        let finite = |value: f64| if value.is_finite() { value } else { 0.0 };
        Some(LinkStatusSample {
            round_trip: measured.round_trip,
            delay: measured.delay,
            jitter: finite(measured.jitter),
            loss: finite(measured.loss),
            age: finite(measured.age),
            energy_in: state.energy.entered,
            energy_out: state.energy.left,
            energy_dissipated: state.dissipated,
            sent: measured.sent,
            received: measured.received,
            lost: measured.lost,
            refused_length: refused.length,
            refused_version: refused.version,
            refused_session: refused.session,
            refused_checksum: refused.checksum,
            refused_time: refused.time,
            refused_value: refused.value,
            refused_replayed: refused.replayed,
            refused_late: refused.late,
            law: Text::new(state.law),
            session: self.session,
            connected: u8::from(state.connected),
            end: self.which,
            ..LinkStatusSample::initial(now)
        })
    }
}

/// What an end tells of the link on `/diagnostics`; `silent` where no frames come.
pub fn report(state: &LinkState, silent: &str, health: &mut NodeHealth) {
    let silence = state.measured.silence;
    health.input_age = if silence.is_finite() {
        silence
    } else {
        f64::NAN
    };
    health.refused = state.measured.refused.total();
    if !state.connected {
        health.raise(Fault::LinkDown, Level::WARN);
        health.message = Text::new(silent);
    }
}
