//! What an arm looks like: the shapes of its links, and of all that hangs on them.

use ferntast_model::rigid_body::Placement;

use crate::{
    arm::Arm,
    robot::{Link, Robot},
    solid::Placed,
};

impl Robot {
    /// The shapes of an arm of this robot, each with the number of the link that it moves with:
    /// 0 is the base, n what the n-th joint carries, with all that hangs on it as if other
    /// joints were held at position zero. Placements are in the frames of these links.
    pub fn shapes(&self, arm: &Arm) -> Vec<(usize, Placed)> {
        let number = |name: &str| self.links.iter().position(|link: &Link| link.name == name);
        let carriers = std::iter::once(&arm.base).chain(&arm.links);
        let carriers: Vec<usize> = carriers.filter_map(|name| number(name)).collect();
        let mut found = Vec::new();
        for (body, carrier) in carriers.iter().enumerate() {
            let mut left = vec![(*carrier, Placement::identity())];
            while let Some((link, placement)) = left.pop() {
                let here = self.links[link].shapes.iter().map(|own| Placed {
                    placement: placement.then(&own.placement),
                    solid: own.solid,
                });
                found.extend(here.map(|own| (body, own)));
                let below = self.joints.iter().filter(|joint| joint.parent == link);
                for joint in below.filter(|joint| !carriers.contains(&joint.child)) {
                    left.push((joint.child, placement.then(&joint.origin)));
                }
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solid::Solid;

    const FILE: &str = r#"<robot name="r">
      <link name="base">
        <visual><geometry><mesh filename="package://missing/base.stl"/></geometry></visual>
        <collision><origin xyz="0 0 0.1"/><geometry><cylinder radius="0.05" length="0.2"/></geometry></collision>
      </link>
      <joint name="one" type="revolute">
        <parent link="base"/><child link="upper"/><origin xyz="0 0 0.2"/>
        <limit lower="-1" upper="1"/>
      </joint>
      <link name="upper">
        <inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial>
        <visual><geometry><box size="0.1 0.2 0.3"/></geometry></visual>
        <visual><geometry><sphere radius="-1"/></geometry></visual>
        <visual><origin xyz="nowhere"/><geometry><sphere radius="1"/></geometry></visual>
        <collision><geometry><sphere radius="1"/></geometry></collision>
      </link>
      <joint name="flange" type="fixed">
        <parent link="upper"/><child link="tool"/><origin xyz="0.3 0 0"/>
      </joint>
      <link name="tool"><visual><origin xyz="0.1 0 0"/><geometry><sphere radius="0.02"/></geometry></visual></link>
    </robot>"#;

    #[test]
    fn shapes_go_with_the_link_that_carries_them_and_bad_ones_are_left_out() {
        let robot = Robot::read(FILE.as_bytes()).unwrap();
        let shapes = robot.shapes(&robot.whole_arm().unwrap());
        let told: Vec<_> = shapes
            .iter()
            .map(|(body, own)| {
                (
                    *body,
                    own.placement.translation.x,
                    own.placement.translation.z,
                    own.solid,
                )
            })
            .collect();
        let cylinder = Solid::Cylinder {
            radius: 0.05,
            length: 0.2,
        };
        assert_eq!(
            told,
            [
                (0, 0.0, 0.1, cylinder),
                (1, 0.0, 0.0, Solid::Box([0.1, 0.2, 0.3])),
                (1, 0.4, 0.0, Solid::Sphere(0.02)),
            ]
        );
    }
}
