//! Two years of experiments: the same motions on many dates, at the
//! temperatures of the day.

use std::{
    fs,
    path::{Path, PathBuf},
};

use ferntast_config::{ConfigError, FileKind};
use ferntast_identification::experiments::{contact_friction::ContactFriction, damping::Average};
use ferntast_model::{ParameterError, check, contour::Surface, parameters};
use ferntast_sim::arm::ArmConfig;
use serde::Serialize;

use super::{
    Conditions, ExperimentError, IdentifyError, Plan,
    identify::{self, CUBIC, Contact, Friction, JointData},
    run,
};
use crate::parallel;

/// Ranges of speed of Figs. 12, 13 (and 10), 14 (and 11) \[deg/s\].
pub const RANGES: [[f64; 2]; 3] = [[0.5, 1.5], [4.0, 6.0], [27.0, 35.0]];

parameters! {
    /// A file of `config/experiments/` that begins a campaign.
    pub struct Mission {
        /// Its name.
        pub name: String,
        /// What it is, in a sentence.
        pub description: String,
        /// The arm: a file of `config/arms/` or a path.
        pub arm: String,
        /// Seed of all noise.
        pub seed: u64,
        /// Whether the reference on the ground comes first.
        pub ground: bool,
        /// Dates: days since 2005-01-26 10:00 UTC.
        pub days: Vec<f64> [0.0..=36_525.0, "d"],
        /// What is done on each date.
        pub experiment: Vec<Plan>,
    }
    check Mission::has_neither_nothing_nor_too_much;
}

/// Where campaigns are.
const FILE: FileKind = FileKind {
    name: "campaign",
    folder: "experiments",
};

impl Mission {
    /// Loads the campaign `name`, shipped or a file.
    ///
    /// # Errors
    ///
    /// What is wrong, in which file, and how to correct it.
    pub fn load(name: &str) -> Result<Mission, ConfigError> {
        ferntast_config::load(FILE, name, Mission::validate)
    }

    fn has_neither_nothing_nor_too_much(&self) -> Result<(), ParameterError> {
        let (days, experiments) = (self.days.len() as f64, self.experiment.len() as f64);
        check("number of days", days, 1.0, 1000.0, "-")?;
        check("number of experiments", experiments, 1.0, 20.0, "-")
    }

    /// All runs: the ground first, then date by date.
    pub fn runs(&self) -> Vec<Run> {
        let ground = self.ground.then_some(Conditions {
            ground: true,
            ..Conditions::default()
        });
        let dates = self.days.iter().map(|&day| Conditions::on_day(day));
        let mut runs = Vec::new();
        for (number, conditions) in ground.into_iter().chain(dates).enumerate() {
            for plan in &self.experiment {
                runs.push(Run {
                    date: number,
                    plan: plan.clone(),
                    conditions,
                    seed: self
                        .seed
                        .wrapping_add(1000 * number as u64 + runs.len() as u64),
                });
            }
        }
        runs
    }
}

/// One run of a campaign.
#[derive(Clone, Debug)]
pub struct Run {
    /// Which date, from 0.
    pub date: usize,
    /// The experiment.
    pub plan: Plan,
    /// The date's conditions.
    pub conditions: Conditions,
    /// Seed of its noise.
    pub seed: u64,
}

impl Run {
    /// Where its recording goes below the campaign's folder.
    pub fn folder(&self) -> PathBuf {
        let date = match (self.conditions.ground, self.conditions.day) {
            (true, _) => "ground".to_owned(),
            (false, Some(day)) => format!("day_{day:07.2}"),
            (false, None) => format!("date_{}", self.date),
        };
        PathBuf::from(date).join(self.plan.folder())
    }
}

/// What a spring experiment on one joint said.
#[derive(Clone, Debug, Serialize)]
pub struct JointResult {
    /// Joint 1 or 2.
    pub joint: usize,
    /// Mean temperature as measured \[degC\].
    pub temperature: f64,
    /// Equation (4).
    pub friction: Friction,
    /// Mean damping in each of [`RANGES`].
    pub averages: Vec<Option<Average>>,
}

/// What a contact experiment said.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct ContactResult {
    /// Which edge.
    pub surface: Surface,
    /// Equation (6).
    pub friction: ContactFriction,
}

