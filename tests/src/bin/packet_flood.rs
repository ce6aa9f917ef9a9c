//! A stranger on another host without a certificate: floods the port of the link with UDP
//! packets that QUIC has to look at. `packet_flood ADDRESS SECONDS RATE`; says as JSON what
//! it sent, and when it began.

use std::{
    net::UdpSocket,
    thread,
    time::{Duration, Instant},
};

use ferntast_tests::now;

/// Packets that are sent between two looks at the time.
const ROUND: usize = 64;
/// What a client's first packet has at least (RFC 9000, section 14.1).
const FIRST: usize = 1200;

/// Packet number `number` of the flood, by the headers of RFC 9000, section 17.
fn packet(number: usize) -> Vec<u8> {
    let word = (number as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let noise = word.to_le_bytes();
    match number % 4 {
        // Of a connection that there is not.
        0 | 1 => [&[0x40][..], &noise, &[number as u8; 60]].concat(),
        // Asks for one: version 1, identifiers of 8 and 0 bytes, no token, and nonsense.
        2 => {
            let mut first = vec![0xc3, 0, 0, 0, 1, 8];
            first.extend(noise);
            first.extend([0, 0, 0x44, 0x9e]);
            first.resize(FIRST, number as u8);
            first
        }
        // Nothing of QUIC.
        _ => noise[..1 + number % 8].to_vec(),
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, address, seconds, rate] = &arguments[..] else {
        panic!("packet_flood ADDRESS SECONDS RATE");
    };
    let seconds: f64 = seconds.parse().expect("seconds");
    let rate: f64 = rate.parse().expect("packets a second");
    let socket = UdpSocket::bind("0.0.0.0:0").expect("a port");
    socket.connect(address).expect("an address");
    let packets: Vec<Vec<u8>> = (0..1024).map(packet).collect();

    let (begun, begun_ns) = (Instant::now(), now().nanos());
    let (mut sent, mut failed) = (0_usize, 0_usize);
    while begun.elapsed().as_secs_f64() < seconds {
        let due = (begun.elapsed().as_secs_f64() * rate) as usize;
        let round = due.min(sent + ROUND);
        while sent < round {
            failed += usize::from(socket.send(&packets[sent % packets.len()]).is_err());
            sent += 1;
        }
        if sent == due {
            thread::sleep(Duration::from_micros(100));
        }
    }
    let seconds = begun.elapsed().as_secs_f64();
    println!(
        "{{\"sent\": {sent}, \"failed\": {failed}, \"seconds\": {seconds}, \"begun_ns\": {begun_ns}}}"
    );
}
