//! What the seal costs a frame: sealed and opened, beside the same bytes with the
//! check that frames had before, a CRC-32, in one run.

use std::{hint::black_box, time::Instant};

use ferntast_seal::{Kind, PLAIN_LENGTH, PrivateKey, Received, Role, SecureEnd};

const FRAMES: usize = 200_000;

fn ends() -> (SecureEnd, SecureEnd) {
    let own = PrivateKey::from_random([1; 32]);
    let peer = own.public();
    let operator = SecureEnd::new(own.clone(), Role::Operator { peer }, "bench", [2; 32]);
    let arm = SecureEnd::new(own, Role::Arm { known: vec![peer] }, "bench", [3; 32]);
    (operator, arm)
}

fn plain(number: u32) -> [u8; PLAIN_LENGTH] {
    let mut plain = [7; PLAIN_LENGTH];
    plain[..4].copy_from_slice(&number.to_le_bytes());
    plain
}

/// Nanoseconds of each call, sorted.
fn timed(mut each: impl FnMut(u32)) -> Vec<u128> {
    let mut times: Vec<u128> = (0..FRAMES as u32)
        .map(|number| {
            let begun = Instant::now();
            each(number);
            begun.elapsed().as_nanos()
        })
        .collect();
    times.sort_unstable();
    times
}

fn main() {
    let (mut operator, mut arm) = ends();
    let mut now_ns = 1;
    let shaken = Instant::now();
    while arm.established().is_none() {
        now_ns += 1_000_000;
        if let Some(message) = operator.message(now_ns) {
            arm.received(message.bytes(), now_ns);
        }
        if let Some(message) = arm.message(now_ns) {
            operator.received(message.bytes(), now_ns);
        }
        if let Some(sealed) = operator.seal(Kind::Frame, &plain(u32::MAX)) {
            arm.received(&sealed, now_ns);
        }
    }
    let shaken = shaken.elapsed().as_micros();
    let sealed = timed(|number| {
        let sealed = operator.seal(Kind::Frame, &plain(number)).expect("keys");
        let opened = arm.received(black_box(&sealed), now_ns);
        assert!(matches!(opened, Received::Sealed(..)));
    });
    let forged = timed(|number| {
        let mut forged = [number as u8; 60];
        forged[0] = 0x40;
        black_box(arm.received(black_box(&forged), now_ns));
    });
    let plain = timed(|number| {
        let plain = plain(number);
        black_box(crc32fast::hash(black_box(&plain)));
        black_box(crc32fast::hash(black_box(&plain)));
    });
    println!("handshake, both ends: {shaken} µs");
    for (what, times) in [
        ("sealed and opened", sealed),
        ("forged, refused", forged),
        ("CRC-32, twice", plain),
    ] {
        let at = |share: f64| times[(share * (FRAMES - 1) as f64) as usize];
        println!(
            "{what:20} p50 {:6} ns   p99 {:6} ns   p99.9 {:6} ns",
            at(0.5),
            at(0.99),
            at(0.999)
        );
    }
}
