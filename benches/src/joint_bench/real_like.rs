//! Recordings as people bring them: ways in which recordings of real joints are less
//! than those of the bench, one at a time, drawn by a seed.
//!
//! Half of the recordings of a kind hide an effect of the catalogue, at full strength;
//! beside it there may be what the kind itself brings along (a load that is off, a
//! drive that ends), which is no less there than what is hidden.

use std::f64::consts::TAU;

use ferntast_emulation::random::Random;

use super::effect::cold_start;
use super::parameters::Transmission;
use super::{Bench, BenchConfig, BenchError, HiddenEffect, Motion, sensors::POSITION_QUANTUM};
use crate::bench::{Hideable, MILLISECONDS_A_LOG, Stream, named, random};

named! {
    /// How a recording differs from those of a bench.
    pub enum RealLike or UnknownRealLike {
        /// No torque sensor: the load is what a model says, off by 2 to 8 % and by 0.1 to
        /// 0.5 Nm.
        UncertainLoad = "uncertain_load",
        /// A joint at its work: three sessions of the same few moves between four places at
        /// one speed, with rests in between.
        LittleExcitation = "little_excitation",
        /// One session, so that no variation from day to day is seen.
        OneSession = "one_session",
        /// A drive that ends within what the motion asks for, or not; the log has what the
        /// motor gives, or what was asked for.
        LimitedDrive = "limited_drive",
        /// An encoder of 12 to 15 bits a turn of the joint, in place of 20.
        CoarseEncoder = "coarse_encoder",
        /// Logged at 100, 125, 200, 250, 500 or 1000 Hz, in three sessions.
        OtherRate = "other_rate",
        /// Friction that no catalogue has.
        UnnamedFriction = "unnamed_friction",
        /// Position and torque of the motor alone, in three sessions at 200 to 1000 Hz. A third has
        /// a stiff gear, a third a soft one, with the load swinging at 4 to 12 Hz, a third a gap
        /// of 10 to 40 mrad.
        MotorOnly = "motor_only",
        /// One session of minutes, from a cold start or a warm one, whose temperature nobody
        /// measures: half of the joints warm up.
        ColdStart = "cold_start",
    }
}

/// What a bench can have that a real one would.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Surroundings {
    /// Between two log entries \[ms\].
    pub(super) log_milliseconds: usize,
    /// Where a model gives the load: what it makes of the true one, a gain and an offset \[Nm\].
    pub(super) modelled_load: Option<[f64; 2]>,
    /// How often a session runs its motion.
    pub(super) rounds: usize,
    /// Whether sessions are a routine in place of a motion of their own.
    pub(super) is_routine: bool,
    /// Where the drive ends.
    pub(super) drive: Option<Drive>,
    /// What a position reading is a multiple of \[rad\].
    pub(super) position_quantum: f64,
}

/// A drive that ends somewhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Drive {
    /// \[Nm\]
    pub(super) limit: f64,
    /// Whether the log has what was asked for in place of what the motor gave.
    pub(super) logs_command: bool,
}

impl Default for Surroundings {
    /// The paper's.
    fn default() -> Self {
        Self {
            log_milliseconds: MILLISECONDS_A_LOG,
            modelled_load: None,
            rounds: 1,
            is_routine: false,
            drive: None,
            position_quantum: POSITION_QUANTUM,
        }
    }
}

/// A bench whose recordings are like real ones, and the answer.
pub struct RealLikeBench {
    /// It.
    pub bench: Bench,
    /// The effect of the catalogue that is hidden.
    pub hidden: Option<HiddenEffect>,
    /// Ids of what is there besides: errors of the load or the drive that the kind brings.
    pub also_there: Vec<&'static str>,
    /// Friction that no catalogue has, in words.
    pub law: Option<String>,
}

