//! One end of the link, as far as strangers are concerned.
//!
//! ```text
//!  operator's end                      arm's end
//!      hello            ─────────▶
//!                       ◀─────────     challenge, at random, good for one handshake
//!      initiation       ─────────▶     who asks? is it known? is the challenge mine?
//!      (new keys)       ◀─────────     answer; its keys wait
//!      frames           ─────────▶     the first that fits makes them the keys in force
//! ```
//!
//! What an attacker plays again is for another challenge; the arm's end gives up
//! the keys in force only for ones that the peer has proved to have. An end that is
//! started anew, or that cannot read what comes in, gets new keys within a fraction
//! of a second and a round trip. A gap in the link changes no key.

use std::collections::VecDeque;

use rand_chacha::{
    ChaCha20Rng,
    rand_core::{RngCore, SeedableRng},
};

use crate::{
    frame::{Keys, Kind, PlainFrame, SealedFrame},
    handshake::Handshake,
    keys::{PrivateKey, PublicKey},
    refusal::{Refusal, RefusalCounts},
    wire::{
        ANSWER, CHALLENGE, Challenge, FRAME, HELLO, INITIATION, LONGEST_MESSAGE, Message, VERSION,
        VIEW, parts,
    },
};

const MILLISECOND: i64 = 1_000_000;
/// The operator's end says hello again after this \[ns\], then after twice that …
const FIRST_RETRY: i64 = 100 * MILLISECOND;
/// … and so on, up to this: longer than any round trip \[ns\].
const LAST_RETRY: i64 = 2_000 * MILLISECOND;
/// A peer that has been heard within this needs no handshake \[ns\].
const SILENCE: i64 = 100 * MILLISECOND;
/// After this much silence the operator's end asks by itself \[ns\].
const LONG_SILENCE: i64 = 1_000 * MILLISECOND;
/// Handshakes that the operator's end awaits answers to: over a long way it asks again
/// before the first answer can be there.
const MOST_ASKED: usize = 4;
/// The arm's end says that it cannot read what comes in no more often than this \[ns\].
const HINT_PERIOD: i64 = 50 * MILLISECOND;
/// The arm's end calculates for no more than one handshake in this time \[ns\]: each
/// takes some tenths of a millisecond, whoever asks.
const HANDSHAKE_PERIOD: i64 = 10 * MILLISECOND;

/// Which end.
#[derive(Clone, Debug)]
pub enum Role {
    /// The operator's: asks the arm of this key.
    Operator {
        /// The arm's.
        peer: PublicKey,
    },
    /// The arm's: obeys hosts of these keys.
    Arm {
        /// Those that may operate it.
        known: Vec<PublicKey>,
    },
}

/// A handshake that is done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Established {
    /// How many there were: one more with every start of either process.
    pub incarnation: u64,
    /// With whom.
    pub peer: PublicKey,
    /// The peer's clock ahead of this one \[ns\], as far as the handshake can tell: to
    /// half a round trip at the operator's end, to the way here at the arm's.
    pub clock_offset_ns: i64,
}

/// What came in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Received {
    /// A frame or a view of the peer, opened.
    Sealed(Kind, PlainFrame),
    /// A message of the handshake.
    Handshake,
    /// Nothing to act on.
    Refused(Refusal),
}

/// A handshake of which the operator's end awaits the answer.
struct Asked {
    handshake: Handshake,
    challenge: Challenge,
    sent_ns: i64,
}

/// Keys of which the arm's end does not know yet whether the peer has them.
struct Proposed {
    keys: Keys,
    peer: PublicKey,
    clock_offset_ns: i64,
}

/// One end.
pub struct SecureEnd {
    own: PrivateKey,
    role: Role,
    session: String,
    random: ChaCha20Rng,
    keys: Option<Keys>,
    established: Option<Established>,
    /// When a frame of the peer came last \[ns\].
    heard_ns: Option<i64>,
    to_send: Option<Message>,
    hello_due_ns: Option<i64>,
    retry_ns: i64,
    /// Handshakes that are not answered yet, oldest first.
    asked: VecDeque<Asked>,
    /// That of the arm's end, for one handshake.
    challenge: Challenge,
    proposed: Option<Proposed>,
    hint_due_ns: i64,
    handshake_due_ns: i64,
    refused: RefusalCounts,
    last_refusal: Option<Refusal>,
}

