use ferntast_config::Believed;
use ferntast_msgs::{
    Message,
    ros::{sensor_msgs, std_msgs::Header},
    sample::Fault,
};

use super::*;
use crate::simulated::load_arm;

const START: i64 = 1_700_000_000_000_000_000;
const HOME: [f64; 7] = [0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785];

fn panda() -> (JointNames, Believed) {
    let model = load_arm("panda").unwrap().model;
    (model.joint_names(), model)
}

fn at(seconds: f64) -> Time {
    Time::from_nanos(START + (seconds * 1e9) as i64)
}

/// The robot with a hand, in an order of its own: joint 7 first, and fingers among them.
fn told(stamp: Time, change: impl Fn(&mut sensor_msgs::JointState)) -> RobotJointsSample {
    let (joints, _) = panda();
    let mut ros = sensor_msgs::JointState {
        header: Header::new(stamp, "base"),
        ..Default::default()
    };
    let mut add = |name: &str, position: f64| {
        ros.name.push(name.to_owned());
        ros.position.push(position);
        ros.velocity.push(0.01 * position);
        ros.effort.push(10.0 * position);
    };
    for (joint, position) in HOME.into_iter().enumerate().rev() {
        add(joints.get(joint).unwrap(), position);
        add(&format!("finger_{joint}"), f64::NAN);
    }
    change(&mut ros);
    RobotJointsSample::from_ros(&ros).unwrap()
}

/// The place of a joint in it.
fn place(name: &str, ros: &sensor_msgs::JointState) -> usize {
    ros.name.iter().position(|own| own == name).unwrap()
}

/// A watch that has heard a good state every 2 ms for `seconds`, each 3 ms after its stamp.
struct Heard {
    watch: StateWatch,
    count: JointCount,
    joints: JointNames,
    now: f64,
}

impl Heard {
    fn new(settings: &Settings) -> Heard {
        let (joints, model) = panda();
        let count = JointCount::new(7).unwrap();
        Heard {
            watch: StateWatch::new(count, model.joints(), settings, Effort::JointTorque),
            count,
            joints,
            now: 0.0,
        }
    }

    fn say(&mut self, stamp: f64, change: impl Fn(&mut sensor_msgs::JointState)) -> bool {
        let sample = told(at(stamp), change);
        let arrived = at(self.now + 0.003);
        let state = JointState::of(&sample, &self.joints, self.count, arrived);
        self.watch.take(state)
    }

    fn well(&mut self, seconds: f64) -> bool {
        let mut all = true;
        for _ in 0..(seconds / 0.002).round() as usize {
            self.now += 0.002;
            all &= self.say(self.now, |_| ());
        }
        all
    }

    fn words(&self) -> String {
        let refusal = self.watch.refusal(at(self.now + 0.003));
        refusal.map_or_else(String::new, |own| {
            own.words(&self.joints, "/joint_states").to_string()
        })
    }
}

fn well() -> Heard {
    let mut heard = Heard::new(&Settings::default());
    assert!(heard.well(1.0));
    assert_eq!(heard.words(), "");
    heard
}

#[test]
fn joints_are_found_by_name_in_any_order_among_others() {
    let heard = well();
    let state = heard.watch.good().unwrap();
    assert_eq!(*state.position, HOME);
    assert!((state.velocity[3] + 0.02356).abs() < 1e-12);
    assert!((state.effort[5] - 15.71).abs() < 1e-12);
}

#[test]
fn nothing_is_believed_before_it_came() {
    let heard = Heard::new(&Settings::default());
    assert!(heard.watch.good().is_none());
    let words = heard.words();
    assert!(words.contains("nothing on /joint_states yet"), "{words}");
}

