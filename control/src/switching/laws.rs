//! The laws among which a session may switch.

use crate::delay::{Law, Samples};
use crate::frame::LAST_LAW_CODE;

/// The laws by their codes in frames: the place in this list. Names keep their
/// places; new ones are appended, at most to the sixteenth.
pub const NAMES: [&str; 8] = [
    "position_force",
    "position_position",
    "four_channel",
    "wave",
    "tdpa",
    "model_mediated",
    "two_layer",
    "auto",
];

const _: () = assert!(NAMES.len() <= LAST_LAW_CODE as usize + 1);

/// Code of the law of that name.
pub fn code(name: &str) -> Option<u8> {
    NAMES
        .iter()
        .position(|known| *known == name)
        .and_then(|place| u8::try_from(place).ok())
}

/// The laws of a session with their parameters, each at most once.
#[derive(Clone, Debug, PartialEq)]
pub struct Laws {
    laws: [Option<Law>; NAMES.len()],
    first: Law,
    first_code: u8,
}

impl Laws {
    /// Only `first`, the law to start with.
    pub fn new(first: Law) -> Laws {
        let laws = Laws {
            laws: [const { None }; NAMES.len()],
            // A law that is not in the list can run, but nothing can be switched.
            first_code: code(first.name()).unwrap_or(LAST_LAW_CODE),
            first: first.clone(),
        };
        laws.with(first)
    }

    /// One more, in place of one of that name.
    pub fn with(mut self, law: Law) -> Laws {
        let place = code(law.name()).and_then(|code| self.laws.get_mut(usize::from(code)));
        if let Some(place) = place {
            *place = Some(law);
        }
        self
    }

    /// The law of that code, if the session knows it.
    pub fn get(&self, code: u8) -> Option<&Law> {
        self.laws.get(usize::from(code))?.as_ref()
    }

    /// What packets of the law of that code say: the leader's, the follower's; nothing where the
    /// session does not know it.
    pub fn samples(&self, code: u8) -> [Samples; 2] {
        let first = (code == self.first_code).then_some(&self.first);
        let law = self.get(code).or(first);
        law.map(Law::samples).unwrap_or_default()
    }

    /// The law to start with, and its code.
    pub fn first(&self) -> (&Law, u8) {
        (&self.first, self.first_code)
    }
}