impl SecureEnd {
    /// An end of the session of that name, of the host of key `own`. `seed` is
    /// random: whoever knows it knows the session's keys.
    pub fn new(own: PrivateKey, role: Role, session: &str, seed: [u8; 32]) -> SecureEnd {
        let mut end = SecureEnd {
            own,
            role,
            session: session.to_owned(),
            random: ChaCha20Rng::from_seed(seed),
            keys: None,
            established: None,
            heard_ns: None,
            to_send: None,
            hello_due_ns: None,
            retry_ns: FIRST_RETRY,
            asked: VecDeque::with_capacity(MOST_ASKED),
            challenge: [0; 8],
            proposed: None,
            hint_due_ns: i64::MIN,
            handshake_due_ns: i64::MIN,
            refused: RefusalCounts::default(),
            last_refusal: None,
        };
        end.random.fill_bytes(&mut end.challenge);
        end
    }

    /// The handshake in force, if there was one.
    pub fn established(&self) -> Option<Established> {
        self.established
    }

    /// What was not acted on since the start.
    pub fn refused(&self) -> RefusalCounts {
        self.refused
    }

    /// Why the newest of that was not.
    pub fn last_refusal(&self) -> Option<Refusal> {
        self.last_refusal
    }

    /// The message of the handshake to send at `now_ns`, if one is due.
    pub fn message(&mut self, now_ns: i64) -> Option<Message> {
        // Asked first: a message is long, and there nearly always is none.
        if self.to_send.is_some() {
            return self.to_send.take();
        }
        if matches!(self.role, Role::Arm { .. }) || !self.wants_keys(now_ns, LONG_SILENCE) {
            self.hello_due_ns = None;
            self.retry_ns = FIRST_RETRY;
            return None;
        }
        if self
            .hello_due_ns
            .is_some_and(|due_ns| !is_due(due_ns, now_ns, LAST_RETRY))
        {
            return None;
        }
        self.hello_due_ns = Some(now_ns.saturating_add(self.retry_ns));
        self.retry_ns = (2 * self.retry_ns).min(LAST_RETRY);
        Some(Message::of(HELLO))
    }

    /// Whether nobody was heard for so long.
    fn is_alone(&self, now_ns: i64, patience_ns: i64) -> bool {
        self.heard_ns.is_none_or(|heard_ns| {
            is_due(heard_ns.saturating_add(patience_ns), now_ns, patience_ns)
        })
    }

    /// Whether there are no keys, or none that still serve.
    fn wants_keys(&self, now_ns: i64, patience_ns: i64) -> bool {
        self.is_alone(now_ns, patience_ns) || self.keys.as_ref().is_none_or(Keys::is_worn)
    }

    /// Seals one of that kind and of a length that it has; `None` before the first handshake.
    pub fn seal(&mut self, kind: Kind, plain: &[u8]) -> Option<SealedFrame> {
        self.keys.as_mut()?.seal(kind, plain)
    }

    /// Bytes came in at `now_ns`.
    pub fn received(&mut self, bytes: &[u8], now_ns: i64) -> Received {
        self.take(bytes, now_ns).unwrap_or_else(|refusal| {
            self.refused.count(&refusal);
            self.last_refusal = Some(refusal);
            Received::Refused(refusal)
        })
    }