/// What one run said.
#[derive(Clone, Debug, Serialize)]
pub struct RunResult {
    /// On the ground.
    pub ground: bool,
    /// Day of the mission.
    pub day: f64,
    /// A joint's friction.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub joint: Option<JointResult>,
    /// A contact's friction.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contact: Option<ContactResult>,
    /// The recording.
    pub recording: PathBuf,
}

/// Why a campaign failed.
#[derive(Debug, thiserror::Error)]
pub enum CampaignError {
    /// A run failed.
    #[error(transparent)]
    Run(#[from] ExperimentError),
    /// A recording says nothing.
    #[error(transparent)]
    Identify(#[from] IdentifyError),
}

/// Runs one and identifies it from its recording.
///
/// # Errors
///
/// [`CampaignError`].
pub fn run_and_identify(
    arm: &ArmConfig,
    one: &Run,
    folder: &Path,
    progress: &dyn Fn(f64),
) -> Result<RunResult, CampaignError> {
    let path = folder.join(one.folder());
    if let Some(parent) = path.parent() {
        fs::create_dir_all(parent).map_err(|source| ExperimentError::Write {
            path: parent.to_owned(),
            source,
        })?;
    }
    run(&one.plan, arm, &one.conditions, one.seed, &path, progress)?;
    let day = one
        .conditions
        .arm(arm)
        .map_err(ExperimentError::from)?
        .truth
        .environment
        .day;
    let (mut joint, mut contact) = (None, None);
    match &one.plan {
        Plan::Spring { joint: number, .. } => joint = Some(joint_result(&path, *number)?),
        Plan::Sine { .. } => joint = Some(joint_result(&path, 2)?),
        Plan::Contact { surface, .. } => {
            let found = Contact::read(&path, *surface)?.friction();
            let friction = found.ok_or_else(|| IdentifyError::Empty {
                path: path.clone(),
                what: "the tip hardly slid; press less or move further",
            })?;
            contact = Some(ContactResult {
                surface: *surface,
                friction,
            });
        }
        Plan::Stiffness { .. } => {}
    }
    Ok(RunResult {
        ground: one.conditions.ground,
        day,
        joint,
        contact,
        recording: path,
    })
}

fn joint_result(path: &Path, joint: usize) -> Result<JointResult, IdentifyError> {
    let data = JointData::read(path, joint)?;
    Ok(JointResult {
        joint,
        temperature: data.temperature.unwrap_or(f64::NAN),
        friction: data.friction(path, CUBIC)?,
        averages: identify::averages(&data.samples(), &RANGES),
    })
}

/// Virtual time of a campaign \[s\].
///
/// # Errors
///
/// A plan that does not fit the arm.
pub fn duration(mission: &Mission, arm: &ArmConfig) -> Result<f64, ExperimentError> {
    let mut sum = 0.0;
    for one in mission.runs() {
        sum += one.plan.program(arm)?.duration();
    }
    Ok(sum)
}

/// Runs all of `mission` into `folder`; results in the order of [`Mission::runs`].
///
/// # Errors
///
/// [`CampaignError`] of the first run that failed.
pub fn run_all(
    mission: &Mission,
    arm: &ArmConfig,
    folder: &Path,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Vec<RunResult>, CampaignError> {
    parallel::map(&mission.runs(), |_, one| {
        run_and_identify(arm, one, folder, &|slice| progress(slice))
    })
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use ferntast_drivers::simulated;

    use super::*;

    #[test]
    fn the_shipped_mission_fits_the_arm_and_no_two_runs_share_a_folder_or_seed() {
        let mission = Mission::load("mission").unwrap();
        let arm = simulated::load_config(&mission.arm).unwrap();
        let seconds = duration(&mission, &arm).unwrap();
        assert!(seconds > 2000.0 && seconds < 10_000.0, "{seconds} s");
        let runs = mission.runs();
        let folders: BTreeSet<PathBuf> = runs.iter().map(Run::folder).collect();
        let seeds: BTreeSet<u64> = runs.iter().map(|one| one.seed).collect();
        assert_eq!(
            runs.len(),
            (mission.days.len() + 1) * mission.experiment.len()
        );
        assert_eq!((folders.len(), seeds.len()), (runs.len(), runs.len()));
        assert!(
            Mission {
                days: vec![-1.0],
                ..mission
            }
            .validate()
            .is_err()
        );
    }
}
