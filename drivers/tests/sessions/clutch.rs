//! The clutch in a session in lockstep: hand and arm are taken apart and together again, free and in
//! contact, and nothing that the arm is commanded jumps.

use crate::common::{heard, scenario};
use ferntast_msgs::{
    Message,
    sample::{
        ContactStateSample, JointSample, OperatingState, OperatingStateSample, PoseSample,
        StateCommand, WrenchSample,
    },
    topics::{self, Topic},
};
use ferntast_nodes::{lockstep::LockstepSession, process::SessionContext, session_graph};

/// What was heard in a millisecond.
#[derive(Clone, Copy, Default)]
struct Seen {
    hand: Option<PoseSample>,
    led: Option<PoseSample>,
    command: Option<PoseSample>,
    tip: Option<PoseSample>,
    felt: Option<WrenchSample>,
    torque: Option<JointSample>,
    contact: Option<ContactStateSample>,
    state: Option<OperatingStateSample>,
}

/// Runs for `seconds`; gives what was heard, millisecond by millisecond.
fn watch(session: &mut LockstepSession, seconds: f64) -> Vec<Seen> {
    fn newest<M: Message>(
        session: &LockstepSession,
        topic: Topic<M>,
    ) -> impl FnMut(&mut Option<M>) + use<M> {
        let mut subscriber = heard(session, topic);
        let now = session.now();
        move |place| {
            // All that is there: the time is that of the bus.
            while let Some(own) = subscriber.next(now.plus_nanos(3_600_000_000_000)) {
                *place = Some(own.message);
            }
        }
    }
    let mut hand = newest(session, topics::LEADER_MEASURED_CP);
    let mut led = newest(session, topics::LEADER_SETPOINT_CP);
    let mut command = newest(session, topics::FOLLOWER_SERVO_CP);
    let mut tip = newest(session, topics::FOLLOWER_MEASURED_CP);
    let mut felt = newest(session, topics::LEADER_SERVO_CF);
    let mut torque = newest(session, topics::FOLLOWER_SERVO_JF);
    let mut contact = newest(session, topics::FOLLOWER_CONTACT_STATE);
    let mut state = newest(session, topics::FOLLOWER_OPERATING_STATE);
    let (mut all, mut seen) = (Vec::new(), Seen::default());
    for _ in 0..(seconds * 1e3).round() as usize {
        session.run(1e-3);
        hand(&mut seen.hand);
        led(&mut seen.led);
        command(&mut seen.command);
        tip(&mut seen.tip);
        felt(&mut seen.felt);
        torque(&mut seen.torque);
        contact(&mut seen.contact);
        state(&mut seen.state);
        all.push(seen);
    }
    all
}

fn apart(a: &PoseSample, b: &PoseSample) -> f64 {
    let pairs = a.position.iter().zip(b.position);
    pairs.map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// The largest step from one millisecond to the next, of what the arm is led by, its command \[m\]
/// and its torques \[Nm\].
fn steps(all: &[Seen]) -> [f64; 3] {
    let mut most = [0.0_f64; 3];
    for pair in all.windows(2) {
        let poses = [
            (pair[0].led, pair[1].led),
            (pair[0].command, pair[1].command),
        ];
        for (place, pair) in most.iter_mut().zip(poses) {
            if let (Some(before), Some(now)) = pair {
                *place = place.max(apart(&before, &now));
            }
        }
        if let (Some(before), Some(now)) = (pair[0].torque, pair[1].torque) {
            for joint in 0..2 {
                most[2] = most[2].max((now.effort[joint] - before.effort[joint]).abs());
            }
        }
    }
    most
}

/// Takes hand and arm apart for 0.8 s, `after` a run of so many seconds, in which the tip has to
/// touch or not.
fn apart_for_a_while(after: f64, touches: bool) {
    let mut context = SessionContext::in_virtual_time(scenario(1, false));
    context.bag = None;
    let graph = session_graph(ferntast_drivers::rows());
    let mut session = LockstepSession::new(&graph, &context).expect("a session in lockstep");
    session.run(0.5);
    let before = watch(&mut session, after - 0.5);
    let contact = before.last().and_then(|own| own.contact).expect("told");
    assert_eq!(contact.in_contact == 1, touches, "at {after} s");
    let word = |session: &mut LockstepSession, word| {
        session.command_leader_at(0.0, word).expect("a topic");
    };
    word(&mut session, StateCommand::CLUTCH);
    let open = watch(&mut session, 0.8);
    word(&mut session, StateCommand::ENGAGE);
    let after = watch(&mut session, 1.0);

    // Nothing jumps that did not before.
    let [led, command, torque] = steps(&before);
    println!("steps before: {led:.6} m, {command:.6} m, {torque:.3} Nm");
    let all: Vec<Seen> = [open.as_slice(), after.as_slice()].concat();
    let [led, command, torque] = steps(&all);
    println!("with the clutch: {led:.6} m, {command:.6} m, {torque:.3} Nm");
    assert!(led < 4e-4 && command < 8e-4, "{led} m, {command} m");
    // The hand stops, to the arm, at once: what is fed forward of friction goes with its speed.
    assert!(torque < 10.0, "{torque} Nm");

    // The arm stays, and the hand, which feels nothing, does not.
    let late = &open[100..];
    let held = late[0].command.expect("a command");
    let tip = late[0].tip.expect("a tip");
    let hand = open[0].hand.expect("a hand");
    let furthest = |which: fn(&Seen) -> Option<PoseSample>, from: &PoseSample| {
        let each = late.iter().filter_map(which);
        each.map(|own| apart(&own, from)).fold(0.0, f64::max)
    };
    let moved = [
        furthest(|own| own.command, &held),
        furthest(|own| own.tip, &tip),
        furthest(|own| own.hand, &hand),
    ];
    println!("command, tip, hand while it is open: {moved:?} m");
    assert!(moved[0] < 1e-5 && moved[1] < 1e-3, "{moved:?}");
    assert!(moved[2] > 5e-3, "{moved:?}");
    assert!(
        late.iter()
            .all(|own| own.felt.is_some_and(|felt| felt.force == [0.0; 3]))
    );

    // Then it follows again, as far from the hand as they were when they were taken together.
    let way = |own: &Seen| -> [f64; 3] {
        let (hand, led) = (own.hand.expect("a hand"), own.led.expect("a hand"));
        std::array::from_fn(|axis| led.position[axis] - hand.position[axis])
    };
    let (first, last) = (way(&after[20]), way(after.last().expect("later")));
    for (first, last) in first.iter().zip(last) {
        assert!((first - last).abs() < 1e-3, "{first} m, then {last} m");
    }
    let enabled = |own: &Seen| {
        own.state
            .is_some_and(|own| own.state == OperatingState::ENABLED)
    };
    assert!(all.iter().all(enabled));
}

#[test]
fn free_the_arm_stays_while_the_hand_goes_on() {
    apart_for_a_while(1.6, false);
}

#[test]
fn in_contact_it_goes_on_pressing() {
    apart_for_a_while(6.0, true);
}
