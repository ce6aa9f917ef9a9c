//! Planted bugs: safety rules that are taken out, one at a time, to show that the
//! tests find that.
//!
//! A build without the feature `planted_bugs` has none of this: [`Planted`] is
//! then nothing at all, and [`Planted::lacks`] is false, so that the compiler
//! leaves out what follows from it. The shipped program is built without.

macro_rules! rules {
    ($($(#[$doc:meta])* $rule:ident $name:literal,)*) => {
        /// A safety rule that tests can take out.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Rule {
            $($(#[$doc])* $rule,)*
        }

        impl Rule {
            /// Every rule.
            pub const ALL: &[Rule] = &[$(Rule::$rule,)*];

            /// Its name.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Rule::$rule => $name,)*
                }
            }
        }
    };
}

rules! {
    /// Silent commands pause the arm.
    CommandWatchdog "command_watchdog",
    /// Silent measurements are a fault.
    MeasurementWatchdog "measurement_watchdog",
    /// Measurements that cannot be true, as they do not change, are a fault.
    FrozenWatch "frozen_watch",
    /// Measurements that cannot be true, as no joint gets there in time, are a fault.
    JumpWatch "jump_watch",
    /// A pause by an event is left by a word only.
    PauseLatched "pause_latched",
    /// A fault is left by disabling only.
    FaultLatched "fault_latched",
    /// `pause` is obeyed.
    PauseObeyed "pause_obeyed",
    /// `disable` is obeyed.
    DisableObeyed "disable_obeyed",
    /// A device starts disabled.
    StartsDisabled "starts_disabled",
    /// The arm holds where it was measured.
    HoldWhereMeasured "hold_where_measured",
    /// The setpoint begins where the arm was measured.
    BeginWhereMeasured "begin_where_measured",
    /// The way to the first command is slow.
    ApproachSpeed "approach_speed",
    /// Motor torques are limited.
    TorqueLimit "torque_limit",
    /// The torque that presses is limited.
    PressingLimit "pressing_limit",
    /// A servo that was held up is patient with others for a moment only.
    PatienceEnds "patience_ends",
    /// The force on the hand is limited.
    HandForceLimit "hand_force_limit",
    /// The force on the hand changes no faster than allowed.
    HandForceRate "hand_force_rate",
    /// A hand that is silent, or whose master is not enabled, gets no force.
    HandLetGo "hand_let_go",
    /// One hand at a time.
    OneHand "one_hand",
    /// A reflected force that is old is not rendered.
    ForceLife "force_life",
    /// The drives are off when torques fall silent.
    DrivesOff "drives_off",
    /// What was refused on the way in is told.
    RefusalsTold "refusals_told",
    /// What could not be forwarded is told.
    FailuresTold "failures_told",
    /// An operator's end that is started again says no word to arm.
    RestartIsNoWord "restart_is_no_word",
    /// The arm's end holds while the operator's end says so.
    HoldObeyed "hold_obeyed",
    /// A tip command is as old as the frame that it rests on.
    CommandsAge "commands_age",
    /// A servo that was held up begins where the arm is.
    BeginAfterStall "begin_after_stall",
}

/// Which safety rule is taken out: none, in a build that is shipped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Planted {
    #[cfg(feature = "planted_bugs")]
    rule: Option<Rule>,
}

impl Planted {
    /// Every rule is in force.
    pub const NONE: Planted = Planted {
        #[cfg(feature = "planted_bugs")]
        rule: None,
    };

    /// All rules but that one.
    #[cfg(feature = "planted_bugs")]
    pub const fn without(rule: Rule) -> Planted {
        Planted { rule: Some(rule) }
    }

    /// All rules but the one of that name; `None` where there is no such rule, or
    /// this build cannot take rules out.
    pub fn named(name: &str) -> Option<Planted> {
        #[cfg(feature = "planted_bugs")]
        return Rule::ALL
            .iter()
            .find(|rule| rule.name() == name)
            .map(|rule| Planted::without(*rule));
        #[cfg(not(feature = "planted_bugs"))]
        {
            let _ = name;
            None
        }
    }

    /// Whether that rule is taken out.
    #[inline(always)]
    pub fn lacks(self, rule: Rule) -> bool {
        #[cfg(feature = "planted_bugs")]
        return self.rule == Some(rule);
        #[cfg(not(feature = "planted_bugs"))]
        {
            let _ = rule;
            false
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(not(feature = "planted_bugs"))]
    fn a_build_that_is_shipped_lacks_no_rule_and_has_nothing_of_this() {
        assert_eq!(size_of::<Planted>(), 0);
        for rule in Rule::ALL {
            assert_eq!(Planted::named(rule.name()), None);
            assert!(!Planted::NONE.lacks(*rule));
        }
    }

    #[test]
    #[cfg(feature = "planted_bugs")]
    fn one_rule_is_taken_out_at_a_time() {
        for rule in Rule::ALL {
            let planted = Planted::named(rule.name()).unwrap();
            let lacking = Rule::ALL.iter().filter(|own| planted.lacks(**own));
            assert_eq!(lacking.collect::<Vec<_>>(), [rule]);
        }
        assert_eq!(Planted::named("nonsense"), None);
    }
}