impl RealLikeBench {
    /// Draws the joint, what is hidden, and how it is recorded.
    ///
    /// # Errors
    ///
    /// The joint runs away while a law is drawn.
    pub fn draw(kind: RealLike, seed: u64) -> Result<Self, BenchError> {
        let mut random = random(seed, Stream::RealLike, kind as usize);
        let mut config = BenchConfig {
            seed,
            sessions: match kind {
                RealLike::OneSession | RealLike::ColdStart => 1,
                RealLike::LittleExcitation | RealLike::OtherRate | RealLike::MotorOnly => 3,
                _ => 6,
            },
            ..BenchConfig::default()
        };
        if kind == RealLike::MotorOnly {
            // What springs pull would have to be measured.
            config.motions = vec![Motion::FastUnloaded];
        }
        if kind == RealLike::UnnamedFriction {
            let (bench, law) = Bench::with_law(&config)?;
            return Ok(Self {
                bench,
                hidden: None,
                also_there: Vec::new(),
                law: Some(law),
            });
        }
        let hidden = hidden(kind, &mut random);
        config.hidden = hidden.into_iter().collect();
        let mut bench = Bench::new(&config)?;
        let mut also_there = Vec::new();
        let here = &mut bench.surroundings;
        match kind {
            RealLike::UncertainLoad => {
                let gain = 1.0 + signed(0.02, 0.08, &mut random);
                here.modelled_load = Some([gain, signed(0.1, 0.5, &mut random)]);
                also_there = vec![
                    "torque_sensor_gain",
                    "torque_sensor_offset",
                    "torque_sensor_calibration",
                ];
            }
            RealLike::LittleExcitation => here.is_routine = true,
            RealLike::LimitedDrive if random.chance(0.5) => {
                let logs_command = random.chance(0.5);
                // What 40 °/s needs at the end of the standard motion's strokes.
                let peak = 30.0 + 0.4 * bench.joint.spring;
                here.drive = Some(Drive {
                    limit: peak * (0.7 + 0.3 * random.uniform()),
                    logs_command,
                });
                if logs_command {
                    also_there.push("current_saturation");
                }
            }
            RealLike::CoarseEncoder => {
                let bits = 12 + (4.0 * random.uniform()) as u32;
                here.position_quantum = TAU / f64::from(1_u32 << bits.min(15));
            }
            RealLike::OtherRate => {
                here.log_milliseconds = one_of(&[1, 2, 4, 5, 8, 10], &mut random)
            }
            RealLike::MotorOnly => {
                here.log_milliseconds = one_of(&[1, 2, 4, 5], &mut random);
                also_there = before_the_load(&mut bench, &mut random);
            }
            RealLike::ColdStart => {
                here.rounds = 5;
                if random.chance(0.5) {
                    bench.effects.push(cold_start::draw(&mut random));
                    also_there = vec!["warm_up_coulomb", "warm_up_viscous"];
                }
            }
            RealLike::OneSession | RealLike::LimitedDrive | RealLike::UnnamedFriction => {}
        }
        Ok(Self {
            bench,
            hidden,
            also_there,
            law: None,
        })
    }

    /// Ids of everything that is there beside what is believed.
    #[must_use]
    pub fn accepted(&self) -> Vec<&'static str> {
        let hidden = self.hidden.map_or(&[][..], Hideable::accepted);
        [hidden, &self.also_there[..]].concat()
    }
}

/// What a recording of this kind hides: half of them nothing, the others one error. Two at
/// once, as a sensor's whole calibration is, are what [`RealLike::UncertainLoad`] brings; a
/// ripple of the gain came later, and would make other recordings of the seeds that figures are
/// stated for.
fn hidden(kind: RealLike, random: &mut Random) -> Option<HiddenEffect> {
    let brings = |own: HiddenEffect| match kind {
        RealLike::UncertainLoad => {
            matches!(
                own,
                HiddenEffect::TorqueSensorGain | HiddenEffect::TorqueSensorOffset
            )
        }
        RealLike::LimitedDrive => own == HiddenEffect::CurrentSaturation,
        RealLike::MotorOnly => needs_a_torque_sensor(own),
        RealLike::ColdStart => matches!(
            own,
            HiddenEffect::TemperatureCoulomb
                | HiddenEffect::TemperatureViscous
                | HiddenEffect::WearDrift
        ),
        _ => false,
    };
    let all = HiddenEffect::ALL.iter().copied();
    let catalogue: Vec<HiddenEffect> = all
        .filter(|own| own.in_catalogue() && !brings(*own))
        .filter(|own| {
            use HiddenEffect::{ClockDrift, LoadRipple, TorqueSensorCalibration};
            !matches!(own, TorqueSensorCalibration | LoadRipple | ClockDrift)
        })
        .collect();
    let hides = random.chance(0.5);
    let drawn = one_of(&catalogue, random);
    hides.then_some(drawn)
}

