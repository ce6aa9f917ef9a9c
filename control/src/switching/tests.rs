use super::*;
use crate::delay::{Law, Motion};

const DT: f64 = 0.001;
/// One way \[steps\].
const DELAY: usize = 50;
/// Stiffness of the wall \[N/m\]; the hand is pressed 10 mm into it.
const STIFFNESS: f64 = 2000.0;

fn everything() -> Laws {
    Law::all()
        .into_iter()
        .fold(Laws::new(Law::default()), Laws::with)
}

/// Both ends, joined by a line that delays by [`DELAY`] steps; the tip is
/// where it is told to be, unless the wall is in the way.
struct Rig {
    leader: LeaderSwitch,
    follower: FollowerSwitch,
    up: Vec<Outgoing>,
    down: Vec<Outgoing>,
    tip: [f64; 3],
    offset: [f64; 3],
}

struct Seen {
    force: [f64; 3],
    command: Option<[f64; 3]>,
}

fn arrived(line: &[Outgoing]) -> Option<MarkedPacket> {
    let place = line.len().checked_sub(DELAY)?;
    line.get(place).map(|own| MarkedPacket {
        law: own.law,
        received: Received {
            packet: own.packet,
            fresh: true,
            silence: 0.0,
            age: DELAY as f64 * DT,
            round_trip: 2.0 * DELAY as f64 * DT,
        },
    })
}

impl Rig {
    fn new() -> Rig {
        let offset = Law::default().mapping().workspace_offset;
        Rig {
            leader: LeaderSwitch::new(everything()),
            follower: FollowerSwitch::new(everything()),
            up: Vec::new(),
            down: Vec::new(),
            tip: offset,
            offset,
        }
    }

    /// The hand moves 10 mm into the wall within half a second and rests there.
    fn step(&mut self) -> Seen {
        let time = self.up.len() as f64 * DT;
        let rest = Motion {
            position: [0.010 * (time / 0.5).min(1.0), 0.0, 0.0],
            velocity: [if time < 0.5 { 0.02 } else { 0.0 }, 0.0, 0.0],
        };
        let felt = self.leader.step(DT, Some(rest), arrived(&self.down), true);
        let wall = -STIFFNESS * (self.tip[0] - self.offset[0]).max(0.0);
        let tip = Motion {
            position: self.tip,
            velocity: [0.0; 3],
        };
        let contact = Some([wall, 0.0, 0.0]);
        let packet = arrived(&self.up);
        let moved = self.follower.step(DT, Some(tip), contact, packet, true);
        if let Some(command) = moved.command {
            // As a servo does: a first-order lag of 20 ms.
            self.tip = between(0.05, self.tip, command.position);
        }
        self.up.push(felt.outgoing);
        self.down.push(moved.outgoing);
        Seen {
            force: felt.force,
            command: moved.command.map(|own| own.position),
        }
    }

    fn run(&mut self, seconds: f64) -> Vec<Seen> {
        let steps = (seconds / DT).round() as usize;
        (0..steps).map(|_| self.step()).collect()
    }
}

fn largest_step(seen: &[Seen], value: impl Fn(&Seen) -> f64) -> f64 {
    seen.windows(2)
        .map(|pair| (value(&pair[1]) - value(&pair[0])).abs())
        .fold(0.0, f64::max)
}

#[test]
fn names_and_codes_belong_together_and_cover_every_law() {
    for (place, name) in NAMES.iter().enumerate() {
        assert_eq!(code(name), u8::try_from(place).ok());
    }
    assert_eq!(code("none"), None);
    for law in Law::all() {
        let code = code(law.name()).unwrap_or_else(|| panic!("{} has no code", law.name()));
        assert_eq!(everything().get(code), Some(&law));
    }
    assert_eq!(everything().get(15), None);
}

#[test]
fn both_ends_change_over_and_neither_force_nor_command_jumps() {
    for from in Law::all() {
        for to in Law::all().into_iter().filter(|to| *to != from) {
            let what = format!("{} to {}", from.name(), to.name());
            let mut rig = Rig::new();
            assert!(rig.leader.switch_to(code(from.name()).unwrap()));
            rig.run(3.0);
            assert_eq!(rig.follower.name(), from.name(), "{what}");
            let before = rig.step().force[0];
            assert!(rig.leader.switch_to(code(to.name()).unwrap()));
            let seen = rig.run(2.0);
            assert_eq!(
                (rig.leader.name(), rig.follower.name()),
                (to.name(), to.name()),
                "{what}"
            );
            assert!(!rig.leader.is_switching(), "{what}");
            // The hand rests: a jump would be the whole difference within a step,
            // 1/300 of it a step is what leading over makes.
            let after = seen.last().unwrap().force[0];
            let peak = seen
                .iter()
                .map(|own| own.force[0].abs())
                .fold(0.0, f64::max);
            let scale = before.abs().max(after.abs()).max(peak);
            let jump = largest_step(&seen, |own| own.force[0]);
            assert!(
                jump < 0.03 * scale + 1e-9,
                "{what}: {jump} N of {scale} N in a step"
            );
            let jump = largest_step(&seen, |own| own.command.map_or(f64::NAN, |at| at[0]));
            assert!(jump < 0.2e-3, "{what}: {jump} m in a step");
        }
    }
}

#[test]
fn a_wish_during_a_switch_waits_for_its_end() {
    let mut rig = Rig::new();
    rig.run(1.0);
    let codes = [code("wave").unwrap(), code("position_position").unwrap()];
    assert!(codes.into_iter().all(|code| rig.leader.switch_to(code)));
    rig.step();
    assert!(rig.leader.switch_to(codes[0]));
    rig.run(2.0);
    assert_eq!(rig.leader.name(), "wave");
    assert_eq!(rig.follower.name(), "wave");
    // Packets of three laws were sent, each law's in one piece.
    let mut order: Vec<u8> = rig.up.iter().map(|own| own.law).collect();
    order.dedup();
    assert_eq!(order, [0, codes[1], codes[0]]);
}

#[test]
fn an_unknown_law_is_refused_and_its_packets_ignored() {
    let mut rig = Rig::new();
    assert!(!rig.leader.switch_to(15));
    rig.run(1.0);
    let mut strange = arrived(&rig.up).unwrap();
    strange.law = 15;
    let moved = rig.follower.step(DT, None, None, Some(strange), true);
    assert_eq!(moved.command, None);
    assert_eq!(rig.follower.name(), "position_force");
}

#[test]
fn the_energy_of_both_laws_is_counted() {
    let mut rig = Rig::new();
    rig.run(1.0);
    let before = rig.leader.energy();
    assert!(before.entered > 0.0);
    rig.leader.switch_to(code("wave").unwrap());
    rig.run(2.0);
    assert!(rig.leader.energy().entered >= before.entered);
}
