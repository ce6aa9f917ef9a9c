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

/// A parameter: name, value, unit.
type Named = (&'static str, f64, &'static str);

impl<Hidden: Copy> TrueParameter<Hidden> {
    /// What is there anyway (`own`), then what each hidden effect has.
    pub(crate) fn list(
        own: impl IntoIterator<Item = Named>,
        hidden: impl Iterator<Item = (Hidden, Vec<Named>)>,
    ) -> Vec<Self> {
        let own = own.into_iter().map(|named| (None, named));
        let hidden = hidden
            .flat_map(|(effect, all)| all.into_iter().map(move |named| (Some(effect), named)));
        own.chain(hidden)
            .map(|(effect, (name, value, unit))| TrueParameter {
                effect,
                name,
                value,
                unit,
            })
            .collect()
    }
}
