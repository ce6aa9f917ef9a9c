//! The scripted operator: a hand with an impedance whose target follows a script.

use super::{
    HandImpedance, HandState, ImpedanceParameters, Tremor, TremorParameters, Turn, TurnParameters,
};
use ferntast_model::{Bounded, ParameterError, Section, check, parameters};
use serde::{Deserialize, Serialize};

/// A place or a way in the leader's base frame \[m\]; in a file x and y, or x, y and z.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<f64>", into = "Vec<f64>")]
pub struct Point(pub [f64; 3]);

impl From<[f64; 2]> for Point {
    fn from([x, y]: [f64; 2]) -> Point {
        Point([x, y, 0.0])
    }
}

impl TryFrom<Vec<f64>> for Point {
    type Error = String;

    fn try_from(values: Vec<f64>) -> Result<Point, String> {
        match values[..] {
            [x, y] => Ok(Point([x, y, 0.0])),
            [x, y, z] => Ok(Point([x, y, z])),
            _ => Err(format!(
                "{} numbers where a point has x and y, or x, y and z",
                values.len()
            )),
        }
    }
}

impl From<Point> for Vec<f64> {
    /// In the plane x and y, as files have it.
    fn from(Point([x, y, z]): Point) -> Vec<f64> {
        match z == 0.0 {
            true => vec![x, y],
            false => vec![x, y, z],
        }
    }
}

impl Bounded for Point {
    fn check_bounds(
        &self,
        key: &str,
        bounds: &std::ops::RangeInclusive<f64>,
        unit: &'static str,
    ) -> Result<(), ParameterError> {
        self.0.check_bounds(key, bounds, unit)
    }
}

/// How the target moves in one phase. It starts where the phase before ended.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Motion {
    /// As people reach: x_0 + (x_1 − x_0)(10 s³ − 15 s⁴ + 6 s⁵), s = t/T (Flash
    /// and Hogan 1985, "The coordination of arm movements").
    Reach {
        /// x_1, leader base frame \[m\].
        to: Point,
    },
    /// At constant speed: sliding along an edge.
    Slide {
        /// \[m\]
        to: Point,
    },
    /// To and fro about where the phase began: amplitude · sin(2π f t). Whole
    /// periods end where they began.
    Sine {
        /// \[m\]
        amplitude: Point,
        /// f \[Hz\].
        frequency: f64,
    },
    /// The target stays.
    // Not a unit variant: those let unknown keys pass.
    Hold {},
}

/// One phase of a script.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Phase {
    /// What it is, for people: reach, press, slide, retreat …
    pub label: String,
    /// T \[s\].
    pub duration: f64,
    /// How the target moves.
    #[serde(flatten)]
    pub motion: Motion,
}

parameters! {
    /// Where the target goes.
    #[derive(Default)]
    pub struct Script {
        /// Where it starts, leader base frame \[m\].
        #[serde(default)]
        pub start: Point [-1.0..=1.0, "m"],
        /// Whether it goes on with the first phase after the last.
        #[serde(default)]
        pub repeat: bool,
        /// The phases, in order.
        pub phase: Vec<Phase> [section],
    }
}

impl Section for Phase {
    fn validate_at(&self, key: &str) -> Result<(), ParameterError> {
        let key = |name: &str| format!("{key}.{name}");
        check(&key("duration"), self.duration, 0.01, 3600.0, "s")?;
        let (name, point) = match self.motion {
            Motion::Reach { to } | Motion::Slide { to } => ("to", to),
            Motion::Sine {
                amplitude,
                frequency,
            } => {
                check(&key("frequency"), frequency, 0.0, 50.0, "Hz")?;
                ("amplitude", amplitude)
            }
            Motion::Hold {} => return Ok(()),
        };
        point.check_bounds(&key(name), &(-1.0..=1.0), "m")
    }
}

parameters! {
    /// A scripted operator: the section `[hand]` of a scenario.
    #[derive(Default)]
    pub struct ScriptedHandConfig {
        /// Impedance of the hand.
        #[serde(default)]
        pub impedance: ImpedanceParameters [section],
        /// Trembling; none when left out.
        #[serde(default)]
        pub tremor: Option<TremorParameters> [section],
        /// Turning; a hand without an orientation when left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub turn: Option<TurnParameters> [section],
        /// Where it wants to be.
        pub script: Script [section],
    }
}

/// The scripted operator.
#[derive(Clone, Debug)]
pub struct ScriptedHand {
    script: Script,
    impedance: HandImpedance<3>,
    tremor: Option<Tremor>,
    turn: Option<Turn>,
    phase: usize,
    /// Time in this phase [s].
    time: f64,
    /// Where this phase started [m].
    from: [f64; 3],
}

