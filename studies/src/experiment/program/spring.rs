//! A spring of the contour pulled at constant velocities: the paper's standard
//! identification trajectory "spring" (Fig. 3).

use super::{Program, Seen, Target, advance};
use ferntast_model::{ParameterError, check};
use ferntast_sim::arm::JOINTS;

/// Slope of the velocity where a stroke begins and ends \[rad/s²\].
const ACCELERATION: f64 = 10.0;

/// Way of one joint from one end to the other, the other joint along with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Which joint's speed counts (0 or 1).
    pub joint: usize,
    /// Joint positions at the end where the spring is free \[rad\].
    pub free: [f64; JOINTS],
    /// Joint positions where the spring is pushed most \[rad\].
    pub loaded: [f64; JOINTS],
    /// Where between them the spring is touched \[0 … 1\].
    pub touch: f64,
}

/// One way between two shares of the stroke.
#[derive(Clone, Copy, Debug)]
struct Way {
    start: f64,
    from: f64,
    to: f64,
    /// Top speed [1/s], in strokes.
    speed: f64,
    /// Slope of the speed [1/s²], in strokes.
    slope: f64,
}

impl Way {
    fn duration(&self) -> f64 {
        let length = (self.to - self.from).abs();
        if length * self.slope <= self.speed * self.speed {
            return 2.0 * (length / self.slope).sqrt();
        }
        length / self.speed + self.speed / self.slope
    }

    /// Share of the stroke `time` \[s\] after its start.
    fn at(&self, time: f64) -> f64 {
        let length = (self.to - self.from).abs();
        let whole = self.duration();
        let top = self.speed.min((length * self.slope).sqrt());
        let ramp = top / self.slope;
        let time = time.clamp(0.0, whole);
        let done = if time < ramp {
            0.5 * self.slope * time * time
        } else if time > whole - ramp {
            length - 0.5 * self.slope * (whole - time).powi(2)
        } else {
            top * (time - 0.5 * ramp)
        };
        self.from + done.min(length) * (self.to - self.from).signum()
    }
}

/// Back and forth at one constant velocity after the other.
#[derive(Clone, Debug)]
pub struct SpringMotion {
    stroke: Stroke,
    ways: Vec<Way>,
    duration: f64,
    /// The way that is on.
    current: usize,
}

impl SpringMotion {
    /// Each of `speeds` \[deg/s\] for about `time_per_speed` \[s\]: the whole
    /// stroke as often as that allows, else a shorter one around the place
    /// where the spring is touched, so that every speed sees both loads.
    ///
    /// # Errors
    ///
    /// A speed or a time out of bounds, or no speed at all.
    pub fn new(
        stroke: Stroke,
        speeds: &[f64],
        time_per_speed: f64,
    ) -> Result<Self, ParameterError> {
        check("number of speeds", speeds.len() as f64, 1.0, 100.0, "-")?;
        check("time_per_speed", time_per_speed, 1.0, 1000.0, "s")?;
        let joint = stroke.joint.min(JOINTS - 1);
        let travel = (stroke.loaded[joint] - stroke.free[joint]).abs();
        check("travel of the joint", travel, 1e-3, 6.3, "rad")?;
        let (mut ways, mut now, mut at): (Vec<Way>, f64, f64) = (Vec::new(), 0.0, 0.0);
        for &degrees in speeds {
            check("speed", degrees, 0.01, 40.0, "deg/s")?;
            let speed = degrees.to_radians() / travel;
            let slope = ACCELERATION / travel;
            let length = (0.5 * time_per_speed * speed).min(1.0);
            // Half of it free, half of it loaded, as far as there is room.
            let low = (stroke.touch - 0.5 * length).clamp(0.0, 1.0 - length);
            let high = low + length;
            let cycle = 2.0 * (length / speed + speed / slope);
            let cycles = ((time_per_speed / cycle).round() as usize).max(1);
            let ends = (0..cycles).flat_map(|_| [high, low]);
            for to in std::iter::once(low).chain(ends) {
                if (to - at).abs() < 1e-9 {
                    continue;
                }
                let way = Way {
                    start: now,
                    from: at,
                    to,
                    speed,
                    slope,
                };
                // On the way to where a slow stroke begins there is no need to be slow.
                let way = match to == low && at < low {
                    true => Way {
                        speed: speed.max(0.1 / travel),
                        ..way
                    },
                    false => way,
                };
                now += way.duration();
                at = to;
                ways.push(way);
            }
        }
        Ok(SpringMotion {
            stroke,
            ways,
            duration: now,
            current: 0,
        })
    }
}

impl Program for SpringMotion {
    fn duration(&self) -> f64 {
        self.duration
    }

    fn target(&mut self, time: f64, _: f64, _: &Seen) -> Target {
        advance(&self.ways, &mut self.current, time, |way| way.start);
        let way = self.ways.get(self.current);
        let share = way.map_or(0.0, |way| way.at(time - way.start));
        let Stroke { free, loaded, .. } = self.stroke;
        Target::Joints(
            [0, 1].map(|joint: usize| free[joint] + share * (loaded[joint] - free[joint])),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STROKE: Stroke = Stroke {
        joint: 1,
        free: [0.0, 1.0],
        loaded: [-0.25, 1.5],
        touch: 0.4,
    };

    fn positions(motion: &mut SpringMotion) -> Vec<f64> {
        let steps = (motion.duration() * 1e3) as usize;
        (0..=steps)
            .map(
                |k| match motion.target(k as f64 * 1e-3, 1e-3, &Seen::default()) {
                    Target::Joints([first, second]) => {
                        assert!(
                            (first + 0.5 * (second - 1.0)).abs() < 1e-12,
                            "joints go together"
                        );
                        second
                    }
                    Target::Tip(_) => f64::NAN,
                },
            )
            .collect()
    }

    #[test]
    fn every_speed_is_held_in_both_directions_for_most_of_its_time() {
        let speeds = [1.0, 5.0, 10.0, 20.0, 40.0];
        let mut motion = SpringMotion::new(STROKE, &speeds, 10.0).unwrap();
        let positions = positions(&mut motion);
        for speed in speeds {
            for sign in [-1.0, 1.0] {
                let wanted = sign * f64::to_radians(speed);
                let held = positions
                    .windows(2)
                    .filter(|w| ((w[1] - w[0]) * 1e3 - wanted).abs() < 1e-6)
                    .count();
                assert!(held > 3500, "{speed} deg/s: {held} ms");
            }
        }
        assert!(
            positions
                .iter()
                .all(|&q| (1.0 - 1e-9..=1.5 + 1e-9).contains(&q))
        );
    }

    #[test]
    fn a_slow_stroke_lies_around_the_place_where_the_spring_is_touched() {
        let mut motion = SpringMotion::new(STROKE, &[1.0], 10.0).unwrap();
        let positions = positions(&mut motion);
        let low = 1.2 - 0.5 * 5.0_f64.to_radians();
        let late = &positions[positions.len() - 10_000..];
        let least = late.iter().copied().fold(f64::MAX, f64::min);
        let most = late.iter().copied().fold(f64::MIN, f64::max);
        assert!((least - low).abs() < 1e-3 && (most - least - 5.0_f64.to_radians()).abs() < 1e-3);
    }

    #[test]
    fn speeds_that_the_arm_has_not_are_refused() {
        assert!(SpringMotion::new(STROKE, &[41.0], 10.0).is_err());
        assert!(SpringMotion::new(STROKE, &[], 10.0).is_err());
        assert!(SpringMotion::new(STROKE, &[f64::NAN], 10.0).is_err());
    }
}
