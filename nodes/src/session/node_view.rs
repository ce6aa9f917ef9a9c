//! What is known of one node.

use ferntast_msgs::{
    Time,
    sample::{Fault, Faults, HealthSample},
};

use crate::node::HEALTH_PERIOD_NANOS;

/// A node that was not heard of for this long \[s\] is not alive.
const ALIVE: f64 = 1.0;
/// Faults that every node has while the others are still being started.
const STARTING: [Fault; 4] = [
    Fault::CommandSilent,
    Fault::MeasurementSilent,
    Fault::LinkDown,
    Fault::DeadlineMissed,
];

/// What is known of one node.
#[derive(Debug, Default)]
pub struct NodeView {
    /// Its last word.
    pub last: Option<HealthSample>,
    /// Faults of the whole session; of what every node has at its start, those since the session
    /// began.
    pub faults: Faults,
    /// Deadlines missed before the session began.
    missed_at_start: u64,
    /// Deadlines missed by earlier processes of the node.
    missed_before: u64,
    /// Messages lost by them.
    lost_before: u64,
}

impl NodeView {
    /// Whether it was heard of lately.
    pub fn is_alive(&self, now: Time) -> bool {
        self.last
            .is_some_and(|health| now.seconds_since(health.stamp) < ALIVE)
    }

    /// Takes in what it says, in a session that began at `begun` if it did.
    pub fn note(&mut self, health: HealthSample, begun: Option<Time>) {
        if let Some(last) = self.last
            && last.process != health.process
        {
            self.missed_before += last.missed;
            self.lost_before += last.lost;
        }
        // A sample has the faults since the one before.
        let is_of_start =
            begun.is_some_and(|begun| health.stamp.nanos_since(begun) < HEALTH_PERIOD_NANOS);
        self.faults.0 |= match is_of_start {
            true => without_starting(health.faults).0,
            false => health.faults.0,
        };
        self.last = Some(health);
    }

    /// Forgets how it started.
    pub fn begin(&mut self) {
        self.faults = without_starting(self.faults);
        self.missed_at_start += self.missed();
    }

    /// Deadlines missed since the session began, or since its start if it has not.
    pub fn missed(&self) -> u64 {
        let all = self.missed_before + self.last.map_or(0, |health| health.missed);
        all.saturating_sub(self.missed_at_start)
    }

    /// Messages lost since the start of the session.
    pub fn lost(&self) -> u64 {
        self.lost_before + self.last.map_or(0, |health| health.lost)
    }
}

fn without_starting(faults: Faults) -> Faults {
    faults
        .iter()
        .filter(|fault| !STARTING.contains(fault))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn health(milliseconds: i64, faults: &[Fault], missed: u64) -> HealthSample {
        HealthSample {
            faults: faults.iter().copied().collect(),
            missed,
            ..HealthSample::new(Time::from_nanos(milliseconds * 1_000_000), "servo")
        }
    }

    #[test]
    fn what_is_so_at_every_start_is_no_fault_of_the_session() {
        let begun = Time::from_nanos(5_000_000_000);
        let mut view = NodeView::default();
        let at_start = [
            Fault::LinkDown,
            Fault::StrangerOnLink,
            Fault::DeadlineMissed,
        ];
        view.note(health(4900, &at_start, 7), None);
        assert_eq!((view.faults.iter().count(), view.missed()), (3, 7));
        view.begin();
        // Its last 100 ms began before the session did.
        view.note(health(5099, &[Fault::LinkDown], 7), Some(begun));
        let told: Vec<Fault> = view.faults.iter().collect();
        assert_eq!((told, view.missed()), (vec![Fault::StrangerOnLink], 0));
        view.note(health(5101, &[Fault::LinkDown], 9), Some(begun));
        assert!(view.faults.has(Fault::LinkDown));
        assert_eq!(view.missed(), 2);
    }
}
