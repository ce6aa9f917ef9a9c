//! Which axes of a device's frame are those of `leader_base`.

use ferntast_model::ParameterError;

/// From the axes of a device to those of `leader_base`: for each of these the place of the
/// device's, and its sign.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axes([(usize, f64); 3]);

impl Axes {
    /// The device's axis that is x, y and z of the leader, as `"-x"`; `None` where they are not
    /// those of a rotation.
    pub fn named(names: &[String; 3]) -> Option<Axes> {
        let mut axes = [(0, 1.0); 3];
        for (place, name) in axes.iter_mut().zip(names) {
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

    /// Checks the key `axes` of a section.
    pub(super) fn check(names: &[String; 3]) -> Result<(), ParameterError> {
        match Axes::named(names) {
            Some(_) => Ok(()),
            None => Err(ParameterError::Inconsistent {
                key: "axes".to_owned(),
                reason: "each of x, y and z once, signs such that right stays right, as \"y\", \"-x\", \"z\"".to_owned(),
            }),
        }
    }

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
