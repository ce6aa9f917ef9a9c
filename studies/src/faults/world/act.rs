//! What goes wrong, done to the world.

use ferntast_bus::Bus;
use ferntast_msgs::{
    Text,
    sample::{Frame, LawCommandSample, LinkCommandSample, PoseSample},
    topics,
};

use super::{
    super::{
        fault::{Fault, Side, Way},
        gateway::Gateway,
        recorder::everything,
        seen::{ArmTaps, CLIENT, OperatorTaps},
        wire::WireWay,
    },
    Lasting, World, WorldError,
};

/// A client that does not hold the authority, as sources are told apart.
const STRANGER: u64 = 0xb;

impl World<'_> {
    fn lasting(&mut self, fault: Fault, ms: i64) {
        let until = self.tick + ms;
        self.lasting.push(Lasting { fault, until });
    }

    pub(super) fn begin(&mut self, fault: Fault) -> Result<(), WorldError> {
        let tick = self.tick;
        if !matches!(fault, Fault::DiskFull { .. } | Fault::Garbage { .. }) {
            self.log.disturbed = tick;
        }
        match fault {
            Fault::Crash { node } => self.host(node.side()).crash(node.name(), tick),
            Fault::Stall { node, ms } => self.host(node.side()).stall(node.name(), tick + ms),
            Fault::HostStall { side, ms } => self.host(side).stall_all(tick + ms),
            Fault::Clock {
                side,
                offset_ms,
                drift_ppm,
            } => self
                .host(side)
                .clock
                .set(tick, offset_ms * 1_000_000, drift_ppm),
            Fault::ClockJump { side, ms } => self.jump(side, ms)?,
            Fault::Loss { way, ms, .. }
            | Fault::Duplicate { way, ms, .. }
            | Fault::Reorder { way, ms, .. }
            | Fault::Jitter { way, ms, .. }
            | Fault::Blackout { way, ms }
            | Fault::BitFlip { way, ms, .. } => {
                self.way(way).suffer(fault.clone(), tick + ms);
                self.log.disturbed = tick + ms + 100;
            }
            Fault::Forge { way, count } => {
                let other = match way {
                    Way::Forth => self.back.newest_heard(),
                    Way::Back => self.forth.newest_heard(),
                };
                self.way(way).forge(count, other.as_ref());
            }
            Fault::Replay { way, ago_ms, count } => self.way(way).replay(tick, ago_ms, count),
            Fault::SecondMaster { ms } => {
                if let Some(other) = &mut self.other {
                    other.began = tick;
                }
                self.lasting(fault, ms);
            }
            Fault::SecondHand { ms } | Fault::Stranger { ms, .. } => self.lasting(fault, ms),
            Fault::Garbage {
                side,
                garbage,
                count,
            } => {
                let now = self.host(side).clock.now(tick);
                let scenario = &self.session.loaded.scenario;
                if let Some(gateways) = &mut self.gateways {
                    let place = side as usize;
                    for _ in 0..count {
                        gateways[place].garbage(now, garbage, scenario)?;
                    }
                    self.log.gateway_refusable[place] = (gateways[place].refusable(), tick);
                }
            }
            Fault::LawSwitch { law } => {
                let law = Text::new(&law);
                self.publish(Side::Operator, topics::LINK_LAW_COMMAND, |stamp| {
                    LawCommandSample { stamp, law }
                })?;
                self.log.law_switched = true;
            }
            Fault::Sensor { sensor, ms } => {
                self.mechanics.fail(Some(sensor));
                self.log.sensor_wrong = i64::MAX;
                self.lasting(fault, ms);
            }
            Fault::Word { device, word } => self.say(device, word)?,
            Fault::Channel {
                round_trip_ms,
                jitter_ms,
                loss,
            } => {
                for side in [Side::Operator, Side::Arm] {
                    self.publish(side, topics::LINK_COMMAND, |stamp| LinkCommandSample {
                        round_trip: round_trip_ms * 1e-3,
                        jitter: jitter_ms * 1e-3,
                        loss,
                        ..LinkCommandSample::initial(stamp)
                    })?;
                }
                let delay = (round_trip_ms / 2.0 + jitter_ms).ceil() as i64 + 1;
                self.log.channel_delay = self.log.channel_delay.max(delay);
                self.log.channel_loses |= loss > 0.0;
                self.log.disturbed = i64::MAX / 2;
            }
            Fault::DiskFull { ms } => {
                if let Some(recorder) = &self.recorder {
                    recorder.fill(true);
                }
                self.lasting(fault, ms);
            }
        }
        Ok(())
    }

    fn way(&mut self, way: Way) -> &mut WireWay {
        match way {
            Way::Forth => &mut self.forth,
            Way::Back => &mut self.back,
        }
    }

    /// What lasts: does what it does in a step, and ends what is over.
    pub(super) fn go_on(&mut self) -> Result<(), WorldError> {
        let tick = self.tick;
        let mut over = Vec::new();
        let mut doing = Vec::new();
        self.lasting.retain(|own| {
            let goes_on = tick < own.until;
            match goes_on {
                true => doing.push(own.fault.clone()),
                false => over.push(own.fault.clone()),
            }
            goes_on
        });
        for fault in over {
            match fault {
                Fault::Sensor { .. } => {
                    let others = self.lasting.iter();
                    let mut others = others.filter(|own| matches!(own.fault, Fault::Sensor { .. }));
                    if others.next().is_none() {
                        self.mechanics.fail(None);
                        self.log.sensor_wrong = tick;
                    }
                }
                Fault::DiskFull { .. } => {
                    if let Some(recorder) = &self.recorder {
                        recorder.fill(false);
                    }
                }
                Fault::SecondMaster { .. } => {
                    if let Some(other) = &mut self.other {
                        other.began = i64::MAX;
                    }
                }
                _ => {}
            }
        }
        for fault in doing {
            match fault {
                Fault::SecondHand { .. } if tick % 2 == 0 => {
                    // The client holds still where the hand was, as a page that
                    // takes the controls does; the other one is elsewhere.
                    let hand = self.seen.hand.unwrap_or([0.0; 3]);
                    let hand = *self.client.get_or_insert(hand);
                    let elsewhere = [hand[0] + 0.004, hand[1] - 0.004, 0.0];
                    for (source, position) in [(CLIENT, hand), (STRANGER, elsewhere)] {
                        self.publish(Side::Operator, topics::LEADER_MEASURED_CP, |now| {
                            PoseSample {
                                source,
                                ..PoseSample::at(now, Frame::LEADER_BASE, position)
                            }
                        })?;
                    }
                }
                Fault::Stranger { side, .. } if tick % 4 == 0 => {
                    let now = self.host(side).clock.now(tick);
                    let scenario = &self.session.loaded.scenario;
                    let offset = self.kit.facts.mapping.workspace_offset;
                    let tip = [offset[0] - 0.04, offset[1] + 0.03, offset[2]];
                    if let Some(gateways) = &mut self.gateways {
                        gateways[side as usize].stranger(now, tip, scenario)?;
                    }
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn jump(&mut self, side: Side, ms: i64) -> Result<(), WorldError> {
        let tick = self.tick;
        let host = self.host(side);
        host.clock.jump(ms * 1_000_000);
        if ms >= 0 {
            match side {
                Side::Operator => self.log.operator_side_stalled = tick,
                Side::Arm => self.seen.arm_side_stalled = tick,
            }
            return Ok(());
        }
        host.begin_anew(tick);
        let bus = host.bus().clone();
        let joints = self.session.joints();
        match side {
            Side::Operator => self.taps.0 = OperatorTaps::open(&bus)?,
            Side::Arm => self.taps.1 = ArmTaps::open(&bus)?,
        }
        if let Some(gateways) = &mut self.gateways {
            let scenario = &self.session.loaded.scenario;
            gateways[side as usize] = Gateway::new(&bus, scenario, joints, self.session.planted)?;
            self.log.gateway_refusable[side as usize] = (0, tick);
        }
        if let Some(recorder) = &mut self.recorder {
            recorder.replace(side as usize, &bus, &joints)?;
        }
        if let Some(digest) = &mut self.digest {
            digest.add(&bus, &joints)?;
        }
        if let Some((bag, forwarders)) = &mut self.recording {
            let to = Bus::Mcap(bag.clone());
            forwarders[side as usize] = everything(&bus, &to, &joints)?;
        }
        Ok(())
    }
}
