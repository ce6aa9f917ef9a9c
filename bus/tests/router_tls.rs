//! The router for ROS 2 set up by a file, as docs/who_may_do_what.md has it: peers show
//! certificates, and what each may do goes by the name in it.

#![allow(missing_docs)]
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::{
    fs,
    net::TcpListener,
    path::{Path, PathBuf},
    process,
    time::{Duration, Instant},
};

use ferntast_bus::{OpenError, ZenohBus, ZenohConfig, ZenohMode};
use ferntast_msgs::{
    Time,
    sample::{StateCommand, StateCommandSample},
    topics::{Delivery, Topic, TopicName},
};
use rcgen::{BasicConstraints, CertificateParams, CertifiedIssuer, DnType, IsCa, KeyPair};
use zenoh::Wait;

const PATIENCE: Duration = Duration::from_secs(20);

/// An authority with the certificates that it gave, in a folder.
struct Authority {
    folder: tempfile::TempDir,
    issuer: CertifiedIssuer<'static, KeyPair>,
}

impl Authority {
    fn new() -> Authority {
        let folder = tempfile::tempdir().unwrap();
        let mut own = CertificateParams::default();
        own.is_ca = IsCa::Ca(BasicConstraints::Unconstrained);
        let key = KeyPair::generate().unwrap();
        let issuer = CertifiedIssuer::self_signed(own, key).unwrap();
        fs::write(folder.path().join("ca.pem"), issuer.pem()).unwrap();
        Authority { folder, issuer }
    }

    /// Gives one; `NAME.pem` and `NAME.key` are its files.
    fn certify(&self, name: &str) {
        let mut own = CertificateParams::new(["localhost".to_owned()]).unwrap();
        own.distinguished_name.push(DnType::CommonName, name);
        let key = KeyPair::generate().unwrap();
        let certificate = own.signed_by(&key, &self.issuer).unwrap();
        fs::write(self.file(name, "pem"), certificate.pem()).unwrap();
        fs::write(self.file(name, "key"), key.serialize_pem()).unwrap();
    }

    fn file(&self, name: &str, kind: &str) -> PathBuf {
        self.folder.path().join(format!("{name}.{kind}"))
    }

