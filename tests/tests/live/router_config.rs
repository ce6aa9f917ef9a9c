//! `--router-config`: the session's router for ROS 2 as a file of Zenoh has it, with TLS and who may what by the name in a
//! certificate (docs/who_may_do_what.md), and peers that speak as rmw_zenoh does.

use std::{fs, thread, time::Duration};

use ferntast_tests::{
    PATIENCE, Process, Session, await_enabled, free_tcp_port, number, operated, rearmed,
    state_of_follower, wait_until,
};
use rcgen::{BasicConstraints, CertificateParams, CertifiedIssuer, DnType, IsCa, KeyPair};
use serde_json::{Value, json};

/// Files of an authority, the router and peers in the session's folder: `ca.pem`, `router.json5`, and
/// `NAME.pem`, `NAME.key` and `NAME.json5` of each name. `intruder` calls itself operator, by an authority of its own.
fn write_files(session: &Session, port: u16) {
    let write = |name: &str, text: &str| {
        fs::write(session.folder().join(name), text)
            .unwrap_or_else(|error| panic!("{name}: {error}"));
    };
    let [authority, other] = [(), ()].map(|()| {
        let mut own = CertificateParams::default();
        own.is_ca = IsCa::Ca(BasicConstraints::Unconstrained);
        CertifiedIssuer::self_signed(own, KeyPair::generate().expect("a key"))
            .expect("an authority")
    });
    write("ca.pem", &authority.pem());
    let endpoints = json!({"endpoints": [format!("tls/localhost:{port}")]});
    for (name, called, by) in [
        ("arm", "arm", &authority),
        ("operator", "operator", &authority),
        ("watcher", "watcher", &authority),
        ("intruder", "operator", &other),
    ] {
        let mut own = CertificateParams::new(["localhost".to_owned()]).expect("a name");
        own.distinguished_name.push(DnType::CommonName, called);
        let key = KeyPair::generate().expect("a key");
        let certificate = own.signed_by(&key, by).expect("a certificate");
        write(&format!("{name}.pem"), &certificate.pem());
        write(&format!("{name}.key"), &key.serialize_pem());
        let tls = json!({
            "root_ca_certificate": "ca.pem",
            "connect_certificate": format!("{name}.pem"),
            "connect_private_key": format!("{name}.key"),
            "enable_mtls": true,
        });
        let mut connect = endpoints.clone();
        connect["timeout_ms"] = json!(5000);
        let peer = json!({
            "mode": "client",
            "connect": connect,
            "scouting": {"multicast": {"enabled": false}},
            "transport": {"link": {"tls": tls}},
        });
        write(&format!("{name}.json5"), &peer.to_string());
    }
    let all = [
        "put",
        "delete",
        "declare_subscriber",
        "query",
        "reply",
        "declare_queryable",
    ];
    let seen = [
        "liveliness_token",
        "liveliness_query",
        "declare_liveliness_subscriber",
    ];
    let rule = |id: &str, flows: &[&str], messages: &[&str]| json!({"id": id, "permission": "allow", "key_exprs": ["**"], "flows": flows, "messages": messages});
    let router = json!({
        "mode": "router",
        "listen": endpoints,
        "scouting": {"multicast": {"enabled": false}},
        "transport": {"link": {"tls": {
            "root_ca_certificate": "ca.pem",
            "listen_certificate": "arm.pem",
            "listen_private_key": "arm.key",
            "enable_mtls": true,
        }}},
        "access_control": {
            "enabled": true,
            "default_permission": "deny",
            "rules": [
                rule("all", &["ingress", "egress"], &[&all[..], &seen].concat()),
                rule("listen", &["egress"], &["put", "reply", "liveliness_token"]),
                rule("ask", &["ingress"], &["declare_subscriber", "query", "liveliness_query", "declare_liveliness_subscriber"]),
            ],
            "subjects": [
                {"id": "operators", "cert_common_names": ["operator"]},
                {"id": "watchers", "cert_common_names": ["watcher"]},
            ],
            "policies": [
                {"rules": ["all"], "subjects": ["operators"]},
                {"rules": ["listen", "ask"], "subjects": ["watchers"]},
            ],
        },
    });
    write("router.json5", &router.to_string());
}

#[test]
fn who_has_which_certificate_may_stop_the_arm_or_only_listen() {
    let session = Session::new();
    write_files(&session, free_tcp_port());
    let mut command = session.ferntast(&["session", "--json", "--no-console", "--no-rearm"]);
    command.args(["--session", session.name(), "--record", "run"]);
    command.args(["--link-endpoint", &session.link_endpoint()]);
    command.args(["--middleware", "zenoh", "--router-config", "router.json5"]);
    let mut process = Process::spawn(command);
    await_enabled(&session, &mut process);
    let begin = |name: &str, arguments: &[&str]| {
        let config = format!("{name}.json5");
        let arguments = [&["--config", config.as_str()], arguments].concat();
        Process::spawn(session.peer("zenoh_peer.py", &arguments))
    };
    let peer = |name: &str, arguments: &[&str]| begin(name, arguments).wait(PATIENCE);
    let count = [
        "count",
        "/follower/measured_js",
        "sensor_msgs/msg/JointState",
        "--seconds",
        "40",
        "--at-least",
        "100",
    ];
    for name in ["operator", "watcher"] {
        let heard: Value = peer(name, &count).success().json();
        assert!(number(&heard, "received") >= 100.0, "{name}: {heard:#}");
    }
    let intruder = peer("intruder", &count).failure();
    assert!(
        intruder.stderr.contains("Unable to connect"),
        "{intruder:#?}"
    );

    let pause = ["command", "/follower/state_command", "pause"];
    // Of an arm that a busy machine holds already nobody would see that it is asked to pause.
    let told = operated(&session, begin("watcher", &pause))
        .success()
        .json();
    assert_eq!(told["heard"], false);
    thread::sleep(Duration::from_secs(1));
    let paused = "pause was asked for";
    assert!(!process.stderr().contains(paused), "{}", process.stderr());
    let obeyed = (0..4).any(|_| {
        rearmed(&session);
        let told = peer("operator", &pause).success().json();
        assert_eq!(told["heard"], true);
        wait_until(Duration::from_secs(5), || process.stderr().contains(paused))
    });
    assert!(obeyed, "{}", process.stderr());
    assert_eq!(state_of_follower(&session), "PAUSED");
    process.interrupt();
    let ended = process.wait(PATIENCE).success();
    // Unlike a router of the session's own making beyond the loopback, this one knows whom it lets in.
    assert!(!ended.stderr.contains("certificate"), "{}", ended.stderr);
}
