//! What a model leaves unexplained on a bench recording, by equation (6) and a
//! viscous film: F_T − b_0T |F_N| sign(ṙ) − c ṙ.
//!
//! For the author of a test: parameters are the true ones and nothing is
//! fitted. The lab has its own, which fits.

use super::{ContactRecording, ContactSession};
use crate::bench::{differentiate, rms, smooth};

/// Slower than this, the sign of the velocity is not known \[m/s\].
const REST: f64 = 2e-4;
/// Entries on either side of rest that do not count either: the low-pass reaches
/// so far, and spreads the step of F_T at a turn over them.
const AROUND_REST: usize = 4;
/// F_N below which the tip may not touch \[N\].
const TOUCHES: f64 = 2.0;

impl ContactRecording {
    /// `tangential` less what the believed model says of F_T under `normal`,
    /// low-pass at 8 Hz \[N\], and whether the tip slides. Where it does, and which
    /// way, is taken from the truth: noise shows in forces alone.
    fn residual(
        &self,
        session: &ContactSession,
        tangential: &[f64],
        normal: &[f64],
    ) -> Vec<(f64, bool)> {
        let value = |id: &str, name: &str| match self.believed.contains(&id) {
            true => self.edge_parameter(name),
            false => 0.0,
        };
        let (b0t, film) = (
            value("contact_coulomb", "b0T"),
            value("contact_viscous", "film"),
        );
        let velocity = differentiate(&session.truth.place);
        let believed: Vec<f64> = velocity
            .iter()
            .zip(normal)
            .map(|(&v, &n)| b0t * n * v.signum() + film * v)
            .collect();
        // Friction is filtered like the rest, so that its step is no spike.
        let (measured, believed) = (smooth(tangential), smooth(&believed));
        let is_sliding: Vec<bool> = velocity
            .iter()
            .zip(&session.truth.normal)
            .map(|(v, n)| v.abs() > REST && *n > TOUCHES)
            .collect();
        let slides = (0..is_sliding.len()).map(|index| {
            let from = index.saturating_sub(AROUND_REST);
            let mut near = is_sliding[from..]
                .iter()
                .take(index + AROUND_REST + 1 - from);
            near.all(|slides| *slides)
        });
        let left = measured.iter().zip(&believed).map(|(m, b)| m - b);
        left.zip(slides).collect()
    }

    fn logged(&self, session: &ContactSession) -> Vec<(f64, bool)> {
        self.residual(session, &session.tangential, &session.normal)
    }

    fn exact(&self, session: &ContactSession) -> Vec<(f64, bool)> {
        let truth = &session.truth;
        self.residual(session, &truth.tangential, &truth.normal)
    }

    fn rms_of(&self, part: impl Fn(&ContactSession) -> Vec<(f64, bool)>) -> f64 {
        let all = self.sessions.iter().flat_map(part);
        rms(all.filter_map(|(force, slides)| slides.then_some(force)))
    }

    /// The hidden effects' own part of the believed model's residual: without
    /// noise and without what parameters scatter by.
    fn own_part(&self, session: &ContactSession) -> Vec<(f64, bool)> {
        let scatter = smooth(&session.truth.scatter);
        let exact = self.exact(session).into_iter().zip(scatter);
        exact.map(|((all, slides), s)| (all - s, slides)).collect()
    }

    /// rms \[N\] of the filtered sensor noise.
    pub fn noise_rms(&self) -> f64 {
        self.rms_of(|session| {
            let pairs = self.logged(session).into_iter().zip(self.exact(session));
            pairs.map(|((l, slides), (e, _))| (l - e, slides)).collect()
        })
    }

    /// rms \[N\] that the true model, with its nominal parameters, leaves:
    /// noise and scatter between sessions.
    pub fn reference_rms(&self) -> f64 {
        self.rms_of(|session| {
            let pairs = self.logged(session).into_iter().zip(self.own_part(session));
            pairs.map(|((l, slides), (o, _))| (l - o, slides)).collect()
        })
    }

    /// ρ: rms of the hidden effects' own part over the rms of the filtered
    /// sensor noise; infinite without noise. A fit of the believed model takes
    /// a share of the own part away.
    pub fn visibility(&self) -> f64 {
        self.rms_of(|session| self.own_part(session)) / self.noise_rms()
    }
}
