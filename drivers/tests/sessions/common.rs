//! Sessions in lockstep with twins, and an arm that is not what is believed of it.

use std::{
    fs,
    path::{Path, PathBuf},
};

use ferntast_bus::{Depth, Subscriber};
use ferntast_config::Loaded;
use ferntast_drivers::simulated::{arm_file, load_arm};
use ferntast_emulation::hand::Motion;
use ferntast_msgs::{Message, topics::Topic};
use ferntast_nodes::{lockstep::LockstepSession, process::SessionContext, session_graph};
use ferntast_sim::arm::ArmConfig;

/// The joint of the tests, from 0.
pub const JOINT: usize = 1;

/// Its experiment.
const EXPERIMENT: &str = r#"
recording = "first"

[signals]
position = "/follower/measured_js.position[1]"
joint_torque = "/follower/measured_js.effort[1]"
motor_torque = "/follower/motor_js.effort[1]"
temperature = "/follower/joint_2/temperature.temperature"

[model]
inertia = 0.5
gear_ratio = 160
effects = ["coulomb", "load_coulomb", "viscous", "quadratic_viscous", "cubic_viscous"]
"#;

/// The scenario at 10 °C; where `free` the hand stays clear of everything and
/// is quicker: so friction shows over speed.
pub fn scenario(seed: u64, free: bool) -> Loaded {
    let mut loaded =
        ferntast_config::load_scenario("rokviss", load_arm).expect("a session in lockstep");
    loaded.scenario.seed = seed;
    change_arm(&mut loaded, |arm| {
        arm.truth.environment.temperature = Some([10.0; 2]);
    });
    if free {
        let hand = loaded
            .scenario
            .hand
            .scripted
            .as_mut()
            .expect("a session in lockstep");
        for phase in &mut hand.script.phase {
            phase.duration *= 0.6;
            if let Motion::Reach { to } = &mut phase.motion {
                to.0 = to.0.map(|x| 0.8 * x);
            }
        }
    }
    loaded.complete().expect("a session in lockstep");
    loaded
}

/// All of joint 2's true friction times `factor`.
pub fn worn(loaded: &mut Loaded, factor: f64) {
    change_arm(loaded, |arm| {
        let friction = &mut arm.truth.joint[JOINT].friction;
        for value in [
            &mut friction.b_0,
            &mut friction.b_0t,
            &mut friction.b_1,
            &mut friction.b_2,
            &mut friction.b_3,
        ] {
            *value *= factor;
        }
    });
}

/// Changes the simulated arm.
pub fn change_arm(loaded: &mut Loaded, change: impl FnOnce(&mut ArmConfig)) {
    let mut arm = loaded.arm.whole().expect("a simulated arm");
    change(&mut arm);
    loaded.arm = arm_file(&arm).expect("a simulated arm");
}

/// A session of `loaded`; recorded to `bag`, followed by twins of the experiments `twins`.
pub fn session(loaded: &Loaded, bag: Option<&Path>, twins: Vec<PathBuf>) -> LockstepSession {
    let mut context = SessionContext::in_virtual_time(loaded.clone());
    context.bag = bag.map(Path::to_owned);
    context.twins = twins;
    LockstepSession::new(&session_graph(ferntast_drivers::rows()), &context)
        .expect("a session in lockstep")
}

/// A session of `loaded` with a twin of joint 2, fitted to 40 s of `fitted_to` with another seed.
pub fn with_twin(loaded: &Loaded, fitted_to: &Loaded) -> LockstepSession {
    let folder = tempfile::tempdir().expect("a session in lockstep");
    let mut other = fitted_to.clone();
    other.scenario.seed += 1000;
    let mut first = session(&other, Some(&folder.path().join("first")), Vec::new());
    first.run(40.0);
    first.finish().expect("a session in lockstep");
    let file = folder.path().join("joint.toml");
    fs::write(&file, EXPERIMENT).expect("a session in lockstep");
    session(loaded, None, vec![file])
}

/// Every message on `topic` of `session`, for as long as it is read each 0.2 s.
pub fn heard<M: Message>(session: &LockstepSession, topic: Topic<M>) -> Subscriber<M> {
    let subscriber = session.bus().subscriber(topic, Depth::Queue(256));
    subscriber.expect("a session in lockstep")
}