impl ScriptedHand {
    /// At rest where the script starts.
    ///
    /// # Errors
    ///
    /// The first value of `config` that is out of bounds.
    pub fn new(config: &ScriptedHandConfig, seed: u64) -> Result<ScriptedHand, ParameterError> {
        config.validate()?;
        Ok(ScriptedHand {
            impedance: HandImpedance::new(config.impedance, config.script.start.0),
            tremor: config.tremor.map(|own| Tremor::new(own, seed)),
            turn: config.turn.map(Turn::new),
            from: config.script.start.0,
            script: config.script.clone(),
            phase: 0,
            time: 0.0,
        })
    }

    /// Label of the phase; `end` after the last.
    pub fn label(&self) -> &str {
        self.script
            .phase
            .get(self.phase)
            .map_or("end", |phase| phase.label.as_str())
    }

    /// Where the hand wants to be \[m\].
    pub fn target(&self) -> [f64; 3] {
        self.target_and_rate().0
    }

    /// Where the hand wants to be after `dt` \[s\], trembling \[m\], and how fast that moves
    /// \[m/s\]: for one that holds something with a mass of its own, in place of [`step`](Self::step).
    pub fn want(&mut self, dt: f64) -> ([f64; 3], [f64; 3]) {
        self.advance(dt);
        let (mut target, mut rate) = self.target_and_rate();
        if let Some(tremor) = &mut self.tremor {
            let (displacement, speed) = tremor.step(dt);
            for axis in 0..2 {
                target[axis] += displacement[axis];
                rate[axis] += speed[axis];
            }
        }
        (target, rate)
    }

    /// Moves on by `dt` \[s\] under `force` on the hand \[N\].
    pub fn step(&mut self, dt: f64, force: [f64; 3]) -> HandState {
        let (target, rate) = self.want(dt);
        self.impedance.step(dt, target, rate, force);
        HandState {
            position: self.impedance.position(),
            velocity: self.impedance.velocity(),
            orientation: self.turn.as_mut().map(|own| own.step(dt)),
            finished: self.phase >= self.script.phase.len(),
        }
    }

    fn advance(&mut self, dt: f64) {
        self.time += dt;
        // Phases last 10 ms at least, so this ends.
        while let Some(phase) = self.script.phase.get(self.phase) {
            // Half a step of tolerance: sums of dt are not exact.
            if self.time < phase.duration - 1e-9 {
                return;
            }
            self.from = position(&phase.motion, self.from, phase.duration, phase.duration).0;
            self.time = (self.time - phase.duration).max(0.0);
            self.phase += 1;
            if self.script.repeat && self.phase == self.script.phase.len() {
                self.phase = 0;
            }
        }
    }

    fn target_and_rate(&self) -> ([f64; 3], [f64; 3]) {
        match self.script.phase.get(self.phase) {
            Some(phase) => position(&phase.motion, self.from, self.time, phase.duration),
            None => (self.from, [0.0; 3]),
        }
    }
}

