//! The arm and what it can touch, as a page draws it in space.

use ferntast_config::{
    ArmFile, Believed,
    serial::{Serial, SerialFile},
};
use ferntast_console::session::spatial::{
    FrameView, JointView, LinkShape, SolidView, SpatialView, ThingView,
};
use ferntast_model::{
    ArmModel, Joints,
    contour::{EdgeParameters, SpringParameters, Surface},
    rigid_body::{JointKind, Placement},
    serial_arm::Plane,
    shape::Shape,
};
use ferntast_urdf::{Placed, Robot, Solid};
use serde_json::Value;

/// Shapes and things that a page is told of at most.
const MOST_SHAPES: usize = 256;
const MOST_THINGS: usize = 64;
/// How high the contour of a planar arm is drawn, and how thick \[m\].
const HEIGHT: f64 = 0.05;
const THICKNESS: f64 = 0.012;

/// What is drawn of the arm of that file.
pub fn spatial(arm: &ArmFile) -> SpatialView {
    match &arm.model {
        Believed::Planar(model) => planar(model),
        Believed::Serial(serial) => match arm.whole() {
            Ok(file) => serial_arm(serial, &file),
            Err(_) => SpatialView::default(),
        },
    }
}

fn frame(placement: &Placement) -> FrameView {
    FrameView {
        at: placement.translation.into(),
        turn: placement.quaternion(),
    }
}

fn serial_arm(serial: &Serial, file: &SerialFile) -> SpatialView {
    let chain = serial.arm.chain();
    let zero = Joints::filled(chain.count(), 0.0);
    let mut frames: Vec<FrameView> = serial.frames(&zero).map(|(.., own)| frame(&own)).collect();
    let tip = frames.pop().unwrap_or_default();
    let moves = chain.kinds().into_iter().zip(chain.axes());
    let joints = frames
        .into_iter()
        .zip(moves)
        .map(|(frame, (kind, axis))| JointView {
            frame,
            axis: axis.into(),
            slides: kind == JointKind::Prismatic,
        });
    SpatialView {
        joints: joints.collect(),
        tip,
        home: file.home.clone(),
        shapes: shapes(file),
        things: things(file),
    }
}

/// What the URDF says of the links' looks.
fn shapes(file: &SerialFile) -> Vec<LinkShape> {
    let Ok(robot) = Robot::read(file.urdf.as_bytes()) else {
        return Vec::new();
    };
    let Ok(arm) = robot.between(&file.base, &file.tip) else {
        return Vec::new();
    };
    let shapes = robot.shapes(&arm).into_iter().take(MOST_SHAPES);
    let view = |(link, Placed { placement, solid }): (usize, Placed)| LinkShape {
        link,
        frame: frame(&placement),
        solid: match solid {
            Solid::Box(size) => SolidView::Box { size },
            Solid::Cylinder { radius, length } => SolidView::Cylinder { radius, length },
            Solid::Sphere(radius) => SolidView::Sphere { radius },
        },
    };
    shapes.map(view).collect()
}

/// What the file of the arm says that there is to touch: where it tells the truth about that, the
/// things themselves, else the planes that are believed to be there.
fn things(file: &SerialFile) -> Vec<ThingView> {
    let true_ones = file.truth.as_ref().and_then(|truth| truth.get("object"));
    if let Some(Value::Array(those)) = true_ones {
        let those = those.iter().take(MOST_THINGS);
        // What is wrong with one, the driver says, which reads the rest of it.
        return those
            .filter_map(|own| serde_json::from_value(own.clone()).ok())
            .collect();
    }
    let planes = file.surface.iter().take(MOST_THINGS);
    let view = |plane: &Plane| ThingView {
        name: plane.name.clone(),
        shape: Shape::Plane {
            point: plane.point,
            normal: plane.normal,
        },
    };
    planes.map(view).collect()
}

/// Two links in a plane, and its contour as walls that stand on it.
fn planar(model: &ArmModel) -> SpatialView {
    let lengths = model.arm.link.each_ref().map(|link| link.length);
    let out = |length: f64| FrameView {
        at: [length, 0.0, 0.0],
        ..FrameView::default()
    };
    let joint = |frame: FrameView| JointView {
        frame,
        axis: [0.0, 0.0, 1.0],
        slides: false,
    };
    let contour = &model.contour;
    let edges = contour.edge.iter().map(wall);
    let springs = contour.spring.iter().map(head);
    SpatialView {
        joints: vec![joint(FrameView::default()), joint(out(lengths[0]))],
        tip: out(lengths[1]),
        home: Vec::new(),
        shapes: Vec::new(),
        things: edges.chain(springs).take(MOST_THINGS).collect(),
    }
}

