//! Figs. 3 and 9 (right): how the joint moved in an experiment.

use ferntast_identification::data::Dataset;

use super::item::{Chart, Curve, Item, Section};

/// Points that are drawn, at most.
const DRAWN: usize = 1500;
/// Velocity is the difference of positions so far apart \[s\].
const APART: f64 = 0.04;
/// A sample belongs to a speed where it is as near \[-\].
const NEAR: f64 = 0.3;

/// Place, speed and torque over time, as recorded.
#[derive(Clone, Debug, Default)]
pub struct Trajectory {
    /// Since the start \[s\].
    time: Vec<f64>,
    /// q \[deg\].
    position: Vec<f64>,
    /// q̇ \[deg/s\].
    velocity: Vec<f64>,
    /// τ \[Nm\].
    torque: Vec<f64>,
}

impl Trajectory {
    /// Of all sessions of a recording that measures torque.
    pub fn of(dataset: &Dataset) -> Trajectory {
        let count: usize = dataset.sessions.iter().map(|own| own.position.len()).sum();
        let step = count.div_ceil(DRAWN).max(1);
        let mut found = Trajectory::default();
        for session in &dataset.sessions {
            let q = &session.position;
            let half = ((0.5 * APART / session.period).round() as usize).max(1);
            let inner = half..q.len().saturating_sub(half);
            for at in inner.step_by(step) {
                let way = q[at + half] - q[at - half];
                let speed = way / (2.0 * half as f64 * session.period);
                let torque = session.joint_torque.as_ref().map(|torque| torque[at]);
                found.time.push(session.start + at as f64 * session.period);
                found.position.push(q[at].to_degrees());
                found.velocity.push(speed.to_degrees());
                found.torque.push(torque.unwrap_or(f64::NAN));
            }
        }
        found
    }

    /// `values` over time.
    fn chart(&self, title: &str, y: &str, values: &[f64]) -> Chart {
        let points = self.time.iter().copied().zip(values.iter().copied());
        Chart {
            title: title.to_owned(),
            x: "time [s]".to_owned(),
            y: y.to_owned(),
            curves: vec![Curve::line("measured", points)],
        }
    }

    /// The right half of Fig. 9.
    pub fn position(&self, title: &str) -> Chart {
        self.chart(title, "position [deg]", &self.position)
    }

    fn speed(&self, title: &str) -> Chart {
        self.chart(title, "velocity [deg/s]", &self.velocity)
    }

    /// The middle one of the speeds near `wanted` \[deg/s\]; `None` where it was not driven.
    fn median_near(&self, wanted: f64) -> Option<f64> {
        let near = |speed: &f64| (speed / wanted - 1.0).abs() < NEAR;
        let mut speeds: Vec<f64> = self.velocity.iter().map(|speed| speed.abs()).collect();
        speeds.retain(near);
        speeds.sort_by(f64::total_cmp);
        speeds.get(speeds.len() / 2).copied()
    }
}

/// Fig. 3, of the trajectory `own` that was driven at `speeds` \[deg/s\].
pub fn identification_trajectory(own: &Trajectory, speeds: &[f64]) -> Section {
    let off = |speed: &f64| {
        own.median_near(*speed)
            .map(|found| (found / speed - 1.0).abs())
    };
    let worst: Option<f64> = speeds
        .iter()
        .map(off)
        .try_fold(0.0, |worst: f64, own| own.map(|own| worst.max(own)));
    Section {
        name: "Fig. 3".to_owned(),
        title: "The standard identification trajectory".to_owned(),
        text: "Joint 2 in space (2005-03-24). The paper: \"the spring of the experimental contour is pulled at constant \
               velocities of 1°/s, 5°/s, 10°/s, 20°/s and 40°/s\"; it draws position, velocity and joint torque."
            .to_owned(),
        charts: vec![
            own.position("Position"),
            own.speed("Velocity"),
            own.chart("Joint torque", "joint torque [Nm]", &own.torque),
        ],
        items: vec![Item::inside(
            "fig3/farthest_from_a_speed",
            "",
            worst,
            None,
            [0.0, 0.05],
            "each of the five velocities is driven: its median over what was asked for, less 1",
        )],
    }
}

/// What Fig. 9 has at its right, of the trajectory `own`.
pub fn sinusoid(own: &Trajectory) -> Vec<Chart> {
    vec![
        own.position("The sinusoid: position"),
        own.speed("The sinusoid: velocity"),
    ]
}
