//! A twin in lockstep: what it found is taken over by the servo, and it
//! follows what changes at the simulated arm.

use crate::common::{JOINT, change_arm, heard, scenario, session, with_twin, worn};
use ferntast_bus::Subscriber;
use ferntast_config::Loaded;
use ferntast_msgs::{
    sample::{Fault, FrictionCommand, JointSample},
    topics,
};
use ferntast_nodes::{lockstep::LockstepSession, servo::FrictionSummary};

/// Length of the script that the hand repeats, where it is free \[s\].
const PERIOD: f64 = 0.6 * 19.0;

/// A session of `loaded`, watched, with a twin fitted to the arm as it is configured.
fn watched(loaded: &Loaded) -> Watched {
    Watched::new(with_twin(loaded, &scenario(3, true)))
}

/// A session of which tracking error and torque are watched.
struct Watched {
    session: LockstepSession,
    setpoint: Subscriber<JointSample>,
    measured: Subscriber<JointSample>,
    torque: Subscriber<JointSample>,
}

impl Watched {
    fn new(session: LockstepSession) -> Self {
        Self {
            setpoint: heard(&session, topics::FOLLOWER_SETPOINT_JS),
            measured: heard(&session, topics::FOLLOWER_MEASURED_JS),
            torque: heard(&session, topics::FOLLOWER_SERVO_JF),
            session,
        }
    }

    /// Runs `seconds`; gives the RMS of setpoint less position \[rad\], and the
    /// largest step of the motor torque from one period to the next \[Nm\].
    fn run(&mut self, seconds: f64) -> (f64, f64) {
        let (mut squares, mut count, mut largest) = (0.0, 0.0, 0.0_f64);
        let mut last = None;
        for _ in 0..(seconds * 10.0).round() as usize {
            self.session.run(0.1);
            let now = self.session.now();
            while let (Some(wanted), Some(is)) = (self.setpoint.next(now), self.measured.next(now))
            {
                let error = wanted.message.position[JOINT] - is.message.position[JOINT];
                squares += error * error;
                count += 1.0;
            }
            while let Some(own) = self.torque.next(now) {
                let torque = own.message.effort[JOINT];
                if let Some(last) = last.replace(torque) {
                    largest = largest.max((torque - last).abs());
                }
            }
        }
        ((squares / count).sqrt(), largest)
    }

    fn friction(&mut self) -> FrictionSummary {
        self.session.monitor().friction()[JOINT].clone()
    }

    fn command(&mut self, command: FrictionCommand) {
        self.session
            .command_friction_at(0.0, command)
            .expect("a session in lockstep");
    }
}

#[test]
fn taking_over_makes_the_servo_follow_better_and_giving_back_restores() {
    let mut loaded = scenario(5, true);
    worn(&mut loaded, 1.3);
    let mut own = watched(&loaded);
    own.run(4.0 * PERIOD);
    let (before, step) = own.run(PERIOD);
    assert_eq!(own.friction().source, "configured");

    own.command(FrictionCommand::TAKE_OVER);
    let (_, step_taking) = own.run(PERIOD);
    let taken = own.friction();
    println!("{taken}");
    assert_eq!(
        (taken.source.as_str(), taken.refused.as_ref()),
        ("twin", None)
    );
    let (with, _) = own.run(PERIOD);

    own.command(FrictionCommand::GIVE_BACK);
    let (_, step_giving) = own.run(PERIOD);
    let (after, _) = own.run(PERIOD);
    println!("tracking error {before:.2e}, taken over {with:.2e}, given back {after:.2e} rad");
    println!("torque steps {step:.3}, {step_taking:.3}, {step_giving:.3} Nm");
    let given = own.friction();
    assert_eq!(given.source, "configured");
    assert!(
        given
            .parameters
            .iter()
            .all(|one| one.value == one.configured)
    );
    assert!(with < 0.7 * before, "{with} of {before}");
    assert!((after / before - 1.0).abs() < 0.1, "{after} of {before}");
    assert!(step_taking < 1.2 * step && step_giving < 1.2 * step);
}

#[test]
fn what_is_beyond_the_bounds_is_refused_and_changes_nothing() {
    let mut loaded = scenario(6, true);
    worn(&mut loaded, 1.8);
    let mut own = watched(&loaded);
    own.run(5.0 * PERIOD);
    own.command(FrictionCommand::TAKE_OVER);
    own.run(2.0);
    let refused = own.friction();
    assert_eq!(refused.source, "configured");
    let reason = refused.refused.unwrap();
    assert!(reason.contains("is outside"), "{reason}");
    assert!(
        refused
            .parameters
            .iter()
            .all(|one| one.target == one.configured)
    );
    let faults = own.session.monitor().nodes["servo"].faults;
    assert!(faults.has(Fault::TakeOverRefused));
}

#[test]
fn without_a_twin_there_is_nothing_to_take_over() {
    let mut own = Watched::new(session(&scenario(6, true), None, Vec::new()));
    own.command(FrictionCommand::TAKE_OVER);
    own.run(2.0);
    let reason = own.friction().refused.unwrap();
    assert!(reason.contains("no twin"), "{reason}");
}

/// At a steady temperature the model is complete for as long as one looks: the
/// stamps of torque and position belong together.
#[test]
fn five_minutes_of_a_right_model_raise_no_alarm() {
    let loaded = scenario(7, false);
    let mut session = with_twin(&loaded, &loaded);
    session.run(300.0);
    let twin = session.monitor().twins().remove(0);
    println!("{twin}");
    assert_eq!(twin.verdict, "complete", "{twin:?}");
    assert!(!twin.out_of_band);
    assert_eq!(twin.change, None);
}

/// The joint's temperature changes by degrees a minute: friction drifts, and b_0 or b_1 is named.
#[test]
fn a_rising_temperature_is_a_drift() {
    let mut loaded = scenario(8, true);
    change_arm(&mut loaded, |arm| {
        arm.truth.environment.temperature = None;
        arm.truth.joint[JOINT].thermal.capacity = 3000.0;
    });
    let mut session = with_twin(&loaded, &loaded);
    session.run(240.0);
    let twin = session.monitor().twins().remove(0);
    println!("{twin}");
    let change = twin.change.unwrap();
    assert_eq!(change.kind, "drift", "{change:?}");
    assert!(
        ["b0", "b1"].contains(&change.parameter.as_str()),
        "{change:?}"
    );
    assert!(twin.out_of_band);
}
