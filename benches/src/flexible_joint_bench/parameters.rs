//! Truth of the flexible joint, its gear and its brake.

/// The joint on its bench, joint side throughout. The second paper's fragment
/// gives no numbers: these are assumed, of the size of a space manipulator's
/// joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlexibleJointParameters {
    /// J_m, motor and gear \[kg m²\].
    pub motor_inertia: f64,
    /// J_l, what the joint turns \[kg m²\].
    pub load_inertia: f64,
    /// k_1 \[Nm/rad\].
    pub k1: f64,
    /// k_2 \[Nm/rad³\].
    pub k2: f64,
    /// b_in: viscous, input side \[Nm s/rad\].
    pub b_in: f64,
    /// b_inD: dry, input side \[Nm\].
    pub b_in_dry: f64,
    /// b_out: viscous, output side \[Nm s/rad\].
    pub b_out: f64,
    /// b_outC: Coulomb, output side \[Nm\].
    pub b_out_coulomb: f64,
    /// Share by which the gear's stiffness varies over one turn of the joint \[1\].
    pub gear_weakness: f64,
    /// Cycles of that variation in one turn \[1\].
    pub gear_cycles: f64,
    /// Standard deviation of the brake's torque about the commanded one, as a
    /// share of it \[1\].
    pub brake_fluctuation: f64,
    /// Time in which the fluctuation forgets itself \[s\].
    pub brake_correlation: f64,
}

impl Default for FlexibleJointParameters {
    fn default() -> Self {
        Self {
            motor_inertia: 1.4,
            load_inertia: 5.0,
            k1: 12_000.0,
            k2: 1.0e8,
            b_in: 28.0,
            b_in_dry: 6.0,
            b_out: 9.0,
            b_out_coulomb: 3.5,
            gear_weakness: 0.04,
            gear_cycles: 8.0,
            brake_fluctuation: 0.03,
            brake_correlation: 0.4,
        }
    }
}

impl FlexibleJointParameters {
    /// τ_s of the gear for the twist Δ = θ − q \[rad\] at q \[rad\]: \[Nm\].
    pub(super) fn spring(&self, twist: f64, position: f64) -> f64 {
        let weak = 1.0 - self.gear_weakness * (self.gear_cycles * position).cos();
        weak * (self.k1 + self.k2 * twist * twist) * twist
    }
}
