//! The hardware behind the clocks: a slow one costs every step microseconds.

use super::host::Host;
use super::report::Check;

const FOLDER: &str = "/sys/devices/system/clocksource/clocksource0";

/// Those that a process reads without a call into the kernel.
const FAST: [&str; 7] = [
    "tsc",
    "kvm-clock",
    "hyperv_clocksource_tsc_page",
    "arch_sys_counter",
    "riscv_clocksource",
    "timebase",
    "tod",
];

pub(super) fn check(host: &dyn Host) -> Check {
    const ID: &str = "clock_source";
    const TITLE: &str = "Clock source";
    let path = format!("{FOLDER}/current_clocksource");
    let current = match host.read(&path) {
        Ok(text) => text.trim().to_owned(),
        Err(error) => {
            return Check::ok(ID, TITLE, "").warn(
                &format!("unknown: {path}: {error}"),
                "mount /sys to let the doctor see it; a session needs it not",
            );
        }
    };
    let check = Check::ok(ID, TITLE, current.clone()).with("current", current.clone());
    if FAST.contains(&current.as_str()) {
        return check;
    }
    let available = host.read(&format!("{FOLDER}/available_clocksource"));
    let available = available.unwrap_or_default();
    let better = FAST
        .iter()
        .find(|fast| available.split_whitespace().any(|name| name == **fast));
    let mend = match better {
        Some(better) => format!("`echo {better} | sudo tee {path}`"),
        None => "see `dmesg | grep -i -e tsc -e clocksource` for why the kernel gave up the fast one; often a firmware update or, in a virtual machine, the host's settings mend it".to_owned(),
    };
    check.warn(
        "slow: each reading of the clock is a call into the kernel",
        mend,
    )
}

#[cfg(test)]
mod tests {
    use super::super::fake::Fake;
    use super::super::report::Status;
    use super::*;

    fn with(current: &str, available: &str) -> Check {
        check(
            &Fake::empty()
                .file(&format!("{FOLDER}/current_clocksource"), current)
                .file(&format!("{FOLDER}/available_clocksource"), available),
        )
    }

    #[test]
    fn tsc_and_its_like_are_good() {
        assert_eq!(with("tsc\n", "tsc hpet\n").status, Status::Ok);
        assert_eq!(with("kvm-clock\n", "kvm-clock\n").status, Status::Ok);
    }

    #[test]
    fn a_slow_one_warns_and_names_the_faster() {
        let check = with("hpet\n", "tsc hpet acpi_pm \n");
        assert_eq!(check.status, Status::Warn);
        assert!(check.mend.is_some_and(|mend| mend.contains("echo tsc")));
        let check = with("acpi_pm\n", "acpi_pm \n");
        assert!(check.mend.is_some_and(|mend| mend.contains("dmesg")));
    }
}
