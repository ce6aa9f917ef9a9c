//! Who waits for whom when the computer has too much to do.
//!
//! From the first that is let go to the last: the lab's work on the page,
//! Foxglove, the gateway, the recorder (which tells what it lost), and behind
//! them all that the arm's safety rests on, which no other program holds up.

use std::io;

/// What a process or thread is worth to the scheduler.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Priority {
    /// The servo with its watchdog: before all else.
    Servo,
    /// The ends of the link.
    Link,
    /// The arm's driver.
    Arm,
    /// The haptic master.
    Master,
    /// The contact-force estimator.
    Estimator,
    /// A hand on the page.
    Hand,
    /// What carries the arm's joints and commands to and from a middleware.
    ArmTransport,
    /// An operator's word on the command line.
    Command,
    /// What looks after the nodes, and what hears the page's stop.
    Supervision,
    /// The recorder.
    Recording,
    /// The gateway and the player.
    Gateway,
    /// What only tells: limits, twin.
    Advice,
    /// What shows the topics to others.
    Display,
}

/// What the scheduler is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheduling {
    /// SCHED_FIFO of that priority: below the kernel's own interrupt threads at 50.
    RealTime(libc::c_int),
    /// An ordinary thread of that nice value.
    Ordinary(libc::c_int),
}

impl Priority {
    /// What the scheduler is asked for.
    pub const fn scheduling(self) -> Scheduling {
        match self {
            Priority::Servo => Scheduling::RealTime(45),
            Priority::Link => Scheduling::RealTime(44),
            Priority::Arm => Scheduling::RealTime(43),
            Priority::Master => Scheduling::RealTime(42),
            Priority::Estimator => Scheduling::RealTime(41),
            Priority::Hand => Scheduling::RealTime(40),
            Priority::ArmTransport => Scheduling::RealTime(35),
            Priority::Command => Scheduling::RealTime(30),
            Priority::Supervision => Scheduling::Ordinary(-15),
            Priority::Recording => Scheduling::Ordinary(-10),
            Priority::Gateway => Scheduling::Ordinary(-5),
            Priority::Advice => Scheduling::Ordinary(-2),
            Priority::Display => Scheduling::Ordinary(0),
        }
    }

    /// Whether it asks for real time.
    pub const fn is_real_time(self) -> bool {
        matches!(self.scheduling(), Scheduling::RealTime(_))
    }

    /// Takes it for the calling thread, and for those that it starts from then on.
    ///
    /// # Errors
    ///
    /// The operating system's reason when it is refused. Work goes on without.
    pub fn take(self) -> Result<(), io::Error> {
        let result = match self.scheduling() {
            Scheduling::RealTime(priority) => {
                let parameters = libc::sched_param {
                    sched_priority: priority,
                };
                // SAFETY: `parameters` is valid; 0 means the calling thread.
                unsafe { libc::sched_setscheduler(0, libc::SCHED_FIFO, &parameters) }
            }
            // SAFETY: takes no pointers; 0 means the calling thread.
            Scheduling::Ordinary(nice) => unsafe { libc::setpriority(libc::PRIO_PROCESS, 0, nice) },
        };
        match result {
            0 => Ok(()),
            _ => Err(io::Error::last_os_error()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_let_go_first_is_worth_least() {
        let order = [
            Priority::Display,
            Priority::Advice,
            Priority::Gateway,
            Priority::Recording,
            Priority::Supervision,
            Priority::Command,
            Priority::ArmTransport,
            Priority::Hand,
            Priority::Estimator,
            Priority::Master,
            Priority::Arm,
            Priority::Link,
            Priority::Servo,
        ];
        let worth = |priority: Priority| match priority.scheduling() {
            Scheduling::Ordinary(nice) => -nice,
            Scheduling::RealTime(priority) => 100 + priority,
        };
        assert!(order.is_sorted_by(|a, b| worth(*a) < worth(*b)));
        assert!(worth(Priority::Servo) < 150, "interrupts come before it");
    }
}
