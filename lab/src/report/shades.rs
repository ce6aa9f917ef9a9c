//! Stretches of a session that are not used, and such that validate.

use ferntast_identification::comparison::Series;

use super::Shade;

/// Of one session, in order of time.
pub(super) fn of(series: &Series) -> Vec<Shade> {
    let half = match series.time.as_slice() {
        [first, .., last] => 0.5 * (last - first) / (series.time.len() - 1) as f64,
        _ => 0.0,
    };
    let what = |used: bool| match (used, series.held_out) {
        (false, _) => Some("not used"),
        (true, true) => Some("validates"),
        (true, false) => None,
    };
    let mut shades: Vec<Shade> = Vec::new();
    let mut open = None;
    for (time, used) in series.time.iter().zip(&series.used) {
        let now = what(*used);
        match (now, shades.last_mut()) {
            (Some(what), Some(last)) if open == Some(what) => {
                last.to = time + half;
                last.what = what;
            }
            (Some(what), _) => shades.push(Shade {
                from: time - half,
                to: time + half,
                what,
            }),
            (None, _) => {}
        }
        open = now;
    }
    shades
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(held_out: bool) -> Series {
        Series {
            session: "a".to_owned(),
            held_out,
            time: vec![0.0, 1.0, 2.0, 3.0, 4.0],
            used: vec![false, false, true, true, false],
            position: Vec::new(),
            velocity: Vec::new(),
            acceleration: Vec::new(),
            load: Vec::new(),
            temperature: Vec::new(),
            measured: Vec::new(),
            modelled: Vec::new(),
        }
    }

    #[test]
    fn what_is_not_used_is_shaded_and_what_validates_another_way() {
        let told = |held_out: bool| -> Vec<(f64, f64, &str)> {
            let shades = of(&series(held_out));
            shades.iter().map(|s| (s.from, s.to, s.what)).collect()
        };
        let ends = [(-0.5, 1.5, "not used"), (3.5, 4.5, "not used")];
        assert_eq!(told(false), ends);
        assert_eq!(told(true), [ends[0], (1.5, 3.5, "validates"), ends[1]]);
    }
}
