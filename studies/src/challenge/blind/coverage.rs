//! How often the intervals that the lab states hold the true value.
//!
//! The true model is fitted to recordings with one hidden effect, or none; of each
//! parameter whose true value is known in the lab's terms it is noted whether its 95 %
//! interval holds that. Sessions differ on a bench: the true value is that of the
//! joint, around which sessions scatter. Of a single session, where nobody can know
//! that scatter, nothing is scattered.

use std::collections::BTreeMap;

use ferntast_benches::bench::{BenchConfig, Hideable};
use ferntast_identification::{ModelSpec, Term, design::Design, fit::fit, prepare};
use serde::{Deserialize, Serialize};

use super::{super::TestBench, Case, Made, count::Count};

/// How often intervals hold the true value.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Coverage {
    /// Parameters that are fitted, in recordings of several sessions.
    pub fitted: Count,
    /// The same of parameters that are searched: speeds, places, widths, periods.
    pub searched: Count,
    /// Parameters of both kinds in a recording of one session.
    pub one_session: Count,
    /// By parameter, of several sessions.
    pub by_parameter: BTreeMap<String, OfParameter>,
    /// Intervals that do not hold it, of several sessions and of one.
    pub outside: Vec<Outside>,
}

/// Intervals of one parameter.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct OfParameter {
    /// How many hold the true value.
    #[serde(flatten)]
    pub count: Count,
    /// Mean of estimate less true value, in standard errors: a systematic error where it
    /// is far from zero.
    pub mean_deviation: f64,
    /// Root mean square of the same: above that of Student's distribution, standard
    /// errors are too small.
    pub rms_deviation: f64,
}

/// An interval that does not hold the true value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outside {
    /// The parameter.
    pub parameter: String,
    /// At which strength of what is hidden.
    pub strength: f64,
    /// Seed of the recording.
    pub seed: u64,
    /// Sessions in it.
    pub sessions: usize,
    /// Its true value.
    pub truth: f64,
    /// What was found.
    pub value: f64,
    /// With which standard error.
    pub std_error: f64,
    /// The interval.
    pub interval_95: [f64; 2],
}

impl Coverage {
    pub(super) fn add(&mut self, held: &[Held]) {
        for own in held {
            let found = &own.found;
            match (found.sessions, own.is_searched) {
                (1, _) => self.one_session.note(own.holds),
                (_, true) => self.searched.note(own.holds),
                (_, false) => self.fitted.note(own.holds),
            }
            if found.sessions > 1 {
                let of = self.by_parameter.entry(found.parameter.clone());
                of.or_default().note(own);
            }
            if !own.holds {
                self.outside.push(found.clone());
            }
        }
    }
}

impl OfParameter {
    fn note(&mut self, held: &Held) {
        let before = self.count.tried as f64;
        self.count.note(held.holds);
        let own = (held.found.value - held.found.truth) / held.found.std_error.max(1e-300);
        let mean = |of: f64, own: f64| (of * before + own) / (before + 1.0);
        self.mean_deviation = mean(self.mean_deviation, own);
        self.rms_deviation = mean(self.rms_deviation.powi(2), own * own).sqrt();
    }
}

/// Whether the interval of one parameter holds its true value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Held {
    found: Outside,
    is_searched: bool,
    holds: bool,
}

/// Intervals of the true model's parameters, of the case's recording and of one session.
pub(super) fn held<H: TestBench>(
    case: &Case<H>,
    recording: &H::Recording,
) -> Result<Vec<Held>, String> {
    let is_known = case.hidden.is_none_or(Hideable::in_catalogue);
    if !is_known {
        return Ok(Vec::new());
    }
    let mut all = of_recording(case, recording, H::SESSIONS)?;
    // One session may be too short for what is hidden between sessions.
    all.extend(of_one_session(case).unwrap_or_default());
    Ok(all)
}

fn of_one_session<H: TestBench>(case: &Case<H>) -> Result<Vec<Held>, String> {
    let config = BenchConfig {
        sessions: 1,
        scatter: 0.0,
        ..case.config()
    };
    let made = Made::<H>::by(&config)?;
    of_recording(case, &made.recording, 1)
}

