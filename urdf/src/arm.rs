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
    /// The link that each joint carries.
    pub links: Vec<String>,
    /// The link in whose frame it stands.
    pub base: String,
    /// The link whose frame is the tip.
    pub tip: String,
    /// Greatest torque \[Nm\] or force \[N\] of each joint, where the file tells it.
    pub efforts: Vec<Option<f64>>,
    /// Greatest speed \[rad/s\] or \[m/s\] of each joint, where the file tells it.
    pub velocities: Vec<Option<f64>>,
    /// Joints of the file that are none of these and carry something that these carry, as a
    /// gripper's: all that is taken to stand at zero.
    pub standing: Vec<String>,
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

    /// The arm that the file is of, where nobody says which: from the link that nothing
    /// carries along all joints that move, as far as no link carries two of them (the
    /// fingers of a hand). Its tip is the link that is fixed furthest out behind the last
    /// joint; one with `tcp`, `tool` or `tip` in its name comes first.
    ///
    /// # Errors
    ///
    /// [`ArmError::Ambiguous`], where the file begins with several arms; otherwise as
    /// [`Robot::between`].
    pub fn whole_arm(&self) -> Result<Arm, ArmError> {
        let roots = (0..self.links.len()).filter(|link| self.carried_by[*link].is_none());
        // A "world" without anything, or a camera, may stand beside the arm.
        let longest = roots.map(|root| (root, self.out_from(root)));
        let longest = longest.max_by_key(|(_, (way, _))| way.len());
        let Some((root, (way, branches))) = longest else {
            return Err(ArmError::EmptyList);
        };
        if way.is_empty() && branches.len() > 1 {
            return Err(ArmError::Ambiguous {
                link: self.links[root].name.clone(),
                joints: branches
                    .iter()
                    .map(|own| self.joints[*own].name.clone())
                    .collect(),
            });
        }
        let last = way.last().map_or(root, |joint| self.joints[*joint].child);
        self.between(
            &self.links[root].name,
            &self.links[self.tip_behind(last)].name,
        )
    }

    /// The joints that move one behind the other from `root` on, and those between which
    /// there is a choice then.
    fn out_from(&self, root: usize) -> (Vec<usize>, Vec<usize>) {
        let (mut way, mut link) = (Vec::new(), root);
        loop {
            let fixed = self.fixed_to(link);
            let moving = |joint: &&Joint| {
                fixed.iter().any(|(own, _)| *own == joint.parent)
                    && joint.joint_type != JointType::Fixed
            };
            let numbers = (0..self.joints.len()).filter(|own| moving(&&self.joints[*own]));
            let branches: Vec<usize> = numbers.collect();
            match branches[..] {
                [only] if self.joints[only].mimics.is_none() => {
                    way.push(only);
                    link = self.joints[only].child;
                }
                _ => return (way, branches),
            }
        }
    }

    /// `link` and all that is fixed to it, with how many joints further out each is.
    fn fixed_to(&self, link: usize) -> Vec<(usize, usize)> {
        let mut found = vec![(link, 0)];
        let mut next = 0;
        while let Some(&(parent, depth)) = found.get(next) {
            let fixed = self
                .joints
                .iter()
                .filter(|joint| joint.parent == parent && joint.joint_type == JointType::Fixed);
            found.extend(fixed.map(|joint| (joint.child, depth + 1)));
            next += 1;
        }
        found
    }

    /// Of what is fixed to `link`, what is used as the arm's tip.
    fn tip_behind(&self, link: usize) -> usize {
        const NAMES: [&str; 3] = ["tcp", "tool", "tip"];
        let named = |link: usize| {
            let name = self.links[link].name.to_lowercase();
            NAMES.iter().any(|part| name.contains(part))
        };
        let fixed = self.fixed_to(link);
        let best = fixed
            .iter()
            .max_by_key(|(own, depth)| (named(*own), *depth));
        best.map_or(link, |(own, _)| *own)
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
            links: moving
                .iter()
                .map(|joint| self.links[joint.child].name.clone())
                .collect(),
            base: self.links[base].name.clone(),
            tip: self.links[tip].name.clone(),
            efforts: moving.iter().map(|j| limit(j)?.effort).collect(),
            velocities: moving.iter().map(|j| limit(j)?.velocity).collect(),
            standing: self.standing(&moving),
        })
    }

    /// Joints that are none of `moving`, and turn or slide something with a mass that these carry.
    fn standing(&self, moving: &[&Joint]) -> Vec<String> {
        let Some(first) = moving.first() else {
            return Vec::new();
        };
        let carries = |joint: &Joint| {
            let mut links = self.links.iter().enumerate();
            links.any(|(link, own)| own.inertia.is_some() && self.way(joint.child, link).is_some())
        };
        let others = self.joints.iter().filter(|joint| {
            joint.joint_type != JointType::Fixed
                && !moving.iter().any(|own| own.child == joint.child)
                && self.way(first.child, joint.parent).is_some()
                && carries(joint)
        });
        others.map(|joint| joint.name.clone()).collect()
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
