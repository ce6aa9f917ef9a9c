//! Single regressions of the papers: damping by speed, stiffness, contact friction, the
//! flexible joint. They use numerics and signals, and nothing else of the pipeline.

pub mod contact_friction;
pub mod damping;
pub mod flexible_joint;
pub mod stiffness;
