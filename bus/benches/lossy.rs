//! The link's frames over a long way that loses some, by UDP and by QUIC, which slows
//! down where it sees losses: how many arrive, and how old. A relay in between delays
//! and drops packets; 500 frames a second go each way, as in a session.

mod link_pair;

use std::{
    collections::VecDeque,
    io,
    net::{SocketAddr, UdpSocket},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use ferntast_bus::frames::MAX_FRAME;
use ferntast_msgs::Time;

const PERIOD: Duration = Duration::from_millis(2);
/// Until the two have met and QUIC knows the way \[s\].
const SETTLE: f64 = 5.0;
const MEASURE: f64 = 10.0;

fn main() {
    println!(
        "{:<6} {:>9} {:>7} {:>10} {:>9} {:>9} {:>9}",
        "way", "rtt [ms]", "loss %", "arrived %", "p50 [ms]", "p99 [ms]", "max [ms]"
    );
    for (round_trip_ms, loss) in [
        (20, 0.0),
        (20, 0.05),
        (100, 0.01),
        (200, 0.01),
        (600, 0.0),
        (600, 0.01),
    ] {
        for kind in ["udp", "quic"] {
            match measured(kind, round_trip_ms, loss) {
                Ok((arrived, [p50, p99, max])) => println!(
                    "{kind:<6} {round_trip_ms:>9} {:>7} {:>10.2} {p50:>9.1} {p99:>9.1} {max:>9.1}",
                    loss * 100.0,
                    arrived * 100.0
                ),
                Err(error) => println!("{kind:<6} {round_trip_ms:>9} {:>7}  {error}", loss * 100.0),
            }
        }
    }
}

/// Share of frames that arrived, and how old they were \[ms\].
fn measured(kind: &str, round_trip_ms: u64, loss: f64) -> Result<(f64, [f64; 3]), String> {
    let failed = |error: io::Error| error.to_string();
    let arm = UdpSocket::bind("127.0.0.1:0").and_then(|own| own.local_addr());
    let arm = arm.map_err(failed)?;
    let done = Arc::new(AtomicBool::new(false));
    let relay = relay(arm, round_trip_ms, loss, done.clone()).map_err(failed)?;

    let start = Instant::now();
    let clock = move || Time::from_nanos(1 + start.elapsed().as_nanos() as i64);
    let [mut there, mut here] =
        link_pair::open(format!("{kind}/{arm}"), format!("{kind}/{relay}"), clock)?;

    let mut ages = Vec::new();
    let mut sent = 0_usize;
    let mut due = Instant::now();
    let mut buffer = [0; MAX_FRAME];
    let begin = clock().seconds_since(Time::from_nanos(0)) + SETTLE;
    loop {
        let now = clock();
        let at = now.seconds_since(Time::from_nanos(0)) - begin;
        // What was sent at the end has time to arrive.
        if at > MEASURE + 3.0 {
            break;
        }
        let mut frame = [0; 60];
        frame[..8].copy_from_slice(&now.nanos().to_le_bytes());
        let told = |error: ferntast_bus::SendError| error.to_string();
        here.sender.send(now, &frame).map_err(told)?;
        there.sender.send(now, &frame).map_err(told)?;
        sent += usize::from((0.0..MEASURE).contains(&at));
        while let Some((_, arrived)) = there.receiver.receive(now, &mut buffer) {
            let stamp = buffer[..8].try_into().map(i64::from_le_bytes);
            let stamp = Time::from_nanos(stamp.unwrap_or_default());
            let at = stamp.seconds_since(Time::from_nanos(0)) - begin;
            if (0.0..MEASURE).contains(&at) {
                ages.push(arrived.seconds_since(stamp) * 1e3);
            }
        }
        while here.receiver.receive(now, &mut buffer).is_some() {}
        due += PERIOD;
        thread::sleep(due.saturating_duration_since(Instant::now()));
    }
    done.store(true, Ordering::Relaxed);
    if ages.is_empty() {
        return Err("nothing arrived".to_owned());
    }
    ages.sort_by(f64::total_cmp);
    let at = |share: f64| ages[((ages.len() - 1) as f64 * share) as usize];
    Ok((
        ages.len() as f64 / sent as f64,
        [at(0.5), at(0.99), at(1.0)],
    ))
}

/// Carries packets between whoever sends to it and `arm`, late and not all.
fn relay(
    arm: SocketAddr,
    round_trip_ms: u64,
    loss: f64,
    done: Arc<AtomicBool>,
) -> io::Result<SocketAddr> {
    let outside = UdpSocket::bind("127.0.0.1:0")?;
    let inside = UdpSocket::bind("127.0.0.1:0")?;
    inside.connect(arm)?;
    outside.set_nonblocking(true)?;
    inside.set_nonblocking(true)?;
    let address = outside.local_addr()?;
    let delay = Duration::from_micros(round_trip_ms * 500);
    thread::spawn(move || {
        let mut operator = None;
        let mut random = 0x9e37_79b9_7f4a_7c15_u64;
        let mut lost = move || {
            random ^= random << 13;
            random ^= random >> 7;
            random ^= random << 17;
            (random >> 11) as f64 / (1_u64 << 53) as f64 <= loss && loss > 0.0
        };
        let mut up: VecDeque<(Instant, Vec<u8>)> = VecDeque::new();
        let mut down: VecDeque<(Instant, Vec<u8>)> = VecDeque::new();
        let mut buffer = [0; 65_536];
        while !done.load(Ordering::Relaxed) {
            let now = Instant::now();
            while let Ok((length, from)) = outside.recv_from(&mut buffer) {
                operator = Some(from);
                if !lost() {
                    up.push_back((now + delay, buffer[..length].to_vec()));
                }
            }
            while let Ok(length) = inside.recv(&mut buffer) {
                if !lost() {
                    down.push_back((now + delay, buffer[..length].to_vec()));
                }
            }
            // A packet that the system does not take is lost too.
            while let Some((_, packet)) = up.pop_front_if(|(due, _)| *due <= now) {
                let _ = inside.send(&packet);
            }
            while let Some((_, packet)) = down.pop_front_if(|(due, _)| *due <= now) {
                if let Some(operator) = operator {
                    let _ = outside.send_to(&packet, operator);
                }
            }
            thread::sleep(Duration::from_micros(300));
        }
    });
    Ok(address)
}
