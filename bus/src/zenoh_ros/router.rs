//! The router's settings from a file of Zenoh's own format, as rmw_zenoh's router takes
//! them: TLS, access control.

use std::path::Path;

use serde_json::Value;

use crate::{endpoint, error::OpenError, zenoh_words::words};

/// Reads them.
pub(super) fn settings(path: &Path) -> Result<zenoh::Config, OpenError> {
    let refused = |reason: &str| OpenError::RouterConfig {
        path: path.to_owned(),
        reason: reason.to_owned(),
    };
    let told = |error: zenoh::Error| refused(&words(error));
    let mut config = zenoh::Config::from_file(path).map_err(told)?;
    match value(&config, "mode") {
        Value::String(mode) if mode == "router" => {}
        // What Zenoh takes a file for that does not say: a router is meant here.
        Value::Null => config.insert_json5("mode", r#""router""#).map_err(told)?,
        other => return Err(refused(&format!("its mode is {other}, not \"router\""))),
    }
    Ok(config)
}

/// Where a router of those settings listens.
pub(super) fn endpoints(config: &zenoh::Config) -> Vec<String> {
    // A list, or one for each mode.
    let listed = match value(config, "listen/endpoints") {
        Value::Object(mut modes) => modes.remove("router").unwrap_or_default(),
        listed => listed,
    };
    let listed = listed.as_array().into_iter().flatten();
    let texts = listed.filter_map(|own| own.as_str().or_else(|| own["endpoint"].as_str()));
    texts.map(str::to_owned).collect()
}

/// The first endpoint at which a router of those settings lets in whoever comes from
/// another host, because it asks nobody for a certificate.
pub(super) fn unprotected(config: &zenoh::Config) -> Option<String> {
    let asks = value(config, "transport/link/tls/enable_mtls") == Value::Bool(true);
    let is_open = |own: &String| {
        let protected = asks && endpoint::is_protected(own);
        !protected && !endpoint::is_loopback(own)
    };
    endpoints(config).into_iter().find(is_open)
}

fn value(config: &zenoh::Config, key: &str) -> Value {
    let text = config.get_json(key).unwrap_or_default();
    serde_json::from_str(&text).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn config(text: &str) -> Result<zenoh::Config, OpenError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("router.json5");
        std::fs::write(&path, text).unwrap();
        settings(&path)
    }

    #[test]
    fn a_file_that_is_no_routers_is_refused_in_words() {
        for (text, word) in [
            (r#"{ mode: "client" }"#, "client"),
            ("{ mode: ", "router.json5"),
            (r#"{ listen: { endpoint: [] } }"#, "router.json5"),
        ] {
            let error = config(text).unwrap_err();
            assert!(matches!(error, OpenError::RouterConfig { .. }), "{error:?}");
            assert!(error.to_string().contains(word), "{error}");
        }
        let error = settings(Path::new("/nowhere/router.json5")).unwrap_err();
        assert!(error.to_string().contains("/nowhere"), "{error}");
    }

    #[test]
    fn who_lets_in_strangers_is_told_from_who_asks_for_a_certificate() {
        let open = |listen: &str, tls: &str| {
            let text = format!(
                "{{ listen: {{ endpoints: {listen} }}, transport: {{ link: {{ tls: {{ {tls} }} }} }} }}"
            );
            unprotected(&config(&text).unwrap())
        };
        assert_eq!(open(r#"["tcp/127.0.0.1:7447"]"#, ""), None);
        let mtls = "enable_mtls: true";
        assert_eq!(open(r#"["tls/0.0.0.0:7447"]"#, mtls), None);
        for (listen, tls, told) in [
            (r#"["tls/0.0.0.0:7447"]"#, "", "tls/0.0.0.0:7447"),
            (
                r#"["tls/0.0.0.0:7447", "tcp/[::]:7448"]"#,
                mtls,
                "tcp/[::]:7448",
            ),
            (
                r#"{ router: ["tcp/[::]:7447"], peer: [] }"#,
                mtls,
                "tcp/[::]:7447",
            ),
        ] {
            assert_eq!(open(listen, tls).as_deref(), Some(told), "{listen}");
        }
    }
}
