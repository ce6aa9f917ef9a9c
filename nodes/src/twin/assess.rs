//! When the lab is asked, and how without holding up the loop.

use std::thread::JoinHandle;

use ferntast_identification::{Diagnosis, Verdict, twin::Twin};
use ferntast_msgs::{Text, sample::TwinVerdict};

/// The lab is asked first after this much motion, then each time after as much \[s\].
const EVERY: f64 = 60.0;
/// Where the residual left its band since, sooner: after this much \[s\].
const WHERE_OUT_OF_BAND: f64 = 20.0;
/// Rows further apart than this are no motion in between \[s\].
const MAX_BETWEEN_ROWS: f64 = 0.5;

/// Where the lab's work is done: it takes seconds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Assessing {
    /// In the step, which then takes as long: in virtual time, so that the
    /// answer is there at a known time.
    Inline,
    /// On a thread of its own; the answer is taken when it is ready.
    OnThread,
}

/// What the lab said last.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Assessment {
    /// After the first sample \[s\]; 0 before the first.
    pub(super) at: f64,
    pub(super) verdict: Option<Verdict>,
    pub(super) candidate: Text<32>,
    pub(super) goes_with: Text<64>,
}

impl Assessment {
    fn of(diagnosis: &Diagnosis, at: f64) -> Self {
        let candidate = diagnosis.candidates.first();
        let goes_with = diagnosis.residual_depends_on.first();
        Self {
            at,
            verdict: Some(diagnosis.verdict),
            candidate: candidate.map_or(Text::EMPTY, |best| Text::new(&best.effect)),
            goes_with: goes_with.map_or(Text::EMPTY, |map| Text::new(&map.signals.join(", "))),
        }
    }

    /// As on the topic.
    pub(super) fn code(&self) -> TwinVerdict {
        match self.verdict {
            None => TwinVerdict::PENDING,
            Some(Verdict::Complete) => TwinVerdict::COMPLETE,
            Some(Verdict::Missing) => TwinVerdict::MISSING,
            Some(Verdict::Unexplained) => TwinVerdict::UNEXPLAINED,
        }
    }
}

/// Asks the lab after each minute of motion.
#[derive(Debug)]
pub(super) struct Assessor {
    how: Assessing,
    /// So far \[s\].
    motion: f64,
    /// Of motion, when the lab was asked last \[s\].
    asked: f64,
    /// Whether the residual was out of its band then.
    asked_out_of_band: bool,
    last_row: Option<f64>,
    running: Option<JoinHandle<Option<Assessment>>>,
    newest: Assessment,
}

impl Assessor {
    pub(super) fn new(how: Assessing) -> Self {
        Self {
            how,
            motion: 0.0,
            asked: 0.0,
            asked_out_of_band: false,
            last_row: None,
            running: None,
            newest: Assessment::default(),
        }
    }

    /// The lab's last answer.
    pub(super) fn newest(&self) -> &Assessment {
        &self.newest
    }

    /// Counts the motion of a row at `time` \[s\].
    pub(super) fn note(&mut self, time: f64, slides: bool) {
        let passed = self.last_row.replace(time).map_or(0.0, |last| time - last);
        if slides && (0.0..MAX_BETWEEN_ROWS).contains(&passed) {
            self.motion += passed;
        }
    }

    /// Asks when it is time; takes an answer that is ready. `time` \[s\] is that
    /// of the newest row.
    pub(super) fn step(&mut self, twin: &Twin, time: f64) {
        if self.running.as_ref().is_some_and(JoinHandle::is_finished)
            && let Some(thread) = self.running.take()
            && let Ok(Some(answer)) = thread.join()
        {
            self.newest = answer;
        }
        let out_of_band = twin.out_of_band();
        let wait = match out_of_band && !self.asked_out_of_band {
            true => WHERE_OUT_OF_BAND,
            false => EVERY,
        };
        if self.motion < self.asked + wait || self.running.is_some() {
            return;
        }
        self.asked = self.motion;
        self.asked_out_of_band = out_of_band;
        // Data that are not enough for an answer yet leave the last one.
        let ask = move |twin: &Twin| {
            let diagnosis = twin.assess().ok()?;
            Some(Assessment::of(&diagnosis, time))
        };
        match self.how {
            Assessing::Inline => {
                if let Some(answer) = ask(twin) {
                    self.newest = answer;
                }
            }
            Assessing::OnThread => {
                let twin = twin.clone();
                self.running = Some(std::thread::spawn(move || ask(&twin)));
            }
        }
    }
}
