//! How a Haply Inverse3 is a hand.

use ferntast_model::{ParameterError, parameters};

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

/// From the axes of a device to those of `leader_base`: for each of these the place of the
/// device's, and its sign.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axes([(usize, f64); 3]);

impl HaplyConfig {
    /// The axes, where they are those of a rotation.
    pub fn turned(&self) -> Option<Axes> {
        let mut axes = [(0, 1.0); 3];
        for (place, name) in axes.iter_mut().zip(&self.axes) {
            let (sign, name) = match name.strip_prefix('-') {
                Some(name) => (-1.0, name),
                None => (1.0, name.as_str()),
            };
            *place = (["x", "y", "z"].iter().position(|own| *own == name)?, sign);
        }
        let axes = Axes(axes);
        let [x, y, z] =
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|own| axes.to_leader(own));
        let cross = [
            x[1] * y[2] - x[2] * y[1],
            x[2] * y[0] - x[0] * y[2],
            x[0] * y[1] - x[1] * y[0],
        ];
        (cross == z).then_some(axes)
    }

    fn axes_turn(&self) -> Result<(), ParameterError> {
        match self.turned() {
            Some(_) => Ok(()),
            None => Err(ParameterError::Inconsistent {
                key: "axes".to_owned(),
                reason: "each of x, y and z once, signs such that right stays right, as \"y\", \"-x\", \"z\"".to_owned(),
            }),
        }
    }
}

impl Axes {
    /// A vector of the device's frame, in that of the leader.
    pub fn to_leader(&self, device: [f64; 3]) -> [f64; 3] {
        self.0.map(|(place, sign)| sign * device[place])
    }

    /// A vector of the leader's frame, in that of the device.
    pub fn to_device(&self, leader: [f64; 3]) -> [f64; 3] {
        let mut device = [0.0; 3];
        for ((place, sign), value) in self.0.into_iter().zip(leader) {
            device[place] = sign * value;
        }
        device
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
