//! How an arm is the master.

use ferntast_model::{ParameterError, parameters};

use super::Axes;

parameters! {
    /// An arm as the master: section `[hand.leader]`. Its tip is the hand, whose workspace has its
    /// middle where the tip is at the arm's home.
    pub struct LeaderConfig {
        /// The arm: a file of `config/arms/`, a path, or a URDF alone.
        pub arm: String = "so101".to_owned(),
        /// What is behind its joints, as `--driver` has it.
        pub driver: String = "simulated".to_owned(),
        /// Which of the axes of its base is x, y and z of `leader_base`, with its sign.
        pub axes: [String; 3] = ["x", "y", "z"].map(String::from),
        /// Whether the tool turns with its tip. Left out, it does with six joints or more: with
        /// fewer the tip turns as it is moved.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub orientation: Option<bool> = None,
    }
    check LeaderConfig::axes_turn;
}

impl LeaderConfig {
    /// The axes, where they are those of a rotation.
    pub fn turned(&self) -> Option<Axes> {
        Axes::named(&self.axes)
    }

    fn axes_turn(&self) -> Result<(), ParameterError> {
        Axes::check(&self.axes)
    }
}