fn of_recording<H: TestBench>(
    case: &Case<H>,
    recording: &H::Recording,
    sessions: usize,
) -> Result<Vec<Held>, String> {
    let mut model: ModelSpec = H::model(recording);
    let hidden = case.hidden.and_then(|own| own.accepted().first().copied());
    model
        .effects
        .extend(hidden.map(|id| Term::Catalogue(id.to_owned())));
    let prepared = prepare(&H::dataset(recording), &model).map_err(|error| error.to_string())?;
    let found = fit(&prepared, &Design::new(&prepared));
    let own = H::truth(recording)
        .iter()
        .filter(|own| own.effect.is_some());
    let own: Vec<(&str, f64)> = own.map(|own| (own.name, own.value)).collect();
    let there = H::truth(recording)
        .iter()
        .filter(|own| own.effect.is_none());
    let mut truths = values(hidden, &own);
    if hidden == Some("presliding_hysteresis") {
        // The joint has bristles anyway: what is hidden makes them longer.
        let bristle = there.clone().find(|own| own.name == "bristle");
        truths.extend(bristle.map(|own| ("delta", own.value)));
    }
    if !changes_all(hidden) {
        truths.extend(there.filter_map(|own| Some((always(own.name)?, own.value))));
    }
    let held = truths.into_iter().filter_map(|(name, truth)| {
        let own = found.parameters.get(name)?;
        let interval_95 = own.interval_95?;
        let [low, high] = interval_95;
        Some(Held {
            is_searched: SEARCHED.contains(&name),
            holds: (low..=high).contains(&truth),
            found: Outside {
                parameter: match hidden.filter(|id| own.effect == *id) {
                    Some(id) => format!("{id}.{name}"),
                    None => name.to_owned(),
                },
                strength: case.strength,
                seed: case.seed,
                sessions,
                truth,
                value: own.value,
                std_error: own.std_error?,
                interval_95,
            },
        })
    });
    Ok(held.collect())
}

/// Names of parameters that are searched, of those in [`values`].
const SEARCHED: &[&str] = &["vs", "vsT", "k", "ql", "wl", "delta", "gap", "L"];

/// Whether beside a hidden effect the parameters that are there anyway have other
/// values in the lab's terms: it counts temperature from its own reference, or believes
/// a channel that is wrong.
fn changes_all(hidden: Option<&str>) -> bool {
    let others = [
        "temperature_coulomb",
        "temperature_viscous",
        "motor_constant",
        "torque_sensor_gain",
        "torque_sensor_calibration",
        "contact_wear",
        "contact_spot",
        "contact_compliance",
    ];
    hidden.is_some_and(|id| others.contains(&id))
}

/// The lab's name of a parameter that is there anyway.
fn always(name: &str) -> Option<&'static str> {
    let known = ["b0", "b0T", "b1", "b2", "b3"];
    known.into_iter().find(|own| *own == name)
}

/// The hidden effect's parameters by the lab's names.
fn values(hidden: Option<&str>, truth: &[(&str, f64)]) -> Vec<(&'static str, f64)> {
    let of = |name: &str| {
        truth
            .iter()
            .find(|own| own.0 == name)
            .map_or(f64::NAN, |own| own.1)
    };
    // A sin(x + φ) as coefficients of sine and cosine.
    let of_wave = |size: &str| {
        let (sine, cosine) = of("phase").sin_cos();
        (of(size) * cosine, of(size) * sine)
    };
    match hidden.unwrap_or_default() {
        "coulomb" => vec![("b0", of("b0"))],
        "load_coulomb" | "contact_coulomb" => vec![("b0T", of("b0T"))],
        "viscous" => vec![("b1", of("b1"))],
        "quadratic_viscous" => vec![("b2", of("b2"))],
        "cubic_viscous" => vec![("b3", of("b3"))],
        "nonlinear_viscous" => vec![("b2", of("b2")), ("b3", of("b3"))],
        "stribeck" => vec![("bs", of("bs")), ("vs", of("vs"))],
        "load_stribeck" => vec![("bsT", of("bsT")), ("vsT", of("vs"))],
        "contact_stribeck" => vec![("bsT", of("bs")), ("vs", of("vs"))],
        "contact_viscous" => vec![("c", of("c"))],
        "asymmetric_coulomb" => vec![("ba", of("ba"))],
        "asymmetric_viscous" => vec![("bav", of("bav"))],
        "local_friction" => vec![
            ("bl", of("level")),
            ("ql", of("centre")),
            ("wl", of("width")),
        ],
        "load_ripple" => {
            let (sine, cosine) = of_wave("gain");
            vec![("a_sT", sine), ("a_cT", cosine), ("kaT", of("rate"))]
        }
        "ripple" => {
            let (sine, cosine) = of_wave("amplitude");
            vec![("a_s", sine), ("a_c", cosine), ("k", of("rate"))]
        }
        "gravity" => {
            let (sine, cosine) = of_wave("g");
            vec![("g_s", sine), ("g_c", cosine)]
        }
        "cable_spring" => vec![("kc", of("kc")), ("k0", -of("kc") * of("q0"))],
        "temperature_coulomb" => vec![("kT", of("kt"))],
        "temperature_viscous" => vec![("kv", of("kv"))],
        "wear_drift" => vec![("kw", of("kw"))],
        "torque_sensor_offset" => vec![("os", -of("offset"))],
        "backlash" => vec![("gap", of("gap"))],
        "current_saturation" => vec![("L", of("limit"))],
        _ => Vec::new(),
    }
}
