//! Identification experiments on the arm: motion, recording, what it says.
//!
//! An experiment runs the simulated arm and its servo (for contacts also the
//! estimator) in virtual time. Commands go through the servo's own topics; a
//! rosbag2 recording samples the measurements every 12 ms, as the paper does.
//! Whatever is said of the arm is identified from that recording alone.
//!
//! * [`Plan`]: which experiment, laid out on the arm's contour,
//! * [`Conditions`]: place, date and temperature,
//! * [`program`]: the motions,
//! * [`bench`]: arm, servo and recorder in virtual time,
//! * [`identify`]: what a recording says,
//! * [`campaign`]: the same on many dates,
//! * [`flexible_joint`]: the second paper's joint, on a bench of its own.

pub mod bench;
pub mod campaign;
mod conditions;
mod error;
pub mod flexible_joint;
pub mod identify;
mod plan;
pub mod program;

use std::path::Path;

use ferntast_sim::arm::ArmConfig;

pub use conditions::{Conditions, MISSION_START};
pub use error::{ExperimentError, IdentifyError};
pub use plan::Plan;

/// Runs `plan` on `arm` under `conditions` into the new rosbag2 directory
/// `folder`; `progress` hears of virtual time passed \[s\]. Gives the virtual
/// time that it took \[s\].
///
/// # Errors
///
/// [`ExperimentError`].
pub fn run(
    plan: &Plan,
    arm: &ArmConfig,
    conditions: &Conditions,
    seed: u64,
    folder: &Path,
    progress: &dyn Fn(f64),
) -> Result<f64, ExperimentError> {
    let mut arm = conditions.arm(arm)?;
    plan.prepare(&mut arm);
    arm.validate()?;
    let json = |value: Result<String, serde_json::Error>| value.unwrap_or_default();
    let record = [
        ("plan".to_owned(), json(serde_json::to_string(plan))),
        (
            "conditions".to_owned(),
            json(serde_json::to_string(conditions)),
        ),
        ("seed".to_owned(), seed.to_string()),
    ];
    let bench = bench::Bench {
        kind: plan.kind(),
        servo: plan.servo(),
        program: plan.program(&arm)?,
        contact: plan.is_contact(),
        start: Conditions::start(&arm),
        arm,
        seed,
        record: record.into(),
    };
    bench.run(folder, progress)
}
