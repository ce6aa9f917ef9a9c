//! A part of a robot as a chain.

use ferntast_model::{
    MAX_JOINTS,
    rigid_body::{Chain, ChainJoint, JointKind, LinkInertia, Placement, PositionLimits},
};

use crate::{
    did_you_mean,
    error::ArmError,
    robot::{Joint, JointType, Robot},
};

/// An arm out of a URDF.
#[derive(Clone, Debug)]
pub struct Arm {
    /// What dynamics and kinematics work on; armatures are zero, which URDF does not tell.
    pub chain: Chain,
    /// Its joints' names, from the base on.
    pub joints: Vec<String>,
    /// The link in whose frame it stands.
    pub base: String,
    /// The link whose frame is the tip.
    pub tip: String,
    /// Greatest torque \[Nm\] or force \[N\] of each joint, where the file tells it.
    pub efforts: Vec<Option<f64>>,
    /// Greatest speed \[rad/s\] or \[m/s\] of each joint, where the file tells it.
    pub velocities: Vec<Option<f64>>,
}

impl Robot {
    /// The arm of all joints that move between the links `base` and `tip`; the base frame
    /// is that of `base`, the tip's that of `tip`.
    ///
    /// # Errors
    ///
    /// [`ArmError`], with the joint or link that is wrong.
    pub fn between(&self, base: &str, tip: &str) -> Result<Arm, ArmError> {
        let (base, tip) = (self.link(base)?, self.link(tip)?);
        let way = self.way(base, tip).ok_or_else(|| ArmError::NotBelow {
            base: self.links[base].name.clone(),
            tip: self.links[tip].name.clone(),
            hint: match self.way(tip, base) {
                Some(_) => ", but above it; exchange them",
                None => "; choose two links of one arm",
            },
        })?;
        self.arm(base, tip, &way)
    }

    /// The arm of these joints, given in order from the base on. The tip's frame is that of
    /// the link which the last one carries; the base frame is that of the outermost link to
    /// which the first one's parent is fixed, usually the file's root or "world".
    ///
    /// # Errors
    ///
    /// [`ArmError`], with the joint or link that is wrong; also where a joint that is not
    /// listed moves between two that are.
    pub fn of_joints(&self, names: &[impl AsRef<str>]) -> Result<Arm, ArmError> {
        let joints: Vec<usize> = names
            .iter()
            .map(|name| self.joint(name.as_ref()))
            .collect::<Result<_, _>>()?;
        let (Some(first), Some(last)) = (joints.first(), joints.last()) else {
            return Err(ArmError::EmptyList);
        };
        let fixed = joints.iter().map(|joint| &self.joints[*joint]);
        let fixed = fixed
            .clone()
            .find(|joint| joint.joint_type == JointType::Fixed);
        if let Some(joint) = fixed {
            return Err(ArmError::Fixed {
                line: joint.line,
                joint: joint.name.clone(),
            });
        }
        for pair in joints.windows(2) {
            let [before, after] = [pair[0], pair[1]].map(|joint| &self.joints[joint]);
            let between = self.way(before.child, after.parent);
            let between = between.ok_or_else(|| ArmError::Order {
                joint: after.name.clone(),
                before: before.name.clone(),
            })?;
            let moves = between.iter().map(|joint| &self.joints[*joint]);
            let moves = moves
                .clone()
                .find(|joint| joint.joint_type != JointType::Fixed);
            if let Some(joint) = moves {
                return Err(ArmError::LeftOut {
                    line: joint.line,
                    joint: joint.name.clone(),
                    before: before.name.clone(),
                    after: after.name.clone(),
                });
            }
        }
        let mut base = self.joints[*first].parent;
        while let Some(joint) = self.carried_by[base].map(|joint| &self.joints[joint]) {
            if joint.joint_type != JointType::Fixed {
                break;
            }
            base = joint.parent;
        }
        let tip = self.joints[*last].child;
        let way = self.way(base, tip).unwrap_or(joints);
        self.arm(base, tip, &way)
    }

    fn link(&self, name: &str) -> Result<usize, ArmError> {
        let names = || self.links.iter().map(|link| link.name.as_str());
        let found = names().position(|own| own == name);
        found.ok_or_else(|| ArmError::NoSuchLink {
            link: name.to_owned(),
            nearest: did_you_mean(name, names()),
        })
    }

    fn joint(&self, name: &str) -> Result<usize, ArmError> {
        let names = || self.joints.iter().map(|joint| joint.name.as_str());
        let found = names().position(|own| own == name);
        found.ok_or_else(|| ArmError::NoSuchJoint {
            joint: name.to_owned(),
            nearest: did_you_mean(name, names()),
        })
    }

    /// The joints from one link down to another; `None` where no way leads there.
    fn way(&self, from: usize, to: usize) -> Option<Vec<usize>> {
        let mut way = Vec::new();
        let mut link = to;
        while link != from {
            let joint = self.carried_by[link]?;
            way.push(joint);
            link = self.joints[joint].parent;
        }
        way.reverse();
        Some(way)
    }

