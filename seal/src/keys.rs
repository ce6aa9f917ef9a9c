//! Key pairs of hosts, written in base64 as WireGuard's are.
//!
//! One secret of 32 bytes is a host's whole identity. As an X25519 key (RFC 7748) it
//! takes part in the link's handshake; a seed derived from it is an Ed25519 key
//! (RFC 8032), which signs the host's certificate for TLS. The public key is both public
//! halves, one after the other.

use std::fmt;

use base64::{Engine, engine::general_purpose::STANDARD};
use curve25519_dalek::{
    edwards::{CompressedEdwardsY, EdwardsPoint},
    montgomery::MontgomeryPoint,
};
use sha2::{Digest, Sha256, Sha512};

/// Length of a secret and of each half of a public key \[bytes\].
pub const KEY_LENGTH: usize = 32;
/// What the seed for certificates is derived under: for that and nothing else.
const CERTIFICATE_LABEL: &[u8] = b"ferntast link certificate 1";
/// Characters of base64 that the first half determines by itself.
const SHARED_TEXT: usize = KEY_LENGTH * 8 / 6;

/// Why a text is no key.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum KeyError {
    /// Not base64.
    #[error("a key is one word of base64, and this is none")]
    Base64,
    /// A private key that is shorter or longer.
    #[error("a private key has {KEY_LENGTH} bytes (44 characters of base64), this has {found}")]
    PrivateLength {
        /// Bytes found.
        found: usize,
    },
    /// A public key that is shorter or longer.
    #[error(
        "a host's public key has 64 bytes (88 characters of base64), this has {found}: \
         take the whole line that 'ferntast link keys show' says on the other host"
    )]
    Length {
        /// Bytes found.
        found: usize,
    },
    /// A key that gives every peer the same secret (RFC 7748, section 6.1), or no point.
    #[error("this is no public key of a host: it would let everybody in")]
    Weak,
}

fn decoded(text: &str) -> Result<Vec<u8>, KeyError> {
    STANDARD.decode(text.trim()).map_err(|_| KeyError::Base64)
}

/// What a host keeps to itself.
#[derive(Clone, PartialEq, Eq)]
pub struct PrivateKey([u8; KEY_LENGTH]);

impl PrivateKey {
    /// The key of 32 random bytes.
    pub fn from_random(random: [u8; KEY_LENGTH]) -> PrivateKey {
        PrivateKey(random)
    }

    /// Reads what [`to_text`](Self::to_text) wrote.
    ///
    /// # Errors
    ///
    /// [`KeyError`].
    pub fn from_text(text: &str) -> Result<PrivateKey, KeyError> {
        let bytes = decoded(text)?;
        let found = bytes.len();
        let bytes = bytes.try_into();
        bytes
            .map(PrivateKey)
            .map_err(|_| KeyError::PrivateLength { found })
    }

    /// In base64. A secret.
    pub fn to_text(&self) -> String {
        STANDARD.encode(self.0)
    }

    /// What others may know of it.
    pub fn public(&self) -> PublicKey {
        let exchange = MontgomeryPoint::mul_base_clamped(self.0).to_bytes();
        // RFC 8032, section 5.1.5.
        let hash = Sha512::digest(self.certificate_seed());
        let scalar = std::array::from_fn(|at| hash[at]);
        let certificate = EdwardsPoint::mul_base_clamped(scalar).compress().to_bytes();
        PublicKey {
            exchange: ExchangeKey(exchange),
            certificate,
        }
    }

    /// Seed of the Ed25519 key that signs this host's certificate. A secret; what it is
    /// derived from cannot be had from it.
    pub fn certificate_seed(&self) -> [u8; KEY_LENGTH] {
        let hash = Sha256::new_with_prefix(CERTIFICATE_LABEL).chain_update(self.0);
        hash.finalize().into()
    }

    pub(crate) fn bytes(&self) -> &[u8; KEY_LENGTH] {
        &self.0
    }
}

impl fmt::Debug for PrivateKey {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "PrivateKey(of {})", self.public())
    }
}

/// The half of a public key that the handshake proves.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct ExchangeKey([u8; KEY_LENGTH]);

impl ExchangeKey {
    pub(crate) fn from_bytes(bytes: [u8; KEY_LENGTH]) -> ExchangeKey {
        ExchangeKey(bytes)
    }

    pub(crate) fn bytes(&self) -> &[u8; KEY_LENGTH] {
        &self.0
    }
}

/// As far as the text of the whole key is the same.
impl fmt::Display for ExchangeKey {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = STANDARD.encode(self.0);
        formatter.write_str(text.get(..SHARED_TEXT).unwrap_or(&text))
    }
}

impl fmt::Debug for ExchangeKey {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "ExchangeKey({self})")
    }
}

/// By which others know a host.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct PublicKey {
    exchange: ExchangeKey,
    certificate: [u8; KEY_LENGTH],
}

