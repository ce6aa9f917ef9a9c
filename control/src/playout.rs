//! Play-out: which of the frames that arrived is acted on, and when.
//!
//! Keyed by sequence number. Without a buffer the newest frame counts as soon as it
//! is there. With one, each frame waits until `buffer` after the quickest way: due =
//! stamp + base + buffer, base the smallest transit time, which forgets slowly
//! (Ramjee, Kurose, Towsley, Schulzrinne 1994, "Adaptive playout mechanisms for
//! packetized audio applications in wide-area networks", take a mean instead);
//! jitter up to `buffer` is evened out, reordered frames fall into place. Transit times are
//! by the sender's own stamps, so that what its clock is ahead is in base, and an estimate of that, which
//! jitter makes wrong by tens of milliseconds and mends later, moves nothing.
//!
//! * A frame older than the one acted on last is late, and dropped.
//! * One that comes after it was due, while frames arrive, is acted on at once, and base
//!   follows: the way has become longer, for all behind that frame where they keep their order,
//!   and who waited for better ones would have nothing to act on.
//! * After an outage one that comes late was held up in it, and is dropped; but when all frames
//!   come late for [`REBASE`], base follows there, too.
//! * Of several that are due only the newest is acted on.
//! * After an outage, nothing that was queued is acted on: what waits when nothing has
//!   arrived for [`OUTAGE`], or for the buffer where that is longer, is dropped. What the arm
//!   does then is not decided here: the servo's watchdog has paused it, and it waits to be
//!   re-armed and approaches on a ramp.
//!
//! Allocates when made, never afterwards.

use std::collections::VecDeque;

use crate::frame::LinkFrame;
use crate::meter::behind;
use crate::nanoseconds;

/// Longest buffer \[s\].
pub const LONGEST_BUFFER: f64 = 0.2;
/// Silence after which what waits is dropped, where the buffer is not longer \[s\].
pub const OUTAGE: f64 = 0.1;
/// When all frames are late for this long, base follows \[s\].
pub const REBASE: f64 = 0.5;
/// Frames that wait at most, as many as there are bits: 0.25 s at 500 Hz.
const SLOTS: usize = 128;
/// Part of the difference by which base grows with each frame, once so many came: some seconds;
/// at first base is that of the few that there are, which may have been quick.
const FORGET: i64 = 1024;
const FORGET_FIRST: i64 = 16;

/// What became of a frame that was offered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Offered {
    /// It waits for its turn.
    Waiting,
    /// Overtaken, or past its time: dropped.
    Late,
    /// It is there already, or was acted on: dropped.
    Replayed,
}

/// A frame that waits: which, and where it lies.
#[derive(Clone, Copy, Debug)]
struct Turn {
    sequence: u32,
    stamp_ns: i64,
    place: usize,
}

/// Frames that wait for their turn.
#[derive(Clone, Debug)]
pub struct PlayOut {
    buffer_ns: i64,
    slots: Box<[Option<LinkFrame>; SLOTS]>,
    /// A bit for each slot in which a frame waits.
    used: u128,
    /// Those that wait, by their sequence numbers; never more than there are slots.
    turns: VecDeque<Turn>,
    /// Smallest transit time [ns].
    base_ns: Option<i64>,
    /// Frames that it is of, up to [`FORGET`].
    based_on: i64,
    late_since_ns: Option<i64>,
    arrived_ns: Option<i64>,
    /// Sequence number of the frame acted on last.
    last: Option<u32>,
    /// The newest with content of those that went with it.
    content: Option<LinkFrame>,
}

impl PlayOut {
    /// Nothing waits. `buffer` \[s\] is clamped to 0 … [`LONGEST_BUFFER`].
    pub fn new(buffer: f64) -> Self {
        PlayOut {
            // Not a number counts as none.
            buffer_ns: nanoseconds(buffer.clamp(0.0, LONGEST_BUFFER)),
            slots: Box::new([None; SLOTS]),
            used: 0,
            turns: VecDeque::with_capacity(SLOTS),
            base_ns: None,
            based_on: 0,
            late_since_ns: None,
            arrived_ns: None,
            last: None,
            content: None,
        }
    }

