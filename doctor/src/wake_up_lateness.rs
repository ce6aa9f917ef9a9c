//! How late loops wake, measured with and without real-time priority.

use std::io;
use std::time::Duration;

use super::host::{Host, WakeUps};
use super::options::DoctorOptions;
use super::report::{Check, Status};

/// Percentiles of how late a loop woke \[µs\].
#[derive(Clone, Copy, Debug, PartialEq)]
struct Lateness {
    p50: f64,
    p99: f64,
    worst: f64,
}

pub(super) fn check(host: &dyn Host, options: &DoctorOptions) -> Check {
    let period = options.wake_up_period.max(Duration::from_micros(10));
    let duration = options
        .wake_up_duration
        .min(DoctorOptions::LONGEST_MEASUREMENT);
    // At least a few, or there are no percentiles.
    let count = (duration.as_nanos() / period.as_nanos()).clamp(10, 10_000_000) as usize;
    let measure = |priority| {
        let lateness = host.wake_up_lateness(WakeUps {
            period,
            count,
            priority,
        })?;
        percentiles(lateness).ok_or_else(|| io::Error::other("no wake-up was measured"))
    };
    let normal = measure(None);
    let real_time = measure(Some(options.real_time_priority));

    let period_us = period.as_secs_f64() * 1e6;
    let mut check = Check::ok("wake_up_lateness", "Wake-up lateness", "")
        .with("period_us", period_us)
        .with("wake_ups", count);
    let mut lines = Vec::new();
    if let Ok(lateness) = &real_time {
        lines.push(line("SCHED_FIFO", lateness));
        check = check
            .with("fifo_p50_us", lateness.p50)
            .with("fifo_p99_us", lateness.p99)
            .with("fifo_worst_us", lateness.worst);
    }
    match &normal {
        Ok(lateness) => {
            lines.push(line("normal", lateness));
            check = check
                .with("normal_p50_us", lateness.p50)
                .with("normal_p99_us", lateness.p99)
                .with("normal_worst_us", lateness.worst);
        }
        Err(error) => lines.push(format!("normal threads could not be measured: {error}")),
    }
    check.found = lines.join("\n");

    // The session uses real-time priority where it gets it.
    let with_priority = real_time.is_ok();
    let Ok(used) = real_time.or(normal) else {
        let mend = "let this process start threads (`ulimit -u`), then ask the doctor again";
        check.add(Status::Warn, "", mend);
        return check;
    };
    let mend = if with_priority {
        "stop other load, set the frequency governor to performance, and on a real arm use a PREEMPT_RT kernel with cores kept free (isolcpus); a virtual machine's host may be what is late"
    } else {
        "allow real-time priority (above) and stop other load"
    };
    let hertz = 1e6 / period_us;
    if used.p50 >= period_us {
        let text = format!("too late to hold {hertz:.0} Hz: every second step is missed");
        check.add(Status::Fail, &text, mend);
    } else if used.p99 >= period_us / 4.0 {
        let text = format!(
            "uneven: at {hertz:.0} Hz a step in a hundred comes more than a quarter period late"
        );
        check.add(Status::Warn, &text, mend);
    }
    check
}

fn line(name: &str, lateness: &Lateness) -> String {
    format!(
        "{name:<10}  p50 {:>6.1} µs   p99 {:>6.1} µs   worst {:>6.1} µs",
        lateness.p50, lateness.p99, lateness.worst
    )
}

/// By nearest rank; `None` of nothing.
fn percentiles(mut nanos: Vec<i64>) -> Option<Lateness> {
    nanos.sort_unstable();
    let rank = |percent: usize| {
        let rank = (nanos.len() * percent).div_ceil(100);
        let nanos = nanos.get(rank.saturating_sub(1))?;
        Some(*nanos as f64 / 1000.0)
    };
    Some(Lateness {
        p50: rank(50)?,
        p99: rank(99)?,
        worst: rank(100)?,
    })
}

#[cfg(test)]
mod tests {
    use std::io::ErrorKind;

    use super::super::fake::Fake;
    use super::*;

    fn check_lateness(normal: &[i64], real_time: Option<&[i64]>) -> Check {
        let mut fake = Fake::empty();
        fake.lateness[0] = normal.to_vec();
        if let Some(real_time) = real_time {
            fake.lateness[1] = real_time.to_vec();
            fake.real_time = Ok(());
        }
        check(&fake, &DoctorOptions::default())
    }

    #[test]
    fn percentiles_are_by_nearest_rank() {
        let all = (1..=200).rev().map(|micros| micros * 1000).collect();
        let expected = Lateness {
            p50: 100.0,
            p99: 198.0,
            worst: 200.0,
        };
        assert_eq!(percentiles(all), Some(expected));
        let one = percentiles(vec![7000]).expect("one value");
        assert_eq!((one.p50, one.p99, one.worst), (7.0, 7.0, 7.0));
        assert_eq!(percentiles(Vec::new()), None);
    }

    #[test]
    fn prompt_loops_are_good_and_both_are_told() {
        let check = check_lateness(&[60_000], Some(&[5_000]));
        assert_eq!(check.status, Status::Ok);
        assert_eq!(check.values["fifo_p99_us"], 5.0);
        assert_eq!(check.values["normal_worst_us"], 60.0);
        assert_eq!(check.values["wake_ups"], 500);
    }

    #[test]
    fn the_better_class_decides_where_it_is_granted() {
        assert_eq!(
            check_lateness(&[900_000], Some(&[5_000])).status,
            Status::Ok
        );
        let refused = check_lateness(&[900_000], None);
        assert_eq!(refused.status, Status::Warn);
        assert!(
            refused
                .mend
                .is_some_and(|mend| mend.contains("allow real-time"))
        );
    }

    #[test]
    fn a_machine_that_cannot_hold_the_rate_fails() {
        assert_eq!(
            check_lateness(&[2_000_000], Some(&[1_000_000])).status,
            Status::Fail
        );
        assert_eq!(check_lateness(&[999_000], None).status, Status::Warn);
    }

    #[test]
    fn nothing_measured_is_a_warning() {
        let check = check_lateness(&[], None);
        assert_eq!(check.status, Status::Warn);
        assert!(check.found.contains("could not be measured"));
    }

    #[test]
    fn odd_options_are_brought_into_range() {
        let options = DoctorOptions {
            wake_up_period: Duration::ZERO,
            wake_up_duration: Duration::MAX,
            ..DoctorOptions::default()
        };
        let mut fake = Fake::empty();
        fake.writing = Err((ErrorKind::Other, ""));
        assert_eq!(check(&fake, &options).values["wake_ups"], 6_000_000);
    }
}
