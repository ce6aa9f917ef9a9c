//! Inertial parameters that a body can have.
//!
//! Least squares knows nothing of bodies: where a motion excites a link's parameters little,
//! it finds negative masses, or inertias of no shape. A link's pseudo-inertia P has to be
//! positive definite (Traversaro, Brossette, Escande, Nori 2016). P is linear in the link's
//! ten parameters, so that the nearest parameters to those of least squares, by its own
//! measure, are those of a convex problem:
//!
//! minimise ½ (x − x̂)ᵀ N (x − x̂) + μ (tr(P₀⁻¹ P) − log det P)
//!
//! with the normal equations N and P₀ of what was believed. The second part keeps P positive
//! definite, and near P₀ in the directions that the data say nothing of (Lee, Wensing, Park
//! 2020); x̂ is in units of its standard error there, so that a small μ moves nothing else.

use ferntast_model::rigid_body::{LINK_PARAMETERS, LinkInertia, Matrix4, Vector3};
use nalgebra::{DMatrix, DVector, SMatrix, SVector};

/// μ, from the first to the last: the last moves what the data determine by a hundredth of
/// its standard error or less.
const BARRIER: [f64; 4] = [10.0, 1.0, 0.1, 0.01];
/// Newton steps for each μ, at most.
const MAX_STEPS: usize = 60;
/// A step that promises less is the last one.
const MIN_PROMISE: f64 = 1e-9;
/// Share of what is believed that a body keeps of it, at least.
const MARGIN: f64 = 1e-6;
/// What a payload that was taken off leaves of the link, at least, as a share.
const LEFT: f64 = 1e-3;
/// Radius of gyration of a link of which nothing possible is believed \[m\].
const GYRATION: f64 = 0.05;
/// Mass of a link of which none is believed \[kg\].
const LEAST_MASS: f64 = 1e-3;

type Ten = SVector<f64, LINK_PARAMETERS>;

/// The changes of a link's ten parameters nearest to `free` by the normal equations `normal`
/// for which `believed` with them is a body that can exist.
pub(super) fn nearest_link(
    believed: &LinkInertia,
    free: &DVector<f64>,
    normal: &DMatrix<f64>,
) -> DVector<f64> {
    let center = start(believed);
    let from = Ten::from(believed.parameters());
    let (Some(prior), true) = (
        center.pseudo_inertia().try_inverse(),
        free.len() == LINK_PARAMETERS && normal.nrows() == LINK_PARAMETERS,
    ) else {
        return free.clone();
    };
    let normal = SMatrix::<f64, LINK_PARAMETERS, LINK_PARAMETERS>::from_fn(|i, j| normal[(i, j)]);
    let aim = from + Ten::from_fn(|i, _| free[i]);
    let basis = basis();
    let mut own = Ten::from(center.parameters());
    for barrier in BARRIER {
        let cost = |own: &Ten| -> Option<f64> {
            let matrix = pseudo_inertia(own);
            let root = matrix.cholesky()?;
            let determinant: f64 = root.l().diagonal().iter().map(|d| 2.0 * d.ln()).sum();
            let apart = own - aim;
            let fit = 0.5 * (apart.transpose() * normal * apart)[(0, 0)];
            Some(fit + barrier * ((prior * matrix).trace() - determinant))
        };
        for _ in 0..MAX_STEPS {
            let (Some(now), Some(inverse)) = (cost(&own), pseudo_inertia(&own).try_inverse())
            else {
                break;
            };
            let turned = basis.map(|own| inverse * own);
            let bend = SMatrix::<f64, LINK_PARAMETERS, LINK_PARAMETERS>::from_fn(|i, j| {
                (turned[i] * turned[j]).trace()
            });
            let slope = normal * (own - aim)
                + Ten::from_fn(|i, _| (prior * basis[i]).trace() - turned[i].trace()) * barrier;
            let Some(root) = (normal + bend * barrier).cholesky() else {
                break;
            };
            let step = -root.solve(&slope);
            let promise = -slope.dot(&step);
            // Back until it is possible and better.
            let mut length = 1.0;
            let mut next = None;
            while next.is_none() && length > 1e-9 {
                let there = own + step * length;
                let better = now - 0.1 * length * promise;
                next = cost(&there).filter(|own| *own <= better).map(|_| there);
                length *= 0.5;
            }
            match next {
                Some(there) => own = there,
                None => break,
            }
            if promise < MIN_PROMISE {
                break;
            }
        }
    }
    // At the edge of what is possible rounding goes over it.
    let least = |of: &Ten| pseudo_inertia(of).symmetric_eigenvalues().min();
    let inside = Ten::from(center.parameters());
    if least(&own) < MARGIN * least(&inside) {
        own += (inside - own) * MARGIN;
    }
    DVector::from_fn(LINK_PARAMETERS, |i, _| own[i] - from[i])
}