    fn router(&self, port: u16) -> PathBuf {
        let path = self.file("router", "json5");
        let folder = self.folder.path().display();
        let text = format!(
            r#"{{
  mode: "router",
  listen: {{ endpoints: ["tls/localhost:{port}"] }},
  scouting: {{ multicast: {{ enabled: false }} }},
  transport: {{ link: {{ tls: {{
    root_ca_certificate: "{folder}/ca.pem",
    listen_certificate: "{folder}/arm.pem",
    listen_private_key: "{folder}/arm.key",
    enable_mtls: true,
  }} }} }},
  access_control: {{
    enabled: true,
    default_permission: "deny",
    rules: [
      {{ id: "everything", permission: "allow", key_exprs: ["**"], flows: ["ingress", "egress"],
        messages: ["put", "delete", "declare_subscriber", "query", "reply", "declare_queryable",
                   "liveliness_token", "liveliness_query", "declare_liveliness_subscriber"] }},
      {{ id: "listen", permission: "allow", key_exprs: ["**"], flows: ["egress"],
        messages: ["put", "reply", "liveliness_token"] }},
      {{ id: "ask", permission: "allow", key_exprs: ["**"], flows: ["ingress"],
        messages: ["declare_subscriber", "query", "liveliness_query", "declare_liveliness_subscriber"] }},
    ],
    subjects: [
      {{ id: "operators", cert_common_names: ["operator"] }},
      {{ id: "watchers", cert_common_names: ["watcher"] }},
    ],
    policies: [
      {{ rules: ["everything"], subjects: ["operators"] }},
      {{ rules: ["listen", "ask"], subjects: ["watchers"] }},
    ],
  }},
}}"#
        );
        fs::write(&path, text).unwrap();
        path
    }

    /// A peer of its own with the certificate of that name.
    fn peer(&self, name: &str, root: &Path, port: u16) -> Result<zenoh::Session, zenoh::Error> {
        let mut config = zenoh::Config::default();
        let tls = serde_json::json!({
            "root_ca_certificate": root,
            "connect_certificate": self.file(name, "pem"),
            "connect_private_key": self.file(name, "key"),
            "enable_mtls": true,
        });
        for (key, value) in [
            ("mode", r#""client""#),
            ("connect/endpoints", &format!(r#"["tls/localhost:{port}"]"#)),
            ("connect/timeout_ms", "3000"),
            ("scouting/multicast/enabled", "false"),
            ("transport/link/tls", &tls.to_string()),
        ] {
            config.insert_json5(key, value)?;
        }
        zenoh::open(config).wait()
    }
}

fn free_port() -> u16 {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    listener.local_addr().unwrap().port()
}

#[test]
fn peers_are_let_in_by_certificate_and_do_what_its_name_may() {
    let (authority, stranger) = (Authority::new(), Authority::new());
    for name in ["arm", "operator", "watcher"] {
        authority.certify(name);
    }
    stranger.certify("operator");
    let port = free_port();
    let mode = ZenohMode::RouterOf {
        config: authority.router(port),
    };
    assert_eq!(ZenohBus::unprotected(&mode).unwrap(), None);
    let domain_id = 1 + process::id() % 99;
    let bus = ZenohBus::open(&ZenohConfig {
        mode,
        domain_id,
        node_name: "router".to_owned(),
        namespace: "/".to_owned(),
    })
    .unwrap();
    let name = TopicName::new(&format!("/w{}/state_command", process::id())).unwrap();
    let topic: Topic<StateCommandSample> = Topic::new(name, Delivery::State);
    let mut publisher = bus.publisher(topic).unwrap();

    let root = authority.file("ca", "pem");
    let refused = stranger.peer("operator", &root, port);
    assert!(refused.is_err(), "a stranger was let in");
    let [operator, watcher] =
        ["operator", "watcher"].map(|name| authority.peer(name, &root, port).unwrap());

    // Both hear what the session says.
    let mut say = || {
        let now = Time::from_nanos(1_700_000_000_000_000_000);
        let message = StateCommandSample::new(now, StateCommand::PAUSE);
        publisher.publish(now, &message).unwrap();
    };
    let key = format!("{domain_id}/**");
    let mut heard = Vec::new();
    for peer in [&operator, &watcher] {
        let subscriber = peer.declare_subscriber(&key).wait().unwrap();
        let begun = Instant::now();
        let sample = loop {
            say();
            let sample = subscriber.recv_timeout(Duration::from_millis(50)).unwrap();
            assert!(begun.elapsed() < PATIENCE, "nothing was heard");
            if let Some(sample) = sample {
                break sample;
            }
        };
        heard.push(sample);
    }

    // What the operator says is heard by the watcher, and not the other way round.
    let word = format!("{domain_id}/word");
    let says = |from: &zenoh::Session, to: &zenoh::Session, within: Duration| {
        let subscriber = to.declare_subscriber(&word).wait().unwrap();
        let begun = Instant::now();
        while begun.elapsed() < within {
            from.put(&word, "pause").wait().unwrap();
            if let Ok(Some(_)) = subscriber.recv_timeout(Duration::from_millis(50)) {
                return true;
            }
        }
        false
    };
    assert!(says(&operator, &watcher, PATIENCE));
    assert!(!says(&watcher, &operator, Duration::from_secs(2)));
    drop(publisher);
}

#[test]
fn a_router_that_lets_in_everybody_is_told() {
    let mode = |listen: &str| ZenohMode::Router {
        listen: listen.to_owned(),
    };
    assert_eq!(ZenohBus::unprotected(&mode("tcp/127.0.0.1:7447")), Ok(None));
    let open = "tcp/0.0.0.0:7447";
    assert_eq!(
        ZenohBus::unprotected(&mode(open)),
        Ok(Some(open.to_owned()))
    );
    let config = PathBuf::from("/nowhere/router.json5");
    let error = ZenohBus::unprotected(&ZenohMode::RouterOf { config }).unwrap_err();
    assert!(matches!(error, OpenError::RouterConfig { .. }), "{error}");
}
