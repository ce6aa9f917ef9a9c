//! The handshake: Noise_IK_25519_ChaChaPoly_SHA256 (The Noise Protocol Framework,
//! revision 34, section 7.5), by the crate `snow`. The operator's end begins; the
//! session's name is the prologue, so that ends of two sessions do not meet.

use rand_chacha::{
    ChaCha20Rng,
    rand_core::{RngCore, SeedableRng},
};
use snow::{
    Builder, Error, HandshakeState,
    params::{CipherChoice, DHChoice, HashChoice, NoiseParams},
    resolvers::{CryptoResolver, DefaultResolver},
    types::{Cipher, Dh, Hash, Random},
};

use crate::{
    frame::Keys,
    keys::{ExchangeKey, KEY_LENGTH, PrivateKey},
};

const PATTERN: &str = "Noise_IK_25519_ChaChaPoly_SHA256";
const PROLOGUE: &str = "ferntast link 4 ";

/// The library's primitives, with randomness from a seed.
struct Seeded([u8; 32]);

struct SeededRandom(ChaCha20Rng);

impl Random for SeededRandom {
    fn try_fill_bytes(&mut self, dest: &mut [u8]) -> Result<(), Error> {
        self.0.fill_bytes(dest);
        Ok(())
    }
}

impl CryptoResolver for Seeded {
    fn resolve_rng(&self) -> Option<Box<dyn Random>> {
        Some(Box::new(SeededRandom(ChaCha20Rng::from_seed(self.0))))
    }

    fn resolve_dh(&self, choice: &DHChoice) -> Option<Box<dyn Dh>> {
        DefaultResolver.resolve_dh(choice)
    }

    fn resolve_hash(&self, choice: &HashChoice) -> Option<Box<dyn Hash>> {
        DefaultResolver.resolve_hash(choice)
    }

    fn resolve_cipher(&self, choice: &CipherChoice) -> Option<Box<dyn Cipher>> {
        DefaultResolver.resolve_cipher(choice)
    }
}

/// A handshake under way.
pub(crate) struct Handshake(HandshakeState);

impl Handshake {
    /// Of the operator's end, which knows the other's key.
    pub fn initiator(
        own: &PrivateKey,
        peer: &ExchangeKey,
        session: &str,
        seed: [u8; 32],
    ) -> Result<Handshake, Error> {
        let prologue = [PROLOGUE, session].concat();
        let state = builder(own, &prologue, seed)?
            .remote_public_key(peer.bytes())?
            .build_initiator()?;
        Ok(Handshake(state))
    }

    /// Of the arm's end, which is told who asks.
    pub fn responder(own: &PrivateKey, session: &str, seed: [u8; 32]) -> Result<Handshake, Error> {
        let prologue = [PROLOGUE, session].concat();
        let state = builder(own, &prologue, seed)?.build_responder()?;
        Ok(Handshake(state))
    }

    /// The next message, with `payload`, into `message`.
    pub fn write(&mut self, payload: &[u8], message: &mut [u8]) -> Result<usize, Error> {
        self.0.write_message(payload, message)
    }

    /// Reads the next message; gives its payload.
    pub fn read<const N: usize>(&mut self, message: &[u8]) -> Result<[u8; N], Error> {
        // Room for whatever the longest message could hold.
        let mut payload = [0; crate::wire::LONGEST_MESSAGE];
        let length = self.0.read_message(message, &mut payload)?;
        match length == N {
            true => Ok(std::array::from_fn(|at| payload[at])),
            false => Err(Error::Input),
        }
    }

    /// Who the peer is.
    pub fn peer(&self) -> Option<ExchangeKey> {
        let bytes: [u8; KEY_LENGTH] = self.0.get_remote_static()?.try_into().ok()?;
        Some(ExchangeKey::from_bytes(bytes))
    }

    /// What frames are sealed with, once both messages have gone.
    pub fn keys(&mut self) -> Keys {
        let number = self.0.get_handshake_hash().first().copied().unwrap_or(0);
        let (forward, back) = self.0.dangerously_get_raw_split();
        match self.0.is_initiator() {
            true => Keys::new(number, &forward, &back),
            false => Keys::new(number, &back, &forward),
        }
    }
}

fn builder<'a>(
    own: &'a PrivateKey,
    prologue: &'a str,
    seed: [u8; 32],
) -> Result<Builder<'a>, Error> {
    let parameters: NoiseParams = PATTERN.parse()?;
    Builder::with_resolver(parameters, Box::new(Seeded(seed)))
        .local_private_key(own.bytes())?
        .prologue(prologue.as_bytes())
}
