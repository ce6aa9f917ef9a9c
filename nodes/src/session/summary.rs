//! What a session comes to, as one JSON object.

use std::{collections::BTreeMap, fmt};

use ferntast_msgs::counted;
use serde::Serialize;

use super::state_times::StateTime;
use crate::{
    process::{End, SessionContext},
    twin::TwinSummary,
};

/// The result of a session. Quantities that were never measured are `null`.
#[derive(Debug, Serialize)]
pub struct Summary {
    /// The scenario's name.
    pub scenario: String,
    /// The session's name.
    pub session: String,
    /// The end of the link that ran here; `null` for both.
    pub end: Option<End>,
    /// Time from when the arm was armed first to the stop \[s\].
    pub duration_s: f64,
    /// How long of that the arm was ENABLED \[s\].
    pub armed_s: f64,
    /// How often the scripted operator armed the arm again.
    pub rearmed: u32,
    /// The arm.
    #[serde(flatten)]
    pub arm: ArmSummary,
    /// The servo loop.
    pub servo: ServoSummary,
    /// The link as the operator's end measured it; the arm's, where only that ran here.
    pub link: LinkSummary,
    /// The contact as estimated.
    pub contact: ContactSummary,
    /// The tip beside the hand.
    pub tip: TipSummary,
    /// Force on the hand by how far it is beyond the surface of the first thing touched, where
    /// it rests, both at the tip's scale \[N/m\]; `null` where it does not press and rest.
    #[serde(rename = "felt_stiffness_N_per_m")]
    pub felt_stiffness: Option<f64>,
    /// The operator's side.
    pub leader: LeaderSummary,
    /// The last word of each twin.
    pub twins: Vec<TwinSummary>,
    /// The recording's folder; `null` without one.
    pub recording: Option<String>,
    /// What went into the recording; `null` without one.
    pub recorder: Option<RecorderSummary>,
    /// CRTK operating states by device.
    pub states: BTreeMap<String, StateSummary>,
    /// Every node: how it did.
    pub nodes: BTreeMap<String, NodeSummary>,
}

/// The arm that was driven.
#[derive(Debug, Serialize)]
pub struct ArmSummary {
    /// What its file calls it.
    pub arm: String,
    /// How many joints it has.
    pub joints: usize,
    /// What stood between its topics and it.
    pub driver: String,
}

impl ArmSummary {
    /// Of a session's arm.
    pub fn of(session: &SessionContext) -> ArmSummary {
        let loaded = &session.loaded;
        ArmSummary {
            arm: match loaded.arm.model.serial() {
                Some(serial) => serial.name.clone(),
                None => loaded.scenario.arm.clone(),
            },
            joints: loaded.arm.model.joints().len(),
            driver: match &session.driver {
                Some(driver) => driver.clone(),
                None => "simulated".to_owned(),
            },
        }
    }
}

/// The tip beside the hand.
#[derive(Debug, Default, Serialize)]
pub struct TipSummary {
    /// Farthest that it was from where the hand had it, while both rested and nothing was
    /// touched \[mm\].
    pub drift_mm: Option<f64>,
}

/// The servo loop.
#[derive(Debug, Default, Serialize)]
pub struct ServoSummary {
    /// Steps a second, over the whole session \[Hz\].
    pub rate_hz: Option<f64>,
    /// Deadlines missed.
    pub missed: u64,
    /// Wake-up lateness at the 99th percentile of the last second \[µs\].
    pub lateness_p99_us: Option<f64>,
}

/// The link.
#[derive(Debug, Default, Serialize)]
pub struct LinkSummary {
    /// Median of the measured round trips \[ms\].
    pub rtt_ms: Option<f64>,
    /// 99th percentile of the measured round trips \[ms\].
    pub rtt_p99_ms: Option<f64>,
    /// Interarrival jitter at the end (RFC 3550) \[ms\].
    pub jitter_ms: Option<f64>,
    /// Share of all frames lost on the way to the operator, 0 … 1.
    pub loss: Option<f64>,
    /// Share of the frames, 500 a second each way, that were sent, 0 … 1.
    pub sent: Option<f64>,
    /// The delay law.
    pub law: String,
}

/// The contact.
#[derive(Debug, Default, Serialize)]
pub struct ContactSummary {
    /// Largest normal force while in contact \[N\].
    #[serde(rename = "peak_normal_force_N")]
    pub peak_normal_force: f64,
    /// Largest force while in contact, normal and tangential together \[N\].
    #[serde(rename = "peak_force_N")]
    pub peak_force: f64,
    /// Time in contact \[s\].
    pub time_s: f64,
    /// Edges touched.
    pub edges: Vec<String>,
}

