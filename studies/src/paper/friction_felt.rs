//! What the friction that the lab finds is worth in the hand: forces by the motors' currents, and
//! the servo's feed-forward taken over from the twins. Not an item of the paper.

use std::{collections::BTreeMap, fs, path::Path};

use ferntast_bus::{Bus, Depth, Subscriber};
use ferntast_config::Loaded;
use ferntast_control::estimator::Form;
use ferntast_drivers::simulated::{arm_file, load_arm};
use ferntast_model::{contour::Surface, friction::FrictionParameters};
use ferntast_msgs::{
    Message,
    sample::{ContactStateSample, FrictionCommand, PoseSample, WrenchSample},
    topics::{self, Topic},
};
use ferntast_nodes::{
    lockstep::{LockstepSession, RunError},
    process::SessionContext,
    session_graph,
};
use ferntast_sim::arm::ArmConfig;

use super::{
    PaperError,
    item::{Item, Section},
};
use crate::experiment::{
    Conditions, IdentifyError, Plan,
    identify::{CUBIC, Contact, Friction, JointData},
    run,
};

/// True friction over the believed one [-]: of forces by currents, and in the session.
const MORE_BY_CURRENTS: f64 = 1.35;
const MORE: f64 = 1.3;
/// Temperature at which friction is as configured \[degC\].
const TEMPERATURE: f64 = 10.0;
/// Length of the script of the shipped session \[s\].
const PERIOD: f64 = 19.0;
/// Periods in which the twins learn, one in which the servo takes over, one that is judged.
const LEARN: usize = 3;
/// Normal force \[N\] at which forces by currents are judged: the currents' noise makes 3 N of them,
/// whatever the force and however true the friction. Speeds that friction is identified at \[deg/s\].
const FORCE: f64 = 40.0;
const SPEEDS: [f64; 5] = [1.0, 5.0, 10.0, 20.0, 40.0];

/// What tip and hand did in one period of the script.
#[derive(Clone, Debug, Default)]
struct Period {
    /// RMS of the tip's command less the tip \[m\], free and in contact.
    free: f64,
    contact: f64,
    /// The force in the hand at each millisecond \[N\].
    hand: Vec<[f64; 3]>,
}

impl Period {
    /// RMS of the force in the hand less that in another session \[N\].
    fn beside(&self, other: &Period) -> f64 {
        let pairs = self.hand.iter().zip(&other.hand);
        let squares = pairs.map(|(own, other)| {
            let each = own.iter().zip(other).map(|(a, b)| (a - b).powi(2));
            each.sum::<f64>()
        });
        (squares.sum::<f64>() / self.hand.len().max(1) as f64).sqrt()
    }
}

/// What was recorded.
#[derive(Clone, Debug)]
pub struct FrictionFelt {
    /// Contact force by currents off that by the sensors, over that [-]: with the believed
    /// friction and with the friction identified.
    by_currents: [f64; 2],
    /// The script's period with friction as believed, more of it, and more of it taken over.
    periods: [Period; 3],
    /// Joints of which the friction was taken over.
    taken: usize,
}

/// Virtual time of it \[s\].
pub(super) fn duration(arm: &ArmConfig) -> Result<f64, PaperError> {
    let mut sum = 3.0 * (LEARN + 2) as f64 * PERIOD + 40.0;
    for plan in [spring(1), spring(2), slide(), slide()] {
        sum += plan.program(arm)?.duration();
    }
    Ok(sum)
}

fn spring(joint: usize) -> Plan {
    Plan::Spring {
        joint,
        speeds: SPEEDS.to_vec(),
        time_per_speed: 12.0,
    }
}

fn slide() -> Plan {
    Plan::Contact {
        surface: Surface::Lubricated,
        forces: vec![FORCE],
        frequencies: vec![0.2, 0.4],
        time_per_press: 10.0,
    }
}

/// Runs all of it into folders below `folder`.
pub(super) fn collect(
    arm: &ArmConfig,
    conditions: &Conditions,
    seed: u64,
    folder: &Path,
    progress: &dyn Fn(f64),
) -> Result<FrictionFelt, PaperError> {
    let by_currents = by_currents(arm, conditions, seed, folder, progress)?;
    let (periods, taken) = in_the_hand(seed, folder, progress)?;
    Ok(FrictionFelt {
        by_currents,
        periods,
        taken,
    })
}

/// All of a joint's true friction, times `factor`.
fn wear(arm: &mut ArmConfig, factor: f64) {
    for joint in &mut arm.truth.joint {
        let own = &mut joint.friction;
        own.wear = None;
        for value in [
            &mut own.b_0,
            &mut own.b_0t,
            &mut own.b_1,
            &mut own.b_2,
            &mut own.b_3,
        ] {
            *value *= factor;
        }
    }
}

/// What was identified, as an arm's file has it.
fn configured(found: &Friction, speed_range: [f64; 2]) -> FrictionParameters {
    let effects = CUBIC
        .iter()
        .zip(["b_0", "b_0T", "b_1", "b_2", "b_3"])
        .map(|(effect, key)| {
            let value = found.value(&key.replace('_', ""));
            (
                (*effect).to_owned(),
                BTreeMap::from([(key.to_owned(), value)]),
            )
        });
    FrictionParameters {
        speed_range,
        effects: effects.collect(),
    }
}