fn wall(edge: &EdgeParameters) -> ThingView {
    let [from, to] = [edge.from, edge.to];
    let along = [to[0] - from[0], to[1] - from[1]];
    let length = along[0].hypot(along[1]);
    // The free side is on the left.
    let free = [-along[1] / length, along[0] / length];
    let middle = |axis: usize| 0.5 * (from[axis] + to[axis]) - 0.5 * THICKNESS * free[axis];
    ThingView {
        name: match edge.surface {
            Surface::Unlubricated => "bare edge",
            Surface::Lubricated => "lubricated edge",
            Surface::Spring => "spring",
        }
        .to_owned(),
        shape: Shape::Box {
            center: [middle(0), middle(1), 0.0],
            size: [length, THICKNESS, HEIGHT],
            roll_pitch_yaw: [0.0, 0.0, along[1].atan2(along[0])],
        },
    }
}

fn head(spring: &SpringParameters) -> ThingView {
    let [x, y] = spring.direction;
    let length = x.hypot(y);
    let normal = [x / length, y / length, 0.0];
    let [foot_x, foot_y] = spring.anchor;
    ThingView {
        name: "spring".to_owned(),
        shape: Shape::Disc {
            center: [
                foot_x + spring.rest_length * normal[0],
                foot_y + spring.rest_length * normal[1],
                0.0,
            ],
            normal,
            radius: spring.half_width,
            travel: spring.rest_length,
        },
    }
}

#[cfg(test)]
mod tests {
    use ferntast_config::{load_model_only, serial::load_serial};
    use serde_json::json;

    use super::*;

    fn panda() -> ArmFile {
        load_serial("panda").unwrap().unwrap()
    }

    /// The joints of the view, followed at home, lead to the tip of the model.
    #[test]
    fn its_joints_lead_to_the_tip() {
        use by_quaternions::tip_of;
        let arm = panda();
        let view = spatial(&arm);
        assert_eq!((view.joints.len(), view.home.len()), (7, 7));
        let serial = arm.model.serial().unwrap();
        let tip = serial.arm.home_tip().translation;
        let found = tip_of(&view);
        for axis in 0..3 {
            assert!((found[axis] - tip[axis]).abs() < 1e-9, "{found:?} {tip:?}");
        }
    }

    #[test]
    fn things_are_those_of_the_truth_where_the_file_has_them() {
        let arm = panda();
        let told = |arm: &ArmFile| -> Vec<String> {
            let view = spatial(arm);
            view.things.into_iter().map(|own| own.name).collect()
        };
        assert_eq!(told(&arm), ["table", "block", "spring"]);
        let mut file: SerialFile = arm.whole().unwrap();
        file.truth = None;
        // What is believed to be there instead.
        let believed = ArmFile::serial(&file).unwrap();
        assert_eq!(told(&believed), ["table", "edge", "spring"]);
        file.truth = Some(json!({"object": [
            {"name": "ball", "shape": {"kind": "sphere", "center": [0.4, 0.0, 0.3], "radius": 0.05}, "surface": {}},
            {"name": "cone", "shape": {"kind": "cone"}},
            {"name": "edge", "shape": {"kind": "box", "center": [0.4, 0.0, 0.3], "size": [0.1, 0.1, 0.1]}},
        ]}));
        assert_eq!(told(&ArmFile::serial(&file).unwrap()), ["ball", "edge"]);
    }

    #[test]
    fn the_walls_of_a_contour_end_at_its_edges() {
        let arm = load_model_only("rokviss").unwrap();
        let view = spatial(&arm);
        let edge = arm.model.planar().unwrap().contour.edge[0];
        let Shape::Box { center, size, .. } = view.things[0].shape else {
            panic!("a wall is a box");
        };
        // The bare edge goes up; its free side is towards smaller x.
        assert!((center[0] - 0.5 * size[1] - edge.from[0]).abs() < 1e-12);
        assert!((size[0] - (edge.to[1] - edge.from[1])).abs() < 1e-12);
    }

    /// Forward kinematics as the page does it: by quaternions, from the view alone.
    mod by_quaternions {
        use super::SpatialView;

        fn times(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
            let [ax, ay, az, aw] = a;
            let [bx, by, bz, bw] = b;
            [
                aw * bx + ax * bw + ay * bz - az * by,
                aw * by - ax * bz + ay * bw + az * bx,
                aw * bz + ax * by - ay * bx + az * bw,
                aw * bw - ax * bx - ay * by - az * bz,
            ]
        }

        fn turned(q: [f64; 4], [x, y, z]: [f64; 3]) -> [f64; 3] {
            let conjugate = [-q[0], -q[1], -q[2], q[3]];
            let [x, y, z, _] = times(times(q, [x, y, z, 0.0]), conjugate);
            [x, y, z]
        }

        pub fn tip_of(view: &SpatialView) -> [f64; 3] {
            let (mut at, mut turn) = ([0.0; 3], [0.0, 0.0, 0.0, 1.0]);
            for (joint, q) in view.joints.iter().zip(&view.home) {
                let way = turned(turn, joint.frame.at);
                at = [0, 1, 2].map(|axis| at[axis] + way[axis]);
                let (sine, cosine) = (0.5 * q).sin_cos();
                let [x, y, z] = joint.axis.map(|own| own * sine);
                turn = times(times(turn, joint.frame.turn), [x, y, z, cosine]);
            }
            let way = turned(turn, view.tip.at);
            [0, 1, 2].map(|axis| at[axis] + way[axis])
        }
    }
}
