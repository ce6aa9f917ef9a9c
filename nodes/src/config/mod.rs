//! What a session is made of: scenarios, and the files that they name.

mod laws;
mod load;
mod scenario;
mod shipped;

pub use laws::UnknownLaw;
pub use load::{
    ConfigError, Loaded, load_arm, load_mission, load_scenario, load_sweep, read_hand_recording,
};
pub use scenario::{
    GatewaySection, HandSection, HandSource, LinkSection, Middleware, RecorderSection, Scenario,
};
