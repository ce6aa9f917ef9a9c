//! What the servo feeds forward of the lab's effects, effect by effect.

use ferntast_control::servo::{
    FeedForward, FoundParameter, LeftOut, TakeOverConfig, TakeOverRefusal,
};
use ferntast_identification::Subject;
use ferntast_identification::effects::{self, Point};
use ferntast_model::friction::{self, Preset, Signal};
use ferntast_model::joint::JointParameters;

/// A feed-forward of a joint after Table 1 that takes over whatever is not absurd, and what it
/// is configured with: name in the catalogue and value.
fn willing() -> (FeedForward, Vec<(&'static str, f64)>) {
    let joint = JointParameters {
        motor_inertia: 1.2,
        gear_ratio: 160.0,
        stiffness: 4400.0,
        damping: 5.0,
        motor_constant: 10.0,
        motor_torque_limit: 150.0,
        torque_sensor_range: 120.0,
        position_lower: -1.6,
        position_upper: 2.6,
        velocity_limit: 2.0,
        friction: Preset::named("spring_2005_03_24")
            .expect("Table 1 has it")
            .parameters(),
    };
    let config = TakeOverConfig {
        torque_share: 0.95,
        ..TakeOverConfig::default()
    };
    let configured = friction::Friction::new(&joint.friction).expect("a valid joint");
    let terms = configured.terms().iter();
    let values = terms.map(|term| (term.effect.row.coefficients[0].name, term.values[0]));
    let mut own = FeedForward::new(&joint, config).expect("a valid joint");
    own.set_temperature(15.0);
    (own, values.collect())
}

/// τ_F of some effects of the lab with coefficients by name.
fn by_the_lab(ids: &[&str], shape: &[f64], values: &[(&str, f64)], point: &Point) -> f64 {
    let torque = |id: &&str| -> f64 {
        let effect = effects::find(id).expect("an effect of the catalogue");
        let mut columns = [0.0; effects::MAX_COLUMNS];
        let names = effect.row().coefficients;
        let columns = &mut columns[..names.len()];
        effect.evaluate(shape, point, &mut [0.0; 4], columns);
        let value = |name| {
            values
                .iter()
                .rev()
                .find(|(own, _)| *own == name)
                .expect("a value")
                .1
        };
        let both = names.iter().zip(columns);
        both.map(|(own, x)| *x * value(own.name)).sum()
    };
    ids.iter().map(torque).sum()
}

/// Every effect of the lab's catalogue: what is fed forward of it is what the lab
/// says of it, or it is refused with a reason.
#[test]
fn every_static_effect_of_the_lab_is_fed_forward() {
    const SHAPE: [f64; 2] = [0.3, 0.2];
    let configured_ids = [
        "coulomb",
        "load_coulomb",
        "viscous",
        "quadratic_viscous",
        "cubic_viscous",
    ];
    for effect in effects::for_subject(Subject::Joint) {
        let (row, (mut own, mut values)) = (effect.row(), willing());
        let known = values.clone();
        let new = row.coefficients.iter().map(|each| {
            let configured = known.iter().find(|(name, _)| *name == each.name);
            (
                each.name,
                configured.map_or(0.02, |(_, value)| 1.05 * value),
            )
        });
        values.extend(new);
        let shape = row.shape.iter().map(|each| each.name).zip(SHAPE);
        let told = values[known.len()..].iter().copied().chain(shape);
        let found: Vec<FoundParameter<'_>> = told
            .chain([(friction::REFERENCE_TEMPERATURE, 10.0)])
            .map(|(name, value)| FoundParameter {
                name,
                value,
                std_error: 0.0,
                excitation: 1.0,
            })
            .collect();
        let taken = own.take_over(&found);
        let refused = |why| Err(TakeOverRefusal::NothingStatic(why));
        match friction::effect(row.id) {
            None => assert_eq!(taken, refused(LeftOut::NotStatic), "{}", row.id),
            Some(law) if law.reads(Signal::Date) => {
                assert_eq!(taken, refused(LeftOut::Unknown(Signal::Date)), "{}", row.id);
            }
            Some(_) => {
                let taken = taken.unwrap_or_else(|error| panic!("{}: {error}", row.id));
                assert_eq!(
                    (taken.count, taken.left_out),
                    (row.coefficients.len(), None)
                );
                own.step(10.0);
                let mut ids = configured_ids.to_vec();
                if !row.is_sum && !ids.contains(&row.id) {
                    ids.push(row.id);
                }
                for (position, velocity, load) in [
                    (0.3, 0.02, 4.0),
                    (-0.7, 0.3, -9.0),
                    (0.31, -0.1, 1.0),
                    (1.0, -0.6, 0.0),
                ] {
                    let point = Point {
                        position,
                        velocity,
                        load,
                        temperature: 5.0,
                        ..Point::default()
                    };
                    let expected = by_the_lab(&ids, &SHAPE[..row.shape.len()], &values, &point);
                    let fed = own.torque(position, velocity, load);
                    let error = fed.sliding + fed.standing - expected;
                    assert!(
                        error.abs() < 1e-12 * expected.abs().max(1.0),
                        "{}: {error}",
                        row.id
                    );
                }
            }
        }
    }
}
