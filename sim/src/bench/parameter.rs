//! What is true on a bench.

/// A true parameter, before it scatters between sessions.
#[derive(Clone, Debug, PartialEq)]
pub struct TrueParameter<Hidden> {
    /// The hidden effect that it belongs to; none: it is there anyway.
    pub effect: Option<Hidden>,
    /// Name within its effect.
    pub name: &'static str,
    /// In `unit`.
    pub value: f64,
    /// Unit, "-" for none.
    pub unit: &'static str,
}
