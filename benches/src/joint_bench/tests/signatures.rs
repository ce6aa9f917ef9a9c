//! Each effect changes the residual of the believed model as the catalogue says.

use super::*;

/// One log entry, as the believed model sees it, without noise.
pub(in crate::joint_bench) struct Row {
    session: usize,
    index: usize,
    pub(in crate::joint_bench) time: f64,
    pub(in crate::joint_bench) date: f64,
    pub(in crate::joint_bench) temperature: f64,
    pub(in crate::joint_bench) q: f64,
    pub(in crate::joint_bench) v: f64,
    pub(in crate::joint_bench) a: f64,
    pub(in crate::joint_bench) tau: f64,
    pub(in crate::joint_bench) tau_rate: f64,
    pub(in crate::joint_bench) tau_m: f64,
    /// True velocity and acceleration.
    pub(in crate::joint_bench) v_true: f64,
    pub(in crate::joint_bench) a_true: f64,
    /// Way since the last reversal \[rad\].
    pub(in crate::joint_bench) travel: f64,
    /// Own part of the effect \[Nm\].
    pub(in crate::joint_bench) r: f64,
}

impl Row {
    pub(in crate::joint_bench) fn s(&self) -> f64 {
        self.v.signum()
    }
}

pub(in crate::joint_bench) struct Case {
    recording: BenchRecording,
    rows: Vec<Row>,
}

fn case(effect: HiddenEffect, seed: u64, motion: Motion) -> Case {
    let recording = record(BenchConfig {
        seed,
        hidden: vec![effect],
        noise: 0.0,
        scatter: 0.0,
        motions: vec![motion],
        ..BenchConfig::default()
    });
    let mut rows = Vec::new();
    for (number, session) in recording.sessions.iter().enumerate() {
        let own = recording.own_part(session);
        let rate = |values: &[f64], index: usize| {
            (values[index + 1] - values[index - 1]) / (2.0 * LOG_PERIOD)
        };
        let mut turned = 0.0;
        for index in 1..session.time.len() - 1 {
            if own.velocity[index] * own.velocity[index - 1] <= 0.0 {
                turned = own.position[index];
            }
            if !own.used[index] {
                continue;
            }
            rows.push(Row {
                session: number,
                index,
                time: session.time[index],
                date: (session.start + session.time[index]) / 86_400.0,
                temperature: session.temperature[index],
                q: own.position[index],
                v: own.velocity[index],
                a: own.acceleration[index],
                tau: session.joint_torque[index],
                tau_rate: rate(&session.joint_torque, index),
                tau_m: session.motor_torque[index],
                v_true: session.truth.velocity[index],
                a_true: rate(&session.truth.velocity, index),
                travel: (own.position[index] - turned).abs(),
                r: own.torque[index],
            });
        }
    }
    Case { recording, rows }
}

impl Case {
    /// Parameter of the hidden effect, else of the joint.
    pub(in crate::joint_bench) fn get(&self, name: &str) -> f64 {
        let named = || self.recording.truth.iter().filter(|p| p.name == name);
        let own = named().find(|p| p.effect.is_some());
        own.or_else(|| named().next()).unwrap().value
    }

    /// Equation (4)'s friction while sliding.
    fn equation_4(&self, v: f64, tau: f64) -> f64 {
        (self.get("b0") + self.get("b0T") * tau.abs()) * v.signum()
            + v * (self.get("b1") + v.abs() * self.get("b2") + v * v * self.get("b3"))
    }

    /// Checks that `expected` explains the own part but for a share of it and
    /// what reversals leave, and that it is not all too small.
    #[track_caller]
    pub(in crate::joint_bench) fn is(&self, share: f64, expected: impl Fn(&Row) -> f64) {
        let mean = |f: &dyn Fn(&Row) -> f64| {
            self.rows.iter().map(|row| f(row).powi(2)).sum::<f64>() / self.rows.len() as f64
        };
        let all = mean(&|row| row.r).sqrt();
        let left = mean(&|row| row.r - expected(row)).sqrt();
        let allowed = (share * all).hypot(0.22);
        println!("own part {all:.3} Nm, unexplained {left:.3}, allowed {allowed:.3}");
        assert!(all > 0.4, "own part {all}");
        assert!(left < allowed, "own part {all}, unexplained {left}");
    }
}

