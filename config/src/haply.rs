//! How a Haply Inverse3 is a hand.

use ferntast_model::{ParameterError, parameters};

use super::Axes;

parameters! {
    /// A Haply Inverse3 as the hand: section `[hand.haply]`.
    pub struct HaplyConfig {
        /// Where its Inverse Service is.
        pub url: String = "ws://localhost:10001".to_owned(),
        /// Which of the service's axes is x, y and z of `leader_base`, with its sign. Those of the
        /// default are right where its x is to the operator's right, its y away from the operator
        /// and its z up.
        pub axes: [String; 3] = ["y", "-x", "z"].map(String::from),
    }
    check HaplyConfig::axes_turn;
}

impl HaplyConfig {
    /// The axes, where they are those of a rotation.
    pub fn turned(&self) -> Option<Axes> {
        Axes::named(&self.axes)
    }

    /// Where a WebSocket service of that URL listens: the `HOST:PORT` of `ws://HOST:PORT/…`; `None` of
    /// another kind of URL.
    pub fn address_of(url: &str) -> Option<&str> {
        let place = url.strip_prefix("ws://")?;
        Some(place.split('/').next().unwrap_or(place))
    }

    fn axes_turn(&self) -> Result<(), ParameterError> {
        Axes::check(&self.axes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_turned_forth_and_back_and_never_mirrored() {
        let axes = HaplyConfig::default().turned().unwrap();
        // To the right is towards negative y.
        assert_eq!(axes.to_leader([1.0, 0.0, 0.0]), [0.0, -1.0, 0.0]);
        assert_eq!(axes.to_leader([0.0, 1.0, 2.0]), [1.0, 0.0, 2.0]);
        assert_eq!(
            axes.to_device(axes.to_leader([1.0, 2.0, 3.0])),
            [1.0, 2.0, 3.0]
        );
        for bad in [["x", "y", "-z"], ["x", "x", "z"], ["x", "y", "up"]] {
            let axes = bad.map(String::from);
            let config = HaplyConfig {
                axes,
                ..HaplyConfig::default()
            };
            let words = config.validate().unwrap_err().to_string();
            assert!(words.contains("axes"), "{words}");
        }
    }
}
