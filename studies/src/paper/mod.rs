//! Every system of the paper held against this one, table by table and figure
//! by figure ("Robotic Joints and Contact Dynamics Experiments: Lessons
//! Learned from ROKVISS"), and the second paper's flexible joint on line.
//!
//! All numbers come from recordings: the experiments run in virtual time on
//! the simulated arm ([`evidence`]), and the lab identifies from what was
//! recorded. Where the paper gives a number it stands beside ours; where it
//! makes a statement, the statement is what has to hold.

mod contacts;
pub mod evidence;
mod flexible_joint;
mod friction_felt;
mod item;
mod joints;
mod page;
mod sensor_truth;
mod stiffness;
mod table1;
mod temperature;
mod time;
mod trajectory;

pub use evidence::{Evidence, PaperError, collect, duration};
pub use item::{Chart, Curve, Item, OnLineItem, Section, Settling};
pub use page::render;

/// Judges what was recorded: table 1, Figs. 3 to 17, the second paper, and what sensors that are
/// off and friction that is found are to the forces felt.
pub fn judge(evidence: &Evidence) -> Vec<Section> {
    let mut sections = vec![table1::section(evidence)];
    let (driven, speeds) = (&evidence.march[1].trajectory, &evidence::SPEEDS);
    sections.push(trajectory::identification_trajectory(driven, speeds));
    sections.extend(joints::linear_and_cubic(evidence));
    sections.extend(time::at_low_speed(evidence));
    sections.push(joints::shares(evidence));
    sections.push(joints::other_trajectory(evidence));
    sections.extend(time::by_speed(evidence));
    sections.extend(temperature::sections(evidence));
    sections.push(stiffness::section(evidence));
    sections.extend(contacts::sections(evidence));
    sections.push(flexible_joint::section(evidence));
    sections.push(sensor_truth::section(&evidence.sensor_truth));
    sections.push(friction_felt::section(&evidence.friction_felt));
    sections
}
