//! The surfaces that the arm's end knows: the one that the tip touched last and, where it is in a
//! corner, the others there.
//!
//! The contact's force is shared out to the normals of those that are near. What of it none of
//! them explains, for long enough, is another surface's. The one that was touched last is known
//! wherever the tip goes, as planes have no ends; the others only near the tip: a plane next to
//! which another was met may end there.

use super::estimate::{GONE, Scale, SurfaceEstimator};
use super::place::Place;
use super::surface::{SURFACES, SurfaceModel, shares};
use crate::low_pass_share;
use nalgebra::Vector3;

/// There is another surface once the tip was pushed so much from where none is known, without a
/// break [N s]: what an arm that shakes feigns is shorter.
const OTHER: f64 = 0.1;
/// A tip that is no farther from it may touch a surface that it touched before [m].
const NEAR: f64 = 0.5e-3;
/// One that was not touched last is forgotten once the tip is so far before it [m].
const LEFT: f64 = 0.01;
/// Time constant with which the force of a surface is known, before another pushes too [s].
const CALM: f64 = 0.05;
/// Each surface is told for so long before the next one is [s].
const TURN: f64 = 0.02;

/// One of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct KnownSurface {
    estimator: SurfaceEstimator,
    /// Where it is.
    pub place: Place,
    /// Of it on the tip, with its friction [N].
    pub force: Vector3<f64>,
    /// What it pushed with before another one did [N].
    calm: f64,
    /// What the hand gives into it [N].
    pub asked: f64,
    /// Of the command into it [m/s].
    pub speed: f64,
    /// Its own force is to be felt.
    pub felt: bool,
}

impl KnownSurface {
    fn of(scale: Scale, normal: Vector3<f64>, pushed: Vector3<f64>) -> KnownSurface {
        let estimator = SurfaceEstimator::of(scale, normal, pushed);
        KnownSurface {
            place: Place::of(estimator.model()),
            estimator,
            force: Vector3::zeros(),
            calm: 0.0,
            asked: 0.0,
            speed: 0.0,
            felt: false,
        }
    }

    /// As it is estimated.
    pub fn model(&self) -> &SurfaceModel {
        self.estimator.model()
    }

    /// How deep `position` \[m\] is along its normal, from the origin on \[m\].
    pub fn inward(&self, position: &Vector3<f64>) -> f64 {
        -self.model().normal.dot(position)
    }
}

/// All of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surfaces {
    scale: Scale,
    known: [Option<KnownSurface>; SURFACES],
    /// Which was touched last.
    latest: usize,
    /// Impulse of what none of them explains, since one did [N s].
    strange: Vector3<f64>,
    /// Which is told, and for how long it has been [s].
    turn: usize,
    told: f64,
}

impl Surfaces {
    /// None is known.
    pub fn new(scale: Scale) -> Surfaces {
        Surfaces {
            scale,
            known: [None; SURFACES],
            latest: 0,
            strange: Vector3::zeros(),
            turn: 0,
            told: 0.0,
        }
    }

    /// The hand gives `force` \[N\] into them.
    pub fn ask(&mut self, force: &Vector3<f64>) {
        let own = shares(&self.normals(|_, _| true), &-force);
        for (known, share) in self.known.iter_mut().zip(own) {
            if let Some(known) = known {
                known.asked = share;
            }
        }
    }