/// What is not there or cannot be told without a torque sensor: a joint whose inertia is fitted
/// has no other one, and no measure of torque; a late channel may be that of the sensor.
fn needs_a_torque_sensor(own: HiddenEffect) -> bool {
    use HiddenEffect::{
        Backlash, ChannelDelay, Elasticity, Inertia, LoadCoulomb, LoadStribeck, MotorConstant,
        TorqueSensorGain, TorqueSensorOffset,
    };
    matches!(
        own,
        Backlash
            | ChannelDelay
            | Elasticity
            | Inertia
            | LoadCoulomb
            | LoadStribeck
            | MotorConstant
            | TorqueSensorGain
            | TorqueSensorOffset
    )
}

/// Gives the joint a load that nobody measures and draws what is between it and the motor: ids of
/// the effects that it may be called, of a stiff gear none. Behind the gap there is all friction,
/// too, as `backlash` has it.
fn before_the_load(bench: &mut Bench, random: &mut Random) -> Vec<&'static str> {
    let joint = &mut bench.joint;
    let mut within = |low: f64, high: f64| low + (high - low) * random.uniform();
    joint.link_inertia = joint.inertia * within(0.3, 1.5);
    let drawn = within(0.0, 3.0);
    if drawn < 1.0 {
        return Vec::new();
    }
    if drawn < 2.0 {
        let rate = TAU * within(4.0, 12.0);
        joint.transmission = Transmission::Elastic {
            stiffness: joint.link_inertia * rate * rate,
            cubic_stiffness: 0.0,
            damping: 2.0 * within(0.02, 0.1) * joint.link_inertia * rate,
            link_friction: within(0.0, 4.0),
            measures_motor: true,
        };
        return vec!["load_elasticity"];
    }
    joint.transmission = Transmission::Backlash {
        gap: within(0.01, 0.04),
    };
    vec!["backlash", "load_backlash"]
}

/// One of `all`, which are some.
fn one_of<T: Copy>(all: &[T], random: &mut Random) -> T {
    let number = (random.uniform() * all.len() as f64) as usize;
    all[number.min(all.len() - 1)]
}

