//! Recorded human motion, from text.

use super::HandState;
use ferntast_model::{ParameterError, parameters};

/// Why a recording cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RecordingError {
    /// The first line is not the header.
    #[error("line 1 is \"{found}\"; it must name the columns t_s,x_m,y_m, and may name pen_down")]
    Header {
        /// What it is.
        found: String,
    },
    /// A line with too few or too many values.
    #[error("line {line} has {found} values, the header names {expected} columns")]
    Columns {
        /// Counted from 1.
        line: usize,
        /// Values found.
        found: usize,
        /// Columns named.
        expected: usize,
    },
    /// Not a number.
    #[error("line {line}, column {column}: \"{found}\" is not a number")]
    Number {
        /// Counted from 1.
        line: usize,
        /// Name of the column.
        column: &'static str,
        /// What it is.
        found: String,
    },
    /// NaN or infinite.
    #[error("line {line}, column {column}: {value} is not finite; leave such samples out")]
    NotFinite {
        /// Counted from 1.
        line: usize,
        /// Name of the column.
        column: &'static str,
        /// What it is.
        value: f64,
    },
    /// Time does not increase.
    #[error(
        "line {line}: time {time} s is not after {before} s of the line before; sort the samples"
    )]
    TimeBackwards {
        /// Counted from 1.
        line: usize,
        /// Its time \[s\].
        time: f64,
        /// Time of the sample before \[s\].
        before: f64,
    },
    /// Fewer than two samples.
    #[error("the recording has {found} samples; two are needed to interpolate")]
    TooShort {
        /// Samples found.
        found: usize,
    },
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Sample {
    time: f64,
    position: [f64; 2],
}

/// A recorded motion: samples (t, x, y), unevenly spaced.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedMotion {
    samples: Vec<Sample>,
}

const COLUMNS: [&str; 3] = ["t_s", "x_m", "y_m"];

impl RecordedMotion {
    /// Reads comma-separated text with the header `t_s,x_m,y_m[,pen_down]`;
    /// time \[s\], position in the leader's base frame \[m\]. Empty lines are
    /// skipped; `pen_down` is not used.
    ///
    /// # Errors
    ///
    /// [`RecordingError`] with the line.
    pub fn parse(text: &str) -> Result<RecordedMotion, RecordingError> {
        let mut lines = text
            .lines()
            .enumerate()
            .map(|(index, line)| (index + 1, line.trim()));
        let header = lines.next().map_or("", |(_, line)| line);
        let names: Vec<&str> = header
            .trim_start_matches('\u{feff}')
            .split(',')
            .map(str::trim)
            .collect();
        if names != COLUMNS
            && !(names.len() == 4 && names[..3] == COLUMNS && names[3] == "pen_down")
        {
            return Err(RecordingError::Header {
                found: header.chars().take(80).collect(),
            });
        }
        let mut samples: Vec<Sample> = Vec::new();
        for (line, content) in lines.filter(|(_, content)| !content.is_empty()) {
            let found = content.split(',').count();
            if found != names.len() {
                let expected = names.len();
                return Err(RecordingError::Columns {
                    line,
                    found,
                    expected,
                });
            }
            let mut values = [0.0; 3];
            for ((value, text), column) in values.iter_mut().zip(content.split(',')).zip(COLUMNS) {
                *value = number(text.trim(), line, column)?;
            }
            let [time, x, y] = values;
            if let Some(last) = samples.last().filter(|last| time <= last.time) {
                let before = last.time;
                return Err(RecordingError::TimeBackwards { line, time, before });
            }
            samples.push(Sample {
                time,
                position: [x, y],
            });
        }
        if samples.len() < 2 {
            let found = samples.len();
            return Err(RecordingError::TooShort { found });
        }
        Ok(RecordedMotion { samples })
    }

    /// Number of samples.
    pub fn samples(&self) -> usize {
        self.samples.len()
    }

    /// From the first sample to the last \[s\].
    pub fn duration(&self) -> f64 {
        self.samples[self.samples.len() - 1].time - self.samples[0].time
    }

