//! Orientations of a hand that go over the link.
//!
//! A hand says that it has none with a quaternion of zeros, or, as programs do that know of
//! none, with one that is not turned at all, exactly (0, 0, 0, 1). Neither turns a tool: not the
//! orientation itself is followed but how it changes ([`crate::servo`]).

use nalgebra::{Quaternion, UnitQuaternion};

/// How far the norm of a quaternion may be from 1.
const NORM_TOLERANCE: f64 = 1e-3;
/// Bits of each of the three numbers that are sent.
const BITS: u32 = 20;
/// Largest number of so many bits.
const LARGEST: u64 = (1 << BITS) - 1;
/// Squares of the three smaller components of a unit quaternion: 3/4, and what rounding adds.
const SMALLER: f64 = 0.75 + 1e-5;

/// How something is turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orientation(UnitQuaternion<f64>);

impl Orientation {
    /// By a quaternion x, y, z, w; `None` where that says that there is none, or is no unit
    /// quaternion.
    pub fn given(quaternion: [f64; 4]) -> Option<Orientation> {
        let [x, y, z, w] = quaternion;
        let quaternion = Quaternion::new(w, x, y, z);
        let turned = quaternion != Quaternion::identity();
        // Not what is no number, either.
        let unit = (quaternion.norm() - 1.0).abs() <= NORM_TOLERANCE;
        (turned && unit).then(|| Orientation(UnitQuaternion::from_quaternion(quaternion)))
    }

    /// Quaternion x, y, z, w.
    pub fn quaternion(&self) -> [f64; 4] {
        self.0.coords.into()
    }

    /// The rotation.
    pub fn rotation(&self) -> UnitQuaternion<f64> {
        self.0
    }

    /// The angle from `other` to this one \[rad\], 0 … π.
    pub fn angle_to(&self, other: &Orientation) -> f64 {
        self.0.angle_to(&other.0)
    }
}

/// An orientation as a frame has it: "smallest three", little-endian in 8 bytes. Bits 60 and 61
/// are the place of the largest component in x, y, z, w, whose sign is made positive; the other
/// three follow in their order, the first in the lowest bits, 20 bits each for −1/√2 … 1/√2. It
/// is at most 5 µrad off. Zero lies between two numbers, so that what is unpacked is never
/// exactly not turned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PackedOrientation(u64);

impl PackedOrientation {
    /// Length in a frame \[bytes\].
    pub const LENGTH: usize = 8;

    /// The bytes.
    pub fn to_bytes(self) -> [u8; Self::LENGTH] {
        self.0.to_le_bytes()
    }

    /// Of these bytes.
    ///
    /// # Errors
    ///
    /// The sum of the squares of its components, where they are those of no rotation.
    pub fn from_bytes(bytes: [u8; Self::LENGTH]) -> Result<PackedOrientation, f64> {
        let packed = PackedOrientation(u64::from_le_bytes(bytes));
        let [a, b, c] = packed.smaller();
        let sum = a * a + b * b + c * c;
        match packed.0 >> (3 * BITS + 2) == 0 && sum <= SMALLER {
            true => Ok(packed),
            false => Err(sum),
        }
    }

    fn smaller(self) -> [f64; 3] {
        [0, 1, 2].map(|place| {
            let number = self.0 >> (place * BITS) & LARGEST;
            (2.0 * number as f64 / LARGEST as f64 - 1.0) * std::f64::consts::FRAC_1_SQRT_2
        })
    }
}

impl From<Orientation> for PackedOrientation {
    fn from(orientation: Orientation) -> PackedOrientation {
        let all = orientation.quaternion();
        let largest = (0..4).fold(0, |best, place| match all[place].abs() > all[best].abs() {
            true => place,
            false => best,
        });
        let mut packed = (largest as u64) << (3 * BITS);
        let others = (0..4).filter(|place| *place != largest);
        for (shift, place) in (0..3).map(|own| own * BITS).zip(others) {
            let value = all[place] * all[largest].signum() * std::f64::consts::SQRT_2;
            let number = (0.5 * (value + 1.0) * LARGEST as f64).round();
            packed |= (number.clamp(0.0, LARGEST as f64) as u64) << shift;
        }
        PackedOrientation(packed)
    }
}

impl From<PackedOrientation> for Orientation {
    fn from(packed: PackedOrientation) -> Orientation {
        let smaller = packed.smaller();
        let squares: f64 = smaller.iter().map(|own| own * own).sum();
        let largest = (packed.0 >> (3 * BITS) & 3) as usize;
        let mut others = smaller.into_iter();
        let all: [f64; 4] = std::array::from_fn(|place| match place == largest {
            true => (1.0 - squares).max(0.0).sqrt(),
            false => others.next().unwrap_or(0.0),
        });
        Orientation(UnitQuaternion::from_quaternion(Quaternion::from(all)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn what_says_that_there_is_none_is_none() {
        for none in [
            [0.0; 4],
            [0.0, 0.0, 0.0, 1.0],
            [0.0, 0.0, 0.0, 1.1],
            [f64::NAN, 0.0, 0.0, 1.0],
            [f64::INFINITY, 0.0, 0.0, 1.0],
        ] {
            assert_eq!(Orientation::given(none), None, "{none:?}");
        }
        assert!(Orientation::given([1e-9, 0.0, 0.0, 1.0]).is_some());
    }

    #[test]
    fn one_that_is_unpacked_is_never_none() {
        let nearly = Orientation::given([1e-12, 0.0, 0.0, 1.0]).unwrap();
        let unpacked = Orientation::from(PackedOrientation::from(nearly));
        assert!(Orientation::given(unpacked.quaternion()).is_some());
    }

    proptest! {
        #[test]
        fn little_is_lost_on_the_way(all in proptest::array::uniform4(-1.0..1.0f64)) {
            let norm = all.iter().map(|own| own * own).sum::<f64>().sqrt();
            prop_assume!(norm > 1e-3);
            let orientation = Orientation::given(all.map(|own| own / norm)).unwrap();
            let packed = PackedOrientation::from(orientation);
            let read = PackedOrientation::from_bytes(packed.to_bytes());
            prop_assert_eq!(read, Ok(packed));
            prop_assert!(Orientation::from(packed).angle_to(&orientation) < 5e-6);
        }

        #[test]
        fn what_is_read_is_a_rotation(bytes: [u8; 8]) {
            if let Ok(packed) = PackedOrientation::from_bytes(bytes) {
                let rotation = Orientation::from(packed).rotation();
                prop_assert!((rotation.coords.norm() - 1.0).abs() < 1e-9);
                prop_assert_eq!(packed.to_bytes(), bytes);
            }
        }
    }
}
