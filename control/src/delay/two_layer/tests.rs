use super::*;
use crate::delay::{
    Energy, Follower, FollowerInput, Leader, LeaderInput, Motion, Packet, PositionForce, Received,
};

const DT: f64 = 1e-3;

/// Around position and force as they come.
fn law() -> TwoLayer {
    TwoLayer {
        inside: InnerLaw::PositionForce(PositionForce::default()),
        force_scale: 1.0,
        workspace_offset: [0.0; 3],
        ..TwoLayer::default()
    }
}

fn received(position: f64, force_or_speed: f64, promised: f64) -> Option<Received> {
    Some(Received {
        packet: Packet {
            valid: true,
            position: [position as f32, 0.0, 0.0],
            vector: [force_or_speed as f32, 0.0, 0.0],
            energy: [promised as f32, 0.0],
        },
        fresh: true,
        silence: 0.0,
        age: 0.0,
        round_trip: 0.0,
    })
}

fn moving(position: f64, speed: f64) -> Option<Motion> {
    Some(Motion {
        position: [position, 0.0, 0.0],
        velocity: [speed, 0.0, 0.0],
    })
}

/// A hand at the leader's end, and what goes through it.
struct Hand {
    leader: TwoLayerLeader,
    energy: Energy,
    position: f64,
    /// On the hand [N].
    force: f64,
    /// To the hand since the start [J].
    given: f64,
    steps: u32,
}

impl Hand {
    fn new() -> Hand {
        Hand {
            leader: law().leader(),
            energy: Energy::default(),
            position: 0.0,
            force: 0.0,
            given: 0.0,
            steps: 0,
        }
    }

    /// Goes on by `way` \[m\], with a speed \[m/s\] then, and so much force \[N\] asked for and
    /// energy promised \[J\].
    fn step(&mut self, way: f64, speed: f64, wanted: f64, promised: f64) {
        self.position += way;
        let work = self.force * way;
        self.energy.left += f64::max(work, 0.0);
        self.energy.entered += f64::max(-work, 0.0);
        self.given += work;
        // Sums since the start; the first one tells where they begin.
        let promised = if self.steps < 10 { 0.0 } else { promised };
        self.steps += 1;
        let step = self.leader.step(
            DT,
            &LeaderInput {
                hand: moving(self.position, speed),
                received: received(0.0, wanted, promised),
                connected: true,
            },
            self.energy,
        );
        let change = step.force[0] - self.force;
        assert!(change.abs() <= 1e-3 * law().force_rate + 1e-9, "{step:?}");
        self.force = step.force[0];
    }
}

/// A hand that is pulled along by 5 N: what it gets, with what was promised \[J\].
fn pulled(promised: f64) -> f64 {
    let mut hand = Hand::new();
    for _ in 0..2000 {
        hand.step(1e-4, 0.1, 5.0, promised);
    }
    hand.given
}

#[test]
fn a_hand_gets_what_was_promised_and_no_more() {
    let nothing = pulled(0.0);
    assert!((-0.1..=1e-6).contains(&nothing), "{nothing}");
    // 5 N over 0.2 m would be 1 J.
    let some = pulled(0.02);
    assert!((0.001..=0.02).contains(&some), "{some}");
}

/// A hand of the lightest mass that was held against 10 N, with so much promised \[J\], is let
/// go: what it gets \[J\].
fn let_go(promised: f64) -> f64 {
    let mut hand = Hand::new();
    for _ in 0..=500 {
        hand.step(0.0, 0.0, 10.0, promised);
    }
    assert!(hand.force > 5.0 || promised < 0.01, "{} N", hand.force);
    let mut speed = 0.0;
    for _ in 501..1000 {
        let pushed = speed + hand.force / law().hand_mass * DT;
        hand.step(0.5 * (speed + pushed) * DT, pushed, 10.0, promised);
        speed = pushed;
    }
    hand.given
}

#[test]
fn a_hand_that_lets_go_is_pushed_no_further_than_the_tank_pays_for() {
    for promised in [0.005, 0.02, 0.04] {
        let given = let_go(promised);
        // A step's delay overdraws a little: at most f v Δt, 10 N at 0.6 m/s.
        assert!(
            (0.3 * promised..promised + 0.006).contains(&given),
            "{given} J of {promised} J"
        );
    }
}

struct Tip {
    follower: TwoLayerFollower,
    command: f64,
    /// Of the command, along the other axis [m].
    sideways: f64,
    tip: f64,
}

impl Tip {
    fn new(credit: f64) -> Tip {
        let law = TwoLayer { credit, ..law() };
        Tip {
            follower: law.follower(),
            command: 0.0,
            sideways: 0.0,
            tip: 0.0,
        }
    }

    /// A step with the hand at `hand` \[m\] and the contact's force \[N\]; gives what was promised
    /// since the start \[J\].
    fn step(&mut self, hand: f64, force: f64) -> f64 {
        self.step_to([hand, 0.0], force)
    }

    /// The same with the hand elsewhere along the other axis, too.
    fn step_to(&mut self, [hand, sideways]: [f64; 2], force: f64) -> f64 {
        let mut heard = received(hand, 0.0, 0.0);
        if let Some(heard) = &mut heard {
            heard.packet.position[1] = sideways as f32;
        }
        let mut tip = moving(self.tip, 0.0);
        if let Some(tip) = &mut tip {
            tip.position[1] = self.sideways;
        }
        let step = self.follower.step(
            DT,
            &FollowerInput {
                tip,
                contact_force: Some([force, 0.0, 0.0]),
                received: heard,
                connected: true,
            },
            Energy::default(),
        );
        let command = step.command.expect("a command").position;
        [self.command, self.sideways] = [command[0], command[1]];
        f64::from(step.packet.energy[0])
    }
}