    fn take(&mut self, bytes: &[u8], now_ns: i64) -> Result<Received, Refusal> {
        let found = bytes.len();
        let &first = bytes.first().ok_or(Refusal::Length { found })?;
        if found > LONGEST_MESSAGE {
            return Err(Refusal::Length { found });
        }
        if first >> 4 != VERSION {
            return Err(Refusal::Version { found: first >> 4 });
        }
        let arm = matches!(self.role, Role::Arm { .. });
        match (first & 0x0f, arm) {
            (FRAME, _) => return self.sealed(Kind::Frame, bytes, now_ns),
            (VIEW, false) => return self.sealed(Kind::View, bytes, now_ns),
            (HELLO, true) if found == 1 => self.challenge(),
            (HELLO, true) => return Err(Refusal::Length { found }),
            (CHALLENGE, false) => self.challenged(bytes, now_ns)?,
            (INITIATION, true) => self.asked(bytes, now_ns)?,
            (ANSWER, false) => self.answered(bytes, now_ns)?,
            _ => return Err(Refusal::WrongSide),
        }
        Ok(Received::Handshake)
    }

    fn sealed(&mut self, kind: Kind, bytes: &[u8], now_ns: i64) -> Result<Received, Refusal> {
        let found = bytes.len();
        if !kind.has_length(found) {
            return Err(Refusal::Length { found });
        }
        let plain = self.open(kind, bytes, now_ns)?;
        Ok(Received::Sealed(kind, plain))
    }

    fn open(&mut self, kind: Kind, sealed: &[u8], now_ns: i64) -> Result<PlainFrame, Refusal> {
        let number = sealed.get(1).copied().unwrap_or_default();
        let mut opened = match &mut self.keys {
            Some(keys) if keys.number == number => keys.open(kind, sealed),
            _ => Err(Refusal::UnknownKey),
        };
        let unread = matches!(opened, Err(Refusal::UnknownKey | Refusal::Forged));
        let fits = |own: &mut Proposed| unread && own.keys.number == number;
        if let Some(mut proposed) = self.proposed.take_if(fits) {
            opened = proposed.keys.open(kind, sealed);
            match opened {
                Ok(_) => self.establish(proposed),
                Err(_) => self.proposed = Some(proposed),
            }
        }
        match opened {
            Ok(_) => self.heard_ns = Some(now_ns),
            Err(Refusal::UnknownKey) => self.hint(now_ns),
            Err(_) => {}
        }
        opened
    }

    /// The arm's end cannot read a peer that takes it for another one.
    fn hint(&mut self, now_ns: i64) {
        let arm = matches!(self.role, Role::Arm { .. });
        if arm && is_due(self.hint_due_ns, now_ns, HINT_PERIOD) {
            self.hint_due_ns = now_ns.saturating_add(HINT_PERIOD);
            self.challenge();
        }
    }

    /// Says the challenge next, unless there is an answer to be given first.
    fn challenge(&mut self) {
        let message = Message::with_challenge(CHALLENGE, &self.challenge);
        self.to_send.get_or_insert(message);
    }

    fn establish(&mut self, proposed: Proposed) {
        let before = self.established.map_or(0, |own| own.incarnation);
        self.keys = Some(proposed.keys);
        self.established = Some(Established {
            incarnation: before + 1,
            peer: proposed.peer,
            clock_offset_ns: proposed.clock_offset_ns,
        });
    }

    /// The operator's end: the other one asks to be proved something.
    fn challenged(&mut self, bytes: &[u8], now_ns: i64) -> Result<(), Refusal> {
        let found = bytes.len();
        let (challenge, []) = parts(bytes).ok_or(Refusal::Length { found })? else {
            return Err(Refusal::Length { found });
        };
        let Role::Operator { peer } = self.role else {
            return Err(Refusal::WrongSide);
        };
        let under_way = self.asked.back().is_some_and(|own| {
            let soon_ns = own.sent_ns.saturating_add(FIRST_RETRY / 2);
            own.challenge == challenge && !is_due(soon_ns, now_ns, FIRST_RETRY / 2)
        });
        if under_way || !self.wants_keys(now_ns, SILENCE) {
            return Ok(());
        }
        let seed = self.seed();
        let begun = Handshake::initiator(&self.own, &peer.exchange(), &self.session, seed);
        let mut handshake = begun.map_err(|_| Refusal::Handshake)?;
        let message = Message::with_challenge(INITIATION, &challenge)
            .append(|room| handshake.write(&now_ns.to_le_bytes(), room))
            .map_err(|_| Refusal::Handshake)?;
        if self.asked.len() == MOST_ASKED {
            self.asked.pop_front();
        }
        self.asked.push_back(Asked {
            handshake,
            challenge,
            sent_ns: now_ns,
        });
        self.to_send = Some(message);
        Ok(())
    }