    /// The newest frame with content among the one that was taken last and those that were
    /// dropped then.
    pub fn content(&self) -> Option<&LinkFrame> {
        self.content.as_ref()
    }

    /// Frames that wait.
    pub fn waiting(&self) -> usize {
        self.turns.len()
    }

    /// The sender was started anew, or is another one: what waits is dropped.
    pub fn restart(&mut self) {
        self.clear();
        self.base_ns = None;
        self.based_on = 0;
        self.late_since_ns = None;
        self.last = None;
    }

    /// A frame arrived at `now_ns`.
    pub fn offer(&mut self, frame: &LinkFrame, now_ns: i64) -> Offered {
        let outage = self.after_outage(now_ns);
        self.arrived_ns = Some(now_ns);
        if let Some(sequence) = self.last {
            if frame.sequence == sequence {
                return Offered::Replayed;
            } else if !behind(sequence, frame.sequence) {
                return Offered::Late;
            }
        }
        let transit_ns = now_ns.saturating_sub(frame.stamp_ns);
        let base_ns = self
            .base_ns
            .map_or(transit_ns, |base_ns| base_ns.min(transit_ns));
        let late = self.buffer_ns > 0 && transit_ns.saturating_sub(base_ns) > self.buffer_ns;
        self.base_ns = Some(if late && (outage || self.late_since_ns.is_some()) {
            let since_ns = *self.late_since_ns.get_or_insert(now_ns);
            if now_ns.saturating_sub(since_ns) < nanoseconds(REBASE) {
                return Offered::Late;
            }
            transit_ns
        } else if late {
            transit_ns.saturating_sub(self.buffer_ns)
        } else {
            let part = self.based_on.clamp(FORGET_FIRST, FORGET);
            base_ns.saturating_add(transit_ns.saturating_sub(base_ns) / part)
        });
        self.based_on = (self.based_on + 1).min(FORGET);
        self.late_since_ns = None;
        let not_after = |own: &Turn| !behind(frame.sequence, own.sequence);
        let mut at = self
            .turns
            .iter()
            .rposition(not_after)
            .map_or(0, |own| own + 1);
        if at > 0 && self.turns[at - 1].sequence == frame.sequence {
            return Offered::Replayed;
        }
        if self.turns.len() == SLOTS {
            // Further ahead than there is room: the oldest gives way.
            if at == 0 {
                return Offered::Late;
            }
            self.pop();
            at -= 1;
        }
        let place = (!self.used).trailing_zeros() as usize;
        self.used |= 1 << place;
        self.slots[place] = Some(*frame);
        let (sequence, stamp_ns) = (frame.sequence, frame.stamp_ns);
        let turn = Turn {
            sequence,
            stamp_ns,
            place,
        };
        self.turns.insert(at, turn);
        Offered::Waiting
    }

    /// The frame to act on from `now_ns` on, when there is a new one: the last of those that are
    /// due. Those before it are dropped. No frame is due before those that were sent before it.
    pub fn take(&mut self, now_ns: i64) -> Option<LinkFrame> {
        self.after_outage(now_ns);
        let (base_ns, buffer_ns) = (self.base_ns.unwrap_or(0), self.buffer_ns);
        let due = |own: &Turn| {
            let due_ns = own.stamp_ns.saturating_add(base_ns);
            buffer_ns == 0 || due_ns.saturating_add(buffer_ns) <= now_ns
        };
        let (mut newest, mut content) = (None, None);
        while self.turns.front().is_some_and(due) {
            newest = self.pop();
            content = newest.filter(|own| own.since_content == 0).or(content);
        }
        let newest = newest?;
        self.content = content;
        self.last = Some(newest.sequence);
        Some(newest)
    }

    /// The one that waits first.
    fn pop(&mut self) -> Option<LinkFrame> {
        let turn = self.turns.pop_front()?;
        self.used &= !(1 << turn.place);
        self.slots[turn.place]
    }

    /// Whether nothing arrived for so long that what waits does not count; it is dropped then.
    fn after_outage(&mut self, now_ns: i64) -> bool {
        let silent = self.arrived_ns.is_some_and(|own| {
            now_ns.saturating_sub(own) > self.buffer_ns.max(nanoseconds(OUTAGE))
        });
        if silent {
            self.clear();
        }
        silent
    }

