//! A fleet's parameters over the days, by laws that share nothing with the model that
//! judges them: friction falls exponentially with temperature, loads change, noise has
//! Student's tails and is correlated from day to day, days are missing.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

/// Numbers drawn from a seed.
pub struct Draws(ChaCha8Rng);

impl Draws {
    pub fn new(seed: u64) -> Draws {
        Draws(ChaCha8Rng::seed_from_u64(seed))
    }

    /// Between 0 and 1, neither of them.
    pub fn uniform(&mut self) -> f64 {
        ((self.0.next_u64() >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    /// Standard normal (Box and Muller 1958).
    pub fn normal(&mut self) -> f64 {
        let (a, b) = (self.uniform(), self.uniform());
        (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos()
    }

    /// Student's t with 4 degrees of freedom, scaled to a variance of 1.
    pub fn student_4(&mut self) -> f64 {
        let squares: f64 = (0..4).map(|_| self.normal().powi(2)).sum();
        self.normal() / (squares / 4.0).sqrt() / 2.0_f64.sqrt()
    }
}

/// What a fleet is like.
#[derive(Clone, Copy, Debug)]
pub struct Fleet {
    pub robots: usize,
    /// Noise of a day's value as a share of it, standard deviation: half of its variance is
    /// white with heavy tails, half correlated.
    pub noise: f64,
    /// Correlation from day to day of the second half.
    pub correlation: f64,
    /// How far temperatures go in a year, half of the way \[K\].
    pub season: f64,
    /// How far they differ from day to day on one robot alone: at what hour it moved \[K\].
    pub hours: f64,
    /// How the robots' slopes with temperature differ, as a share of the slope.
    pub slopes: f64,
    /// How a change of load changes a parameter, as a share of it.
    pub loads: f64,
    /// How robots age, a year: mean and standard deviation, as shares.
    pub ageing: (f64, f64),
}

impl Default for Fleet {
    fn default() -> Fleet {
        Fleet {
            robots: 100,
            noise: 0.012,
            correlation: 0.6,
            season: 10.0,
            hours: 3.0,
            slopes: 0.15,
            loads: 0.005,
            ageing: (0.1, 0.04),
        }
    }
}

/// Parameters: name, typical value, change per kelvin.
const PARAMETERS: [(&str, f64, f64); 3] = [
    ("b0", 12.4, -0.025),
    ("b1", 163.0, 0.011),
    ("b0T", 0.146, -0.008),
];
pub const JOINTS: [&str; 2] = ["joint_1", "joint_2"];
/// Mean time between changes of a robot's load \[d\].
const LOAD_HOLDS: f64 = 25.0;
/// Share of the days on which a robot does not move.
const IDLE: f64 = 0.05;

/// A joint that ages: from which day on, by what share a day.
#[derive(Clone, Copy, Debug)]
pub struct Ageing {
    pub robot: usize,
    pub joint: usize,
    pub from: i64,
    pub per_day: f64,
}

/// A day's value of a parameter.
#[derive(Clone, Debug)]
pub struct Value {
    pub robot: usize,
    pub joint: usize,
    pub parameter: &'static str,
    pub value: f64,
    pub std_error: f64,
    pub temperature: f64,
}

struct Series {
    robot: usize,
    joint: usize,
    parameter: usize,
    level: f64,
    per_kelvin: f64,
    ageing: f64,
    noise: f64,
    load_worth: f64,
    wander: f64,
}

/// The fleet, day after day.
pub struct Days {
    fleet: Fleet,
    draws: Draws,
    series: Vec<Series>,
    places: Vec<f64>,
    loads: Vec<f64>,
    weather: f64,
    phase: f64,
    ageing: Option<Ageing>,
    day: i64,
}

impl Days {
    pub fn new(fleet: Fleet, seed: u64, ageing: Option<Ageing>) -> Days {
        let mut draws = Draws::new(seed);
        let mut series = Vec::new();
        for robot in 0..fleet.robots {
            for joint in 0..JOINTS.len() {
                // Robots of one make differ in noise; ageing takes all of a joint along.
                let noise = fleet.noise * (0.25 * draws.normal()).exp();
                let ageing = fleet.ageing.0 + fleet.ageing.1 * draws.normal();
                let slope = (fleet.slopes * draws.normal()).exp();
                for (parameter, (_, value, per_kelvin)) in PARAMETERS.iter().enumerate() {
                    series.push(Series {
                        robot,
                        joint,
                        parameter,
                        level: value * (1.0 + 0.08 * draws.normal()),
                        per_kelvin: per_kelvin * slope * (0.05 * draws.normal()).exp(),
                        ageing,
                        noise,
                        load_worth: fleet.loads * draws.normal(),
                        wander: draws.normal(),
                    });
                }
            }
        }
        let places = (0..fleet.robots).map(|_| 2.0 * draws.normal()).collect();
        let loads = (0..fleet.robots).map(|_| draws.normal()).collect();
        let phase = draws.uniform();
        Days {
            fleet,
            series,
            places,
            loads,
            weather: 0.0,
            phase,
            ageing,
            day: -1,
            draws,
        }
    }
}

impl Iterator for Days {
    type Item = (i64, Vec<Value>);

    fn next(&mut self) -> Option<(i64, Vec<Value>)> {
        self.day += 1;
        let (day, fleet, draws) = (self.day, self.fleet, &mut self.draws);
        self.weather = 0.7 * self.weather + 2.0 * draws.normal();
        let turn = std::f64::consts::TAU * (day as f64 / 365.25 + self.phase);
        let common = 15.0 + fleet.season * turn.sin() + self.weather;
        let mut temperatures = Vec::new();
        let mut idle = Vec::new();
        for robot in 0..fleet.robots {
            temperatures.push(common + self.places[robot] + fleet.hours * draws.normal());
            idle.push(draws.uniform() < IDLE);
            if draws.uniform() < 1.0 / LOAD_HOLDS {
                self.loads[robot] = draws.normal();
            }
        }
        let mut values = Vec::new();
        let keeps = fleet.correlation;
        for own in &mut self.series {
            own.wander = keeps * own.wander + (1.0 - keeps * keeps).sqrt() * draws.normal();
            let noise = own.noise * 0.5_f64.sqrt() * (own.wander + draws.student_4());
            let told = draws.uniform();
            if idle[own.robot] {
                continue;
            }
            // The joint is warmer than its surroundings, the second one more so.
            let temperature = temperatures[own.robot] + 3.0 * own.joint as f64;
            let mut share = (own.per_kelvin * (temperature - 15.0)).exp();
            share *= 1.0 + own.ageing * day as f64 / 365.25;
            share *= 1.0 + own.load_worth * self.loads[own.robot] + noise;
            if let Some(ageing) = &self.ageing
                && ageing.robot == own.robot
                && ageing.joint == own.joint
            {
                share *= 1.0 + ageing.per_day * (day - ageing.from).max(0) as f64;
            }
            // Twins tell too small an error, and not always the same one.
            let std_error = own.level * own.noise * (0.3 + 0.4 * told);
            values.push(Value {
                robot: own.robot,
                joint: own.joint,
                parameter: PARAMETERS[own.parameter].0,
                value: own.level * share,
                std_error,
                temperature,
            });
        }
        Some((day, values))
    }
}
