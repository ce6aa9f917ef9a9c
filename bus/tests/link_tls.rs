//! The link over QUIC, within TLS: who is let in, and what a peer may do.

#![allow(missing_docs)]
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::{
    net::UdpSocket,
    process,
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use base64::{Engine, engine::general_purpose::STANDARD};
use ferntast_bus::{
    OpenError,
    frames::{LinkDirection, LinkEndpoint, LinkTls, MAX_FRAME, ZenohLink, ZenohLinkConfig},
};
use ferntast_msgs::Time;
use rcgen::{CertificateParams, DistinguishedName, DnType, Issuer, KeyPair, PublicKeyData};
use zenoh::Wait;

const OPERATOR: u8 = 1;
const ARM: u8 = 2;
const STRANGER: u8 = 3;

/// Of a host whose seed is that byte, 32 times.
fn key(host: u8) -> KeyPair {
    let mut pkcs_8 = vec![
        0x30, 0x2e, 2, 1, 0, 0x30, 5, 6, 3, 0x2b, 0x65, 0x70, 4, 0x22, 4, 0x20,
    ];
    pkcs_8.extend([host; 32]);
    KeyPair::try_from(pkcs_8).unwrap()
}

fn public(host: u8) -> [u8; 32] {
    key(host).der_bytes().try_into().unwrap()
}

fn knows(own: u8, others: &[u8]) -> LinkTls {
    LinkTls {
        seed: [own; 32],
        known: others.iter().map(|&other| public(other)).collect(),
    }
}

/// One whose port is free.
fn endpoint() -> String {
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    format!("quic/{}", socket.local_addr().unwrap())
}

fn session(name: &str) -> String {
    format!("tls_{name}_{}", process::id())
}

fn open(
    session: &str,
    endpoint: LinkEndpoint,
    sends: LinkDirection,
    tls: LinkTls,
) -> Result<ZenohLink, OpenError> {
    ZenohLink::open(ZenohLinkConfig {
        session: session.to_owned(),
        endpoint,
        sends,
        tls: Some(tls),
        clock: Arc::new(|| Time::from_nanos(42)),
    })
}

/// Whether what `from` sends comes to `to` within that time.
fn arrives(from: &mut ZenohLink, to: &mut ZenohLink, within: Duration) -> bool {
    let begun = Instant::now();
    let now = Time::from_nanos(1);
    while begun.elapsed() < within {
        from.sender.send(now, &[5; 60]).unwrap();
        thread::sleep(Duration::from_millis(2));
        if to.receiver.receive(now, &mut [0; MAX_FRAME]).is_some() {
            return true;
        }
    }
    false
}

const LONG: Duration = Duration::from_secs(20);
const SHORT: Duration = Duration::from_secs(3);

#[test]
fn frames_cross_between_hosts_that_know_each_other_and_no_others() {
    let session = session("hosts");
    let endpoint = endpoint();
    let listen = LinkEndpoint::Listen(endpoint.clone());
    let connect = |own: u8, others: &[u8]| {
        let end = LinkEndpoint::Connect(endpoint.clone());
        open(&session, end, LinkDirection::Forward, knows(own, others)).unwrap()
    };
    let tls = knows(ARM, &[ARM, OPERATOR]);
    let mut arm = open(&session, listen, LinkDirection::Back, tls).unwrap();
    // Whom the arm does not know, and who does not know the arm.
    for (own, others) in [(STRANGER, &[ARM][..]), (OPERATOR, &[STRANGER])] {
        let turned_away = arm.door.turned_away();
        let mut stranger = connect(own, others);
        assert!(!arrives(&mut stranger, &mut arm, SHORT), "{own}");
        assert!(!arrives(&mut arm, &mut stranger, SHORT), "{own}");
        assert!(arm.door.turned_away() > turned_away, "{own}");
        println!("{:?}", arm.door.last_turned_away());
    }
    let mut operator = connect(OPERATOR, &[ARM]);
    assert!(arrives(&mut operator, &mut arm, LONG));
    assert!(arrives(&mut arm, &mut operator, LONG));
    // A key that both ends share.
    let mut same = connect(ARM, &[ARM]);
    assert!(arrives(&mut same, &mut arm, LONG));
}

#[test]
fn an_end_without_key_is_refused_in_words() {
    let endpoint = LinkEndpoint::Connect("quic/10.0.0.2:7448".to_owned());
    let nobody = knows(OPERATOR, &[]);
    let error = open("x", endpoint, LinkDirection::Forward, nobody).unwrap_err();
    assert!(
        matches!(error, OpenError::NoCertificate { .. }),
        "{error:?}"
    );
    let taken = endpoint_taken();
    let listen = LinkEndpoint::Listen(format!("quic/{}", taken.local_addr().unwrap()));
    let error = open("x", listen, LinkDirection::Back, knows(ARM, &[ARM])).unwrap_err();
    assert!(matches!(error, OpenError::PortTaken { .. }), "{error:?}");
}

fn endpoint_taken() -> UdpSocket {
    UdpSocket::bind("127.0.0.1:0").unwrap()
}

/// A Zenoh session of a host, whose certificate bears a name of its choice.
fn bare(host: u8, name: &str, knows: u8, endpoint: &str) -> zenoh::Session {
    let pem = |key: &KeyPair, name: &str| {
        let mut own = CertificateParams::default();
        own.distinguished_name = DistinguishedName::new();
        own.distinguished_name.push(DnType::CommonName, name);
        let mut issuer = CertificateParams::default();
        issuer.distinguished_name = DistinguishedName::new();
        let root = format!("ferntast {}", STANDARD.encode(key.der_bytes()));
        issuer.distinguished_name.push(DnType::CommonName, root);
        let issuer = Issuer::new(issuer, key);
        STANDARD.encode(own.signed_by(key, &issuer).unwrap().pem())
    };
    let anchor = {
        let mut own = CertificateParams::default();
        own.distinguished_name = DistinguishedName::new();
        let root = format!("ferntast {}", STANDARD.encode(public(knows)));
        own.distinguished_name.push(DnType::CommonName, root);
        own.is_ca = rcgen::IsCa::Ca(rcgen::BasicConstraints::Unconstrained);
        STANDARD.encode(own.self_signed(&key(knows)).unwrap().pem())
    };
    let tls = serde_json::json!({
        "root_ca_certificate_base64": anchor,
        "connect_certificate_base64": pem(&key(host), name),
        "connect_private_key_base64": STANDARD.encode(key(host).serialize_pem()),
        "enable_mtls": true,
        "verify_name_on_connect": false,
    });
    let mut config = zenoh::Config::default();
    for (key, value) in [
        ("mode", r#""client""#),
        ("connect/endpoints", &format!(r#"["{endpoint}?rel=0"]"#)),
        ("scouting/multicast/enabled", "false"),
        ("transport/link/tls", &tls.to_string()),
    ] {
        config.insert_json5(key, value).unwrap();
    }
    zenoh::open(config).wait().unwrap()
}

#[test]
fn a_peer_may_send_frames_and_hear_frames_and_nothing_else() {
    let session = session("acl");
    let endpoint = endpoint();
    let listen = LinkEndpoint::Listen(endpoint.clone());
    let tls = knows(ARM, &[OPERATOR]);
    let mut arm = open(&session, listen, LinkDirection::Back, tls).unwrap();
    let own_name = format!("ferntast {}", STANDARD.encode(public(OPERATOR)));
    let [forward, back] = ["forward", "back"].map(|way| format!("ferntast/{session}/link/{way}"));
    // How many frames of the peer came, and how many of the arm's the peer heard that asked so.
    let mut heard = |peer: &zenoh::Session, asks: &str| {
        let own = Arc::new(AtomicUsize::new(0));
        let (count, key) = (own.clone(), back.clone());
        let _asking = peer
            .declare_subscriber(asks)
            .callback(move |sample| {
                let is_back = sample.key_expr().as_str() == key;
                count.fetch_add(usize::from(is_back), Ordering::Relaxed);
            })
            .wait()
            .unwrap();
        let now = Time::from_nanos(1);
        // What the peer before sent is not its own.
        thread::sleep(Duration::from_millis(300));
        while arm.receiver.receive(now, &mut [0; MAX_FRAME]).is_some() {}
        let begun = Instant::now();
        let mut came = 0;
        while begun.elapsed() < SHORT {
            peer.put(&forward, [5_u8; 60].as_slice()).wait().unwrap();
            arm.sender.send(now, &[6; 60]).unwrap();
            thread::sleep(Duration::from_millis(5));
            let one = arm.receiver.receive(now, &mut [0; MAX_FRAME]);
            came += usize::from(one.is_some());
        }
        (came, own.load(Ordering::Relaxed))
    };
    // Its certificate is one of the operator's key, under the name of that.
    let peer = bare(OPERATOR, &own_name, ARM, &endpoint);
    let (came, own) = heard(&peer, &format!("ferntast/{session}/**"));
    assert!(came > 100 && own == 0, "{came} {own}");
    let (came, own) = heard(&peer, &back);
    assert!(came > 100 && own > 100, "{came} {own}");
    drop(peer);
    // Another name: let in by its key, allowed nothing.
    let peer = bare(OPERATOR, "arm.example.org", ARM, &endpoint);
    assert_eq!(heard(&peer, &back), (0, 0));
}
