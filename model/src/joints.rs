//! One value for each joint of an arm, for as many joints as the arm has.

use std::{
    array, fmt,
    iter::Take,
    ops::{Deref, DerefMut},
};

use crate::{ParameterError, check};

/// The most joints that an arm may have.
pub const MAX_JOINTS: usize = 8;

/// How many joints an arm has: 1 to [`MAX_JOINTS`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JointCount(usize);

impl JointCount {
    /// So many joints.
    ///
    /// # Errors
    ///
    /// None, or more than [`MAX_JOINTS`].
    pub fn new(count: usize) -> Result<JointCount, ParameterError> {
        let most = MAX_JOINTS as f64;
        check("number of joints", count as f64, 1.0, most, "-")?;
        Ok(JointCount(count))
    }

    /// As a number.
    pub fn get(self) -> usize {
        self.0
    }

    /// Refuses a list of `found` entries under `key` that has not one for each joint.
    ///
    /// # Errors
    ///
    /// [`ParameterError::WrongCount`].
    pub fn check(self, key: &str, found: usize) -> Result<(), ParameterError> {
        if found == self.0 {
            return Ok(());
        }
        Err(ParameterError::WrongCount {
            key: key.to_owned(),
            found,
            wanted: self.0,
            each: "joint of the arm",
        })
    }
}

/// One value for each joint, in the order from the base on: a slice that is
/// never empty, held in place, so that none of this allocates.
#[derive(Clone, Copy)]
pub struct Joints<T> {
    /// What stands behind the last joint has no meaning.
    places: [T; MAX_JOINTS],
    count: JointCount,
}

impl<T: Copy> Joints<T> {
    /// The same value for each of `count` joints.
    pub fn filled(count: JointCount, value: T) -> Joints<T> {
        Joints {
            places: [value; MAX_JOINTS],
            count,
        }
    }

    /// What `value` gives for each of `count` joints, by their number from 0.
    pub fn from_fn(count: JointCount, mut value: impl FnMut(usize) -> T) -> Joints<T> {
        let mut joints = Joints::filled(count, value(0));
        if let Some((_, rest)) = joints.split_first_mut() {
            for (place, joint) in rest.iter_mut().zip(1..) {
                *place = value(joint);
            }
        }
        joints
    }

    /// The first `count` of `places`.
    pub fn from_places(count: JointCount, places: [T; MAX_JOINTS]) -> Joints<T> {
        Joints { places, count }
    }

    /// One value for each joint out of a list.
    ///
    /// # Errors
    ///
    /// An empty list, or one of more than [`MAX_JOINTS`].
    pub fn from_slice(values: &[T]) -> Result<Joints<T>, ParameterError> {
        let count = JointCount::new(values.len())?;
        Ok(Joints::from_fn(count, |joint| values[joint]))
    }

    /// All places, those behind the last joint with `rest`.
    pub fn into_places(self, rest: T) -> [T; MAX_JOINTS] {
        let mut places = [rest; MAX_JOINTS];
        for (place, value) in places.iter_mut().zip(self.iter()) {
            *place = *value;
        }
        places
    }

    /// What `change` makes of each value.
    pub fn map<U: Copy>(&self, mut change: impl FnMut(&T) -> U) -> Joints<U> {
        Joints::from_fn(self.count, |joint| change(&self.places[joint]))
    }
}

impl<T> Joints<T> {
    /// How many joints there are.
    pub fn count(&self) -> JointCount {
        self.count
    }
}

impl<T> Deref for Joints<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        &self.places[..self.count.0]
    }
}

impl<T> DerefMut for Joints<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        &mut self.places[..self.count.0]
    }
}

impl<T> IntoIterator for Joints<T> {
    type Item = T;
    type IntoIter = Take<array::IntoIter<T, MAX_JOINTS>>;

    fn into_iter(self) -> Self::IntoIter {
        self.places.into_iter().take(self.count.0)
    }
}

/// Of an array of 1 to [`MAX_JOINTS`] values; others do not compile.
impl<T: Copy, const N: usize> From<[T; N]> for Joints<T> {
    fn from(values: [T; N]) -> Joints<T> {
        const { assert!(N >= 1 && N <= MAX_JOINTS) };
        Joints::from_fn(JointCount(N), |joint| values[joint])
    }
}

impl<T: PartialEq> PartialEq for Joints<T> {
    fn eq(&self, other: &Joints<T>) -> bool {
        **self == **other
    }
}

impl<T: PartialEq, const N: usize> PartialEq<[T; N]> for Joints<T> {
    fn eq(&self, other: &[T; N]) -> bool {
        **self == *other
    }
}

impl<T: fmt::Debug> fmt::Debug for Joints<T> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        (**self).fmt(formatter)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_are_as_many_values_as_joints() {
        for count in 1..=MAX_JOINTS {
            let joints = Joints::from_fn(JointCount::new(count).unwrap(), |joint| joint * 10);
            let list: Vec<usize> = (0..count).map(|joint| joint * 10).collect();
            assert_eq!(&joints[..], &list[..]);
            assert_eq!(joints.iter().count(), joints.count().get());
            assert_eq!(Joints::from_slice(&list).unwrap(), joints);
        }
        for count in [0, MAX_JOINTS + 1] {
            assert!(JointCount::new(count).is_err());
            assert!(Joints::from_slice(&vec![0.0; count]).is_err());
        }
    }

    #[test]
    fn what_stands_behind_the_last_joint_does_not_count() {
        let joints = Joints::from([1.0, 2.0, 3.0]);
        let places = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0];
        let same = Joints::from_places(joints.count(), places);
        assert_eq!(same, joints);
        assert_eq!(format!("{same:?}"), "[1.0, 2.0, 3.0]");
        assert_eq!(
            same.into_places(0.0),
            [1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 0.0, 0.0]
        );
        assert_ne!(joints, Joints::from([1.0, 2.0]));
    }

    #[test]
    fn values_are_changed_joint_by_joint() {
        let mut joints = Joints::from([1, 2]);
        joints[1] = 5;
        assert_eq!(joints.map(|own| *own > 2), [false, true]);
        assert_eq!(joints.into_iter().collect::<Vec<_>>(), [1, 5]);
    }

    #[test]
    fn a_list_of_another_length_is_refused_by_name() {
        let count = JointCount::new(3).unwrap();
        assert_eq!(count.check("stiffness", 3), Ok(()));
        assert_eq!(
            count.check("stiffness", 2).unwrap_err().to_string(),
            "stiffness has 2 entries where 3 are needed: one for each joint of the arm"
        );
    }
}