/// A recording that hides `effect` in the standard motion.
pub(in crate::joint_bench) fn standard(effect: HiddenEffect) -> Case {
    case(effect, 3, Motion::Standard)
}

#[test]
fn terms_of_equation_4() {
    let c = standard(HiddenEffect::Coulomb);
    c.is(0.05, |row| c.get("b0") * row.s());
    let c = standard(HiddenEffect::LoadCoulomb);
    c.is(0.05, |row| c.get("b0T") * row.tau.abs() * row.s());
    let c = standard(HiddenEffect::Viscous);
    c.is(0.05, |row| c.get("b1") * row.v);
    let c = standard(HiddenEffect::QuadraticViscous);
    c.is(0.05, |row| c.get("b2") * row.v * row.v.abs());
    let c = standard(HiddenEffect::CubicViscous);
    c.is(0.05, |row| c.get("b3") * row.v.powi(3));
    let c = standard(HiddenEffect::NonlinearViscous);
    c.is(0.05, |row| {
        c.get("b2") * row.v * row.v.abs() + c.get("b3") * row.v.powi(3)
    });
}

#[test]
fn friction_that_goes_with_speed_direction_temperature_and_date() {
    let c = standard(HiddenEffect::Stribeck);
    c.is(0.2, |row| {
        c.get("bs") * (-(row.v / c.get("vs")).powi(2)).exp() * row.s()
    });
    let c = standard(HiddenEffect::AsymmetricCoulomb);
    c.is(0.1, |_| c.get("ba"));
    let c = standard(HiddenEffect::TemperatureCoulomb);
    c.is(0.1, |row| {
        c.get("kt") * (row.temperature - c.get("t0")) * row.s()
    });
    let c = standard(HiddenEffect::TemperatureViscous);
    c.is(0.1, |row| {
        c.get("kv") * (row.temperature - c.get("t0")) * row.v
    });
    let c = standard(HiddenEffect::WearDrift);
    c.is(0.1, |row| c.get("kw") * row.date * row.s());
}

#[test]
fn torques_over_position() {
    // Fast, the ripple is beyond what 12 ms show.
    let mut c = standard(HiddenEffect::Ripple);
    c.rows.retain(|row| row.v.abs() < 0.02);
    c.is(0.2, |row| {
        c.get("amplitude") * (c.get("rate") * row.q + c.get("phase")).sin()
    });
    let mut c = standard(HiddenEffect::LoadRipple);
    c.rows.retain(|row| row.v.abs() < 0.02);
    c.is(0.2, |row| {
        c.get("gain") * row.tau * (c.get("rate") * row.q + c.get("phase")).sin()
    });
    let c = standard(HiddenEffect::LocalFriction);
    c.is(0.2, |row| {
        let off = (row.q - c.get("centre")) / c.get("width");
        c.get("level") * (-off * off).exp() * row.s()
    });
    let c = standard(HiddenEffect::Gravity);
    c.is(0.1, |row| c.get("g") * (row.q + c.get("phase")).sin());
    let c = standard(HiddenEffect::CableSpring);
    c.is(0.1, |row| c.get("kc") * (row.q - c.get("q0")));
    let c = case(HiddenEffect::Inertia, 3, Motion::Accelerations);
    c.is(0.1, |row| c.get("dj") * row.a);
}

/// Dahl from one direction to the other: z = 1 − 2 exp(−x/δ) over the way x.
#[test]
fn presliding_is_a_loop_over_travel() {
    let mut c = case(HiddenEffect::PreslidingHysteresis, 3, Motion::Standard);
    // Reversals within the bristles' travel begin elsewhere on the loop.
    c.rows.retain(|row| (14.0..40.0).contains(&row.time));
    let level = |row: &Row| c.get("b0") + c.get("b0T") * row.tau.abs();
    c.is(0.3, |row| {
        -2.0 * level(row) * (-row.travel / c.get("bristle")).exp() * row.s()
    });
}

#[test]
fn backlash_is_a_jump_after_the_reversal() {
    let c = case(HiddenEffect::Backlash, 3, Motion::LoadSteps);
    let gap = c.get("gap");
    let mean = |from: f64, to: f64| {
        let near: Vec<f64> = c
            .rows
            .iter()
            .filter(|row| (from..to).contains(&row.travel) && row.v.abs() < 0.2)
            .map(|row| row.r.abs())
            .collect();
        assert!(near.len() > 30);
        near.iter().sum::<f64>() / near.len() as f64
    };
    let (inside, outside) = (mean(0.3 * gap, 0.7 * gap), mean(2.0 * gap, 9.0));
    assert!(inside > 8.0 && outside < 0.6, "{inside} {outside}");
}

