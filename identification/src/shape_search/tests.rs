//! Searches on a part of the rows beside searches on all of them.

use super::*;
use crate::effects::find;
use crate::preparation::prepare;
use crate::tests::recordings::{JointState, model, plain, recording};

/// Columns of size 1 that are no further apart are the same.
const NEAR: f64 = 0.01;
/// One row in so many is in the part.
const SHARE: usize = 3;

/// A torque that a model lacks \[Nm\].
type Torque<'a> = &'a dyn Fn(&JointState) -> f64;

fn bound(torque: impl Fn(&JointState) -> f64) -> (PreparedModel, Design) {
    let prepared = prepare(&recording(5, torque), &model(&["coulomb", "viscous"])).unwrap();
    let design = Design::new(&prepared);
    (prepared, design)
}

fn searches<'a>(prepared: &'a PreparedModel, design: &'a Design) -> [Search<'a>; 2] {
    let all = Rows { prepared, design };
    let part = Some(Part::one_in(SHARE, prepared, design));
    [Search { all, part }, Search { all, part: None }]
}

/// What is filtered at a row of the part is what is filtered there in the recording, also where
/// an effect looks back or ahead; of one with a memory nearly everywhere.
#[test]
fn a_part_has_the_columns_of_the_whole() {
    let (prepared, design) = bound(plain);
    let part = Part::one_in(SHARE, &prepared, &design);
    for (id, shape, most_apart) in [
        ("stribeck", vec![0.05], 0.0),
        ("ripple", vec![40.0], 0.0),
        ("channel_delay", vec![2.0, 0.1], 0.0),
        ("presliding_hysteresis", vec![0.002], 0.05),
    ] {
        let effect = find(id).unwrap();
        let of_part = part.rows_for(&effect, &shape);
        let whole = design.extra_columns(&prepared, &effect, &shape);
        let own = of_part
            .design
            .extra_columns(of_part.prepared, &effect, &shape);
        let (mut apart, mut count) = (0, 0);
        for (s, (own, whole)) in own.iter().zip(&whole).enumerate() {
            let rows = &prepared.sessions[s].rows;
            let times = rows
                .iter()
                .map(|at| prepared.sessions[s].points[*at].position);
            let places: Vec<f64> = times.collect();
            let mut row = 0;
            for (k, at) in of_part.prepared.sessions[s].rows.iter().enumerate() {
                let place = of_part.prepared.sessions[s].points[*at].position;
                row += places[row..].iter().position(|own| *own == place).unwrap();
                for (own, whole) in own.iter().zip(whole) {
                    count += 1;
                    apart += usize::from((own[k] - whole[row]).abs() > NEAR);
                }
            }
        }
        assert!(
            count > 1000 && apart as f64 <= most_apart * count as f64,
            "{id}: {apart} of {count}"
        );
    }
}

#[test]
fn what_is_there_is_found_as_without_a_part() {
    let stribeck = |s: &JointState| 1.5 * (-(s.qd / 0.05).powi(2)).exp() * s.qd.signum();
    let ripple = |s: &JointState| (73.0 * s.q).sin();
    let hidden: [(&str, Torque); 2] = [("stribeck", &stribeck), ("ripple", &ripple)];
    for (id, own) in hidden {
        let (prepared, design) = bound(|s| plain(s) + own(s));
        let [with, without] = searches(&prepared, &design);
        let effect = find(id).unwrap();
        let shapes = shapes(&prepared, &design, &effect);
        let best = without.best(&effect, shapes.clone()).unwrap();
        let same = |own: &[f64]| (own[0] / best[0] - 1.0).abs() < 1e-6;
        let found = with.best(&effect, shapes.clone()).unwrap();
        assert!(same(&found), "{id}: {found:?} {best:?}");
        let found = with.best_if_any(&effect, shapes, 0.005).unwrap();
        assert!(same(&found), "{id}: {found:?} {best:?}");
    }
}

/// What is not there explains as little at the shape that the part has for best.
#[test]
fn what_is_not_there_is_nothing_with_a_part() {
    let (prepared, design) = bound(plain);
    let [with, without] = searches(&prepared, &design);
    for id in ["stribeck", "local_friction", "backlash"] {
        let effect = find(id).unwrap();
        let shapes = shapes(&prepared, &design, &effect);
        let share = |search: &Search<'_>| {
            let shape = search.best_if_any(&effect, shapes.clone(), 0.05).unwrap();
            search.all.left(&effect, &shape).share()
        };
        let (with, without) = (share(&with), share(&without));
        assert!(with < 0.05 && without < 0.05, "{id}: {with} {without}");
    }
}
