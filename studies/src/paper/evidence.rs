//! The experiments that the paper's tables and figures rest on, recorded.

use std::path::{Path, PathBuf};

use ferntast_config::ConfigError;
use ferntast_drivers::simulated;
use ferntast_identification::experiments::{
    damping::Sample, flexible_joint::Row, stiffness::Stiffness,
};
use ferntast_model::contour::Surface;
use ferntast_nodes::lockstep::RunError;
use ferntast_sim::arm::ArmConfig;

use super::flexible_joint::{self, FlexibleJointEvidence, FlexibleJointJob};
use super::friction_felt::{self, FrictionFelt};
use super::sensor_truth::{self, SensorTruthJob, SensorTruthRun};
use super::trajectory::Trajectory;
use crate::experiment::{
    Conditions, ExperimentError, IdentifyError, Plan, campaign,
    campaign::{CampaignError, Mission, Run, RunResult},
    identify::{self, CUBIC, CUBIC_UNLOADED, Contact, Friction, JointData, LINEAR},
    run,
};
use crate::parallel;

/// A set of Table 1: b_0 \[Nm\], b_0T \[-\], b_1 \[Nm·s/rad\], b_2 \[Nm·s²/rad²\],
/// b_3 \[Nm·s³/rad³\].
pub type FrictionSet = [f64; 5];

/// Table 1, joint 2.
pub const ON_GROUND: FrictionSet = [7.573, 0.127, 168.388, -544.193, 516.421];
/// Spring, 2005-03-24.
pub const MARCH: FrictionSet = [12.372, 0.146, 163.301, -578.954, 547.449];
/// Spring, 2005-05-12.
pub const MAY: FrictionSet = [10.850, -0.178, 194.957, -608.227, 570.378];
/// Sinusoidal, 2005-12-22; b_0T was not identified.
pub const SINE: FrictionSet = [11.635, 0.0, 258.253, -1246.582, 1805.827];

/// Day of the mission of 2005-03-24, 2005-05-12, 2005-12-22.
const MARCH_DAY: f64 = 57.0;
const MAY_DAY: f64 = 106.0;
const SINE_DAY: f64 = 330.0;
/// Temperature at which the sets are taken to hold \[degC\]; the paper gives none.
const TEMPERATURE: f64 = 10.0;
/// The paper's speeds \[deg/s\].
pub const SPEEDS: [f64; 5] = [1.0, 5.0, 10.0, 20.0, 40.0];

