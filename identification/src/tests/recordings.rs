//! Small recordings for tests: a joint whose inverse dynamics are written down
//! by hand, moved along sines of several speeds.

use crate::data::{Dataset, Inertia, JointType, ModelSpec, RecordedSession, Term};

/// JointState that a test's own torque is made of.
pub struct JointState {
    pub q: f64,
    pub qd: f64,
    pub qdd: f64,
    pub tau: f64,
    pub days: f64,
    pub temperature: f64,
}

/// Numbers with mean 0 and deviation 1, nearly normal; the same state gives the
/// same numbers.
pub fn noise(mut state: u64) -> impl FnMut() -> f64 {
    move || {
        let mut sum = -6.0;
        for _ in 0..12 {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            sum += (state >> 11) as f64 / (1_u64 << 53) as f64;
        }
        sum
    }
}

/// J of every test recording \[kg m²\].
pub const INERTIA: f64 = 1.2;

/// Six sessions of 40 s; `torque` is τ_F.
pub fn recording(seed: u64, torque: impl Fn(&JointState) -> f64) -> Dataset {
    let mut noise = noise(seed.wrapping_mul(2).wrapping_add(1));
    let temperatures = [3.0, 21.0, -5.0, 14.0, 26.0, 9.0];
    let sessions = (0..6)
        .map(|k| {
            let days = 17.0 * f64::from(k);
            let temperature = temperatures[k as usize];
            let scatter = 1.0 + 0.01 * noise();
            let mut session = RecordedSession {
                name: format!("session {}", k + 1),
                start: days * 86_400.0,
                period: 0.01,
                joint_torque: Some(Vec::new()),
                temperature: Some(Vec::new()),
                ..RecordedSession::default()
            };
            for i in 0..4000 {
                let t = f64::from(i) * 0.01;
                let (mut q, mut qd, mut qdd) = (0.2, 0.0, 0.0);
                for (amplitude, rate) in
                    [(0.17, 0.5), (0.06, 1.7 + 0.05 * f64::from(k)), (0.02, 5.3)]
                {
                    let (sine, cosine) = (rate * t + 0.3 * f64::from(k)).sin_cos();
                    q += amplitude * sine;
                    qd += amplitude * rate * cosine;
                    qdd -= amplitude * rate * rate * sine;
                }
                // A spring that engages: load is not a function of position alone.
                let tau = 25.0 * f64::max(q - 0.1, 0.0) + 3.0 * (0.9 * t).sin();
                let here = JointState {
                    q,
                    qd,
                    qdd,
                    tau,
                    days,
                    temperature,
                };
                session.position.push(q + 4e-6 * noise());
                session
                    .motor_torque
                    .push(INERTIA * qdd + tau + scatter * torque(&here) + 0.2 * noise());
                session
                    .joint_torque
                    .get_or_insert_default()
                    .push(tau + 0.03 * noise());
                session
                    .temperature
                    .get_or_insert_default()
                    .push(temperature + 0.05 * noise());
            }
            session
        })
        .collect();
    Dataset {
        sessions,
        held_out: Vec::new(),
        joint: JointType::Revolute,
        filter: None,
    }
}

/// Coulomb and viscous friction.
pub fn plain(s: &JointState) -> f64 {
    5.0 * s.qd.signum() + 20.0 * s.qd
}

/// A model with these effects.
pub fn model(effects: &[&str]) -> ModelSpec {
    ModelSpec {
        inertia: Inertia::Given(INERTIA),
        gear_ratio: Some(100.0),
        effects: effects
            .iter()
            .map(|id| Term::Catalogue((*id).to_owned()))
            .collect(),
    }
}