    /// Each of them, and whether it was touched last.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = (bool, &mut KnownSurface)> {
        let latest = self.latest;
        let all = self.known.iter_mut().enumerate();
        all.filter_map(move |(at, known)| Some((at == latest, known.as_mut()?)))
    }

    /// The one that was touched last.
    pub fn latest(&self) -> Option<&KnownSurface> {
        self.known[self.latest].as_ref()
    }

    /// The one whose turn it is to be told, `dt` \[s\] after the last was.
    pub fn whose_turn(&mut self, dt: f64) -> Option<&mut KnownSurface> {
        self.told += dt;
        if self.told > TURN || self.known[self.turn].is_none() {
            let others = (1..=SURFACES).map(|on| (self.turn + on) % SURFACES);
            let next = others.into_iter().find(|at| self.known[*at].is_some());
            self.turn = next.unwrap_or(self.latest);
            self.told = 0.0;
        }
        self.known[self.turn].as_mut()
    }

    fn normals(
        &self,
        counts: impl Fn(usize, &KnownSurface) -> bool,
    ) -> [Option<Vector3<f64>>; SURFACES] {
        std::array::from_fn(|at| {
            let known = self.known[at].as_ref().filter(|own| counts(at, own));
            known.map(|own| own.model().normal)
        })
    }

    /// What of `force` \[N\] is whose, with the tip at `tip` \[m\] \[N\].
    fn shares(&self, tip: &Vector3<f64>, force: &Vector3<f64>) -> [f64; SURFACES] {
        let near = |at, own: &KnownSurface| at == self.latest || own.model().depth(tip) > -NEAR;
        shares(&self.normals(near), force)
    }

    /// After `dt` \[s\], the tip at `tip` \[m\] under the contact's `force` \[N\]; places are followed
    /// with natural frequency `frequency` \[rad/s\].
    pub fn step(&mut self, dt: f64, frequency: f64, tip: Vector3<f64>, force: Vector3<f64>) {
        let touches = force.norm() >= self.scale.threshold && dt > 0.0;
        let mut own = self.shares(&tip, &force);
        if !touches {
            own = [0.0; SURFACES];
            self.strange = Vector3::zeros();
        } else if let Some(pushed) = self.another(dt, &own, &force) {
            self.add(pushed, &tip, &force);
            own = self.shares(&tip, &force);
        }
        let most = (0..SURFACES).max_by(|a, b| own[*a].total_cmp(&own[*b]));
        // Friction is that of the one which is pressed most.
        let owner = most.filter(|at| own[*at] > 0.0).unwrap_or(self.latest);
        let others = self.sum(&own, |at| at != owner);
        for (at, known) in self.known.iter_mut().enumerate() {
            let Some(known) = known else { continue };
            known.force = match (touches, at == owner) {
                (false, _) => Vector3::zeros(),
                (true, true) => force - others,
                (true, false) => own[at] * known.model().normal,
            };
            let touches = known.estimator.step(dt, tip, known.force);
            let model = known.estimator.model();
            known.place = known.place.step(dt, frequency, model, &tip, touches);
            if !touches {
                known.calm = 0.0;
            } else if self.strange == Vector3::zeros() {
                known.calm += low_pass_share(dt, CALM) * (own[at] - known.calm);
            }
        }
        let rests = self.latest().is_none_or(|own| !own.place.touches);
        if rests && self.known[owner].is_some_and(|own| own.place.touches) {
            self.latest = owner;
        }
        self.forget(&tip);
    }

    /// Force of those that `count`, as they have `own` of it \[N\] \[N\].
    fn sum(&self, own: &[f64; SURFACES], counts: impl Fn(usize) -> bool) -> Vector3<f64> {
        let known = (0..SURFACES).filter(|at| counts(*at));
        known
            .filter_map(|at| Some(own[at] * self.known[at].as_ref()?.model().normal))
            .sum()
    }

    /// What of `force` \[N\] is new: without what the surfaces pushed with before another did, as
    /// they have `own` of it \[N\]. One that pushes less than before may have been left, so that the
    /// second wall of a corner of less than a right angle counts as being across the first \[N\].
    fn new_of(&self, own: &[f64; SURFACES], force: &Vector3<f64>) -> Vector3<f64> {
        let known = self.known.iter().zip(own);
        known.fold(*force, |left, (known, share)| match known {
            Some(known) => left - known.calm.min(*share) * known.model().normal,
            None => left,
        })
    }

    /// The impulse of another surface than those that are known \[N s\], where there is one, as
    /// they have `own` of the contact's `force` \[N\].
    fn another(
        &mut self,
        dt: f64,
        own: &[f64; SURFACES],
        force: &Vector3<f64>,
    ) -> Option<Vector3<f64>> {
        let Some(latest) = self.latest() else {
            return Some(Vector3::zeros());
        };
        let known = self.known.iter().zip(own);
        let aside: f64 = known
            .filter_map(|(known, share)| Some(known.as_ref()?.estimator.aside(*share)))
            .sum();
        let is_known = (force - self.sum(own, |_| true)).norm() <= aside;
        self.strange = match is_known || latest.estimator.settles() {
            true => Vector3::zeros(),
            false => self.strange + self.new_of(own, force) * dt,
        };
        (self.strange.norm() > self.scale.force * OTHER).then(|| std::mem::take(&mut self.strange))
    }

    /// Another surface is known, which `pushed` so much \[N s\].
    fn add(&mut self, pushed: Vector3<f64>, tip: &Vector3<f64>, force: &Vector3<f64>) {
        let along = pushed.try_normalize(1e-9);
        let normal = along.unwrap_or(force / force.norm());
        let at = |fits: &dyn Fn(&Option<KnownSurface>) -> bool| self.known.iter().position(fits);
        // It is the one that was there, elsewhere; or a new one, in place of the one farthest away.
        let same = at(&|own| own.is_some_and(|own| own.model().pushes_along(&normal)));
        let free = same.or_else(|| at(&Option::is_none));
        let depth =
            |at: &usize| self.known[*at].map_or(f64::NEG_INFINITY, |own| own.model().depth(tip));
        let others = (0..SURFACES).filter(|at| *at != self.latest);
        let farthest = others.min_by(|a, b| depth(a).total_cmp(&depth(b)));
        self.latest = free.or(farthest).unwrap_or(self.latest);
        self.known[self.latest] = Some(KnownSurface::of(self.scale, normal, pushed));
        self.turn = self.latest;
        self.told = 0.0;
    }

    /// Forgets what is not there any more, or may not be: where the tip went through, and what it left.
    fn forget(&mut self, tip: &Vector3<f64>) {
        let Some(latest) = self.latest().map(|own| *own.model()) else {
            return;
        };
        for (at, known) in self.known.iter_mut().enumerate() {
            if at == self.latest {
                continue;
            }
            *known = known.filter(|own| {
                let depth = own.model().depth(tip);
                let is_there = own.place.touches || (-LEFT..0.5 * GONE).contains(&depth);
                is_there && !own.model().pushes_along(&latest.normal)
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FREQUENCY: f64 = 12.0;

    fn surfaces(force_scale: f64) -> Surfaces {
        Surfaces::new(Scale {
            force: force_scale,
            threshold: 0.1 * force_scale,
            searched: 2.4 * force_scale,
        })
    }

    fn normals(surfaces: &Surfaces) -> Vec<Vector3<f64>> {
        let known = surfaces.known.iter().flatten();
        known.map(|own| own.model().normal).collect()
    }

    #[test]
    fn a_known_surface_keeps_its_normal_until_it_is_pushed_from_elsewhere_for_long() {
        let mut surfaces = surfaces(1.0);
        let tip = Vector3::zeros();
        let mut touch = |force: [f64; 3], steps: usize| {
            surfaces.step(1e-3, FREQUENCY, tip, Vector3::zeros());
            (0..steps).for_each(|_| surfaces.step(1e-3, FREQUENCY, tip, force.into()));
            surfaces.latest().unwrap().model().normal
        };
        assert!((touch([-5.0, 0.0, 0.0], 100) + Vector3::x()).norm() < 1e-9);
        // 0.08 N s, as of an arm that shakes.
        assert!((touch([0.0, 8.0, 0.0], 10) + Vector3::x()).norm() < 1e-9);
        // 0.16 N s.
        assert!((touch([0.0, 8.0, 0.0], 20) - Vector3::y()).norm() < 1e-9);
    }

    /// A second wall takes over without a break, and so gently that after 50 ms the tip has felt
    /// half of what tells another surface.
    #[test]
    fn a_wall_that_is_met_slowly_or_in_a_contact_is_another() {
        for force_scale in [1.0, 0.05] {
            let mut surfaces = surfaces(force_scale);
            for k in 0..500 {
                let first = if k < 200 { 10.0 } else { 0.0 };
                let second = 0.04 * f64::from((k - 200_i32).max(0));
                let force = Vector3::new(-second, first, 0.0) * force_scale;
                surfaces.step(1e-3, FREQUENCY, Vector3::zeros(), force);
                if k == 199 {
                    let normal = surfaces.latest().unwrap().model().normal;
                    assert!((normal - Vector3::y()).norm() < 1e-9);
                }
            }
            let normal = surfaces.latest().unwrap().model().normal;
            assert!((normal + Vector3::x()).norm() < 1e-9, "{normal}");
        }
    }

    /// The tip slides along a wall of 5 kN/m across x, pressed by 5 N, into another one at an angle
    /// \[deg\] to it, then back.
    fn into_a_corner(angle: f64, force_scale: f64) -> [Surfaces; 2] {
        let mut surfaces = surfaces(force_scale);
        let [first, second] = [180.0, 180.0 + angle].map(|angle: f64| {
            let (sine, cosine) = angle.to_radians().sin_cos();
            Vector3::new(cosine, sine, 0.0)
        });
        let mut in_corner = surfaces;
        for k in 0..1600 {
            // In at 30 mm/s, 2 mm into the second wall, and back.
            let time = 1e-3 * f64::from(k);
            let along = (0.03 * time).min(0.012) - (0.03 * (time - 1.0)).clamp(0.0, 0.017);
            let tip = Vector3::new(1e-3, along, 0.0);
            let depth = -second.dot(&(tip - Vector3::new(1e-3, 0.01, 0.0)));
            let force = 5.0 * first + 5000.0 * depth.max(0.0) * second;
            surfaces.step(1e-3, FREQUENCY, tip, force * force_scale);
            if k == 990 {
                in_corner = surfaces;
            }
        }
        [in_corner, surfaces]
    }

    #[test]
    fn in_a_corner_both_walls_are_known_with_the_force_of_each() {
        for (angle, force_scale) in [(90.0, 1.0), (90.0, 0.05), (60.0, 1.0)] {
            let told = format!("{angle}°, {force_scale}");
            let [in_corner, after] = into_a_corner(angle, force_scale);
            let known = normals(&in_corner);
            assert_eq!(known.len(), 2, "{told}: {known:?}");
            let apart = known[0].angle(&known[1]).to_degrees();
            assert!((apart - angle).abs() < 6.0, "{told}: {apart}°");
            let [first, second] = [0, 1].map(|at| in_corner.known[at].unwrap());
            let size = |own: &KnownSurface| own.force.norm() / force_scale;
            assert!(
                (4.0..6.5).contains(&size(&first)),
                "{told}: {}",
                size(&first)
            );
            // 2 mm along the first wall.
            let deep = 10.0 * f64::to_radians(angle).sin();
            assert!(
                (size(&second) / deep - 1.0).abs() < 0.2,
                "{told}: {}",
                size(&second)
            );
            // 15 mm away from the second one, which may end there.
            assert_eq!(normals(&after).len(), 1, "{told}");
        }
    }

    #[test]
    fn in_a_corner_each_wall_is_told_in_its_turn() {
        let [mut surfaces, _] = into_a_corner(90.0, 1.0);
        let mut count = [0; 2];
        for _ in 0..200 {
            let normal = surfaces.whose_turn(1e-3).unwrap().model().normal;
            count[usize::from(normal.y < -0.5)] += 1;
        }
        assert!(count.iter().all(|own| (80..120).contains(own)), "{count:?}");
    }

    /// Where the tip goes on behind a wall that it does not touch, that wall ends.
    #[test]
    fn a_plane_that_the_tip_went_through_is_forgotten_where_another_is_touched() {
        let [mut surfaces, _] = into_a_corner(90.0, 1.0);
        let tip = Vector3::new(1e-3, 0.013, 0.0);
        surfaces.step(1e-3, FREQUENCY, tip, Vector3::new(-5.0, 0.0, 0.0));
        let known = normals(&surfaces);
        assert!(known.len() == 1 && known[0].x < -0.99, "{known:?}");
    }
}