/// The measured velocity lacks the twist's, τ̇/(K + 3 K₃ δ²), and so does what
/// friction and inertia make of it.
#[test]
fn elasticity_goes_with_the_rate_of_the_load() {
    let mut c = standard(HiddenEffect::Elasticity);
    c.rows.retain(|row| row.v.abs() > 0.05 && row.a.abs() < 0.5);
    let (k, k3) = (c.get("stiffness"), c.get("cubic_stiffness"));
    c.is(0.3, |row| {
        let mut twist = row.tau / k;
        for _ in 0..20 {
            twist -= (k * twist + k3 * twist.powi(3) - row.tau) / (k + 3.0 * k3 * twist * twist);
        }
        let rate = row.tau_rate / (k + 3.0 * k3 * twist * twist);
        c.equation_4(row.v + rate, row.tau) - c.equation_4(row.v, row.tau)
    });
}

#[test]
fn gains_and_offsets_of_sensors() {
    let c = standard(HiddenEffect::MotorConstant);
    let share = c.get("gain") / (1.0 + c.get("gain"));
    c.is(0.1, |row| share * row.tau_m);
    // The believed load-dependent friction takes the wrong τ as well.
    let c = standard(HiddenEffect::TorqueSensorGain);
    let share = c.get("gain") / (1.0 + c.get("gain"));
    c.is(0.1, |row| {
        -share * (row.tau + c.get("b0T") * row.tau.abs() * row.s())
    });
    let c = standard(HiddenEffect::TorqueSensorOffset);
    c.is(0.25, |_| -c.get("offset"));
}

/// `values` at `delay` \[s\] after entry `index`.
fn later(values: &[f64], index: usize, delay: f64) -> f64 {
    let at = index as f64 + delay / LOG_PERIOD;
    let whole = (at as usize).min(values.len() - 2);
    let (before, after) = (values[whole], values[whole + 1]);
    before + (at - whole as f64).min(1.0) * (after - before)
}

#[test]
fn a_late_channel_goes_with_its_rate() {
    let mut seen = [false; 3];
    for seed in 0..24 {
        let config = BenchConfig {
            seed,
            hidden: vec![HiddenEffect::ChannelDelay],
            ..BenchConfig::default()
        };
        let parameters = Bench::new(&config).unwrap().parameters();
        let name = parameters.last().unwrap().name;
        let names = ["motor_torque_delay", "joint_torque_delay", "position_delay"];
        let channel = names.iter().position(|&other| other == name).unwrap();
        if std::mem::replace(&mut seen[channel], true) {
            continue;
        }
        let mut c = case(HiddenEffect::ChannelDelay, seed, Motion::Standard);
        let delay = c.get(name);
        println!("{name} {delay:.3} s");
        // Away from reversals, where friction jumps.
        c.rows.retain(|row| row.v.abs() > 0.1);
        match channel {
            // What a channel says a delay later is what was true now.
            0 => c.is(0.3, |row| {
                let says = &c.recording.sessions[row.session].motor_torque;
                row.tau_m - later(says, row.index, delay)
            }),
            1 => c.is(0.3, |row| {
                let says = &c.recording.sessions[row.session].joint_torque;
                later(says, row.index, delay) - row.tau
            }),
            _ => c.is(0.4, |row| {
                let friction = c.equation_4(row.v_true, row.tau) - c.equation_4(row.v, row.tau);
                friction + c.recording.believed.inertia * (row.a_true - row.a)
            }),
        }
    }
    assert_eq!(seen, [true; 3]);
}