    /// The arm's end: somebody wants to operate it.
    fn asked(&mut self, bytes: &[u8], now_ns: i64) -> Result<(), Refusal> {
        let found = bytes.len();
        let (challenge, message) = parts(bytes).ok_or(Refusal::Length { found })?;
        // Whoever is heard keeps the arm, from strangers and from those who may have it next.
        let is_free = self.is_alone(now_ns, SILENCE);
        if !is_free && !self.keys.as_ref().is_none_or(Keys::may_be_renewed) {
            return Err(Refusal::Taken);
        }
        if challenge != self.challenge || !is_due(self.handshake_due_ns, now_ns, HANDSHAKE_PERIOD) {
            return Err(Refusal::StaleHandshake);
        }
        self.handshake_due_ns = now_ns.saturating_add(HANDSHAKE_PERIOD);
        let seed = self.seed();
        let begun = Handshake::responder(&self.own, &self.session, seed);
        let mut handshake = begun.map_err(|_| Refusal::Handshake)?;
        let sent_ns: [u8; 8] = handshake.read(message).map_err(|_| Refusal::Handshake)?;
        let asking = handshake.peer().ok_or(Refusal::Handshake)?;
        let Role::Arm { known } = &self.role else {
            return Err(Refusal::WrongSide);
        };
        let Some(&peer) = known.iter().find(|own| own.exchange() == asking) else {
            return Err(Refusal::UnknownPeer(asking));
        };
        if !is_free && self.established.is_none_or(|own| own.peer != peer) {
            return Err(Refusal::Taken);
        }
        // Received and sent within one step: one time stands for both.
        let answer = Message::with_challenge(ANSWER, &challenge)
            .append(|room| handshake.write(&now_ns.to_le_bytes(), room))
            .map_err(|_| Refusal::Handshake)?;
        // Good for one handshake; a stranger does not use it up.
        self.random.fill_bytes(&mut self.challenge);
        self.proposed = Some(Proposed {
            keys: handshake.keys(),
            peer,
            clock_offset_ns: i64::from_le_bytes(sent_ns).saturating_sub(now_ns),
        });
        self.to_send = Some(answer);
        Ok(())
    }

    /// The operator's end: the arm's has answered.
    fn answered(&mut self, bytes: &[u8], now_ns: i64) -> Result<(), Refusal> {
        let found = bytes.len();
        let (challenge, message) = parts(bytes).ok_or(Refusal::Length { found })?;
        let Role::Operator { peer } = self.role else {
            return Err(Refusal::WrongSide);
        };
        let mut refusal = Refusal::StaleHandshake;
        let mut answered = None;
        for asked in &mut self.asked {
            if asked.challenge != challenge {
                continue;
            }
            match asked.handshake.read::<8>(message) {
                Ok(there_ns) => {
                    let half_ns = asked.sent_ns.midpoint(now_ns);
                    answered = Some(Proposed {
                        keys: asked.handshake.keys(),
                        peer,
                        clock_offset_ns: i64::from_le_bytes(there_ns).saturating_sub(half_ns),
                    });
                    break;
                }
                // The true answer may still come: a stranger's ends nothing.
                Err(_) => refusal = Refusal::Handshake,
            }
        }
        self.establish(answered.ok_or(refusal)?);
        self.asked.clear();
        self.heard_ns = Some(now_ns);
        Ok(())
    }

    fn seed(&mut self) -> [u8; 32] {
        let mut seed = [0; 32];
        self.random.fill_bytes(&mut seed);
        seed
    }
}

/// Whether it is time at `now_ns` for what was set for `due_ns`, no more than
/// `most_ns` ahead: where it is further, the clock jumped back.
fn is_due(due_ns: i64, now_ns: i64, most_ns: i64) -> bool {
    now_ns >= due_ns || due_ns.saturating_sub(now_ns) > most_ns
}

#[cfg(test)]
mod tests;