#[test]
fn what_is_wrong_with_a_joint_is_told_with_its_name() {
    type Change = fn(&mut sensor_msgs::JointState);
    let cases: [(Change, &str, Fault); 7] = [
        (
            |ros| ros.name[0] = "other".to_owned(),
            "lacks joint panda_joint7",
            Fault::MeasurementInvalid,
        ),
        (
            |ros| {
                let place = place("panda_joint2", ros);
                ros.position[place] = f64::NAN;
            },
            "position of panda_joint2 is NaN",
            Fault::MeasurementInvalid,
        ),
        (
            |ros| ros.velocity.clear(),
            "velocity of panda_joint1 is NaN or not given",
            Fault::MeasurementInvalid,
        ),
        (
            |ros| ros.effort.clear(),
            "effort of panda_joint1 is NaN or not given",
            Fault::MeasurementInvalid,
        ),
        (
            |ros| {
                ros.position
                    .iter_mut()
                    .for_each(|own| *own = own.to_degrees())
            },
            "panda_joint2 at -44.98, not in -1.81 … 1.81: degrees?",
            Fault::MeasurementInvalid,
        ),
        (
            |ros| {
                let place = place("panda_joint4", ros);
                ros.position[place] = 2.356;
            },
            "panda_joint4 at 2.36, not in -3.12 … -0.02: zero or sign wrong?",
            Fault::MeasurementInvalid,
        ),
        (
            |ros| {
                let place = place("panda_joint3", ros);
                ros.velocity[place] = 40.0;
            },
            "panda_joint3 at 40.00 rad/s",
            Fault::MeasurementInvalid,
        ),
    ];
    for (change, words, fault) in cases {
        let mut heard = well();
        heard.now += 0.002;
        assert!(!heard.say(heard.now, change), "{words}");
        let told = heard.words();
        assert!(told.contains(words), "{told:?} where {words:?} is expected");
        let refusal = heard.watch.refusal(at(heard.now + 0.003)).unwrap();
        assert_eq!(refusal.fault(), fault, "{words}");
        // A single one is left at once.
        assert!(heard.well(0.002));
    }
}

#[test]
fn after_a_jump_it_has_to_go_on_well_for_a_second() {
    let mut heard = well();
    heard.now += 0.002;
    let lost = |ros: &mut sensor_msgs::JointState| {
        let place = place("panda_joint6", ros);
        ros.position[place] += 0.3;
    };
    assert!(!heard.say(heard.now, lost));
    assert_eq!(heard.words(), "panda_joint6 jumped by 0.300 rad");
    let mut until = 0.0;
    while until < 2.0 {
        heard.now += 0.002;
        until += 0.002;
        if heard.say(heard.now, lost) {
            break;
        }
    }
    assert!((0.99..1.01).contains(&until), "{until} s");
}

/// As fast as the joint can go is no jump, whatever the time between.
#[test]
fn a_joint_may_move_as_fast_as_it_can() {
    let mut heard = well();
    for step in 1..100 {
        heard.now += 0.002;
        let moved = f64::from(step) * 0.002 * 2.0;
        assert!(heard.say(heard.now, |ros| {
            let place = place("panda_joint1", ros);
            ros.position[place] += moved;
            ros.velocity[place] = 2.0;
        }));
    }
}

#[test]
fn silence_a_slow_rate_and_delay_are_told_with_their_numbers() {
    let mut silent = well();
    let later = |heard: &Heard, seconds: f64| heard.watch.refusal(at(heard.now + 0.003 + seconds));
    assert_eq!(later(&silent, 0.019), None);
    assert!(matches!(later(&silent, 0.5), Some(Refusal::Silent(silent)) if silent > 0.49));
    silent.now += 0.5;
    assert_eq!(silent.words(), "/joint_states is silent for 0.50 s");

    let mut slow = well();
    let mut steps = 0;
    loop {
        slow.now += 0.02;
        steps += 1;
        if !slow.say(slow.now, |_| ()) || steps > 100 {
            break;
        }
    }
    // 50 Hz where 100 Hz are needed: told once the mean of half a second shows it.
    assert!((10..60).contains(&steps), "{steps}");
    let words = slow.words();
    assert!(words.contains("Hz, 100 Hz are needed"), "{words}");

    let mut late = well();
    late.now += 0.032;
    let stamp = late.now - 0.030;
    assert!(!late.say(stamp, |_| ()));
    assert_eq!(late.words(), "/joint_states comes 30 ms late");
}

#[test]
fn a_stamp_that_stands_is_no_news() {
    let mut heard = well();
    let stamp = heard.now;
    for _ in 0..5 {
        heard.now += 0.002;
        assert!(!heard.say(stamp, |_| ()));
    }
    assert_eq!(heard.words(), "/joint_states: the stamp stands still");
    heard.now += 0.05;
    assert!(heard.words().contains("silent for"), "{}", heard.words());
}

/// A clock of the robot that is an hour away, and drifts, is nobody's delay.
#[test]
fn clocks_need_not_agree() {
    let mut heard = Heard::new(&Settings::default());
    for _ in 0..5000 {
        heard.now += 0.002;
        let stamp = heard.now - 3600.0 + heard.now * 1e-4;
        assert!(
            heard.say(stamp, |_| ()),
            "{} at {} s",
            heard.words(),
            heard.now
        );
    }
}
