//! When views are sent, and which of those that arrive are shown.

use super::{ArmView, Reason, SentView, View, ViewBytes, ViewError, decode, encode};

/// Time between two views \[ns\]: 25 Hz.
pub const VIEW_PERIOD_NS: i64 = 40_000_000;
/// One view of so many says why the arm is in its state, for an end that comes later or lost it.
const REASON_EVERY: u32 = 8;

/// The arm's end: when a view is due, and its number.
#[derive(Clone, Debug, Default)]
pub struct ViewSender {
    due_ns: i64,
    number: u32,
    told: Option<Reason>,
}

impl ViewSender {
    /// The bytes of a view, when one is due at `now_ns`: of the arm, where it is measured; of
    /// `reason` at once when it is another one.
    pub fn step(
        &mut self,
        now_ns: i64,
        reason: Option<Reason>,
        arm: impl FnOnce() -> Option<ArmView>,
    ) -> Option<ViewBytes> {
        let is_news = reason.is_some() && reason != self.told;
        // Further ahead than a period: a clock jumped back.
        let waits = now_ns < self.due_ns && self.due_ns.saturating_sub(now_ns) <= VIEW_PERIOD_NS;
        if waits && !is_news {
            return None;
        }
        let again = self.number.is_multiple_of(REASON_EVERY);
        let told = reason.filter(|_| is_news || again).map(View::Reason);
        let view = told.or_else(|| arm().map(View::Arm));
        // Where the arm is not measured.
        let view = view.or(reason.map(View::Reason))?;
        let bytes = encode(&view, self.number, now_ns);
        self.told = reason;
        self.due_ns = now_ns.saturating_add(VIEW_PERIOD_NS);
        self.number = self.number.wrapping_add(1);
        Some(bytes)
    }
}

/// The operator's end: only what is newer than what was there is shown.
#[derive(Clone, Debug, Default)]
pub struct ViewReceiver {
    newest: Option<u32>,
}

impl ViewReceiver {
    /// Another process is at the other end, which counts anew.
    pub fn restart(&mut self) {
        self.newest = None;
    }

    /// The view in `bytes` that arrived at `now_ns` from a sender whose clock is `ahead_ns` ahead;
    /// `None` where it was overtaken.
    ///
    /// # Errors
    ///
    /// [`ViewError`].
    pub fn arrived(
        &mut self,
        bytes: &[u8],
        now_ns: i64,
        ahead_ns: i64,
    ) -> Result<Option<SentView>, ViewError> {
        let sent = decode(bytes, now_ns, ahead_ns)?;
        let ahead = |newest: u32| sent.number.wrapping_sub(newest) as i32 > 0;
        if !self.newest.is_none_or(ahead) {
            return Ok(None);
        }
        self.newest = Some(sent.number);
        Ok(Some(sent))
    }
}
