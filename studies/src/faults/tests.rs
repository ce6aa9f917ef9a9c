//! Bounds are near what an arm does without faults: what is far from all that happens holds whatever happens.

use ferntast_control::planted::Planted;
use ferntast_nodes::session_graph;

use super::{
    body::Speeds,
    kit::{Kit, load},
    schedule::Schedule,
    world::{Looks, World},
};

/// The largest share of its bound that something came to, over the first 2.5 s of `scenario`: the force of
/// the contact without an impact, a joint's torque, the setpoint's speed.
fn shares(scenario: &str) -> [f64; 3] {
    let graph = session_graph(ferntast_drivers::rows());
    let kit = Kit::new(&graph, &load(scenario).unwrap(), "position_force").unwrap();
    let schedule = Schedule {
        scenario: scenario.to_owned(),
        seed: 1,
        law: "position_force".to_owned(),
        length_ms: 2500,
        planted: None,
        event: Vec::new(),
    };
    let session = kit.session(1, Planted::NONE);
    let mut world = World::new(&kit, &session, None, &schedule, Looks::default()).unwrap();
    let mut shares = [0.0_f64; 3];
    for _ in 0..schedule.length_ms {
        world.step().unwrap();
        let (seen, facts) = (&world.seen, &kit.facts);
        let rest = Speeds {
            motors: 0.0,
            tip: 0.0,
            setpoint: 0.0,
        };
        let truth = &seen.truth;
        let [pressing, _] = facts.body.contact(&truth.position, truth.force, &rest);
        shares[0] = shares[0].max(truth.pressing() / pressing);
        for joint in 0..facts.torque.len() {
            let torque = seen.torque.map_or(0.0, |own| own[joint].abs());
            shares[1] = shares[1].max(torque / facts.torque[joint]);
            let speed = seen.setpoint.map_or(0.0, |(_, own)| own[joint].abs());
            shares[2] = shares[2].max(speed / facts.setpoint_speed[joint]);
        }
    }
    shares
}

#[test]
fn an_arm_comes_near_its_bounds_and_keeps_them() {
    for scenario in ["rokviss", "panda", "ur5", "xarm7"] {
        let [force, torque, speed] = shares(scenario);
        println!("{scenario}: {force:.3}, {torque:.3}, {speed:.3}");
        assert!(
            (0.1..1.0).contains(&force),
            "{scenario}: {force} of the force"
        );
        assert!(
            (0.1..1.0).contains(&torque),
            "{scenario}: {torque} of the torque"
        );
        assert!(
            (0.03..1.0).contains(&speed),
            "{scenario}: {speed} of the speed"
        );
    }
}