/// Why there is no comparison with the paper.
#[derive(Debug, thiserror::Error)]
pub enum PaperError {
    /// Configuration that cannot be used.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// A number of the mission is out of its bounds.
    #[error("mission: {0}")]
    Parameter(#[from] ferntast_model::ParameterError),
    /// An experiment or what its recording says failed.
    #[error(transparent)]
    Campaign(#[from] CampaignError),
    /// An experiment failed.
    #[error(transparent)]
    Experiment(#[from] ExperimentError),
    /// A recording says nothing.
    #[error(transparent)]
    Identify(#[from] IdentifyError),
    /// A folder or page cannot be written.
    #[error("cannot write {path}: {source}")]
    Write {
        /// Where.
        path: PathBuf,
        /// The operating system's reason.
        source: std::io::Error,
    },
    /// A session in virtual time failed.
    #[error(transparent)]
    Session(#[from] RunError),
    /// The page cannot be made.
    #[error("the page: {0}")]
    Page(#[from] serde_json::Error),
}

/// One joint's friction out of one recording, by several models.
#[derive(Clone, Debug)]
pub struct JointEvidence {
    /// Equation (3).
    pub linear: Friction,
    /// Equation (4); of the sinusoid without load.
    pub cubic: Friction,
    /// Equation (4) with load.
    pub loaded: Friction,
    /// The damping torque itself.
    pub samples: Vec<Sample>,
    /// How the joint moved.
    pub trajectory: Trajectory,
}

/// Everything that was recorded and identified.
#[derive(Clone, Debug)]
pub struct Evidence {
    /// Springs on the ground, joint 1 and joint 2.
    pub ground: [JointEvidence; 2],
    /// Springs in space with the set of 2005-03-24, joint 1 and joint 2.
    pub march: [JointEvidence; 2],
    /// Spring with the set of 2005-05-12, joint 2.
    pub may: JointEvidence,
    /// Sinusoid with the set of 2005-12-22, joint 2.
    pub sine: JointEvidence,
    /// Sinusoid with the set of 2005-05-12, joint 2.
    pub may_sine: JointEvidence,
    /// Stiffness of joint 2 on the ground and in space.
    pub stiffness: [Stiffness; 2],
    /// The contact of Fig. 16, and the normal force that was to be held \[N\].
    pub contact: (Contact, f64),
    /// The campaign.
    pub campaign: Vec<RunResult>,
    /// The second paper's joint: in motion, and with a long rest.
    pub flexible_joint: FlexibleJointEvidence,
    /// Sensors and contour that are off, before and after they are found.
    pub sensor_truth: Vec<SensorTruthRun>,
    /// What the friction found is worth in the hand.
    pub friction_felt: FrictionFelt,
}

/// One experiment apart from the campaign.
struct Single {
    name: &'static str,
    plan: Plan,
    conditions: Conditions,
    set: Option<FrictionSet>,
}

enum Job {
    Single(Single),
    Campaign(Run),
    FlexibleJoint(FlexibleJointJob),
    SensorTruth(SensorTruthJob),
    FrictionFelt,
}

enum Done {
    Joint(Box<JointEvidence>),
    Stiffness(Stiffness),
    Contact(Contact),
    Campaign(Box<RunResult>),
    FlexibleJoint([Vec<Row>; 3]),
    SensorTruth(SensorTruthRun),
    FrictionFelt(Box<FrictionFelt>),
}

const FIG_16_FORCE: f64 = 20.0;

/// In space on `day`, at the sets' temperature.
fn space(day: f64) -> Conditions {
    Conditions {
        day: Some(day),
        temperature: Some(TEMPERATURE),
        ..Conditions::default()
    }
}

fn singles() -> Vec<Single> {
    let spring = |joint| Plan::Spring {
        joint,
        speeds: SPEEDS.to_vec(),
        time_per_speed: 12.0,
    };
    let sine = || Plan::Sine {
        frequencies: vec![0.05, 0.1, 0.2, 0.3, 0.38],
        time_per_frequency: 20.0,
    };
    let ground = Conditions {
        ground: true,
        ..Conditions::default()
    };
    let single = |name, plan, conditions, set| Single {
        name,
        plan,
        conditions,
        set,
    };
    vec![
        single("ground_spring_joint_1", spring(1), ground, None),
        single("ground_spring_joint_2", spring(2), ground, Some(ON_GROUND)),
        single(
            "2005-03-24_spring_joint_1",
            spring(1),
            space(MARCH_DAY),
            None,
        ),
        single(
            "2005-03-24_spring_joint_2",
            spring(2),
            space(MARCH_DAY),
            Some(MARCH),
        ),
        single(
            "2005-05-12_spring_joint_2",
            spring(2),
            space(MAY_DAY),
            Some(MAY),
        ),
        single(
            "2005-12-22_sine_joint_2",
            sine(),
            space(SINE_DAY),
            Some(SINE),
        ),
        single("2005-05-12_sine_joint_2", sine(), space(MAY_DAY), Some(MAY)),
        single(
            "ground_stiffness_joint_2",
            Plan::Stiffness { teeth: 4 },
            ground,
            None,
        ),
        single(
            "space_stiffness_joint_2",
            Plan::Stiffness { teeth: 4 },
            space(MARCH_DAY),
            None,
        ),
        single(
            "2005-03-24_contact_unlubricated",
            Plan::Contact {
                surface: Surface::Unlubricated,
                forces: vec![FIG_16_FORCE],
                frequencies: vec![0.2, 0.4],
                time_per_press: 12.0,
            },
            space(MARCH_DAY),
            None,
        ),
    ]
}

/// Puts a set of Table 1 into joint 2's truth; it holds on this very day.
fn put(arm: &mut ArmConfig, [b_0, b_0t, b_1, b_2, b_3]: FrictionSet) {
    let friction = &mut arm.truth.joint[1].friction;
    friction.b_0 = b_0;
    friction.b_0t = b_0t;
    friction.b_1 = b_1;
    friction.b_2 = b_2;
    friction.b_3 = b_3;
    friction.wear = None;
}

fn joint_evidence(
    path: &Path,
    joint: usize,
    is_loaded: bool,
) -> Result<JointEvidence, IdentifyError> {
    let data = JointData::read(path, joint)?;
    Ok(JointEvidence {
        linear: data.friction(path, LINEAR)?,
        cubic: data.friction(path, if is_loaded { CUBIC } else { CUBIC_UNLOADED })?,
        loaded: data.friction(path, CUBIC)?,
        samples: data.samples(),
        trajectory: Trajectory::of(&data.dataset),
    })
}

fn do_single(
    arm: &ArmConfig,
    one: &Single,
    seed: u64,
    folder: &Path,
    progress: &dyn Fn(f64),
) -> Result<Done, PaperError> {
    let path = folder.join(one.name);
    let mut arm = arm.clone();
    if let (Some(set), false) = (one.set, one.conditions.ground) {
        put(&mut arm, set);
    }
    run(&one.plan, &arm, &one.conditions, seed, &path, progress)?;
    Ok(match &one.plan {
        Plan::Spring { joint, .. } => Done::Joint(Box::new(joint_evidence(&path, *joint, true)?)),
        Plan::Sine { .. } => Done::Joint(Box::new(joint_evidence(&path, 2, false)?)),
        Plan::Stiffness { .. } => Done::Stiffness(identify::stiffness(&path)?),
        Plan::Contact { surface, .. } => Done::Contact(Contact::read(&path, *surface)?),
    })
}

fn jobs(mission: &Mission) -> Vec<Job> {
    let singles = singles().into_iter().map(Job::Single);
    singles
        .chain(mission.runs().into_iter().map(Job::Campaign))
        .chain(flexible_joint::jobs().map(Job::FlexibleJoint))
        .chain(sensor_truth::jobs().map(Job::SensorTruth))
        .chain(std::iter::once(Job::FrictionFelt))
        .collect()
}

fn load() -> Result<(Mission, ArmConfig), PaperError> {
    let mission = Mission::load("mission")?;
    let arm = simulated::load_config(&mission.arm)?;
    Ok((mission, arm))
}

/// Virtual time of everything \[s\].
///
/// # Errors
///
/// [`PaperError`].
pub fn duration() -> Result<f64, PaperError> {
    let (mission, arm) = load()?;
    let mut sum = campaign::duration(&mission, &arm)?;
    for one in singles() {
        sum += one.plan.program(&arm)?.duration();
    }
    sum += flexible_joint::jobs()
        .map(|one| one.duration())
        .sum::<f64>();
    sum += friction_felt::duration(&arm)?;
    for one in sensor_truth::jobs() {
        sum += one.plan().program(&arm)?.duration();
    }
    Ok(sum)
}

/// Runs all experiments into the new folder `folder` and identifies each from
/// its recording. `progress` hears of virtual time passed \[s\].
///
/// # Errors
///
/// [`PaperError`] of the first that failed.
pub fn collect(
    folder: &Path,
    seed: u64,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Evidence, PaperError> {
    let (mut mission, arm) = load()?;
    mission.seed = mission.seed.wrapping_add(seed);
    std::fs::create_dir_all(folder).map_err(|source| PaperError::Write {
        path: folder.to_owned(),
        source,
    })?;
    let done = parallel::map(&jobs(&mission), |index, job| -> Result<Done, PaperError> {
        let progress = |slice| progress(slice);
        match job {
            Job::Single(one) => {
                let seed = seed.wrapping_mul(1_000_003).wrapping_add(index as u64);
                do_single(&arm, one, seed, folder, &progress)
            }
            Job::Campaign(one) => {
                let folder = folder.join("mission");
                let result = campaign::run_and_identify(&arm, one, &folder, &progress)?;
                Ok(Done::Campaign(Box::new(result)))
            }
            Job::FlexibleJoint(one) => {
                let rows = one.run(folder, seed)?;
                progress(one.duration());
                Ok(Done::FlexibleJoint(rows))
            }
            Job::SensorTruth(one) => {
                let conditions = space(MARCH_DAY);
                let run = one.run(&arm, &conditions, seed, folder, &progress)?;
                Ok(Done::SensorTruth(run))
            }
            Job::FrictionFelt => {
                let conditions = space(MARCH_DAY);
                let felt = friction_felt::collect(&arm, &conditions, seed, folder, &progress)?;
                Ok(Done::FrictionFelt(Box::new(felt)))
            }
        }
    })?;
    let (mut joints, mut stiffnesses, mut contacts, mut campaign, mut rows) =
        (Vec::new(), Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let (mut sensor_truth, mut friction_felt) = (Vec::new(), None);
    for one in done {
        match one {
            Done::Joint(one) => joints.push(*one),
            Done::Stiffness(one) => stiffnesses.push(one),
            Done::Contact(one) => contacts.push(one),
            Done::Campaign(one) => campaign.push(*one),
            Done::FlexibleJoint(one) => rows.push(one),
            Done::SensorTruth(one) => sensor_truth.push(one),
            Done::FrictionFelt(one) => friction_felt = Some(*one),
        }
    }
    let missing = || {
        PaperError::Identify(IdentifyError::Empty {
            path: folder.to_owned(),
            what: "an experiment is missing",
        })
    };
    let mut joints = joints.into_iter();
    let mut joint = || joints.next().ok_or_else(missing);
    let mut rows = rows.into_iter();
    let mut stiffnesses = stiffnesses.into_iter();
    let mut stiffness = || stiffnesses.next().ok_or_else(missing);
    Ok(Evidence {
        ground: [joint()?, joint()?],
        march: [joint()?, joint()?],
        may: joint()?,
        sine: joint()?,
        may_sine: joint()?,
        stiffness: [stiffness()?, stiffness()?],
        contact: (
            contacts.into_iter().next().ok_or_else(missing)?,
            FIG_16_FORCE,
        ),
        campaign,
        flexible_joint: FlexibleJointEvidence {
            motion: rows.next().ok_or_else(missing)?,
            rest: rows.next().ok_or_else(missing)?,
        },
        sensor_truth,
        friction_felt: friction_felt.ok_or_else(missing)?,
    })
}
