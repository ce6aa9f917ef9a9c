//! The error that is reported, where it says clearly which of two effects it is.
//!
//! The ranking lets every session have parameters of its own, which take up some of what sets two
//! effects apart; the reported error has one set for all recordings. Whoever reads both wonders why
//! the effect below leaves less.

use super::acceptance::Acceptance;
use super::candidates::Candidate;
use super::equivalents::MAX_REMAINDER_RATIO;

/// Puts first what leaves clearly less of the reported error than the first of `passing` does, if
/// anything: by more than effects that count as equal, and than that is uncertain.
pub(super) fn put_first(acceptance: &mut Acceptance<'_>, passing: &mut Vec<Candidate>) {
    let Some(first) = passing.first().and_then(|own| acceptance.of(own)).cloned() else {
        return;
    };
    let mut best: Option<(usize, f64)> = None;
    for (at, own) in passing.iter().enumerate().skip(1) {
        let Some(other) = acceptance.of(own) else {
            continue;
        };
        if !other.left_out.has_rows_of(&first.left_out) {
            continue;
        }
        let decrease = other.left_out.decrease_from(&first.left_out);
        let is_clear = decrease.is_certain()
            && decrease.before.powi(2) > MAX_REMAINDER_RATIO * decrease.after.powi(2);
        if is_clear && best.is_none_or(|(_, least)| decrease.after < least) {
            best = Some((at, decrease.after));
        }
    }
    if let Some((at, _)) = best {
        let own = passing.remove(at);
        passing.insert(0, own);
    }
}