/// Between `low` and `high`, with either sign.
fn signed(low: f64, high: f64, random: &mut Random) -> f64 {
    let size = low + (high - low) * random.uniform();
    if random.chance(0.5) { size } else { -size }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::joint_bench::BenchRecording;

    fn recorded(kind: RealLike, seed: u64) -> (RealLikeBench, BenchRecording) {
        let drawn = RealLikeBench::draw(kind, seed).unwrap();
        let recording = drawn.bench.record().unwrap();
        (drawn, recording)
    }

    #[test]
    fn the_same_seed_gives_the_same_recording_and_each_kind_hides_half_of_the_time() {
        let (first, recording) = recorded(RealLike::OneSession, 7);
        let (second, again) = recorded(RealLike::OneSession, 7);
        assert_eq!((first.hidden, &recording), (second.hidden, &again));
        assert_eq!(recording.sessions.len(), 1);
        let hides = |seed: &u64| {
            let drawn = RealLikeBench::draw(RealLike::CoarseEncoder, *seed).unwrap();
            drawn.hidden.is_some()
        };
        let share = (0..400).filter(hides).count();
        assert!((160..240).contains(&share), "{share} of 400");
    }

    #[test]
    fn a_modelled_load_is_off_as_it_says() {
        let (drawn, recording) = recorded(RealLike::UncertainLoad, 3);
        let [gain, offset] = drawn.bench.surroundings.modelled_load.unwrap();
        assert!((0.02..=0.08).contains(&(gain - 1.0).abs()) && (0.1..=0.5).contains(&offset.abs()));
        for session in &recording.sessions {
            let told = session.joint_torque.iter().zip(&session.truth.joint_torque);
            for (told, felt) in told {
                assert!((told - gain * felt - offset).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn encoders_rates_and_routines_are_as_drawn() {
        for seed in 0..6 {
            let (drawn, recording) = recorded(RealLike::CoarseEncoder, seed);
            let quantum = drawn.bench.surroundings.position_quantum;
            assert!((TAU / 32_768.0..=TAU / 4096.0).contains(&quantum));
            let steps = recording.sessions[0]
                .position
                .iter()
                .map(|own| own / quantum);
            assert!(
                steps
                    .into_iter()
                    .all(|own| (own - own.round()).abs() < 1e-6)
            );
        }
        let (drawn, recording) = recorded(RealLike::OtherRate, 2);
        let session = &recording.sessions[0];
        let period = drawn.bench.surroundings.log_milliseconds as f64 * 1e-3;
        assert!((session.period - period).abs() < 1e-12 && period <= 0.01);
        assert!((session.time[7] - 7.0 * period).abs() < 1e-9);
        // Rests and one speed: half of the time, and all of it below 20 degrees a second.
        let (_, recording) = recorded(RealLike::LittleExcitation, 2);
        let velocity = &recording.sessions[0].truth.velocity;
        let still = velocity.iter().filter(|own| own.abs() < 0.01).count() as f64;
        let share = still / velocity.len() as f64;
        assert!((0.2..0.7).contains(&share), "{share}");
        let fastest = velocity.iter().fold(0.0, |most, own| own.abs().max(most));
        assert!((0.05..0.45).contains(&fastest), "{fastest}");
    }

    #[test]
    fn before_a_load_that_nobody_measures_is_what_was_drawn() {
        let mut counts = [0; 3];
        for seed in 0..90 {
            let drawn = RealLikeBench::draw(RealLike::MotorOnly, seed).unwrap();
            let (kind, there) = match drawn.bench.joint.transmission {
                Transmission::Rigid => (0, &[][..]),
                Transmission::Elastic { measures_motor, .. } => {
                    assert!(measures_motor);
                    (1, &["load_elasticity"][..])
                }
                Transmission::Backlash { .. } => (2, &["backlash", "load_backlash"][..]),
            };
            assert_eq!(drawn.also_there, there);
            assert!(drawn.bench.joint.link_inertia >= 0.3 * drawn.bench.joint.inertia);
            counts[kind] += 1;
        }
        assert!(
            counts.iter().all(|own| (18..=42).contains(own)),
            "{counts:?}"
        );
        let (_, recording) = recorded(RealLike::MotorOnly, 1);
        let session = &recording.sessions[0];
        assert!(session.motion == Some(Motion::FastUnloaded) && session.period <= 0.005);
    }

    /// The motor never gives more; the log has what it gives, or what was asked for.
    #[test]
    fn a_drive_ends_where_it_says() {
        let mut seen = [false; 3];
        for seed in 0..12 {
            let (drawn, recording) = recorded(RealLike::LimitedDrive, seed);
            let torques = recording
                .sessions
                .iter()
                .flat_map(|own| &own.truth.motor_torque);
            let largest = torques.fold(0.0, |most: f64, own| own.abs().max(most));
            match drawn.bench.surroundings.drive {
                None => seen[0] = true,
                Some(drive) if drive.logs_command => {
                    seen[1] = true;
                    assert_eq!(drawn.also_there, ["current_saturation"]);
                }
                Some(drive) => {
                    seen[2] = true;
                    // A hidden motor constant reads more than there is.
                    if drawn.hidden.is_none() {
                        assert!(largest <= drive.limit + 1e-9, "{largest} {drive:?}");
                    }
                }
            }
        }
        assert_eq!(seen, [true; 3]);
    }
}
