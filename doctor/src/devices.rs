//! Whether the hardware behind arm and hand can be reached: its section, its port, its service.
//! Nothing is sent to a motor.

use std::io;

use super::host::Host;
use super::options::{DoctorOptions, Place};
use super::report::{Check, Status};
use super::text::quoted;

/// `None` where there is no hardware.
pub(super) fn check(host: &dyn Host, options: &DoctorOptions) -> Option<Check> {
    if options.devices.is_empty() {
        return None;
    }
    let mut check = Check::ok("devices", "Hardware of arm and hand", "");
    for device in &options.devices {
        let purpose = &device.purpose;
        match examine(host, &device.place) {
            Ok(found) => check.add_found(&format!("{purpose}: {found}")),
            Err((found, mend)) => check.add(Status::Fail, &format!("{purpose}: {found}"), mend),
        }
    }
    Some(check)
}

/// What was found; or what is wrong, and how to mend it.
fn examine(host: &dyn Host, place: &Place) -> Result<String, (String, String)> {
    match place {
        Place::NotDescribed { why } => {
            Err((why.clone(), "docs/motors.md has such a section".to_owned()))
        }
        Place::SerialPort(path) => match host.try_reading_and_writing(path) {
            Ok(()) => Ok(format!(
                "{path} is there (whether motors answer: `ferntast arm check`)"
            )),
            Err(error) => Err((format!("{path}: {error}"), of_port(host, path, &error))),
        },
        Place::Service(address) => {
            let connect = || -> io::Result<()> {
                let mut last = io::Error::from(io::ErrorKind::NotFound);
                for address in host.resolve(address)? {
                    match host.try_connecting(address) {
                        Ok(()) => return Ok(()),
                        Err(error) => last = error,
                    }
                }
                Err(last)
            };
            connect().map_err(|error| {
                let mend = "start the service there, or name another one in the scenario";
                (
                    format!("nothing answers at {address}: {error}"),
                    mend.to_owned(),
                )
            })?;
            Ok(format!("{address} answers"))
        }
    }
}

fn of_port(host: &dyn Host, path: &str, error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::PermissionDenied => {
            let path = quoted(path);
            format!(
                "`sudo usermod -aG dialout $USER` and log in again, or `sudo chmod a+rw {path}` until it is unplugged"
            )
        }
        _ => {
            const BY_ID: &str = "/dev/serial/by-id";
            let there = host.list(BY_ID).unwrap_or_default();
            let there: Vec<String> = there.iter().map(|name| format!("{BY_ID}/{name}")).collect();
            let there = match there.as_slice() {
                [] => "none is plugged in".to_owned(),
                ports => format!("there are: {}", ports.join(", ")),
            };
            format!("plug the adapter in, or name its port in the arm's file ({there})")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{fake::Fake, options::Device};
    use super::*;

    fn examine(fake: &Fake, place: Place) -> Check {
        let purpose = "the arm (feetech)".to_owned();
        let options = DoctorOptions {
            devices: vec![Device { purpose, place }],
            ..DoctorOptions::default()
        };
        check(fake, &options).expect("there is a device")
    }

    fn port() -> Place {
        Place::SerialPort("/dev/ttyACM0".to_owned())
    }

    #[test]
    fn without_hardware_nothing_is_said() {
        assert_eq!(check(&Fake::good(), &DoctorOptions::default()), None);
    }

    #[test]
    fn a_port_has_to_be_there_and_open_to_this_user() {
        let fake = Fake::good().file("/dev/ttyACM0", "");
        let good = examine(&fake, port());
        assert_eq!(good.status, Status::Ok);
        assert!(
            good.found
                .starts_with("the arm (feetech): /dev/ttyACM0 is there")
        );

        let other = Fake::good().file("/dev/serial/by-id/usb-adapter", "");
        let gone = examine(&other, port());
        assert_eq!(gone.status, Status::Fail);
        let mend = gone.mend.unwrap_or_default();
        assert!(
            mend.contains("there are: /dev/serial/by-id/usb-adapter"),
            "{mend}"
        );

        let mut closed = fake;
        closed.forbidden.insert("/dev/ttyACM0".to_owned());
        let mend = examine(&closed, port()).mend.unwrap_or_default();
        assert!(mend.contains("dialout"), "{mend}");
    }

    #[test]
    fn a_service_has_to_answer() {
        let place = || Place::Service("127.0.0.1:10001".to_owned());
        let silent = examine(&Fake::good(), place());
        assert_eq!(silent.status, Status::Fail);
        let mut fake = Fake::good();
        fake.services
            .insert("127.0.0.1:10001".parse().expect("an address"));
        assert_eq!(examine(&fake, place()).status, Status::Ok);
    }

    #[test]
    fn a_section_that_is_lacking_is_told() {
        let why = "the arm's file has no section [driver.feetech]".to_owned();
        let lacking = examine(&Fake::good(), Place::NotDescribed { why });
        assert_eq!(lacking.status, Status::Fail);
        assert!(lacking.found.ends_with("no section [driver.feetech]"));
    }
}
