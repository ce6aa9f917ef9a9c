//! A step of the simulated serial arm asks for no memory.

#[path = "../../tests/shared/allocations.rs"]
mod allocations;
#[path = "simulated/serial_arm/arms.rs"]
mod arms;

use ferntast_model::Joints;
use ferntast_sim::serial_arm::SerialArm;

#[test]
fn advancing_and_measuring_do_not_allocate() {
    let chain = arms::seven_joints();
    let text = "start_position = [0.0, 0.3, 0.0, -1.6, 0.0, 1.9, 0.0]\n[[joint]]\nstiffness = 1e4\n\
        friction = { b_0 = 2.0, b_0T = 0.05, b_1 = 3.0, b_2 = 0.0, b_3 = 0.0, linear_from = 1.0 }\n\
        [[object]]\nname = \"floor\"\nshape = { kind = \"plane\", point = [0, 0, 0.4], normal = [0, 0, 1] }\n\
        surface = { stiffness = 1e4, damping = 0, friction = 0.3, tangential_stiffness = 1e4, \
        tangential_damping = 0 }\n";
    let parameters = toml::from_str(text).unwrap();
    let mut arm = SerialArm::new(&chain, &arms::any_torque(&chain), &parameters, 1).unwrap();
    let torque = Joints::filled(chain.count(), 0.0);
    let mut touched = false;
    let ((), asked) = allocations::allocations(|| {
        for _ in 0..1000 {
            arm.advance(&torque, 1e-3);
            arm.measure();
            touched |= arm.truth().normal_force > 0.0;
        }
    });
    assert!(touched);
    assert_eq!(asked, 0);
}
