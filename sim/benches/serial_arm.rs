//! How much faster than time the simulated arm of seven joints runs, the plant alone: a tick
//! of 1 ms with measurements. It is the processor's time that counts, so that other programs
//! do not.

#[path = "../tests/simulated/serial_arm/arms.rs"]
mod arms;

use ferntast_model::Joints;
use ferntast_sim::serial_arm::SerialArm;

const RUNS: usize = 9;
/// Ticks of a run.
const TICKS: usize = 20_000;
const TICK: f64 = 1e-3;
const START: &str = "start_position = [0.0, 0.3, 0.0, -1.6, 0.0, 1.9, 0.0]\n";
const FLEXIBLE: &str = "motor_inertia = 0.5\nstiffness = 1e4\ndamping = 5.0\n";
const FRICTION: &str = "friction = { b_0 = 2.0, b_0T = 0.05, b_1 = 3.0, b_2 = 0.0, b_3 = 0.0, \
                        linear_from = 1.0 }\n";
const SENSORS: &str = "sensor = { encoder_counts = 16384, velocity_time_constant = 0.002, \
                       torque_noise = 0.02, torque_step = 0.01, current_noise = 0.02, current_step = 0.005 }\n";
const FLOOR: &str = "[[object]]\nname = \"floor\"\nshape = { kind = \"plane\", point = [0, 0, 0.4], \
                     normal = [0, 0, 1] }\nsurface = { stiffness = 2e4, damping = 50, friction = 0.3, \
                     tangential_stiffness = 2e4, tangential_damping = 50 }\n";

fn main() {
    println!(
        "{:<44} {:>9} {:>8} {:>8} {:>8}   times real time, {RUNS} runs of {TICKS} ms",
        "seven joints", "substep", "min", "median", "max"
    );
    let flexible = format!("[[joint]]\n{FLEXIBLE}");
    let braked = format!("{flexible}{FRICTION}");
    let sensed = format!("{braked}{SENSORS}");
    let touching = format!("{sensed}{FLOOR}");
    for (name, text) in [
        ("rigid, no friction", String::new()),
        ("flexible", flexible),
        ("and friction", braked),
        ("and noise", sensed),
        ("and a floor of 20 kN/m, touched", touching),
    ] {
        report(name, &format!("{START}{text}"));
    }
    let rigid = format!("{START}[[joint]]\n{FRICTION}");
    report("rigid with friction", &rigid);
    report("the same, 1 ms", &format!("substep = 1e-3\n{rigid}"));
}

fn report(name: &str, text: &str) {
    let chain = arms::seven_joints();
    let parameters = toml::from_str(text).expect("parameters");
    let arm = SerialArm::new(&chain, &arms::any_torque(&chain), &parameters, 1).expect("an arm");
    let run = || {
        let mut arm = arm.clone();
        let hold = arm.truth().joint_torque;
        let begun = processor_seconds();
        for tick in 0..TICKS {
            let time = tick as f64 * TICK;
            let torque = Joints::from_fn(chain.count(), |joint| {
                hold[joint] - 2.0 * (3.0 * time + joint as f64).sin()
            });
            arm.advance(&torque, TICK);
            std::hint::black_box(arm.measure());
        }
        TICKS as f64 * TICK / (processor_seconds() - begun)
    };
    let mut factors: Vec<f64> = (0..RUNS).map(|_| run()).collect();
    factors.sort_by(f64::total_cmp);
    let (min, median, max) = (factors[0], factors[RUNS / 2], factors[RUNS - 1]);
    let substep = arm.substep();
    println!("{name:<44} {substep:>9.1e} {min:>8.0} {median:>8.0} {max:>8.0}");
}

/// What this thread has had of the processor \[s\].
fn processor_seconds() -> f64 {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").expect("Linux");
    let nanoseconds = told.split_whitespace().next().expect("a number");
    nanoseconds.parse::<f64>().expect("a number") * 1e-9
}
