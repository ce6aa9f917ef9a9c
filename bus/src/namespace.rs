//! A namespace of ROS 2, so that two sessions can stand in one domain.

/// The absolute `name`, `/follower/measured_js`, within `namespace`: `/left/follower/measured_js`
/// within `/left`, as it is within `/`.
pub(crate) fn within(namespace: &str, name: &str) -> String {
    format!("{}{name}", namespace.trim_end_matches('/'))
}

#[cfg(test)]
mod tests {
    use super::within;

    #[test]
    fn the_root_changes_nothing() {
        assert_eq!(within("/", "/tf"), "/tf");
        assert_eq!(within("/left/arm", "/tf"), "/left/arm/tf");
    }
}