/// The operator's side.
#[derive(Debug, Default, Serialize)]
pub struct LeaderSummary {
    /// Largest force rendered to the hand \[N\].
    #[serde(rename = "peak_force_N")]
    pub peak_force: f64,
    /// Times that another source was refused.
    pub refused_masters: u64,
}

/// What went into the recording.
#[derive(Debug, Serialize)]
pub struct RecorderSummary {
    /// Messages in it.
    pub messages: u64,
    /// Messages that were lost on the way into it.
    pub lost: u64,
    /// Folders of its parts: more than one where a recorder was restarted or
    /// the page recorded.
    pub parts: Vec<String>,
    /// Why it is not whole, in words; empty where it is. The session then ends
    /// with exit code 1.
    pub faults: Vec<String>,
}

/// The states of one device.
#[derive(Debug, Default, Serialize)]
pub struct StateSummary {
    /// The last one.
    #[serde(rename = "final")]
    pub last: String,
    /// All, in the order of entry.
    pub visited: Vec<String>,
    /// Why it is in the last one.
    pub reason: String,
    /// How long it was in each, and why: the longest first.
    pub spent: Vec<StateTime>,
}

/// One node.
#[derive(Debug, Default, Serialize)]
pub struct NodeSummary {
    /// Whether it ran at the end.
    pub alive: bool,
    /// How often it was restarted.
    pub restarts: u32,
    /// Steps a second in its last second \[Hz\].
    pub rate_hz: Option<f64>,
    /// Deadlines missed.
    pub missed: u64,
    /// Messages refused.
    pub refused: u64,
    /// Messages lost.
    pub lost: u64,
    /// Faults that were active at any time.
    pub faults: Vec<String>,
}

impl fmt::Display for ContactSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.time_s {
            none if none <= 0.0 => return write!(f, "none"),
            short if short < 0.1 => write!(f, "{:.0} ms", short * 1e3)?,
            time => write!(f, "{time:.1} s")?,
        }
        write!(f, ", peak normal force {:.1} N", self.peak_normal_force)?;
        match self.edges.is_empty() {
            true => write!(f, ", edges: none"),
            false => write!(f, ", edges: {}", self.edges.join(", ")),
        }
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let number = |value: Option<f64>, digits: usize| match value {
            Some(value) => format!("{value:.digits$}"),
            None => "-".to_owned(),
        };
        // What belongs to the other host is not known here.
        let [has_hand, has_arm] = [End::Operator, End::Arm].map(|own| own.is_at(self.end));
        match has_arm {
            true => writeln!(
                f,
                "scenario {}, {:.1} s, of which the arm was armed for {:.1} s",
                self.scenario, self.duration_s, self.armed_s
            )?,
            false => writeln!(f, "scenario {}, {:.1} s", self.scenario, self.duration_s)?,
        }
        if has_arm {
            writeln!(
                f,
                "servo     {} Hz, {} missed",
                number(self.servo.rate_hz, 1),
                counted(self.servo.missed, "deadline")
            )?;
        }
        writeln!(
            f,
            "link      {} ms round trip (p99 {}), {} % lost, {} % of the frames sent, law {}",
            number(self.link.rtt_ms, 2),
            number(self.link.rtt_p99_ms, 2),
            number(self.link.loss.map(|loss| loss * 100.0), 2),
            number(self.link.sent.map(|sent| sent * 100.0), 1),
            self.link.law
        )?;
        if has_arm {
            writeln!(f, "contact   {}", self.contact)?;
        }
        if has_hand {
            writeln!(f, "hand      peak force {:.1} N", self.leader.peak_force)?;
        }
        for twin in &self.twins {
            writeln!(f, "{twin}")?;
        }
        for (device, state) in &self.states {
            let spent = state.spent.iter().map(|own| {
                let times = match own.times {
                    1 => String::new(),
                    times => format!(" in {times} times"),
                };
                format!("{} {:.1} s{times} ({})", own.state, own.seconds, own.reason)
            });
            writeln!(f, "{device:9} {}", spent.collect::<Vec<_>>().join(", "))?;
        }
        if self.rearmed > 0 {
            writeln!(
                f,
                "operator  the script's armed the arm again {}",
                match self.rearmed {
                    1 => "once".to_owned(),
                    times => format!("{times} times"),
                }
            )?;
        }
        for (name, node) in self
            .nodes
            .iter()
            .filter(|(_, node)| !node.faults.is_empty())
        {
            writeln!(f, "{name:14} {}", node.faults.join("; "))?;
        }
        match &self.recorder {
            Some(recorder) => {
                write!(
                    f,
                    "recorded  {} messages in {}, {} lost",
                    recorder.messages,
                    recorder.parts.join(" and "),
                    recorder.lost
                )?;
                let mut faults = recorder.faults.iter();
                faults.try_for_each(|fault| write!(f, "\nnot whole  {fault}"))
            }
            None => write!(f, "not recorded (--record DIR does)"),
        }
    }
}
