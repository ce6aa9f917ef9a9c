//! The law that changes by itself: model or contact force, by delay and contact, in two layers.
//!
//! No law serves every contact. On the arm that ships, force that goes round through servo, estimate
//! and link swings on a wall of some kN/m without any delay already, where the model of the
//! surface is steady at each. But a model has to be learned first, and counts what it does not know as
//! stiff, which pushes the hand back from something soft. So inside of two layers (`two_layer.rs`) the
//! hand feels
//!
//! * the model of the surface (`model_mediated.rs`) where what is touched is stiff, or the link late;
//! * the contact's own force, as `position_force` brings it back, where what is touched is soft for
//!   the delay: K τ ≤ 10 N·s/m, which is what a hand in contact damps with, K the stiffness as the
//!   follower's end estimates it, and 100 N/m while nothing is known of it, and τ the round trip as it is
//!   measured, with 30 ms for servo and estimate; back again at 15 N·s/m. So 300 N/m are felt by
//!   themselves at no delay, 100 N/m up to 70 ms.
//!
//! The tip's end decides, as it knows contact and delay, and says so in its packets (`told.rs`); the
//! hand's end leads the force over within 0.3 s, without a step. Xu, Liu, Steinbach 2017, "Toward
//! QoE-driven dynamic control scheme switching for time-delayed teleoperation systems: a dedicated
//! case study" (arXiv 1705.05613), change from passivity control to a model where the delay grows, by
//! how well people rate both; the criterion here is ours.
//!
//! **What it guarantees.** As `two_layer`: the layer of passivity stands around both and keeps its
//! tanks over a change.

use super::{
    Guarantee, InnerLaw, Mapping, Parameters, Samples, TwoLayer, TwoLayerFollower, TwoLayerLeader,
};
use ferntast_model::ParameterError;

/// Parameters of the law: those of [`TwoLayer`], with `model_mediated` inside.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(transparent)]
pub struct Auto(TwoLayer);

impl From<TwoLayer> for Auto {
    /// With these layers.
    fn from(layers: TwoLayer) -> Auto {
        Auto(layers)
    }
}

impl Auto {
    /// Checks every value against its bounds.
    ///
    /// # Errors
    ///
    /// The first value that is out of bounds; another law inside than `model_mediated`.
    pub fn validate(&self) -> Result<(), ParameterError> {
        let inside = self.0.inside.name();
        match self.0.inside {
            InnerLaw::ModelMediated(_) => self.0.validate(),
            _ => Err(ParameterError::Inconsistent {
                key: "inside.kind".to_owned(),
                reason: format!(
                    "{inside} has no model of the surface to change to; leave it out, or take the law two_layer"
                ),
            }),
        }
    }

    /// The two layers with both inside.
    fn layers(&self) -> TwoLayer {
        let mut layers = self.0.clone();
        if let InnerLaw::ModelMediated(inside) = &mut layers.inside {
            inside.contact_force = true;
        }
        layers
    }
}

impl Parameters for Auto {
    const NAME: &'static str = "auto";
    type Leader = TwoLayerLeader;
    type Follower = TwoLayerFollower;

    fn guarantee(&self) -> Guarantee {
        self.0.guarantee()
    }

    fn mapping(&self) -> Mapping {
        Parameters::mapping(&self.0)
    }

    fn samples(&self) -> [Samples; 2] {
        self.0.samples()
    }

    fn between(&self, mapping: &Mapping) -> Auto {
        Auto(Parameters::between(&self.0, mapping))
    }

    fn leader(&self) -> TwoLayerLeader {
        self.layers().leader()
    }

    fn follower(&self) -> TwoLayerFollower {
        self.layers().follower()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_law_inside_is_refused() {
        let own: Auto = toml::from_str("force_scale = 0.5\ninside = { kind = \"wave\" }").unwrap();
        let error = own.validate().unwrap_err().to_string();
        assert!(error.starts_with("inside.kind: wave"), "{error}");
        assert_eq!(Auto::default().validate(), Ok(()));
    }

    #[test]
    fn it_is_two_layers_around_model_and_contact_force() {
        let layers = Auto::default().layers();
        let InnerLaw::ModelMediated(inside) = layers.inside else {
            panic!("{:?}", layers.inside.name());
        };
        assert!(inside.contact_force);
        assert_eq!(Auto::default().guarantee(), Guarantee::Passive);
    }
}
