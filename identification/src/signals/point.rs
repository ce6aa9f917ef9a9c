//! The state of the joint at one sample, which effects are functions of.

use ferntast_model::friction::{FrictionState, sign};

/// State of the joint at one sample. For a prismatic joint read m for rad and N
/// for Nm. For a contact, too: then q is the place along the contour, τ_m and
/// τ_F are F_T, and the load is F_N.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point {
    /// Time \[s\] since the sample before.
    pub period: f64,
    /// q \[rad\].
    pub position: f64,
    /// q̇ \[rad/s\].
    pub velocity: f64,
    /// q̈ \[rad/s²\].
    pub acceleration: f64,
    /// τ_m as recorded \[Nm\].
    pub motor_torque: f64,
    /// Load τ \[Nm\]: the joint torque sensor, or without one the modelled load;
    /// of a contact F_N \[N\].
    pub load: f64,
    /// τ̇ \[Nm/s\].
    pub load_rate: f64,
    /// τ̈ \[Nm/s²\].
    pub load_jerk: f64,
    /// T − T₀ \[K\], T₀ the mean over the recordings; 0 without a sensor.
    pub temperature: f64,
    /// Time \[s\] since the recording's start.
    pub time: f64,
    /// Time \[days\] since the first session's start.
    pub days: f64,
    /// τ_m that the model predicts \[Nm\].
    pub motor_predicted: f64,
    /// τ_F that the model predicts \[Nm\].
    pub friction_predicted: f64,
    /// ∂τ_F/∂q̇ that the model predicts \[Nm s/rad\].
    pub friction_slope: f64,
    /// Size of τ_F that the model predicts just above rest \[Nm\]: what friction
    /// holds by itself.
    pub friction_level: f64,
    /// ∂τ_F/∂|τ| that the model predicts for q̇ > 0 \[-\]: b_0T.
    pub load_slope: f64,
    /// J of the model, given or fitted \[kg m²\].
    pub inertia: f64,
    /// Inertia of an arm's links that the joint turns, over its mean \[-\]; 1 of a joint alone.
    pub relative_links_inertia: f64,
}

impl Point {
    /// sign(q̇), zero at rest.
    #[must_use]
    pub fn sign(&self) -> f64 {
        sign(self.velocity)
    }

    /// Friction that the model predicts without the load that it models, weight and springs,
    /// whose effects are among those that it predicts \[Nm\].
    #[must_use]
    pub fn friction_beside_load(&self) -> f64 {
        self.friction_predicted - self.weight_and_springs()
    }

    /// Power that the motor gives and the load does not take: of friction, and of what gives back what
    /// it takes \[W\].
    #[must_use]
    pub fn friction_power(&self) -> f64 {
        (self.motor_torque - self.load) * self.velocity
    }

    /// The modelled load without what drives its inertia \[Nm\].
    #[must_use]
    pub fn weight_and_springs(&self) -> f64 {
        self.load - self.inertia * self.acceleration
    }

    /// What static laws of friction are functions of.
    #[must_use]
    pub fn friction_state(&self) -> FrictionState {
        FrictionState {
            position: self.position,
            velocity: self.velocity,
            load: self.load,
            temperature: self.temperature,
            days: self.days,
        }
    }

    /// Travel since the sample before \[rad\], which q̇ alone would tell half a
    /// sample late.
    #[must_use]
    pub fn travel(&self) -> f64 {
        (self.velocity - 0.5 * self.acceleration * self.period) * self.period
    }
}