fn by_currents(
    arm: &ArmConfig,
    conditions: &Conditions,
    seed: u64,
    folder: &Path,
    progress: &dyn Fn(f64),
) -> Result<[f64; 2], PaperError> {
    let mut nominal = arm.clone();
    wear(&mut nominal, MORE_BY_CURRENTS);
    let mut identified = nominal.clone();
    for joint in 1..=2 {
        let path = folder.join(format!("felt_spring_joint_{joint}"));
        run(&spring(joint), &nominal, conditions, seed, &path, progress)?;
        let found = JointData::read(&path, joint)?.friction(&path, CUBIC)?;
        if let Some(own) = identified.joint.get_mut(joint - 1) {
            own.friction = configured(&found, own.friction.speed_range);
        }
    }
    let off = |arm: &ArmConfig, name: &str| -> Result<f64, PaperError> {
        let mut arm = arm.clone();
        arm.estimator.form = Form::MotorCurrent;
        let path = folder.join(name);
        run(&slide(), &arm, conditions, seed, &path, progress)?;
        let contact = Contact::read(&path, Surface::Lubricated)?;
        let (mut error, mut force) = (0.0, 0.0);
        let usable = (0..contact.usable.len()).filter(|&at| contact.usable[at]);
        for at in usable {
            let [tangential, normal] = contact.by_sensors[at];
            error += (contact.tangential[at] - tangential).powi(2);
            error += (contact.normal[at] - normal).powi(2);
            force += tangential.powi(2) + normal.powi(2);
        }
        if force <= 0.0 {
            return Err(IdentifyError::Empty {
                path,
                what: "the tip hardly slid",
            }
            .into());
        }
        Ok((error / force).sqrt())
    };
    Ok([
        off(&nominal, "felt_currents_nominal")?,
        off(&identified, "felt_currents_identified")?,
    ])
}

/// The experiment of a joint's twin, from 0, on the recording `first` beside it.
fn experiment(joint: usize, inertia: f64, gear_ratio: f64) -> String {
    let number = joint + 1;
    format!(
        r#"
recording = "felt_first"

[signals]
position = "/follower/measured_js.position[{joint}]"
joint_torque = "/follower/measured_js.effort[{joint}]"
motor_torque = "/follower/motor_js.effort[{joint}]"
temperature = "/follower/joint_{number}/temperature.temperature"

[model]
inertia = {inertia}
gear_ratio = {gear_ratio}
effects = ["coulomb", "load_coulomb", "viscous", "quadratic_viscous", "cubic_viscous"]
"#
    )
}

/// The shipped session whose arm has `factor` times the believed friction.
fn loaded(seed: u64, factor: f64) -> Result<(Loaded, ArmConfig), PaperError> {
    let mut loaded = ferntast_config::load_scenario("rokviss", load_arm)?;
    loaded.scenario.seed = seed;
    let mut arm: ArmConfig = loaded.arm.whole()?;
    arm.truth.environment.temperature = Some([TEMPERATURE; 2]);
    wear(&mut arm, factor);
    loaded.arm = arm_file(&arm)?;
    loaded.complete()?;
    Ok((loaded, arm))
}

fn in_the_hand(
    seed: u64,
    folder: &Path,
    progress: &dyn Fn(f64),
) -> Result<([Period; 3], usize), PaperError> {
    let (believed, arm) = loaded(seed, 1.0)?;
    let (more, _) = loaded(seed, MORE)?;
    // The twins' models are fitted to a session of the arm as it is believed.
    let mut first = believed.clone();
    first.scenario.seed = seed.wrapping_add(1000);
    let mut context = SessionContext::in_virtual_time(first);
    context.bag = Some(folder.join("felt_first"));
    let mut session = LockstepSession::new(&session_graph(ferntast_drivers::rows()), &context)?;
    session.run(40.0);
    progress(40.0);
    session.finish()?;
    let mut twins = Vec::new();
    for (joint, own) in arm.joint.iter().enumerate() {
        let file = folder.join(format!("felt_joint_{joint}.toml"));
        let text = experiment(joint, own.motor_inertia, own.gear_ratio);
        fs::write(&file, text).map_err(|source| PaperError::Write {
            path: file.clone(),
            source,
        })?;
        twins.push(file);
    }
    let without = |loaded: &Loaded| Watched::new(loaded, Vec::new());
    let (truth, _) = without(&believed)?.told(false, progress)?;
    let (before, _) = without(&more)?.told(false, progress)?;
    let (after, taken) = Watched::new(&more, twins)?.told(true, progress)?;
    Ok(([truth, before, after], taken))
}

/// A session that is looked at.
struct Watched {
    session: LockstepSession,
    command: Subscriber<PoseSample>,
    tip: Subscriber<PoseSample>,
    contact: Subscriber<ContactStateSample>,
    hand: Subscriber<WrenchSample>,
}

