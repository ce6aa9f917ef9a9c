//! `ferntast doctor`.

use std::{io::IsTerminal, path::PathBuf, process::ExitCode, thread, time::Duration};

use ferntast_config::{ArmFile, HandSource, HaplyConfig, Loaded, Middleware};
use ferntast_doctor::{
    self as doctor, Device, DoctorOptions, Peer, Place, RosMiddleware, TcpEndpoint,
};
use ferntast_drivers::{Choice, dynamixel, feetech, motors::section::Section};
use ferntast_nodes::bridge::gateway;

use super::{Failure, output::print_json, scenario_options::ScenarioOptions};

/// Say what this machine offers and lacks.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "With --driver dynamixel or feetech, and --hand haply, it looks for section, port and service, and sends \
    nothing to motors: whether they answer, `ferntast arm check` says. What --driver process and ros2 need is not looked at."
)]
pub struct Arguments {
    /// Where recordings are to go.
    #[arg(long, default_value = "recordings", value_name = "DIR")]
    recordings: PathBuf,

    #[command(flatten)]
    scenario: ScenarioOptions,
}

/// How long peers are listened for.
const LISTEN: Duration = Duration::from_secs(3);

/// Runs it; exit code 1 when something fails that a session needs.
pub fn run(arguments: Arguments, json: bool) -> Result<ExitCode, Failure> {
    let loaded = arguments.scenario.load()?;
    let section = &loaded.scenario.gateway;
    let mut endpoints = Vec::new();
    let link = &loaded.scenario.link.endpoint;
    if !["udp/", "sealed-udp/", "quic/"]
        .iter()
        .any(|kind| link.starts_with(kind))
    {
        endpoints.push(TcpEndpoint {
            purpose: "link".to_owned(),
            address: link.clone(),
        });
    }
    if let Some(router) = section.own_router() {
        endpoints.push(TcpEndpoint {
            purpose: "Zenoh router".to_owned(),
            address: router.to_owned(),
        });
    }
    let devices = devices(&loaded, &arguments.scenario);
    let options = DoctorOptions {
        devices,
        recording_folder: arguments.recordings,
        tcp_endpoints: endpoints,
        middleware: match section.middleware {
            Middleware::Dds => RosMiddleware::Dds,
            Middleware::Zenoh => RosMiddleware::Zenoh,
        },
        ros_domain: Some(section.domain_id),
        peers_duration: LISTEN,
        ..DoctorOptions::default()
    };
    if !json {
        eprintln!(
            "examining this machine, listening for ROS 2 peers for {} s …",
            LISTEN.as_secs()
        );
    }
    let peers = || -> Result<Vec<Peer>, String> {
        let bus = gateway::open_ros(section).map_err(|error| error.to_string())?;
        thread::sleep(LISTEN);
        Ok(bus
            .topics_seen()
            .into_iter()
            .map(|(name, type_name)| Peer::topic(&name, &type_name))
            .collect())
    };
    let report = doctor::examine(&options, &peers);
    if json {
        print_json(&report)?;
    } else {
        println!("{}", report.text(std::io::stdout().is_terminal()));
    }
    Ok(ExitCode::from(report.exit_code()))
}

/// The hardware behind arm and hand, where it is such as can be looked for.
fn devices(loaded: &Loaded, options: &ScenarioOptions) -> Vec<Device> {
    let hand = &loaded.scenario.hand;
    let driver = options.driver();
    let mut devices = Vec::new();
    let arm = driver.as_deref().and_then(|own| motors(own, &loaded.arm));
    devices.extend(arm.map(|place| Device {
        purpose: format!("the arm ({})", driver.unwrap_or_default()),
        place,
    }));
    match hand.source {
        HandSource::Haply => {
            let url = hand.haply.clone().unwrap_or_default().url;
            let place = HaplyConfig::address_of(&url).unwrap_or(&url);
            devices.push(Device {
                purpose: "the hand (haply)".to_owned(),
                place: Place::Service(place.to_owned()),
            });
        }
        HandSource::Leader => {
            if let (Some(section), Some(arm)) = (&hand.leader, &loaded.leader) {
                devices.extend(motors(&section.driver, arm).map(|place| Device {
                    purpose: format!("the leader arm ({})", section.driver),
                    place,
                }));
            }
        }
        _ => {}
    }
    devices
}

/// Where the motors of an arm are, if its driver has any.
fn motors(driver: &str, arm: &ArmFile) -> Option<Place> {
    let name = match driver.parse() {
        Ok(Choice::Dynamixel) => dynamixel::NAME,
        Ok(Choice::Feetech) => feetech::NAME,
        _ => return None,
    };
    let section = Section::of(name, arm, &arm.model.joint_names());
    Some(match section {
        Ok(section) => Place::SerialPort(section.port),
        Err(error) => Place::NotDescribed {
            why: error.to_string(),
        },
    })
}