#[test]
fn a_channel_of_another_clock_is_the_later_the_longer_it_runs() {
    let mut seen = [false; 3];
    for seed in 0..24 {
        let config = BenchConfig {
            seed,
            hidden: vec![HiddenEffect::ClockDrift],
            ..BenchConfig::default()
        };
        let parameters = Bench::new(&config).unwrap().parameters();
        let name = parameters.last().unwrap().name;
        let names = ["motor_torque_drift", "joint_torque_drift", "position_drift"];
        let channel = names.iter().position(|&other| other == name).unwrap();
        if std::mem::replace(&mut seen[channel], true) {
            continue;
        }
        let mut c = case(HiddenEffect::ClockDrift, seed, Motion::Standard);
        let drift = c.get(name);
        println!("{name} {drift:.5} s/s");
        // Away from reversals, where friction jumps, and from the end, where the log does not
        // say yet what is true.
        c.rows.retain(|row| row.v.abs() > 0.1 && row.time < 45.0);
        match channel {
            // What a channel says later is what was true now.
            0 => c.is(0.3, |row| {
                let says = &c.recording.sessions[row.session].motor_torque;
                row.tau_m - later(says, row.index, drift * row.time)
            }),
            1 => c.is(0.3, |row| {
                let says = &c.recording.sessions[row.session].joint_torque;
                later(says, row.index, drift * row.time) - row.tau
            }),
            _ => c.is(0.4, |row| {
                let friction = c.equation_4(row.v_true, row.tau) - c.equation_4(row.v, row.tau);
                friction + c.recording.believed.inertia * (row.a_true - row.a)
            }),
        }
    }
    assert_eq!(seen, [true; 3]);
}

#[test]
fn saturation_shows_only_at_the_limit() {
    let mut seen = [false; 2];
    for seed in 0..8 {
        let c = case(HiddenEffect::CurrentSaturation, seed, Motion::Standard);
        let limit = c.get("limit");
        let in_drive = c.get("in_drive") > 0.5;
        seen[usize::from(in_drive)] = true;
        let (mut below, mut count, mut at) = (0.0, 0.0, 0.0f64);
        for row in &c.rows {
            // Clear of the limit by more than the filter's reach.
            if row.tau_m.abs() < 0.6 * limit {
                below += row.r * row.r;
                count += 1.0;
            } else if in_drive {
                at = at.max(row.r * row.tau_m.signum());
            } else {
                assert!(row.tau_m.abs() <= limit);
                at = at.max(-row.r * row.tau_m.signum());
            }
        }
        let below = f64::sqrt(below / count);
        assert!(below < 0.6 && at > 3.0, "seed {seed}: {below} {at}");
    }
    assert_eq!(seen, [true; 2]);
}

#[test]
fn effects_outside_the_catalogue() {
    let c = standard(HiddenEffect::UnknownTemperaturePosition);
    c.is(0.1, |row| {
        c.get("coupling") * (row.temperature - c.get("t0")) * (row.q - c.get("centre"))
    });
    let c = standard(HiddenEffect::UnknownTorqueRate);
    c.is(0.4, |row| {
        c.get("level") * (row.tau_rate / c.get("rate")).tanh() * row.s()
    });
    let c = standard(HiddenEffect::UnknownAcceleration);
    c.is(0.3, |row| {
        c.get("level") * (row.a.abs() / c.get("rate")).tanh() * row.s()
    });
    let c = standard(HiddenEffect::UnknownVelocityLoad);
    c.is(0.1, |row| c.get("coefficient") * row.tau * row.tau * row.v);
    let c = standard(HiddenEffect::UnknownPositionStep);
    c.is(0.2, |row| {
        c.get("torque") * ((row.q - c.get("centre")) / c.get("width")).tanh()
    });
    let c = standard(HiddenEffect::UnknownOscillation);
    c.is(0.1, |row| {
        let angle = std::f64::consts::TAU * row.time / c.get("period") + c.get("phase");
        c.get("torque") * angle.sin()
    });
}

/// Friction falls by c for each joule of its own work that has not leaked away.
#[test]
fn work_heats_the_lubricant() {
    let c = standard(HiddenEffect::UnknownWorkHeating);
    let (coefficient, leak) = (c.get("coefficient"), c.get("leak"));
    let (mut all, mut left) = (0.0, 0.0);
    for session in &c.recording.sessions {
        let own = c.recording.own_part(session);
        let truth = &session.truth;
        let mut work = 0.0;
        for (index, &used) in own.used.iter().enumerate() {
            let power = (truth.friction[index] * truth.velocity[index]).abs();
            work += (power - work / leak) * LOG_PERIOD;
            if used {
                let expected = -coefficient * work * own.velocity[index].signum();
                all += own.torque[index].powi(2);
                left += (own.torque[index] - expected).powi(2);
            }
        }
    }
    assert!(all > 100.0 && left < 0.05 * all, "{all} {left}");
}