    /// Longest time between two samples \[s\].
    pub fn longest_gap(&self) -> f64 {
        self.samples
            .windows(2)
            .map(|pair| pair[1].time - pair[0].time)
            .fold(0.0, f64::max)
    }

    /// Largest speed between two samples \[m/s\].
    pub fn top_speed(&self) -> f64 {
        self.samples
            .windows(2)
            .map(|pair| {
                let way = [0, 1].map(|axis: usize| pair[1].position[axis] - pair[0].position[axis]);
                way[0].hypot(way[1]) / (pair[1].time - pair[0].time)
            })
            .fold(0.0, f64::max)
    }
}

fn number(text: &str, line: usize, column: &'static str) -> Result<f64, RecordingError> {
    let value: f64 = text.parse().map_err(|_| RecordingError::Number {
        line,
        column,
        found: text.chars().take(40).collect(),
    })?;
    if !value.is_finite() {
        return Err(RecordingError::NotFinite {
            line,
            column,
            value,
        });
    }
    Ok(value)
}

parameters! {
    /// How a recording is played.
    #[derive(Copy)]
    pub struct RecordedHandConfig {
        /// Whether it starts again at its end.
        pub repeat: bool = false,
        /// Time in which the hand goes from the end back to the start, when it
        /// repeats \[s\].
        pub return_time: f64 [0.01..=60.0, "s"] = 1.0,
        /// Positions are multiplied by this \[-\].
        pub scale: f64 [-100.0..=100.0, "-"] = 1.0,
    }
}

/// A hand that moves as was recorded, whatever the force: linear between
/// samples, however far apart.
#[derive(Clone, Debug)]
pub struct RecordedHand {
    motion: RecordedMotion,
    config: RecordedHandConfig,
    /// Time since the first sample [s].
    time: f64,
    /// The sample at or before that time.
    index: usize,
}

impl RecordedHand {
    /// At the first sample.
    ///
    /// # Errors
    ///
    /// The first value of `config` that is out of bounds.
    pub fn new(
        motion: RecordedMotion,
        config: RecordedHandConfig,
    ) -> Result<RecordedHand, ParameterError> {
        config.validate()?;
        Ok(RecordedHand {
            motion,
            config,
            time: 0.0,
            index: 0,
        })
    }

    /// Moves on by `dt` \[s\].
    pub fn step(&mut self, dt: f64) -> HandState {
        self.time += dt;
        let samples = &self.motion.samples;
        let last = samples.len() - 1;
        let duration = self.motion.duration();
        if self.time >= duration {
            if self.config.repeat && self.time >= duration + self.config.return_time {
                self.time -= duration + self.config.return_time;
                self.index = 0;
            } else if self.config.repeat {
                let share = (self.time - duration) / self.config.return_time;
                let pace = 1.0 / self.config.return_time;
                let (from, to) = (samples[last].position, samples[0].position);
                return self.between(from, to, share, pace, false);
            } else {
                let end = samples[last].position;
                return self.between(end, end, 0.0, 0.0, true);
            }
        }
        let time = samples[0].time + self.time;
        while self.index + 2 < samples.len() && samples[self.index + 1].time <= time {
            self.index += 1;
        }
        let (from, to) = (samples[self.index], samples[self.index + 1]);
        let span = to.time - from.time;
        let share = ((time - from.time) / span).clamp(0.0, 1.0);
        self.between(from.position, to.position, share, 1.0 / span, false)
    }

