//! Numbers as people read them.

/// Bytes with a binary prefix and three digits: `64.0 MiB`.
pub(super) fn bytes(count: u64) -> String {
    const PREFIXES: [&str; 5] = ["KiB", "MiB", "GiB", "TiB", "PiB"];
    if count < 1024 {
        return format!("{count} B");
    }
    let mut value = count as f64 / 1024.0;
    let mut unit = PREFIXES[0];
    for prefix in &PREFIXES[1..] {
        if value < 1023.95 {
            break;
        }
        value /= 1024.0;
        unit = prefix;
    }
    format!("{value:.1} {unit}")
}

/// Minutes as `12 min`, `3.5 h` or `8 days`.
pub(super) fn minutes(minutes: f64) -> String {
    if minutes < 90.0 {
        format!("{minutes:.0} min")
    } else if minutes < 48.0 * 60.0 {
        format!("{:.1} h", minutes / 60.0)
    } else {
        format!("{:.0} days", minutes / 1440.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_take_the_fitting_prefix() {
        assert_eq!(bytes(1023), "1023 B");
        assert_eq!(bytes(1024), "1.0 KiB");
        assert_eq!(bytes((1 << 20) - 1), "1.0 MiB");
        assert_eq!(bytes(64 << 20), "64.0 MiB");
        assert_eq!(bytes(u64::MAX), "16384.0 PiB");
    }

    #[test]
    fn minutes_take_the_fitting_unit() {
        assert_eq!(minutes(1.4), "1 min");
        assert_eq!(minutes(210.0), "3.5 h");
        assert_eq!(minutes(8.0 * 1440.0), "8 days");
    }
}