/// Mass and first moment of a payload nearest to `free` by the normal equations `normal` for
/// which the link with it is a body that can exist. Only one that was taken off can leave
/// none: with y = (h, m), P + y yᵀ / m is positive definite for m < 0 within the ellipsoid
/// yᵀ P⁻¹ y + m < 0. `free` and `normal` are in the order m, h.
pub(super) fn nearest_payload(
    link: &LinkInertia,
    free: &DVector<f64>,
    normal: &DMatrix<f64>,
) -> DVector<f64> {
    let Some(inverse) = link.pseudo_inertia().try_inverse() else {
        return DVector::zeros(4);
    };
    // In the order m, h, as the coefficients are.
    let place = [3, 0, 1, 2];
    let shape = DMatrix::from_fn(4, 4, |i, j| (1.0 + LEFT) * inverse[(place[i], place[j])]);
    let beyond = |y: &DVector<f64>| (y.transpose() * &shape * y)[(0, 0)] + y[0];
    let mut mass = DVector::zeros(4);
    mass[0] = 0.5;
    let at = |multiplier: f64| {
        let system = normal + &shape * multiplier;
        let side = normal * free - &mass * multiplier;
        system
            .lu()
            .solve(&side)
            .unwrap_or_else(|| DVector::zeros(4))
    };
    // The multiplier at which the ellipsoid is reached, by halving its logarithm.
    let (mut low, mut high) = (-60.0, 60.0);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        match beyond(&at(f64::exp(middle))) > 0.0 {
            true => low = middle,
            false => high = middle,
        }
    }
    at(f64::exp(high))
}

/// What is believed, where it is possible; else a ball of its mass at its centre.
fn start(believed: &LinkInertia) -> LinkInertia {
    if believed.is_physical() {
        return *believed;
    }
    let mass = believed.mass.max(LEAST_MASS);
    let center = match believed.mass > LEAST_MASS {
        true => believed.first_moment / believed.mass,
        false => Vector3::zeros(),
    };
    let ball = ferntast_model::rigid_body::Matrix3::identity() * (mass * GYRATION * GYRATION);
    LinkInertia::about_center_of_mass(mass, center, ball)
}

fn pseudo_inertia(parameters: &Ten) -> Matrix4<f64> {
    LinkInertia::from_parameters(&(*parameters).into()).pseudo_inertia()
}

/// Derivatives of the pseudo-inertia by the ten parameters.
fn basis() -> [Matrix4<f64>; LINK_PARAMETERS] {
    std::array::from_fn(|k| pseudo_inertia(&Ten::from_fn(|i, _| f64::from(u8::from(i == k)))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use ferntast_model::rigid_body::Matrix3;
    use proptest::prelude::*;

    fn believed() -> LinkInertia {
        let about = Matrix3::new(0.02, 0.001, 0.0, 0.001, 0.03, 0.0, 0.0, 0.0, 0.025);
        LinkInertia::about_center_of_mass(2.0, Vector3::new(0.1, -0.02, 0.05), about)
    }

    fn with(link: &LinkInertia, changes: &DVector<f64>) -> LinkInertia {
        let mut parameters = link.parameters();
        let each = parameters.iter_mut().zip(changes.iter());
        each.for_each(|(own, change)| *own += change);
        LinkInertia::from_parameters(&parameters)
    }

    fn least(link: &LinkInertia) -> f64 {
        link.pseudo_inertia().symmetric_eigenvalues().min()
    }

    proptest! {
        /// Whatever least squares says, and in however many directions it says nothing.
        #[test]
        fn what_comes_out_can_exist(
            free in prop::collection::vec(-3.0..3.0f64, 10),
            weights in prop::collection::vec(0.0..1e6f64, 10),
            unseen in 0..10usize,
        ) {
            let free = DVector::from_vec(free);
            let mut normal = DMatrix::from_diagonal(&DVector::from_vec(weights));
            normal[(unseen, unseen)] = 0.0;
            let found = nearest_link(&believed(), &free, &normal);
            prop_assert!(least(&with(&believed(), &found)) > 0.0, "{found}");
        }

        /// What is possible, and well determined, is not moved.
        #[test]
        fn what_can_exist_stays(share in prop::collection::vec(-0.2..0.2f64, 10)) {
            let sizes = believed().parameters();
            let free = DVector::from_fn(10, |i, _| 0.2 * share[i] * sizes[i]);
            prop_assume!(least(&with(&believed(), &free)) > 1e-4);
            // Standard errors of a thousandth of each.
            let weights = free.map(|own| (1e-3 * own.abs().max(1e-3)).powi(-2));
            let found = nearest_link(&believed(), &free, &DMatrix::from_diagonal(&weights));
            for ((own, wanted), weight) in found.iter().zip(free.iter()).zip(weights.iter()) {
                prop_assert!((own - wanted).abs() * weight.sqrt() < 0.5, "{found}{free}");
            }
        }

        /// A tool that was taken off, heavier than what carries it.
        #[test]
        fn what_is_taken_off_leaves_a_body(
            mass in -9.0..-2.1f64,
            place in prop::array::uniform3(-0.2..0.2f64),
            weight in 1.0..1e6f64,
        ) {
            let free = DVector::from_fn(4, |i, _| match i {
                0 => mass,
                i => mass * place[i - 1],
            });
            let found = nearest_payload(&believed(), &free, &(DMatrix::identity(4, 4) * weight));
            let moment = Vector3::new(found[1], found[2], found[3]);
            let tensor = Matrix3::identity() * moment.norm_squared() - moment * moment.transpose();
            let payload = LinkInertia {
                mass: found[0],
                first_moment: moment,
                rotational: tensor / found[0],
            };
            prop_assert!(found[0] < 0.0);
            prop_assert!(least(&(believed() + payload)) > 0.0, "{found}");
        }
    }

    /// Mass below zero and nothing else said: the nearest mass is (nearly) none.
    #[test]
    fn a_negative_mass_becomes_none() {
        let mut free = DVector::zeros(10);
        free[0] = -2.5;
        let mut normal = DMatrix::zeros(10, 10);
        normal[(0, 0)] = 1e8;
        let found = with(&believed(), &nearest_link(&believed(), &free, &normal));
        assert!(found.mass > 0.0 && found.mass < 1e-3, "{found:?}");
        assert!(found.is_physical());
    }
}
