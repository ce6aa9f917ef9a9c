//! Points in time.

use serde::{Deserialize, Serialize};

/// A point in time: nanoseconds since the UNIX epoch.
///
/// Zero is not a time: a stamp of zero marks a message as invalid
/// ([`Time::INVALID`]).
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
#[repr(transparent)]
pub struct Time(i64);

impl Time {
    /// The stamp of zero, which marks a message as invalid.
    pub const INVALID: Time = Time(0);

    /// A time from nanoseconds since the UNIX epoch.
    pub const fn from_nanos(nanos: i64) -> Time {
        Time(nanos)
    }

    /// A time from the two fields of `builtin_interfaces/msg/Time`.
    pub const fn from_ros(sec: i32, nanosec: u32) -> Time {
        Time(sec as i64 * 1_000_000_000 + nanosec as i64)
    }

    /// Nanoseconds since the UNIX epoch.
    pub const fn nanos(self) -> i64 {
        self.0
    }

    /// The seconds field of `builtin_interfaces/msg/Time` (rounded towards
    /// minus infinity). Right for times that [fit](Time::fits_ros); others come
    /// out as the nearest that the field can hold.
    pub const fn ros_sec(self) -> i32 {
        let seconds = self.0.div_euclid(1_000_000_000);
        if seconds > i32::MAX as i64 {
            i32::MAX
        } else if seconds < i32::MIN as i64 {
            i32::MIN
        } else {
            seconds as i32
        }
    }

    /// Whether `builtin_interfaces/msg/Time` can hold it: its seconds are an
    /// `int32` and end in January 2038.
    pub const fn fits_ros(self) -> bool {
        let seconds = self.0.div_euclid(1_000_000_000);
        seconds >= i32::MIN as i64 && seconds <= i32::MAX as i64
    }

    /// The nanoseconds field of `builtin_interfaces/msg/Time`.
    pub const fn ros_nanosec(self) -> u32 {
        self.0.rem_euclid(1_000_000_000) as u32
    }

    /// Whether this is a time at all (not zero, not before 1970).
    pub const fn is_valid(self) -> bool {
        self.0 > 0
    }

    /// This time moved by `seconds` \[s\].
    pub fn plus_seconds(self, seconds: f64) -> Time {
        Time(self.0.saturating_add((seconds * 1e9).round() as i64))
    }

    /// This time moved by `nanos` \[ns\].
    pub const fn plus_nanos(self, nanos: i64) -> Time {
        Time(self.0.saturating_add(nanos))
    }

    /// Seconds from `earlier` to this time \[s\]; negative when `earlier` is later.
    pub fn seconds_since(self, earlier: Time) -> f64 {
        (self.0.saturating_sub(earlier.0)) as f64 * 1e-9
    }

    /// Nanoseconds from `earlier` to this time \[ns\].
    pub const fn nanos_since(self, earlier: Time) -> i64 {
        self.0.saturating_sub(earlier.0)
    }
}
