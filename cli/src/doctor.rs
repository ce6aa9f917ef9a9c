//! `ferntast doctor`.

use std::{io::IsTerminal, path::PathBuf, process::ExitCode, thread, time::Duration};

use ferntast_config::Middleware;
use ferntast_doctor::{self as doctor, DoctorOptions, Peer, RosMiddleware, TcpEndpoint};
use ferntast_nodes::bridge::gateway;

use super::{Failure, output::print_json, scenario_options::ScenarioOptions};

/// Say what this machine offers and lacks.
#[derive(Debug, clap::Args)]
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
    let options = DoctorOptions {
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
