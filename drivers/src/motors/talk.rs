//! The thread that talks to the motors: commands out, states in, as fast as the bus goes.

use std::{
    sync::{Arc, atomic::Ordering},
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use super::{
    error::{Lost, MotorError},
    family::{Drive, Family, Missed, States},
    section::Section,
    shared::Shared,
};

/// It is not talked faster than the node steps.
const SHORTEST: Duration = Duration::from_millis(1);
/// A node that commands nothing for so long stands still, and so does its arm.
const STALE: Duration = Duration::from_millis(50);
/// Motors that did not answer, and were heard for so long ago, are held: who is told of no
/// measurement gives no torque after twice that, and these arms have no brakes.
const HELD: Duration = Duration::from_millis(10);
/// A motor that was not heard for so long is lost, …
const LOST: Duration = Duration::from_millis(150);
/// … if it was asked so often meanwhile: a computer that stood still has not listened.
const ASKED: u32 = 3;

/// Starts the thread.
pub fn start<F: Family>(
    family: F,
    section: Section,
    states: States,
    shared: Arc<Shared>,
) -> Result<JoinHandle<()>, MotorError> {
    let port = section.port.clone();
    let talk = Talk {
        family,
        section,
        states,
        shared,
        heard: Instant::now(),
        unanswered: 0,
        command: (0, Instant::now()),
    };
    let thread = thread::Builder::new().name("motors".to_owned());
    thread
        .spawn(|| talk.run())
        .map_err(|source| MotorError::Thread { port, source })
}

struct Talk<F> {
    family: F,
    section: Section,
    states: States,
    shared: Arc<Shared>,
    heard: Instant,
    /// Cycles since then, in which one or more did not answer.
    unanswered: u32,
    /// The newest command's version, and since when it is there.
    command: (u64, Instant),
}

impl<F: Family> Talk<F> {
    fn run(mut self) {
        while !self.shared.ends.load(Ordering::Acquire) {
            let begin = Instant::now();
            let drive = self.drive(begin);
            let answers = self.family.step(&drive, &mut self.states);
            if let Err(missed) = answers {
                self.unanswered = self.unanswered.saturating_add(1);
                self.shared.missed.fetch_add(1, Ordering::Relaxed);
                self.missed(missed);
            } else {
                self.unanswered = 0;
                self.heard = begin;
                self.shared.put_states(&self.states);
            }
            thread::sleep(SHORTEST.saturating_sub(begin.elapsed()));
        }
        self.family.release();
    }

    /// What to do now.
    fn drive(&mut self, now: Instant) -> Drive {
        // Held as long as there is somebody to hear it, once something is wrong.
        let Some((version, drive)) = self.shared.drive() else {
            return Drive::Hold;
        };
        if version != self.command.0 {
            self.command = (version, now);
        }
        let stale = now - self.command.1 > STALE;
        let silent = self.unanswered > 0 && now - self.heard > HELD;
        match drive {
            Drive::Currents(_) if stale || silent || self.shared.failure.get().is_some() => {
                Drive::Hold
            }
            drive => drive,
        }
    }

    fn missed(&mut self, missed: Missed) {
        if self.shared.failure.get().is_some() {
            return;
        }
        let silence = self.heard.elapsed();
        let error = match missed {
            Missed::Error(error) => error,
            Missed::Motor(_, Lost::Port(source)) => MotorError::Gone {
                port: self.section.port.clone(),
                source,
            },
            Missed::Motor(..) if silence < LOST || self.unanswered < ASKED => return,
            Missed::Motor(place, _) => self.lost(place, silence),
        };
        eprintln!("{error}");
        // Nobody else sets it.
        let _ = self.shared.failure.set(error);
    }

    /// Who is lost, where a cycle failed at `place`.
    fn lost(&mut self, place: usize, silence: Duration) -> MotorError {
        let silent = self.family.silent();
        if silent.len() == self.section.motor.len() {
            return MotorError::AllSilent {
                port: self.section.port.clone(),
                milliseconds: silence.as_millis(),
            };
        }
        let motor = self.section.name(*silent.first().unwrap_or(&place));
        MotorError::silent(&motor, silence, self.family.damaged())
    }
}