fn heard<M: Message>(bus: &Bus, topic: Topic<M>) -> Result<Subscriber<M>, RunError> {
    Ok(bus.subscriber(topic, Depth::Queue(256))?)
}

impl Watched {
    fn new(loaded: &Loaded, twins: Vec<std::path::PathBuf>) -> Result<Watched, PaperError> {
        let mut context = SessionContext::in_virtual_time(loaded.clone());
        context.twins = twins;
        let session = LockstepSession::new(&session_graph(ferntast_drivers::rows()), &context)?;
        let bus = session.bus();
        Ok(Watched {
            command: heard(bus, topics::FOLLOWER_SERVO_CP)?,
            tip: heard(bus, topics::FOLLOWER_MEASURED_CP)?,
            contact: heard(bus, topics::FOLLOWER_CONTACT_STATE)?,
            hand: heard(bus, topics::LEADER_SERVO_CF)?,
            session,
        })
    }

    /// The last of several periods of the script, and how many joints' friction was taken over.
    fn told(
        mut self,
        take_over: bool,
        progress: &dyn Fn(f64),
    ) -> Result<(Period, usize), PaperError> {
        for _ in 0..LEARN {
            self.period(progress);
        }
        if take_over {
            self.session
                .command_friction_at(0.0, FrictionCommand::TAKE_OVER)?;
        }
        self.period(progress);
        let frictions = self.session.monitor().friction();
        let taken = frictions
            .iter()
            .filter(|own| own.source == "twin" && own.refused.is_none());
        let taken = taken.count();
        Ok((self.period(progress), taken))
    }

    /// Runs a period of the script.
    fn period(&mut self, progress: &dyn Fn(f64)) -> Period {
        let (mut sums, mut hand) = ([(0.0, 0.0); 2], Vec::new());
        let mut command: Option<PoseSample> = None;
        for _ in 0..(PERIOD * 10.0).round() as usize {
            self.session.run(0.1);
            progress(0.1);
            let now = self.session.now();
            while let (Some(tip), Some(state)) = (self.tip.next(now), self.contact.next(now)) {
                while let Some(own) = self.command.next(tip.received) {
                    command = Some(own.message);
                }
                let Some(command) = command else {
                    continue;
                };
                let pairs = command.position.iter().zip(tip.message.position);
                let apart: f64 = pairs.map(|(a, b)| (a - b).powi(2)).sum();
                let (sum, count) = &mut sums[usize::from(state.message.in_contact == 1)];
                *sum += apart;
                *count += 1.0;
            }
            while let Some(own) = self.hand.next(now) {
                hand.push(own.message.force);
            }
        }
        let rms = |(sum, count): (f64, f64)| (sum / count.max(1.0)).sqrt();
        Period {
            free: rms(sums[0]),
            contact: rms(sums[1]),
            hand,
        }
    }
}

/// The section.
pub(super) fn section(felt: &FrictionFelt) -> Section {
    let [nominal, identified] = felt.by_currents;
    let [truth, before, after] = &felt.periods;
    let hand = [before.beside(truth), after.beside(truth)];
    let inside = |name: &str, unit, here: f64, range, statement: &str| {
        let name = format!("friction_felt/{name}");
        Item::inside(&name, unit, Some(here), None, range, statement)
    };
    let infinity = f64::INFINITY;
    let items = vec![
        inside(
            "motor_current/identified",
            "",
            identified,
            [0.0, 0.10],
            "contact force by currents with the friction identified, off that by the sensors",
        ),
        inside(
            "motor_current/nominal_over_identified",
            "",
            nominal / identified,
            [3.0, infinity],
            "the same with the believed friction is worse",
        ),
        inside(
            "take_over/joints",
            "",
            felt.taken as f64,
            [2.0, 2.0],
            "taken over at the script's own pace",
        ),
        inside(
            "take_over/free/before_over_believed",
            "",
            before.free / truth.free,
            [1.5, infinity],
            "30 % more friction than believed: tip off its command",
        ),
        inside(
            "take_over/free/after_over_believed",
            "",
            after.free / truth.free,
            [0.0, 1.25],
            "nearly as with the friction believed",
        ),
        inside(
            "take_over/contact/after_over_believed",
            "",
            after.contact / truth.contact,
            [0.0, 1.15],
            "the same in contact",
        ),
        inside(
            "take_over/hand/before",
            "N",
            hand[0],
            [0.05, infinity],
            "force in the hand off that of a session as believed",
        ),
        inside(
            "take_over/hand/after",
            "N",
            hand[1],
            [0.0, 0.7 * hand[0]],
            "less of it is left; the rest is of the dry edge, along which joints hardly turn",
        ),
    ];
    Section {
        name: "Friction felt".to_owned(),
        title: "What the friction found is worth in the hand".to_owned(),
        text: "Not in the paper. Contact forces by the motors' currents alone, beside those by the torque sensors, with an arm \
               of 35 % more friction than believed; and the shipped session with 30 % more, in which the servo takes over what \
               the twins of both joints found."
            .to_owned(),
        charts: Vec::new(),
        items,
    }
}