    fn clear(&mut self) {
        self.turns.clear();
        self.used = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delay::Packet;
    use crate::operating::OperatingState;
    use proptest::prelude::*;

    const START: i64 = 1_700_000_000_000_000_000;
    const MS: i64 = 1_000_000;

    fn frame(sequence: u32, sent_ms: i64) -> LinkFrame {
        LinkFrame {
            sequence,
            stamp_ns: START + sent_ms * MS,
            sent_ns: START + sent_ms * MS,
            echo: None,
            hold: false,
            state: OperatingState::Enabled,
            arming: 0,
            law: 0,
            pace: 0,
            since_content: 0,
            packet: Packet::default(),
            orientation: None,
        }
    }

    fn taken(playout: &mut PlayOut, now_ms: i64) -> Option<u32> {
        playout.take(START + now_ms * MS).map(|own| own.sequence)
    }

    fn offered(playout: &mut PlayOut, sequence: u32, sent_ms: i64, now_ms: i64) -> Offered {
        playout.offer(&frame(sequence, sent_ms), START + now_ms * MS)
    }

    #[test]
    fn without_a_buffer_the_newest_counts_at_once() {
        let mut playout = PlayOut::new(0.0);
        assert_eq!(offered(&mut playout, 5, 10, 30), Offered::Waiting);
        assert_eq!(offered(&mut playout, 4, 8, 30), Offered::Waiting);
        assert_eq!(taken(&mut playout, 30), Some(5));
        assert_eq!(taken(&mut playout, 31), None);
        assert_eq!(offered(&mut playout, 5, 10, 31), Offered::Replayed);
        assert_eq!(offered(&mut playout, 3, 6, 31), Offered::Late);
    }

    #[test]
    fn a_buffer_evens_jitter_out_and_puts_frames_in_order() {
        // Sent every 2 ms, on their way for 20 … 28 ms, every third overtakes.
        let mut playout = PlayOut::new(0.010);
        let arrivals: Vec<i64> = (0..200).map(|k| 2 * k + 20 + 4 * (k % 3)).collect();
        let mut seen = Vec::new();
        for now in 0..420_i64 {
            for (k, at) in arrivals.iter().enumerate() {
                if *at == now {
                    offered(&mut playout, k as u32, 2 * k as i64, now);
                }
            }
            if let Some(sequence) = taken(&mut playout, now) {
                seen.push((now, i64::from(sequence)));
            }
        }
        // Each comes 30 ms after it was sent, but for the little that base forgets.
        assert!(seen.len() > 190, "{}", seen.len());
        for (now, sequence) in seen {
            let delay = now - 2 * sequence;
            assert!((30..=31).contains(&delay), "{sequence} after {delay} ms");
        }
    }

    #[test]
    fn where_there_is_no_room_the_oldest_gives_way() {
        let mut playout = PlayOut::new(LONGEST_BUFFER);
        let (first, after) = (10, 10 + SLOTS as u32);
        for sequence in first..after {
            assert_eq!(offered(&mut playout, sequence, 0, 20), Offered::Waiting);
        }
        assert_eq!(offered(&mut playout, first - 1, 0, 20), Offered::Late);
        assert_eq!(offered(&mut playout, after, 0, 20), Offered::Waiting);
        assert_eq!(offered(&mut playout, first, 0, 20), Offered::Late);
        assert_eq!(offered(&mut playout, first + 1, 0, 20), Offered::Replayed);
        assert_eq!(playout.waiting(), SLOTS);
        // All are due at once, the newest is acted on.
        assert_eq!(taken(&mut playout, 219), None);
        assert_eq!(taken(&mut playout, 220), Some(after));
        assert_eq!(playout.waiting(), 0);
    }

    /// Whatever a frame's stamp: who sent one with a later stamp before sent it sooner.
    #[test]
    fn no_frame_is_acted_on_before_those_sent_before_it() {
        let mut playout = PlayOut::new(0.010);
        offered(&mut playout, 0, 0, 20);
        assert_eq!(taken(&mut playout, 30), Some(0));
        offered(&mut playout, 2, 31, 51);
        offered(&mut playout, 1, 35, 51);
        assert_eq!(taken(&mut playout, 60), None);
        assert_eq!(taken(&mut playout, 61), Some(2));
    }

    #[test]
    fn nothing_queued_is_acted_on_after_an_outage() {
        let mut playout = PlayOut::new(0.150);
        for k in 0..20 {
            offered(&mut playout, k, 2 * i64::from(k), 2 * i64::from(k) + 20);
        }
        assert_eq!(playout.waiting(), 20);
        // Each 170 ms after it was sent, for as long as the buffer bridges; this end was held
        // up from then on.
        assert_eq!(taken(&mut playout, 169), None);
        assert_eq!(taken(&mut playout, 190), Some(10));
        assert_eq!(taken(&mut playout, 209), None);
        assert_eq!(playout.waiting(), 0);
        // What was held up on the way comes late, what is sent now counts.
        assert_eq!(offered(&mut playout, 20, 40, 400), Offered::Late);
        let mut first = None;
        for now in 420..600 {
            if now % 2 == 0 {
                let sequence = 200 + (now as u32 - 420) / 2;
                offered(&mut playout, sequence, now - 20, now);
            }
            let own = taken(&mut playout, now);
            first = first.or(own.map(|sequence| (now, sequence)));
        }
        assert_eq!(first, Some((570, 200)));
    }

    #[test]
    fn a_way_that_has_become_longer_is_followed() {
        let mut playout = PlayOut::new(0.010);
        offered(&mut playout, 0, 0, 20);
        let mut first = None;
        for k in 1..1000_u32 {
            let sent = 2 * i64::from(k);
            if offered(&mut playout, k, sent, sent + 300) == Offered::Waiting && first.is_none() {
                first = Some(k);
            }
        }
        // 0.5 s of frames at 500 Hz.
        assert_eq!(first, Some(251));
    }

    /// The first frame had no other before it, so it was the quickest; then one holds up all
    /// behind it for 60 ms, twice as long as the buffer.
    #[test]
    fn frames_that_come_late_while_frames_arrive_are_acted_on() {
        let mut playout = PlayOut::new(0.030);
        offered(&mut playout, 0, 0, 20);
        let mut seen = Vec::new();
        for now in 40..1000_i64 {
            for k in 1..500_i64 {
                let arrives = (2 * k + 40).max(if k >= 100 { 300 } else { 0 });
                if arrives == now {
                    offered(&mut playout, k as u32, 2 * k, now);
                }
            }
            if taken(&mut playout, now).is_some() {
                seen.push(now);
            }
        }
        let gaps = seen.windows(2).map(|own| own[1] - own[0]);
        // What the buffer cannot bridge of the 62 ms between two arrivals, and no more.
        let longest = gaps.max().expect("frames");
        assert!((30..=52).contains(&longest), "{longest} ms");
        let after = seen.iter().filter(|now| **now >= 300).count();
        assert!(after > 300, "{after}");
    }

    #[test]
    fn a_sender_that_began_anew_is_heard() {
        let mut playout = PlayOut::new(0.0);
        offered(&mut playout, 1000, 0, 20);
        assert_eq!(taken(&mut playout, 20), Some(1000));
        playout.restart();
        assert_eq!(offered(&mut playout, 0, 50, 70), Offered::Waiting);
        assert_eq!(taken(&mut playout, 70), Some(0));
    }

    proptest! {
        #[test]
        fn what_is_taken_is_always_newer_than_before(
            arrivals in proptest::collection::vec((0..400u32, 0..60i64), 1..300),
            buffer in 0.0..0.05f64,
            first: u32,
        ) {
            let mut playout = PlayOut::new(buffer);
            let mut newest: Option<u32> = None;
            for (now, (number, held)) in arrivals.into_iter().enumerate() {
                let now = now as i64 * 3;
                let frame = frame(first.wrapping_add(number), 2 * i64::from(number) - 800);
                playout.offer(&frame, START + (now + held) * MS);
                if let Some(own) = playout.take(START + (now + held) * MS) {
                    let ahead = own.sequence.wrapping_sub(first);
                    prop_assert!(newest.is_none_or(|before| before < ahead));
                    newest = Some(ahead);
                }
                prop_assert!(playout.waiting() <= SLOTS);
            }
        }
    }
}
