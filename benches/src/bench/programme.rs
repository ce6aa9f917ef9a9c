//! Position over time, as stretches one after another.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// One stretch of a programme.
#[derive(Clone, Copy, Debug)]
enum Piece {
    Rest,
    /// Speed rises and falls by raised cosines, so that acceleration has no step.
    Move {
        speed: f64,
        ramp: f64,
    },
    /// `centre` − `reach` cos(ω t) from its turning point, or the move there.
    Sine {
        reach: f64,
        rate: f64,
    },
}

/// Position over time, as stretches one after another, from 0 on.
#[derive(Clone, Debug, Default)]
pub(crate) struct Programme {
    /// Start \[s\], start position \[rad or m\], what follows.
    pieces: Vec<(f64, f64, Piece)>,
    end: f64,
    position: f64,
}

impl Programme {
    /// Its length \[s\].
    pub(crate) fn duration(&self) -> f64 {
        self.end
    }

    fn push(&mut self, piece: Piece, duration: f64, position: f64) {
        self.pieces.push((self.end, self.position, piece));
        self.end += duration;
        self.position = position;
    }

    pub(crate) fn rest(&mut self, duration: f64) {
        self.push(Piece::Rest, duration, self.position);
    }

    /// Moves to `target` \[rad or m\] at `speed` \[rad or m/s\], with at most
    /// `acceleration` \[rad or m/s²\]; a short way is taken more slowly.
    pub(crate) fn to(&mut self, target: f64, speed: f64, acceleration: f64) {
        let way = target - self.position;
        if way.abs() < 1e-6 {
            return;
        }
        // A raised-cosine ramp of duration r peaks at speed π/(2 r).
        let speed = speed.min((way.abs() * acceleration / FRAC_PI_2).sqrt());
        let ramp = FRAC_PI_2 * speed / acceleration;
        let duration = way.abs() / speed + ramp;
        let speed = speed.copysign(way);
        self.push(Piece::Move { speed, ramp }, duration, target);
    }

    /// To `from`, then to `target` and back at one speed.
    pub(crate) fn stroke(&mut self, from: f64, target: f64, speed: f64, acceleration: f64) {
        self.to(from, 0.3, 2.0);
        self.to(target, speed, acceleration);
        self.to(from, speed, acceleration);
    }

    /// `cycles` of a sine whose lower turning point is here.
    pub(crate) fn sine(&mut self, reach: f64, speed: f64, cycles: f64) {
        let rate = speed / reach;
        self.push(
            Piece::Sine { reach, rate },
            cycles * TAU / rate,
            self.position,
        );
    }

    /// Position \[rad or m\], velocity and acceleration at `time` \[s\]; `cursor` is
    /// the stretch found last and only moves on.
    pub(crate) fn at(&self, time: f64, cursor: &mut usize) -> [f64; 3] {
        while self
            .pieces
            .get(*cursor + 1)
            .is_some_and(|(start, ..)| *start <= time)
        {
            *cursor += 1;
        }
        let Some(&(start, from, piece)) = self.pieces.get(*cursor) else {
            return [self.position, 0.0, 0.0];
        };
        let next = self.pieces.get(*cursor + 1).map_or(self.end, |next| next.0);
        let (time, left) = (time - start, next - time);
        match piece {
            Piece::Rest => [from, 0.0, 0.0],
            Piece::Move { speed, ramp } => {
                let to = self
                    .pieces
                    .get(*cursor + 1)
                    .map_or(self.position, |next| next.1);
                if left <= 0.0 {
                    [to, 0.0, 0.0]
                } else if time < ramp {
                    let [way, velocity, acceleration] = rise(time, speed, ramp);
                    [from + way, velocity, acceleration]
                } else if left < ramp {
                    let [way, velocity, acceleration] = rise(left, speed, ramp);
                    [to - way, velocity, -acceleration]
                } else {
                    [from + speed * (time - 0.5 * ramp), speed, 0.0]
                }
            }
            Piece::Sine { reach, rate } => {
                let (sine, cosine) = (rate * time).sin_cos();
                [
                    from + reach * (1.0 - cosine),
                    reach * rate * sine,
                    reach * rate * rate * cosine,
                ]
            }
        }
    }
}

/// Way, velocity and acceleration `time` after the start of a ramp to `speed`.
fn rise(time: f64, speed: f64, ramp: f64) -> [f64; 3] {
    let rate = PI / ramp;
    let (sine, cosine) = (rate * time).sin_cos();
    [
        0.5 * speed * (time - sine / rate),
        0.5 * speed * (1.0 - cosine),
        0.5 * speed * rate * sine,
    ]
}
