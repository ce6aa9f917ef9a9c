//! A stranger on the link of a session, who got hold of a certificate for TLS and has no
//! keys of frames: hears what the arm's end says, then floods it with that, reflected,
//! damaged and forged. `intruder SESSION ENDPOINT SECONDS RATE`, with the private key that
//! the certificate is of in `INTRUDER_KEY`; says as JSON what it sent.

use std::{
    thread,
    time::{Duration, Instant},
};

use ferntast_tests::{Stranger, certificate_of};

/// Frames that are sent between two looks at the time.
const ROUND: usize = 256;
/// How long it listens before it speaks.
const LISTENS: Duration = Duration::from_secs(2);

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, session, endpoint, seconds, rate] = &arguments[..] else {
        panic!("intruder SESSION ENDPOINT SECONDS RATE");
    };
    let seconds: f64 = seconds.parse().expect("seconds");
    let rate: f64 = rate.parse().expect("frames a second");
    let key = std::env::var("INTRUDER_KEY").expect("INTRUDER_KEY");
    let mut stranger = Stranger::new(session, endpoint, Some(certificate_of(&key)));
    thread::sleep(LISTENS);
    let mut heard = stranger.heard();
    heard.retain(|own| own.len() == 60);
    assert!(!heard.is_empty(), "nothing was heard");
    eprintln!("flood");

    let begun = Instant::now();
    let (mut sent, mut failed) = (0_usize, 0_usize);
    while begun.elapsed().as_secs_f64() < seconds {
        // As many as are due by now, and no more at once than it can look at the time between.
        let due = (begun.elapsed().as_secs_f64() * rate) as usize;
        let round = due.min(sent + ROUND);
        while sent < round {
            let mut bytes = heard[sent % heard.len()].clone();
            let length = bytes.len();
            match sent % 5 {
                0 => {}
                1 => bytes[sent % length] ^= 1 << (sent % 8),
                // A number that is yet to come.
                2 => bytes[2..6].copy_from_slice(&(1_000_000 + sent as u32).to_le_bytes()),
                // Hello: asks for a handshake.
                3 => bytes = vec![0x41],
                _ => bytes = vec![sent as u8; 1 + sent % 200],
            }
            failed += usize::from(!stranger.send(&bytes));
            sent += 1;
        }
        if sent == due {
            thread::sleep(Duration::from_micros(200));
        }
    }
    let seconds = begun.elapsed().as_secs_f64();
    println!("{{\"sent\": {sent}, \"failed\": {failed}, \"seconds\": {seconds}}}");
}
