//! `geometry_msgs`.

mod point;
mod pose;
mod pose_stamped;
mod quaternion;
mod transform;
mod transform_stamped;
mod vector3;
mod wrench;
mod wrench_stamped;

pub use point::Point;
pub use pose::Pose;
pub use pose_stamped::PoseStamped;
pub use quaternion::Quaternion;
pub use transform::Transform;
pub use transform_stamped::TransformStamped;
pub use vector3::Vector3;
pub use wrench::Wrench;
pub use wrench_stamped::WrenchStamped;