/// Position [m] and velocity [m/s] at `time` of a motion from `from`.
fn position(motion: &Motion, from: [f64; 3], time: f64, duration: f64) -> ([f64; 3], [f64; 3]) {
    let s = (time / duration).clamp(0.0, 1.0);
    let (way, rate) = match *motion {
        Motion::Hold {} => return (from, [0.0; 3]),
        Motion::Sine {
            amplitude: Point(amplitude),
            frequency,
        } => {
            let omega = std::f64::consts::TAU * frequency;
            let (sine, cosine) = (omega * time).sin_cos();
            let moved = std::array::from_fn(|axis| from[axis] + amplitude[axis] * sine);
            return (moved, amplitude.map(|own| own * omega * cosine));
        }
        Motion::Reach { .. } => (
            s * s * s * (10.0 + s * (-15.0 + 6.0 * s)),
            30.0 * s * s * (1.0 - s) * (1.0 - s) / duration,
        ),
        Motion::Slide { .. } => (s, 1.0 / duration),
    };
    let (Motion::Reach { to: Point(to) } | Motion::Slide { to: Point(to) }) = *motion else {
        return (from, [0.0; 3]);
    };
    (
        std::array::from_fn(|axis| from[axis] + way * (to[axis] - from[axis])),
        std::array::from_fn(|axis| rate * (to[axis] - from[axis])),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn config(text: &str) -> ScriptedHandConfig {
        toml::from_str(text).unwrap()
    }

    const PRESS: &str = r#"
        [impedance]
        mass = 1.0
        damping = 25.0
        stiffness = 400.0

        [script]
        start = [0.0, 0.0]
        phase = [
            { label = "reach", kind = "reach", to = [0.03, 0.0], duration = 1.0 },
            { label = "press", kind = "hold", duration = 1.0 },
            { label = "slide", kind = "slide", to = [0.03, 0.04], duration = 2.0 },
            { label = "wave", kind = "sine", amplitude = [0.0, 0.01], frequency = 2.0, duration = 1.0 },
            { label = "retreat", kind = "reach", to = [0.0, 0.0], duration = 1.0 },
        ]
    "#;

    #[test]
    fn it_goes_where_the_script_says() {
        let mut hand = ScriptedHand::new(&config(PRESS), 0).unwrap();
        let mut fastest = 0.0_f64;
        let mut at = |hand: &mut ScriptedHand, steps: u32| {
            let mut state = HandState::default();
            for _ in 0..steps {
                state = hand.step(1e-3, [0.0; 3]);
                fastest = fastest.max(state.velocity[0]);
            }
            state
        };
        assert_eq!(hand.label(), "reach");
        // Half way at half time.
        at(&mut hand, 500);
        assert!((hand.target()[0] - 0.015).abs() < 1e-9);
        at(&mut hand, 1000);
        assert_eq!(hand.label(), "press");
        let state = at(&mut hand, 499);
        assert!((state.position[0] - 0.03).abs() < 1e-4);
        at(&mut hand, 1001);
        assert_eq!(hand.label(), "slide");
        let state = at(&mut hand, 500);
        assert!((state.velocity[1] - 0.02).abs() < 1e-3);
        at(&mut hand, 500);
        assert_eq!(hand.label(), "wave");
        at(&mut hand, 125);
        assert!((hand.target()[1] - 0.05).abs() < 1e-6);
        let state = at(&mut hand, 3000);
        assert_eq!(hand.label(), "end");
        assert!(state.finished && state.position[0].abs() < 1e-3);
        // Peak speed of a minimum-jerk reach: 1.875 of its mean; the hand lags
        // a little and stays below.
        assert!(
            (fastest / (1.875 * 0.03) - 1.0).abs() < 0.1,
            "{fastest} m/s"
        );
    }

    #[test]
    fn a_wall_takes_the_force_that_the_stiffness_says() {
        // Wall of 2000 N/m at 10 mm, target at 30 mm: F = 20 mm · 400·2000/2400.
        let mut hand = ScriptedHand::new(&config(PRESS), 0).unwrap();
        let mut force = 0.0;
        for _ in 0..1990 {
            let state = hand.step(1e-3, [force, 0.0, 0.0]);
            force = -2000.0 * (state.position[0] - 0.01).max(0.0);
        }
        let expected = -0.02 * 400.0 * 2000.0 / 2400.0;
        assert!(
            (force / expected - 1.0).abs() < 0.01,
            "{force} N, not {expected} N"
        );
    }

    #[test]
    fn it_repeats_and_trembles_from_its_seed() {
        let mut own = config(PRESS);
        own.script.repeat = true;
        own.tremor = Some(TremorParameters { amplitude: 1e-4 });
        let run = |seed| {
            let mut hand = ScriptedHand::new(&own, seed).unwrap();
            let states: Vec<_> = (0..6500).map(|_| hand.step(1e-3, [0.0; 3])).collect();
            assert_eq!(hand.label(), "reach");
            states
        };
        assert_eq!(run(1), run(1));
        assert_ne!(run(1), run(2));
        assert!(!run(1)[6499].finished);
    }

    #[test]
    fn a_script_may_go_through_space_and_is_written_as_it_was_read() {
        let text = PRESS.replace("to = [0.03, 0.04]", "to = [0.03, 0.04, -0.02]");
        let own = config(&text);
        let mut hand = ScriptedHand::new(&own, 0).unwrap();
        let mut lowest = 0.0_f64;
        let mut force = 0.0;
        for _ in 0..4500 {
            let at = hand.step(1e-3, [0.0, 0.0, force]).position[2];
            lowest = lowest.min(at);
            // A spring below 10 mm.
            force = 400.0 * (-0.01 - at).max(0.0);
        }
        // Half way between where the spring begins and the target.
        assert!((lowest + 0.015).abs() < 1e-3, "{lowest} m");
        let written = toml::to_string(&own).unwrap();
        assert!(written.contains("to = [0.03, 0.04, -0.02]"), "{written}");
        assert!(written.contains("start = [0.0, 0.0]\n"), "{written}");
        assert_eq!(config(&written), own);
        let error = toml::from_str::<ScriptedHandConfig>(&PRESS.replace("0.03, 0.04", "0.03"));
        assert!(error.unwrap_err().to_string().contains("1 numbers"));
    }

    #[test]
    fn wrong_scripts_are_named() {
        let mut own = config(PRESS);
        own.script.phase[2].duration = 0.0;
        let error = own.validate().unwrap_err().to_string();
        assert!(error.contains("script.phase[2].duration = 0 s"), "{error}");
        let unknown = PRESS.replace("stiffness", "stifness");
        assert!(toml::from_str::<ScriptedHandConfig>(&unknown).is_err());
        let unknown = PRESS.replace("kind = \"hold\"", "kind = \"hold\", to = [0.0, 0.0]");
        assert!(toml::from_str::<ScriptedHandConfig>(&unknown).is_err());
    }
}
