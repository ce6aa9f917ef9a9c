//! What stands in one cell.

/// What stands in one cell of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cell<'a> {
    /// A finite number; of a date or a time of day its seconds.
    Number(f64),
    /// Nothing, or a word for it: NaN, inf, NA, null, `-`.
    Missing,
    /// Something else.
    Text(&'a str),
}

/// Words for a value that is not there, in small letters.
const MISSING: [&str; 11] = [
    "", "-", "--", "na", "n/a", "#n/a", "nan", "none", "null", "missing", "?",
];

/// Reads one cell. With `comma` a comma may stand for the decimal point.
#[must_use]
pub fn cell(text: &str, comma: bool) -> Cell<'_> {
    let text = text.trim();
    if let Ok(value) = text.parse::<f64>() {
        return match value.is_finite() {
            true => Cell::Number(value),
            false => Cell::Missing,
        };
    }
    if MISSING.iter().any(|word| text.eq_ignore_ascii_case(word)) {
        return Cell::Missing;
    }
    let other = with_comma(text, comma)
        .or_else(|| with_fortran_exponent(text))
        .or_else(|| clock(text));
    match other {
        Some(value) if value.is_finite() => Cell::Number(value),
        _ => Cell::Text(text),
    }
}

/// `0,5`: a digit behind the comma, so that `0,` is none.
fn with_comma(text: &str, comma: bool) -> Option<f64> {
    let (whole, part) = text.split_once(',')?;
    let is_decimal = comma && part.starts_with(|c: char| c.is_ascii_digit());
    if !is_decimal || whole.contains('.') {
        return None;
    }
    format!("{whole}.{part}").parse().ok()
}

/// `1.5D-03`.
fn with_fortran_exponent(text: &str) -> Option<f64> {
    let starts = |c: char| c.is_ascii_digit() || c == '-' || c == '+' || c == '.';
    if !text.starts_with(starts) {
        return None;
    }
    text.replace(['D', 'd'], "e").parse().ok()
}

/// `2024-05-01T12:00:00.25Z` (a blank in place of the T, an offset in place of
/// the Z) in seconds since 1970; `12:00:00.25` in seconds since midnight.
fn clock(text: &str) -> Option<f64> {
    let Some((date, time)) = text.split_once(['T', ' ']) else {
        return time_of_day(text);
    };
    let mut parts = date.splitn(3, ['-', '/']);
    let [year, month, day] = [parts.next()?, parts.next()?, parts.next()?];
    if year.len() != 4 {
        return None;
    }
    let (year, month, day): (i64, i64, i64) =
        (year.parse().ok()?, month.parse().ok()?, day.parse().ok()?);
    if !((1..=12).contains(&month) && (1..=31).contains(&day)) {
        return None;
    }
    let time = time.trim();
    let (time, offset) = match time.rfind(['+', '-', 'Z']) {
        Some(at) => {
            let (time, zone) = time.split_at_checked(at)?;
            (time, zone_offset(zone)?)
        }
        None => (time, 0.0),
    };
    Some(days_since_1970(year, month, day) as f64 * 86_400.0 + time_of_day(time)? - offset)
}

fn zone_offset(zone: &str) -> Option<f64> {
    if zone == "Z" {
        return Some(0.0);
    }
    let sign = if zone.starts_with('-') { -1.0 } else { 1.0 };
    let digits: String = zone.chars().filter(char::is_ascii_digit).collect();
    let (hours, minutes) = digits.split_at_checked(2)?;
    let minutes: f64 = match minutes {
        "" => 0.0,
        minutes => minutes.parse().ok()?,
    };
    Some(sign * (hours.parse::<f64>().ok()? * 3600.0 + minutes * 60.0))
}

/// `hh:mm:ss`, with or without a fraction.
fn time_of_day(text: &str) -> Option<f64> {
    let mut parts = text.splitn(3, ':');
    let mut next = || {
        let part = parts.next()?;
        let is_plain = part.starts_with(|c: char| c.is_ascii_digit());
        is_plain.then_some(part)?.replace(',', ".").parse().ok()
    };
    let (hours, minutes, seconds): (f64, f64, f64) = (next()?, next()?, next()?);
    (minutes < 60.0 && seconds < 61.0).then_some(hours * 3600.0 + minutes * 60.0 + seconds)
}

/// Days from 1970-01-01 in the Gregorian calendar: 365 a year, the leap days, and
/// the days of the months from March on, which are 153 in five months.
fn days_since_1970(year: i64, month: i64, day: i64) -> i64 {
    let year = if month <= 2 { year - 1 } else { year };
    let month_from_march = (month + 9) % 12;
    let leap_days = year.div_euclid(4) - year.div_euclid(100) + year.div_euclid(400);
    year * 365 + leap_days + (153 * month_from_march + 2) / 5 + day - 719_469
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_of_all_kinds() {
        for (text, comma, value) in [
            (" 1.5 ", false, 1.5),
            ("-2e1", false, -20.0),
            ("0,5", true, 0.5),
            ("-1,25e-3", true, -1.25e-3),
            ("1.5D-03", false, 1.5e-3),
            ("12:00:01.5", false, 43_201.5),
            // date -u -d 2024-05-01T12:00:00 +%s
            ("2024-05-01T12:00:00.25Z", false, 1_714_564_800.25),
            ("2024-05-01 14:00:00.25+02:00", false, 1_714_564_800.25),
            ("1970-01-01 00:00:00", false, 0.0),
            ("2000-02-29 00:00:00", false, 951_782_400.0),
        ] {
            assert_eq!(cell(text, comma), Cell::Number(value), "{text}");
        }
        for text in ["", "NaN", "inf", "-inf", "null", "N/A", "-"] {
            assert_eq!(cell(text, true), Cell::Missing, "{text}");
        }
        for (text, comma) in [
            ("0,", true),
            ("0,5", false),
            ("1.234,5", true),
            ("on", true),
        ] {
            assert_eq!(cell(text, comma), Cell::Text(text), "{text}");
        }
    }
}
