//! One joint of an arm, as the pipeline takes it.

use crate::data::{Dataset, ModelSpec};
use crate::design::{Design, PreparedModel};
use crate::validation::left_out::LeftOut;

/// One joint of an arm, as the pipeline takes it.
pub struct ArmJoint {
    /// Its name.
    pub name: String,
    /// Its recordings, with the torque of its links as the load and the other joints'
    /// motions as extra signals.
    pub dataset: Dataset,
    /// Its model.
    pub spec: ModelSpec,
    /// Both put together.
    pub prepared: PreparedModel,
    /// The regression.
    pub design: Design,
    /// RMS on rows left out, with the coefficients of the arm as they are \[Nm\].
    pub held_out: f64,
}

impl ArmJoint {
    /// Of a model that is bound to its recordings.
    pub(super) fn new(
        name: String,
        dataset: Dataset,
        spec: ModelSpec,
        prepared: PreparedModel,
    ) -> Self {
        let design = Design::new(&prepared);
        Self {
            held_out: LeftOut::new(&prepared, &design).rms(),
            name,
            dataset,
            spec,
            prepared,
            design,
        }
    }

    /// The same on the rows of `other`, which is bound to the same recordings.
    pub(super) fn on_rows_of(self, other: &Self) -> Self {
        let prepared = self.prepared.on_rows_of(&other.prepared);
        Self::new(self.name, self.dataset, self.spec, prepared)
    }
}
