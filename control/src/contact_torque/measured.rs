//! From what an arm measures to the torque of the contact.

use super::{FilteredMotion, Form, Links, TorqueOfContact};
use ferntast_model::joint::JointParameters;
use ferntast_model::{JointCount, Joints};

/// What a measurement comes to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OfMeasurement {
    /// Newest link-side positions \[rad\], not filtered.
    pub(crate) link: Joints<f64>,
    /// Filtered motion and the torque of the contact.
    pub(crate) motion: FilteredMotion,
    /// The filters began with it: what they had before is too old.
    pub(crate) anew: bool,
}

/// The torque of the contact from motor positions and joint torques, with gaps between them.
#[derive(Clone, Debug)]
pub(crate) struct MeasuredContact {
    joints: Vec<JointParameters>,
    contact: TorqueOfContact,
    longest_gap: f64,
    started: bool,
    /// How far the gears were wound last [rad].
    wound: Joints<f64>,
}

impl MeasuredContact {
    /// For these `joints` as they are believed to be, as many as `count` says, by `form` and with
    /// filters of `cut_off` \[Hz\], which begin anew after more than `longest_gap` \[s\].
    pub(crate) fn new(
        joints: &[JointParameters],
        count: JointCount,
        form: Form,
        cut_off: f64,
        longest_gap: f64,
    ) -> MeasuredContact {
        MeasuredContact {
            joints: joints.to_vec(),
            contact: TorqueOfContact::new(form, cut_off, count),
            longest_gap,
            started: false,
            wound: Joints::filled(count, 0.0),
        }
    }

    /// The joints as they are believed to be.
    pub(crate) fn joints(&self) -> &[JointParameters] {
        &self.joints
    }

    /// How late everything filtered is \[s\].
    pub(crate) fn delay(&self) -> f64 {
        self.contact.delay()
    }

    /// Begins anew with the next measurement.
    pub(crate) fn forget(&mut self) {
        self.started = false;
    }

    /// Takes in motor positions \[rad\] and joint torques \[Nm\], `passed` \[s\] after the last ones.
    pub(crate) fn step(
        &mut self,
        links: &impl Links,
        passed: f64,
        motor_position: &Joints<f64>,
        joint_torque: &Joints<f64>,
    ) -> OfMeasurement {
        let anew = !self.started || passed > self.longest_gap;
        self.started = true;
        for (joint, wound) in self.wound.iter_mut().enumerate() {
            let own = &self.joints[joint];
            // Beyond its range a sensor says nothing, least of all how far the gear is wound.
            let range = own.torque_sensor_range;
            let torque = joint_torque[joint].clamp(-range, range);
            *wound = match anew {
                true => torque / own.stiffness,
                false => own.wound(*wound, torque, passed),
            };
        }
        let link = Joints::from_fn(motor_position.count(), |joint| {
            motor_position[joint] - self.wound[joint]
        });
        if anew {
            self.contact.reset(links, &link, joint_torque);
        } else {
            self.contact.step(passed, &link, joint_torque);
        }
        OfMeasurement {
            link,
            motion: self.contact.motion(links, passed),
            anew,
        }
    }
}