    fn between(
        &self,
        from: [f64; 2],
        to: [f64; 2],
        share: f64,
        pace: f64,
        finished: bool,
    ) -> HandState {
        let scale = self.config.scale;
        let at = |axis: usize| scale * (from[axis] + share * (to[axis] - from[axis]));
        let speed = |axis: usize| scale * pace * (to[axis] - from[axis]);
        HandState {
            position: [at(0), at(1), 0.0],
            velocity: [speed(0), speed(1), 0.0],
            orientation: None,
            finished,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const TEXT: &str = "t_s,x_m,y_m,pen_down\n\
        10.000,0.0,0.010,1\n\
        10.001,0.003,0.010,1\n\
        \n\
        11.001,0.004,-0.010,0\n";

    #[test]
    fn samples_are_joined_by_straight_lines() {
        let motion = RecordedMotion::parse(TEXT).unwrap();
        assert_eq!(motion.samples(), 3);
        assert!((motion.longest_gap() - 1.0).abs() < 1e-9);
        assert!((motion.top_speed() - 3.0).abs() < 1e-9);
        let mut hand = RecordedHand::new(motion, RecordedHandConfig::default()).unwrap();
        let state = hand.step(0.0005);
        assert!((state.position[0] - 0.0015).abs() < 1e-9, "{state:?}");
        assert!((state.velocity[0] - 3.0).abs() < 1e-9);
        let state = hand.step(0.5005);
        assert!((state.position[0] - 0.0035).abs() < 1e-9);
        assert!(state.position[1].abs() < 1e-9 && !state.finished);
        let state = hand.step(10.0);
        assert_eq!(state.position, [0.004, -0.010, 0.0]);
        assert!(state.finished);
    }

    #[test]
    fn it_goes_back_and_starts_again() {
        let config = RecordedHandConfig {
            repeat: true,
            return_time: 1.0,
            scale: 2.0,
        };
        let mut hand = RecordedHand::new(RecordedMotion::parse(TEXT).unwrap(), config).unwrap();
        let mut before = hand.step(0.0);
        for _ in 0..10_000 {
            let state = hand.step(1e-3);
            let way = (state.position[0] - before.position[0]).abs();
            assert!(way < 0.0061 && !state.finished);
            before = state;
        }
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        let cases = [
            ("", "line 1"),
            ("time,x,y\n0,0,0\n1,0,0", "line 1"),
            ("t_s,x_m,y_m\n0,0,0\n1,0", "line 3 has 2 values"),
            ("t_s,x_m,y_m\n0,0,0\n1,0,0,0", "line 3 has 4 values"),
            (
                "t_s,x_m,y_m\n0,0,0\n1,zero,0",
                "line 3, column x_m: \"zero\"",
            ),
            (
                "t_s,x_m,y_m\n0,0,NaN\n1,0,0",
                "line 2, column y_m: NaN is not finite",
            ),
            ("t_s,x_m,y_m\n0,0,0\ninf,0,0", "line 3, column t_s"),
            (
                "t_s,x_m,y_m\n0,0,0\n\n2,0,0\n1,0,0",
                "line 5: time 1 s is not after 2 s",
            ),
            ("t_s,x_m,y_m\n0,0,0\n0,0,0", "line 3: time 0 s"),
            ("t_s,x_m,y_m\n0,0,0", "1 samples"),
        ];
        for (text, expected) in cases {
            let error = RecordedMotion::parse(text).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
    }

    proptest! {
        #[test]
        fn any_text_is_read_or_refused(text in "(t_s,x_m,y_m\n)?[-0-9.,eNaif\n]{0,120}") {
            if let Ok(motion) = RecordedMotion::parse(&text) {
                prop_assert!(motion.duration() > 0.0);
            }
        }

        /// The hand is never outside what was recorded.
        #[test]
        fn it_stays_within_the_recording(
            points in proptest::collection::vec((0.001..1.0f64, -0.05..0.05f64, -0.05..0.05f64), 2..30),
            dt in 0.0001..0.5f64,
        ) {
            let mut text = String::from("t_s,x_m,y_m\n");
            let mut time = 0.0;
            for (pause, x, y) in &points {
                time += pause;
                text += &format!("{time},{x},{y}\n");
            }
            let motion = RecordedMotion::parse(&text).unwrap();
            let mut hand = RecordedHand::new(motion, RecordedHandConfig::default()).unwrap();
            for _ in 0..100 {
                let state = hand.step(dt);
                prop_assert!(state.position.iter().all(|value| value.abs() <= 0.05));
            }
        }
    }
}
