//! Both joints have more friction than is believed: what their twins found and the servo takes
//! over, judged by what tip and hand do in a session in lockstep whose friction is as believed.

use crate::common::{heard, scenario, session, with_twins, worn_at};
use ferntast_bus::Subscriber;
use ferntast_config::Loaded;
use ferntast_msgs::{
    sample::{ContactStateSample, FrictionCommand, PoseSample, WrenchSample},
    topics,
};
use ferntast_nodes::lockstep::LockstepSession;

/// The hand is quicker than its script: what friction does at higher speeds a twin has to see.
const SHARE: f64 = 0.6;
/// Length of the script then \[s\].
const PERIOD: f64 = SHARE * 19.0;
/// Periods in which the twins learn, then one in which the servo takes over.
const LEARN: usize = 3;

/// What tip and hand did in a period of the script.
struct Told {
    /// RMS of the tip's command less the tip \[m\], free and in contact.
    free: f64,
    contact: f64,
    /// The force in the hand at each millisecond \[N\].
    hand: Vec<[f64; 3]>,
}

impl Told {
    /// RMS of the force in the hand less that in another session \[N\].
    fn beside(&self, other: &Told) -> f64 {
        let pairs = self.hand.iter().zip(&other.hand);
        let squares = pairs.map(|(own, other)| {
            let each = own.iter().zip(other).map(|(a, b)| (a - b).powi(2));
            each.sum::<f64>()
        });
        (squares.sum::<f64>() / self.hand.len() as f64).sqrt()
    }
}

struct Watched {
    session: LockstepSession,
    command: Subscriber<PoseSample>,
    tip: Subscriber<PoseSample>,
    contact: Subscriber<ContactStateSample>,
    hand: Subscriber<WrenchSample>,
}

impl Watched {
    fn new(session: LockstepSession) -> Watched {
        Watched {
            command: heard(&session, topics::FOLLOWER_SERVO_CP),
            tip: heard(&session, topics::FOLLOWER_MEASURED_CP),
            contact: heard(&session, topics::FOLLOWER_CONTACT_STATE),
            hand: heard(&session, topics::LEADER_SERVO_CF),
            session,
        }
    }

    /// Runs a period of the script.
    fn period(&mut self) -> Told {
        let (mut sums, mut hand) = ([(0.0, 0.0); 2], Vec::new());
        let mut command: Option<PoseSample> = None;
        for _ in 0..(PERIOD * 10.0).round() as usize {
            self.session.run(0.1);
            let now = self.session.now();
            while let (Some(tip), Some(state)) = (self.tip.next(now), self.contact.next(now)) {
                while let Some(own) = self.command.next(tip.received) {
                    command = Some(own.message);
                }
                let Some(command) = command else {
                    continue;
                };
                let pairs = command.position.iter().zip(tip.message.position);
                let apart: f64 = pairs.map(|(a, b)| (a - b).powi(2)).sum();
                let (sum, count) = &mut sums[usize::from(state.message.in_contact)];
                *sum += apart;
                *count += 1.0;
            }
            while let Some(own) = self.hand.next(now) {
                hand.push(own.message.force);
            }
        }
        let rms = |(sum, count): (f64, f64)| (sum / count).sqrt();
        Told {
            free: rms(sums[0]),
            contact: rms(sums[1]),
            hand,
        }
    }
}

fn quick(seed: u64) -> Loaded {
    let mut loaded = scenario(seed, false);
    let hand = loaded.scenario.hand.scripted.as_mut().expect("a script");
    for phase in &mut hand.script.phase {
        phase.duration *= SHARE;
    }
    loaded.complete().expect("a session in lockstep");
    loaded
}

fn told(session: LockstepSession, take_over: bool) -> Told {
    let mut own = Watched::new(session);
    for _ in 0..LEARN {
        own.period();
    }
    if take_over {
        own.session
            .command_friction_at(0.0, FrictionCommand::TAKE_OVER)
            .expect("a topic");
    }
    own.period();
    if take_over {
        for friction in own.session.monitor().friction() {
            println!("{friction}");
            assert_eq!(friction.source, "twin", "{friction}");
            assert_eq!(friction.refused, None, "{friction}");
        }
    }
    own.period()
}

#[test]
fn what_both_twins_found_makes_tip_and_hand_as_with_the_true_friction() {
    let as_believed = quick(5);
    let mut loaded = as_believed.clone();
    for joint in 0..2 {
        worn_at(&mut loaded, joint, 1.3);
    }
    let truth = told(session(&as_believed, None, Vec::new()), false);
    let other = told(session(&quick(6), None, Vec::new()), false);
    let before = told(session(&loaded, None, Vec::new()), false);
    let twins = with_twins(&loaded, &scenario(3, true), &[0, 1]);
    let after = told(twins, true);
    for (what, own) in [
        ("as believed", &truth),
        ("other noise", &other),
        ("30 % more", &before),
        ("taken over", &after),
    ] {
        println!(
            "{what}: tip off by {:.2} mm free, {:.2} mm in contact; hand off by {:.3} N",
            1e3 * own.free,
            1e3 * own.contact,
            own.beside(&truth)
        );
    }
    assert!(
        before.free > 1.5 * truth.free,
        "{} {}",
        before.free,
        truth.free
    );
    assert!(
        after.free < 1.15 * truth.free,
        "{} {}",
        after.free,
        truth.free
    );
    assert!(
        after.contact < 1.15 * truth.contact,
        "{} {}",
        after.contact,
        truth.contact
    );
    let noise = other.beside(&truth);
    let (before, after) = (before.beside(&truth), after.beside(&truth));
    assert!((0.001..0.03).contains(&noise), "{noise} N by noise alone");
    assert!((0.15..0.40).contains(&before), "{before} N");
    // What is left is of the dry edge, along which the tip creeps: what holds a joint that hardly
    // turns is not fed forward. On the lubricated one it is a tenth of what it was.
    assert!(after < 0.6 * before, "{after} N, {before} N before");
}
