//! The error that is reported, where it says clearly which of two effects it is.
//!
//! The ranking lets every session have parameters of its own, which take up some of what sets two
//! effects apart; the reported error has one set for all recordings. Whoever reads both wonders why
//! the effect below leaves less.

use std::collections::BTreeMap;

use super::candidates::Candidate;
use super::equivalents::MAX_REMAINDER_RATIO;
use crate::fit::addition::Addition;

/// Puts first what leaves clearly less of the reported error than the first of `passing` does, if
/// anything: by more than effects that count as equal, and than that is uncertain. `made` has the
/// model with each of them.
pub(super) fn put_first(made: &BTreeMap<String, Option<Addition>>, passing: &mut Vec<Candidate>) {
    let left_out = |own: &Candidate| Some(&made.get(own.id())?.as_ref()?.left_out);
    let Some(first) = passing.first().and_then(left_out) else {
        return;
    };
    let clearly_less = passing.iter().enumerate().filter_map(|(at, own)| {
        let other = left_out(own).filter(|other| other.has_rows_of(first))?;
        let decrease = other.decrease_from(first);
        let is_clear = decrease.is_certain()
            && decrease.before.powi(2) > MAX_REMAINDER_RATIO * decrease.after.powi(2);
        is_clear.then_some((at, decrease.after))
    });
    let best = clearly_less.min_by(|a, b| a.1.total_cmp(&b.1));
    if let Some((at, _)) = best {
        let own = passing.remove(at);
        passing.insert(0, own);
    }
}
