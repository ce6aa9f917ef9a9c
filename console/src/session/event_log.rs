//! What happened in the session, for pages that come later.

use std::collections::VecDeque;

use ferntast_msgs::{Time, sample::HealthSample};

use super::message::EventView;

/// Events that are kept; the oldest go.
const KEPT: usize = 60;

/// The events that a status on `/diagnostics` says one after the other.
pub struct EventLog {
    /// The name of that status.
    teller: &'static str,
    events: VecDeque<HealthSample>,
}

impl EventLog {
    /// An empty log of what `teller` says.
    pub fn new(teller: &'static str) -> EventLog {
        EventLog {
            teller,
            events: VecDeque::with_capacity(KEPT),
        }
    }

    /// Takes note of an event; what was said before is none. Gives whether it was the
    /// teller who said it.
    pub fn note(&mut self, sample: &HealthSample) -> bool {
        if sample.node.as_str() != self.teller {
            return false;
        }
        let newest = self.events.back();
        if newest.is_none_or(|newest| sample.stamp > newest.stamp) {
            if self.events.len() == KEPT {
                self.events.pop_front();
            }
            self.events.push_back(*sample);
        }
        true
    }

    /// The events, the oldest first, in seconds since `began`.
    pub fn views(&self, began: Time) -> Vec<EventView> {
        let events = self.events.iter().map(|event| EventView {
            t: event.stamp.seconds_since(began),
            unix: event.stamp.nanos() as f64 * 1e-9,
            level: event.level.name().unwrap_or("error"),
            text: event.message.to_string(),
        });
        events.collect()
    }
}

#[cfg(test)]
mod tests {
    use ferntast_msgs::Text;

    use super::*;

    #[test]
    fn repetitions_and_other_nodes_are_no_events() {
        let mut log = EventLog::new("session");
        let at = |seconds: i64| Time::from_nanos(1_000_000_000_000 + seconds * 1_000_000_000);
        let say = |seconds: i64, node: &str, text: &str| HealthSample {
            message: Text::new(text),
            ..HealthSample::new(at(seconds), node)
        };
        assert!(log.note(&say(1, "session", "arm ENABLED")));
        assert!(log.note(&say(1, "session", "arm ENABLED")));
        assert!(!log.note(&say(2, "servo", "joint 1 is too fast")));
        assert!(log.note(&say(3, "session", "arm PAUSED")));
        let views = log.views(at(2));
        let told: Vec<_> = views.iter().map(|own| (own.t, own.text.as_str())).collect();
        assert_eq!(told, [(-1.0, "arm ENABLED"), (1.0, "arm PAUSED")]);
        for second in 4..1000 {
            log.note(&say(second, "session", "again"));
        }
        assert_eq!(log.views(at(0)).len(), KEPT);
    }
}