#[test]
fn a_free_tip_goes_as_fast_as_the_tank_pays_for_and_catches_up() {
    let mut tip = Tip::new(0.02);
    let (mut fastest, mut before, mut changed) = (0.0_f64, 0.0, 0.0_f64);
    let mut speed_before = 0.0;
    for _ in 0..4000 {
        // The hand jumps to 50 mm.
        tip.step(0.05, 0.0);
        let speed = (tip.command - before) / DT;
        fastest = fastest.max(speed);
        changed = changed.max((speed - speed_before).abs() / DT);
        (before, speed_before) = (tip.command, speed);
        tip.tip = tip.command;
    }
    // ½ · 4 kg · v² = 20 mJ at the start: 0.1 m/s; it gives all but 5 mJ away.
    assert!((0.04..=0.06).contains(&fastest), "{fastest} m/s");
    assert!((tip.command - 0.05).abs() < 1e-4, "{}", tip.command);
    assert!((0.4..1.2).contains(&changed), "{changed} m/s²");
}

#[test]
fn in_contact_an_empty_tank_lets_the_spring_go() {
    let mut tip = Tip::new(0.0);
    tip.tip = 1e-3;
    for _ in 0..1000 {
        tip.step(0.05, -5.0);
    }
    // As far as the tip, and no further.
    assert!((tip.command - tip.tip).abs() < 1e-5, "{}", tip.command);
}

#[test]
fn a_contact_that_the_estimate_no_longer_sees_is_still_near() {
    let mut tip = Tip::new(0.0);
    tip.tip = 1e-3;
    for _ in 0..1000 {
        tip.step(0.05, -5.0);
    }
    // Beside it the force is below what the estimate tells: the command does not push again.
    tip.tip = 0.5e-3;
    for _ in 0..1000 {
        tip.step(0.05, 0.0);
    }
    assert!((tip.command - tip.tip).abs() < 1e-5, "{}", tip.command);
    // Farther away nothing is near, and the tip goes on by the speed that it always may have.
    tip.tip = -0.5e-3;
    for _ in 0..50 {
        tip.step(0.05, 0.0);
    }
    let before = tip.command;
    for _ in 0..50 {
        tip.step(0.05, 0.0);
    }
    let speed = (tip.command - before) / (50.0 * DT);
    assert!((0.009..0.011).contains(&speed), "{speed} m/s");
}

#[test]
fn an_overdrawn_tank_keeps_the_tip_where_it_touches() {
    let mut tip = Tip::new(0.0);
    // The tip goes 2 mm into what pushes with 10 N, and gives out 20 mJ that nobody paid.
    for k in 0..500 {
        tip.tip = 1e-3 + if k < 200 { 1e-5 * f64::from(k) } else { 2e-3 };
        tip.step(0.05, -10.0);
    }
    let (command, mut sideways) = (tip.command, tip.sideways);
    let mut slide = |tip: &mut Tip, hand: f64, force: f64| {
        for _ in 0..200 {
            tip.step_to([hand, 0.05], force);
        }
        let way = tip.sideways - sideways;
        sideways = tip.sideways;
        way
    };
    let way = slide(&mut tip, 0.05, -10.0);
    assert!(way.abs() < 1e-9, "{way} m");
    assert!(tip.command <= command + 1e-9, "{} m", tip.command);
    // It may leave: the hand goes back.
    slide(&mut tip, -0.05, -10.0);
    assert!(
        tip.command < command - 1e-3,
        "{} of {command} m",
        tip.command
    );
    // Nothing is near there, and it goes on by the speed that it always may have.
    let here = tip.command;
    tip.tip = here;
    let way = slide(&mut tip, here, 0.0);
    assert!((1e-3..3e-3).contains(&way), "{way} m in 0.2 s");
}

/// What the tip's end has promised after a tip was pushed back by 1 mm with 10 N, `since` \[s\] after
/// contact began \[J\].
fn promised_after_push(since: f64) -> f64 {
    let mut tip = Tip::new(0.0);
    let mut promised = 0.0;
    let rest = (since / DT) as usize;
    for k in 0..rest + 200 {
        if (rest..rest + 20).contains(&k) {
            tip.tip -= 5e-5;
        }
        promised = tip.step(0.0, -10.0);
    }
    promised
}

#[test]
fn an_impact_brings_nothing_in_and_what_pushes_later_does() {
    let impact = promised_after_push(0.005);
    assert!((-1e-6..1e-3).contains(&impact), "{impact} J");
    let pushed = promised_after_push(0.3);
    assert!((9e-3..=0.0101).contains(&pushed), "{pushed} J of 10 mJ");
}

#[test]
fn in_contact_the_spring_is_wound_up_to_what_the_tank_has() {
    let mut tip = Tip::new(0.005);
    tip.tip = 1e-3;
    for _ in 0..1000 {
        tip.step(0.05, -5.0);
    }
    // ½ · 7 kN/m · d² = 5 mJ, which the end keeps for itself: 1.2 mm.
    let lead = tip.command - tip.tip;
    assert!((1.1e-3..1.3e-3).contains(&lead), "{lead} m");
}

#[test]
fn a_servo_that_does_not_take_over_finds_its_command_near_the_tip() {
    let mut tip = Tip::new(0.1);
    for _ in 0..4000 {
        tip.step(0.05, 0.0);
    }
    assert!((2.9e-3..3.1e-3).contains(&tip.command), "{}", tip.command);
}
