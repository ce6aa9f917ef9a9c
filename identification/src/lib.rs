//! What recordings say about a model of a joint, or of a contact: how far off it is and where,
//! which physical effect is missing, and how far the error falls with it.
//!
//! ```text
//! sessions ─ filter, differentiate, thin, mask ─ columns of effects ─ Gram matrices ─┬ compare
//!           (signals)                           (effects, design)    (gram)          ├ diagnose
//!                                                                                    └ add
//! ```
//!
//! Equation throughout: τ_m = J q̈ + τ + τ_F, joint quantities on the joint side
//! of the gear. A contact is the same without motor and inertia: F_T, which
//! depends on F_N as τ_F on the load ([`JointType::Contact`]). Pure: no file, clock, thread or randomness; the same recordings
//! give the same answer.

pub mod add;
pub mod candidates;
pub mod check;
pub mod compare;
pub mod contact_friction;
pub mod damping;
pub mod data;
pub mod dependence;
pub mod design;
pub mod diagnose;
pub mod effects;
pub mod encompass;
pub mod error;
pub mod expression;
pub mod extrapolation;
pub mod family;
pub mod filter;
pub mod fit;
pub mod flexible_joint;
pub mod gram;
pub mod noise_floor;
pub mod periodic;
mod prediction;
pub mod refine;
pub mod regression;
pub mod residual_map;
pub mod reversal;
pub mod scatter;
pub mod sensor_zero;
pub mod setup;
pub mod signals;
pub mod simulate;
pub mod stated_filter;
pub mod statistics;
pub mod stiffness;
pub mod turns;
pub mod twin;
mod undo;
pub mod validation;

pub use add::{Addition, add};
pub use compare::{Comparison, compare};
pub use data::{CustomEffect, Dataset, Inertia, JointType, ModelSpec, Session, Subject, Term};
pub use diagnose::{Diagnosis, Suspect, Verdict, diagnose};
pub use effects::EffectDescription;
pub use error::{ExpressionError, PrepareError};
pub use ferntast_model::friction::Proposal;
pub use stated_filter::StatedFilter;

/// Every effect that a model can be given by id, and that [`diagnose()`] tries.
#[must_use]
pub fn catalogue() -> Vec<EffectDescription> {
    effects::all()
        .iter()
        .map(|effect| effect.description().clone())
        .collect()
}

#[cfg(test)]
mod bench;
#[cfg(test)]
mod contact_tests;
#[cfg(test)]
mod tests;
