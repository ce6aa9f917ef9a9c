//! The date that a recording began at, as a TOML date says it.

use chrono::{FixedOffset, NaiveDate, NaiveDateTime, NaiveTime};
use toml::value::{Datetime, Offset};

/// Nanoseconds since 1970. Without a time of day its midnight, without an offset UTC.
///
/// # Errors
///
/// Why it is no date that a recording can have, in words.
pub(super) fn nanoseconds(stated: &Datetime) -> Result<i64, String> {
    let refuse = || format!("{stated} is no day: write 2026-03-09, or 2026-03-09T14:30:00+01:00");
    let day = stated.date.ok_or_else(refuse)?;
    let (year, month, day) = (i32::from(day.year), day.month.into(), day.day.into());
    let day = NaiveDate::from_ymd_opt(year, month, day).ok_or_else(refuse)?;
    let time = match stated.time {
        None => NaiveTime::MIN,
        Some(own) => {
            let second = own.second.unwrap_or_default().into();
            let nanosecond = own.nanosecond.unwrap_or_default();
            NaiveTime::from_hms_nano_opt(own.hour.into(), own.minute.into(), second, nanosecond)
                .ok_or_else(refuse)?
        }
    };
    let east = match stated.offset {
        None | Some(Offset::Z) => 0,
        Some(Offset::Custom { minutes }) => 60 * i32::from(minutes),
    };
    let offset = FixedOffset::east_opt(east).ok_or_else(refuse)?;
    let began = NaiveDateTime::new(day, time).and_local_timezone(offset);
    let began = began.single().and_then(|own| own.timestamp_nanos_opt());
    began.filter(|own| *own > 0).ok_or_else(refuse)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(text: &str) -> Result<i64, String> {
        nanoseconds(&text.parse().unwrap())
    }

    /// Against `date -u -d … +%s`.
    #[test]
    fn a_date_is_seconds_since_1970() {
        assert_eq!(told("2026-03-09"), Ok(1_773_014_400_000_000_000));
        let half_past = Ok(1_773_066_600_500_000_000);
        assert_eq!(told("2026-03-09T14:30:00.5"), half_past);
        assert_eq!(told("2026-03-09T14:30:00.5Z"), half_past);
        assert_eq!(told("2026-03-09T15:30:00.5+01:00"), half_past);
    }

    #[test]
    fn what_is_no_day_is_refused() {
        for text in ["14:30:00", "1960-01-01", "9999-01-01"] {
            let why = told(text).unwrap_err();
            assert!(why.contains(text) && why.contains("2026-03-09"), "{why}");
        }
    }
}