    /// The arm along these joints, of which those that are fixed lead on only.
    fn arm(&self, base: usize, tip: usize, way: &[usize]) -> Result<Arm, ArmError> {
        let moving: Vec<&Joint> = way
            .iter()
            .map(|joint| &self.joints[*joint])
            .filter(|joint| joint.joint_type != JointType::Fixed)
            .collect();
        let kinds: Vec<JointKind> = moving
            .iter()
            .map(|joint| kind(joint))
            .collect::<Result<_, _>>()?;
        let (Some(first), Some(last)) = (moving.first(), moving.last()) else {
            return Err(ArmError::NoJoints {
                base: self.links[base].name.clone(),
                tip: self.links[tip].name.clone(),
            });
        };
        if moving.len() > MAX_JOINTS {
            return Err(ArmError::TooManyJoints {
                count: moving.len(),
                first: first.name.clone(),
                last: last.name.clone(),
            });
        }
        let bodies = self.bodies(&moving);
        // What is fixed between two joints that move.
        let mut led = Placement::identity();
        let mut chain = Vec::new();
        for joint in way.iter().map(|joint| &self.joints[*joint]) {
            let placement = led.then(&joint.origin);
            let Some(kind) = kinds
                .get(chain.len())
                .filter(|_| joint.joint_type != JointType::Fixed)
            else {
                led = placement;
                continue;
            };
            let link = bodies[chain.len()];
            if link.mass == 0.0 {
                let carried = &self.links[joint.child];
                return Err(ArmError::NoInertia {
                    line: carried.line,
                    link: carried.name.clone(),
                    joint: joint.name.clone(),
                });
            }
            chain.push(ChainJoint {
                kind: *kind,
                placement,
                axis: joint.axis,
                armature: 0.0,
                limits: limits(joint)?,
                link,
            });
            led = Placement::identity();
        }
        let limit = |joint: &&Joint| joint.limit;
        Ok(Arm {
            chain: Chain::new(&chain, led)?,
            joints: moving.iter().map(|joint| joint.name.clone()).collect(),
            base: self.links[base].name.clone(),
            tip: self.links[tip].name.clone(),
            efforts: moving.iter().map(|j| limit(j)?.effort).collect(),
            velocities: moving.iter().map(|j| limit(j)?.velocity).collect(),
        })
    }

    /// What each of these joints carries, without what the next one carries, in the frame
    /// of its child.
    fn bodies(&self, moving: &[&Joint]) -> Vec<LinkInertia> {
        let mut below: Vec<Vec<&Joint>> = vec![Vec::new(); self.links.len()];
        for joint in &self.joints {
            below[joint.parent].push(joint);
        }
        let is_chain = |joint: &Joint| moving.iter().any(|own| own.child == joint.child);
        let body = |joint: &&Joint| {
            let mut sum = LinkInertia::zero();
            let mut left = vec![(joint.child, Placement::identity())];
            while let Some((link, placement)) = left.pop() {
                if let Some(inertia) = self.links[link].inertia {
                    sum = sum + inertia.placed(&placement);
                }
                for next in below[link].iter().filter(|next| !is_chain(next)) {
                    left.push((next.child, placement.then(&next.origin)));
                }
            }
            sum
        };
        moving.iter().map(body).collect()
    }
}

/// Turning or sliding; refuses what an arm's joint cannot be.
fn kind(joint: &Joint) -> Result<JointKind, ArmError> {
    let (line, name) = (joint.line, joint.name.clone());
    if let Some(of) = joint.mimics.clone() {
        return Err(ArmError::Mimic {
            line,
            joint: name,
            of,
        });
    }
    let kind = match joint.joint_type {
        JointType::Revolute | JointType::Continuous => JointKind::Revolute,
        JointType::Prismatic => JointKind::Prismatic,
        JointType::Floating => return Err(ArmError::Floating { line, joint: name }),
        JointType::Planar => return Err(ArmError::Planar { line, joint: name }),
        JointType::Fixed => return Err(ArmError::Fixed { line, joint: name }),
    };
    match joint.axis.norm() > 1e-9 {
        true => Ok(kind),
        false => Err(ArmError::NoAxis { line, joint: name }),
    }
}

/// The ends of a joint; a continuous one has none.
fn limits(joint: &Joint) -> Result<PositionLimits, ArmError> {
    if joint.joint_type == JointType::Continuous {
        return Ok(PositionLimits::NONE);
    }
    let (line, name) = (joint.line, joint.name.clone());
    let Some(limit) = joint.limit else {
        return Err(ArmError::NoLimit { line, joint: name });
    };
    let (lower, upper) = (limit.lower, limit.upper);
    if lower > upper {
        return Err(ArmError::Limits {
            line,
            joint: name,
            lower,
            upper,
        });
    }
    Ok(PositionLimits { lower, upper })
}
