//! Who may be at the other end of the link, as Zenoh is told it: TLS (within QUIC) with
//! certificates at both ends, and a list of what a peer may do.
//!
//! Nobody signs certificates but the hosts themselves. An end signs its own with its key
//! at every start, and makes of each public key that it knows an anchor of trust: of that
//! the verifier takes name and key, whoever signed it. Certificates are good for all
//! times, since clocks need not agree and the keys say who is known.
//!
//! A connecting end of Zenoh also trusts the usual authorities of the web. The name in
//! the certificate, without which nothing is allowed, is one that none of those gives.

use std::fmt;

use base64::{Engine, engine::general_purpose::STANDARD};
use rcgen::{
    BasicConstraints, CertificateParams, DistinguishedName, DnType, IsCa, Issuer, KeyPair,
    PKCS_ED25519, PublicKeyData, SignatureAlgorithm,
};
use serde_json::{Value, json};

/// Before the 32 bytes of a seed it is a private key in PKCS #8 (RFC 8410, section 7).
const PKCS_8: [u8; 16] = [
    0x30, 0x2e, 0x02, 0x01, 0x00, 0x30, 0x05, 0x06, 0x03, 0x2b, 0x65, 0x70, 0x04, 0x22, 0x04, 0x20,
];

/// Whom an end trusts, and by what it is known.
#[derive(Clone, PartialEq, Eq)]
pub struct LinkTls {
    /// Seed of this end's Ed25519 key. A secret.
    pub seed: [u8; 32],
    /// Ed25519 keys of the hosts that may be at the other end.
    pub known: Vec<[u8; 32]>,
}

impl fmt::Debug for LinkTls {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let known: Vec<String> = self.known.iter().map(|own| name(own)).collect();
        f.debug_struct("LinkTls")
            .field("known", &known)
            .finish_non_exhaustive()
    }
}

/// A public key that is not ours.
struct Known<'a>(&'a [u8; 32]);

impl PublicKeyData for Known<'_> {
    fn der_bytes(&self) -> &[u8] {
        self.0
    }

    fn algorithm(&self) -> &'static SignatureAlgorithm {
        &PKCS_ED25519
    }
}

/// Zenoh's settings of TLS, under `transport/link/tls`.
pub(super) fn settings(tls: &LinkTls) -> Result<Value, rcgen::Error> {
    let own = KeyPair::try_from(&[&PKCS_8[..], &tls.seed].concat()[..])?;
    let of_own = certificate_of(own.der_bytes());
    let issuer = Issuer::from_params(&of_own, &own);
    let certificate = STANDARD.encode(of_own.signed_by(&own, &issuer)?.pem());
    let private_key = STANDARD.encode(own.serialize_pem());
    let mut anchors = String::new();
    for key in &tls.known {
        let mut anchor = certificate_of(key);
        anchor.is_ca = IsCa::Ca(BasicConstraints::Constrained(0));
        anchors += &anchor.signed_by(&Known(key), &issuer)?.pem();
    }
    Ok(json!({
        "root_ca_certificate_base64": STANDARD.encode(anchors),
        "listen_certificate_base64": certificate,
        "listen_private_key_base64": private_key,
        "connect_certificate_base64": certificate,
        "connect_private_key_base64": private_key,
        "enable_mtls": true,
        // Names and addresses of hosts change; the key says who it is.
        "verify_name_on_connect": false,
        "close_link_on_expiration": false,
    }))
}

/// Zenoh's access control: frames go the two ways they go, and nothing else does.
/// With `tls` only peers whose certificate bears the name of a known key may send any.
pub(super) fn access(tls: Option<&LinkTls>, sends: &str, receives: &str) -> Value {
    let rule = |id: &str, message: &str, flow: &str, key: &str| {
        json!({
            "id": id,
            "messages": [message],
            "flows": [flow],
            "permission": "allow",
            "key_exprs": [key],
        })
    };
    let mut peer = json!({"id": "peer"});
    if let Some(tls) = tls {
        let names: Vec<String> = tls.known.iter().map(|own| name(own)).collect();
        peer["cert_common_names"] = json!(names);
    }
    json!({
        "enabled": true,
        "default_permission": "deny",
        "rules": [
            rule("receive", "put", "ingress", receives),
            rule("ask for frames", "declare_subscriber", "egress", receives),
            rule("send", "put", "egress", sends),
            rule("be asked for frames", "declare_subscriber", "ingress", sends),
        ],
        "subjects": [peer],
        "policies": [{
            "rules": ["receive", "ask for frames", "send", "be asked for frames"],
            "subjects": ["peer"],
        }],
    })
}

/// The name in the certificate of a key. With its space it is no name of a server, for
/// which authorities of the web give certificates.
fn name(key: &[u8]) -> String {
    format!("ferntast {}", STANDARD.encode(key))
}

/// What the certificate of a key says.
fn certificate_of(key: &[u8]) -> CertificateParams {
    let mut subject = DistinguishedName::new();
    subject.push(DnType::CommonName, name(key));
    let mut certificate = CertificateParams::default();
    certificate.distinguished_name = subject;
    certificate.not_before = rcgen::date_time_ymd(1975, 1, 1);
    certificate.not_after = rcgen::date_time_ymd(4096, 1, 1);
    certificate
}
