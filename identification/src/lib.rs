//! Identification of a joint's model, or of a contact's, from recordings: how large its
//! error is and where, which physical effect is missing, and by how much the error falls
//! with it.
//!
//! Folders in the order of the pipeline; each uses only those above it:
//!
//! ```text
//! numerics/      zero-phase filters, Gram matrices, least squares, statistics
//! data/          recordings and the believed model, as given; what is refused
//! signals/       sessions filtered, differentiated, thinned, masked: rows
//! effects/       the catalogue: columns over the state, formulas of the user's own
//! design/        model and signals together: columns, blocks of time, Gram matrices
//! validation/    error on data left out, within sessions and between them
//! shape_search/  parameters that enter nonlinearly: grid, golden sections, periods
//! preparation/   terms bound, shapes found, prediction made, channels compensated
//! fit/           parameters with standard errors; the model with one more effect
//! comparison/    the model against the recordings: residual maps, noise, simulation
//! diagnosis/     which effect is missing, which others explain as much, what to record next
//! discovery/     a formula for what no effect of the catalogue explains
//! twin/          the model held against the joint while it moves
//! arm/           all of that for the joints of an arm together, and effects of the arm
//! experiments/   single regressions of the papers, apart from the pipeline
//! ```
//!
//! Equation throughout: τ_m = J q̈ + τ + τ_F, joint quantities on the joint side
//! of the gear. A contact is the same without motor and inertia: F_T, which
//! depends on F_N as τ_F on the load ([`JointType::Contact`]). Pure: no file, clock, thread or randomness; the same recordings
//! give the same answer.

pub mod arm;
pub mod comparison;
pub mod data;
pub mod design;
pub mod diagnosis;
pub mod discovery;
pub mod effects;
pub mod experiments;
pub mod fit;
pub mod numerics;
pub mod preparation;
pub mod shape_search;
pub mod signals;
pub mod twin;
pub mod validation;

pub use comparison::{Comparison, Usage, compare};
pub use data::error::{ExpressionError, PrepareError};
pub use data::stated_filter::StatedFilter;
pub use data::{
    CustomEffect, Dataset, Inertia, JointType, ModelSpec, RecordedSession, Subject, Term,
};
pub use design::PreparedModel;
pub use diagnosis::{Diagnosis, NotTested, Suspect, Verdict, diagnose, diagnose_at_cutoffs};
pub use discovery::{Discovery, Formula, discover};
pub use effects::EffectDescription;
pub use ferntast_model::friction::Proposal;
pub use fit::addition::{Addition, add};
pub use preparation::prepare;

/// Every effect that a model can be given by id, and that [`diagnose()`] tries.
#[must_use]
pub fn catalogue() -> Vec<EffectDescription> {
    effects::all()
        .iter()
        .map(|effect| effect.description().clone())
        .collect()
}

#[cfg(test)]
mod tests;
