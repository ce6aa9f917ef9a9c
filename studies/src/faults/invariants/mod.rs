//! What holds whatever goes wrong.

mod approach;
mod authority;
mod encoder;
mod energy;
mod fresh_word;
mod hold;
mod invariant;
mod let_go;
mod limits;
mod measurement;
mod no_jump;
mod pressing;
mod refusals;
mod release;
mod stop;

pub use invariant::Invariant;

/// Every invariant that is checked step by step, at the start of a schedule.
pub fn all() -> Vec<Box<dyn Invariant>> {
    vec![
        Box::new(fresh_word::FreshWord::default()),
        Box::new(stop::StopObeyed::default()),
        Box::new(hold::HoldInTime),
        Box::new(release::Release::default()),
        Box::new(measurement::MeasurementWatched::default()),
        Box::new(encoder::EncoderWatched::default()),
        Box::new(no_jump::NoJump::default()),
        Box::new(approach::SlowApproach::default()),
        Box::new(limits::ArmLimits),
        Box::new(limits::ContactForce::default()),
        Box::new(pressing::PressingLimited::default()),
        Box::new(limits::HandLimits::default()),
        Box::new(authority::Authority::default()),
        Box::new(energy::Energy::default()),
        Box::new(let_go::HandLetGo::default()),
        Box::new(let_go::DrivesOff::default()),
        Box::new(let_go::StaysPut::default()),
        Box::new(refusals::RefusalsTold),
    ]
}

/// Names of the invariants that are checked of a schedule as a whole.
pub const OF_A_SCHEDULE: [&str; 3] = ["nothing_recorded_lost", "same_seed_same_bytes", "no_panic"];
