//! A second operator, and how an end of the link is wired.

use ferntast_bus::frames::{Door, LinkDirection};
use ferntast_msgs::{
    Time,
    sample::{StateCommand, StateCommandSample},
    topics,
};
use ferntast_nodes::{
    link::LinkWire,
    process::{NodeError, SessionContext},
};

use super::{
    super::{
        fault::{Node, Side},
        host::Host,
        keys::Keys,
        kit::Kit,
        wire::WireWay,
    },
    WorldError,
};

/// A second operator's host.
pub(super) struct Other<'a> {
    host: Host<'a>,
    wire: WireWay,
    /// When it begins \[step\].
    pub(super) began: i64,
}

/// The ends of the wire for an end of the link that is started.
pub(super) fn open(
    forth: &mut WireWay,
    back: &mut WireWay,
    keys: &mut Keys,
    sends: LinkDirection,
) -> LinkWire {
    let (sender, receiver) = match sends {
        LinkDirection::Forward => (forth.sender(), back.receiver()),
        LinkDirection::Back => (back.sender(), forth.receiver()),
    };
    let secure = keys.end(sends);
    LinkWire {
        sender,
        receiver,
        secure,
        door: Door::default(),
    }
}

impl<'a> Other<'a> {
    pub(super) fn new(
        kit: &Kit,
        session: &'a SessionContext,
        start: Time,
        seed: u64,
    ) -> Result<Other<'a>, WorldError> {
        let mut host = Host::new(session, start);
        let mut wire = WireWay::new(kit.link.up.clone(), seed)?;
        let mut nowhere = WireWay::new(kit.link.down.clone(), seed)?;
        // Of a host that the arm does not know.
        let mut keys = Keys::new(session, seed, 2);
        for (node, row) in Node::ALL.into_iter().zip(&kit.rows) {
            if node.side() == Side::Operator {
                let mut open = |sends| Ok(open(&mut wire, &mut nowhere, &mut keys, sends));
                host.add(row, None, &mut open)?;
            }
        }
        Ok(Other {
            host,
            wire,
            began: i64::MAX,
        })
    }

    /// A step, whose frames go to the arm.
    pub(super) fn step(&mut self, tick: i64, forth: &mut WireWay) -> Result<(), WorldError> {
        if tick < self.began {
            return Ok(());
        }
        let now = self.host.clock.now(tick);
        if tick == self.began {
            let command = match tick % 2 {
                0 => StateCommand::ENABLE,
                _ => StateCommand::RESUME,
            };
            for word in [StateCommand::ENABLE, command] {
                let _ = self
                    .host
                    .bus()
                    .publisher(topics::LEADER_STATE_COMMAND)?
                    .publish(now.plus_nanos(-1), &StateCommandSample::new(now, word));
            }
        }
        let mut none = |_| Err(NodeError::NoLink);
        self.host.step(tick, &mut none, |_, _| {})?;
        self.wire.pass_on(forth, tick);
        Ok(())
    }
}