impl PublicKey {
    /// Reads what was written as text.
    ///
    /// # Errors
    ///
    /// [`KeyError`].
    pub fn from_text(text: &str) -> Result<PublicKey, KeyError> {
        let bytes = decoded(text)?;
        let found = bytes.len();
        let bytes: [u8; 2 * KEY_LENGTH] =
            bytes.try_into().map_err(|_| KeyError::Length { found })?;
        let exchange: [u8; KEY_LENGTH] = std::array::from_fn(|at| bytes[at]);
        let certificate = std::array::from_fn(|at| bytes[KEY_LENGTH + at]);
        // A point of small order: the secret with it is zero, whoever asks.
        let secret = MontgomeryPoint(exchange).mul_clamped([1; KEY_LENGTH]);
        let point = CompressedEdwardsY(certificate).decompress();
        let strong = secret.to_bytes() != [0; KEY_LENGTH]
            && point.is_some_and(|point| !point.is_small_order());
        match strong {
            true => Ok(PublicKey {
                exchange: ExchangeKey(exchange),
                certificate,
            }),
            false => Err(KeyError::Weak),
        }
    }

    /// The half that the handshake proves.
    pub fn exchange(&self) -> ExchangeKey {
        self.exchange
    }

    /// The half that the host's certificate is signed with, an Ed25519 key.
    pub fn certificate(&self) -> [u8; KEY_LENGTH] {
        self.certificate
    }
}

impl fmt::Display for PublicKey {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let bytes = [*self.exchange.bytes(), self.certificate].concat();
        formatter.write_str(&STANDARD.encode(bytes))
    }
}

impl fmt::Debug for PublicKey {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "PublicKey({self})")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hex(text: &str) -> [u8; 32] {
        std::array::from_fn(|at| u8::from_str_radix(&text[2 * at..2 * at + 2], 16).unwrap())
    }

    /// RFC 7748, section 6.1: Bob's keys.
    #[test]
    fn the_public_key_is_that_of_rfc_7748() {
        let private = hex("5dab087e624a8a4b79e17f8b83800ee66f3bb1292618b6fd1c2f8b27ff88e0eb");
        let public = hex("de9edb7d7b7dc1b4d35b61c2ece435373f8343c85b78674dadfc7e146f882b4f");
        let key = PrivateKey::from_random(private).public();
        assert_eq!(key.exchange().bytes(), &public);
    }

    /// By an implementation of its own of RFC 8032, which has that document's first vector.
    #[test]
    fn the_key_of_certificates_is_that_of_rfc_8032() {
        let key = PrivateKey::from_random([7; 32]);
        let seed = hex("0d0c2adcc0b6fbf9c343f16b51bde0aa42dc81a3a82539e1c112cd7b411b85a5");
        let public = hex("68acb0d64fc24ec71b8a819157d2f28353e9ff8f4b9fa995e779e43d55fbb0bf");
        assert_eq!(key.certificate_seed(), seed);
        assert_eq!(key.public().certificate(), public);
    }

    #[test]
    fn the_seed_for_certificates_is_another_secret() {
        let keys = [7, 8].map(|byte| PrivateKey::from_random([byte; 32]));
        let seeds = keys.each_ref().map(PrivateKey::certificate_seed);
        assert_ne!(seeds[0], seeds[1]);
        assert_ne!(&seeds[0], keys[0].bytes());
        assert_ne!(
            keys[0].public().certificate(),
            keys[1].public().certificate()
        );
    }

    #[test]
    fn keys_are_read_as_they_are_written() {
        let private = PrivateKey::from_random([7; 32]);
        assert_eq!(
            PrivateKey::from_text(&private.to_text()),
            Ok(private.clone())
        );
        let public = private.public();
        let text = format!("  {public}\n");
        assert_eq!(text.trim().len(), 88);
        assert_eq!(PublicKey::from_text(&text), Ok(public));
        assert!(text.trim().starts_with(&public.exchange().to_string()));
        assert!(!format!("{private:?}").contains(&private.to_text()));
    }

    #[test]
    fn what_is_no_key_is_refused() {
        assert_eq!(PublicKey::from_text("no key!"), Err(KeyError::Base64));
        let half = STANDARD.encode([9; 32]);
        let error = PublicKey::from_text(&half).unwrap_err();
        assert_eq!(error, KeyError::Length { found: 32 });
        assert!(error.to_string().contains("ferntast link keys show"));
        assert_eq!(
            PrivateKey::from_text("AAAA"),
            Err(KeyError::PrivateLength { found: 3 })
        );
        let public = PrivateKey::from_random([7; 32]).public();
        let text = |exchange: [u8; 32], certificate: [u8; 32]| {
            STANDARD.encode([exchange, certificate].concat())
        };
        // The neutral element of the Edwards curve.
        let neutral = std::array::from_fn(|at| u8::from(at == 0));
        for weak in [
            text([0; 32], public.certificate()),
            text(*public.exchange().bytes(), neutral),
        ] {
            assert_eq!(PublicKey::from_text(&weak), Err(KeyError::Weak));
        }
    }
}
