//! How long a step of the integration may be.

use ferntast_model::{
    Joints, ParameterError,
    rigid_body::{Chain, JointKind, PositionLimits},
};

use super::{plant::Plant, world::Object};

/// Longest substep where the file gives none \[s\].
const LONGEST_SUBSTEP: f64 = 5e-4;
/// Postures that are looked at for the fastest vibration of the tip.
const POSTURES: usize = 64;

/// A substep with h ω ≤ 1/2 for the fastest vibration of the tip on what it touches; the
/// integration breaks down at 2. Gears are integrated at any stiffness.
pub(super) fn substep(plant: &Plant, given: Option<f64>) -> Result<f64, ParameterError> {
    let stiffest = plant
        .objects
        .iter()
        .map(Object::stiffness)
        .fold(0.0, f64::max);
    let postures = (0..POSTURES).map(|number| posture(plant.chain(), number));
    let fastest = std::iter::once(plant.q)
        .chain(postures)
        .map(|q| plant.contact_rate(&q, stiffest))
        .fold(0.0, f64::max);
    let longest = 0.5 / fastest.sqrt();
    match given {
        None => Ok(longest.min(LONGEST_SUBSTEP)),
        Some(given) if given <= longest => Ok(given),
        Some(given) => Err(ParameterError::Inconsistent {
            key: "substep".into(),
            reason: format!(
                "{given} s does not resolve how fast the tip vibrates on its stiffest surface \
                 ({stiffest} N/m); set it to {longest:.1e} s or less, or leave it out"
            ),
        }),
    }
}

/// One of many postures, spread evenly between the joints' ends.
fn posture(chain: &Chain, number: usize) -> Joints<f64> {
    // The additive recurrence of Roberts, in as many dimensions as there are joints.
    let ratio = 1.0 / 1.08;
    let mut step = 1.0;
    Joints::from_fn(chain.count(), |joint| {
        step *= ratio;
        let share = (0.5 + number as f64 * step).fract();
        let turns = chain.kinds()[joint] == JointKind::Revolute;
        let reach = if turns { std::f64::consts::PI } else { 1.0 };
        let PositionLimits { lower, upper } = chain.limits()[joint];
        let (lower, upper) = (lower.max(-reach), upper.min(reach));
        lower + (upper - lower) * share
    })
}
