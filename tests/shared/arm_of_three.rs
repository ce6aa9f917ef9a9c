//! An arm of three joints and what motors and encoders tell of a run of it.

use ferntast_model::{
    Joints,
    rigid_body::{Chain, Vector3},
};
use ferntast_urdf::Robot;

/// Its joints are not in the order from the base on.
pub const URDF: &str = r#"<robot name="three"><link name="base"/>
<link name="upper"><inertial><origin xyz="0.2 0 0"/><mass value="2"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.03"/></inertial></link>
<link name="lower"><inertial><origin xyz="0.15 0 0"/><mass value="1"/><inertia ixx="0.005" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
<link name="hand"><inertial><origin xyz="0.05 0 0"/><mass value="0.5"/><inertia ixx="0.001" ixy="0" ixz="0" iyy="0.002" iyz="0" izz="0.002"/></inertial></link>
<joint name="wrist_joint" type="continuous"><parent link="lower"/><child link="hand"/><origin xyz="0.3 0 0"/><axis xyz="1 0 0"/></joint>
<joint name="shoulder_joint" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/></joint>
<joint name="elbow_joint" type="continuous"><parent link="upper"/><child link="lower"/><origin xyz="0.4 0 0"/><axis xyz="0 1 0"/></joint></robot>"#;

/// From the base on, without `_joint`.
pub const JOINTS: [&str; 3] = ["shoulder", "elbow", "wrist"];
/// Inertias of motors and gears \[kg m²\].
pub const ARMATURES: [f64; 3] = [0.3, 0.1, 0.05];
/// Friction of each joint \[Nm\], \[Nm s/rad\].
pub const COULOMB: f64 = 0.8;
pub const VISCOUS: f64 = 0.5;

/// `count` rows at 500 Hz: time \[s\], positions \[rad\], motor torques \[Nm\], of the arm of a URDF
/// with these joints.
pub fn run(urdf: &str, count: u32) -> impl Iterator<Item = (f64, [f64; 3], [f64; 3])> + use<> {
    let robot = Robot::read(urdf.as_bytes()).expect("a URDF");
    let chain = robot.whole_arm().expect("an arm").chain;
    (0..count).map(move |n| {
        let t = f64::from(n) * 0.002;
        let (q, torque) = at(&chain, t);
        (t, q, torque)
    })
}

fn at(chain: &Chain, t: f64) -> ([f64; 3], [f64; 3]) {
    let states = [0, 1, 2].map(|joint| {
        let (mut q, mut qd, mut qdd) = (0.0, 0.0, 0.0);
        for (size, rate) in [(0.6, 0.9), (0.25, 2.3), (0.1, 5.1)] {
            let rate = rate * (1.0 + 0.3 * f64::from(joint));
            let (sine, cosine) = (rate * t + f64::from(joint)).sin_cos();
            q += size * sine;
            qd += size * rate * cosine;
            qdd -= size * rate * rate * sine;
        }
        [q, qd, qdd]
    });
    let [q, qd, qdd] = [0, 1, 2].map(|order| states.map(|own| own[order]));
    let [places, speeds, rates] = [q, qd, qdd].map(Joints::from);
    let gravity = Vector3::new(0.0, 0.0, -9.81);
    let links = chain.inverse_dynamics(&places, &speeds, &rates, &gravity);
    let torque = [0, 1, 2].map(|joint| {
        let friction = COULOMB * qd[joint].signum() + VISCOUS * qd[joint];
        links[joint] + ARMATURES[joint] * qdd[joint] + friction
    });
    (q, torque)
}
