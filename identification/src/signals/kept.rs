//! Columns of a session that a model needs again and again: the model is fitted anew with
//! each effect that it may lack, and its other terms' columns stay the same then.
//!
//! Kept are those alone that are functions of the motion as it is measured
//! ([`Effect::is_of_motion`](crate::effects::Effect::is_of_motion)): the load may be modelled
//! anew, and the model's own prediction made. Whoever changes the channels forgets them.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use ferntast_model::friction::FrictionState;

/// Columns, one value a sample or a row.
pub type Columns = Arc<Vec<Vec<f64>>>;

/// Columns by what they are of.
type List = Vec<(Key, Columns)>;

/// Columns of one kind that are kept, at most; then all are forgotten.
const MOST: usize = 24;

/// Which columns.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Key {
    /// Id of the effect.
    pub effect: String,
    /// Its shape and what else they depend on, bit by bit.
    pub numbers: Vec<u64>,
}

/// The columns that are kept.
#[derive(Debug, Default)]
pub struct Kept {
    all: Mutex<Lists>,
}

#[derive(Debug, Default)]
struct Lists {
    /// At the working rate.
    working: List,
    /// Filtered at these rows.
    filtered: Vec<(Vec<usize>, List)>,
    /// States for laws of the motion, at the working rate: a third of what a point takes, so
    /// that less memory is gone through for each shape.
    states: Option<Arc<Vec<FrictionState>>>,
}

impl Key {
    /// Of the effect `effect` at a shape.
    #[must_use]
    pub fn new(effect: &str, shape: &[f64], more: f64) -> Self {
        let numbers = shape.iter().chain([&more]);
        Self {
            effect: effect.to_owned(),
            numbers: numbers.map(|own| own.to_bits()).collect(),
        }
    }
}

impl Kept {
    /// Columns at the working rate, made where they are not kept.
    pub fn working(&self, key: Key, make: impl FnOnce() -> Vec<Vec<f64>>) -> Columns {
        self.get(|lists| &mut lists.working, key, make)
    }

    /// Columns filtered at these `rows`.
    pub fn filtered(
        &self,
        rows: &[usize],
        key: Key,
        make: impl FnOnce() -> Vec<Vec<f64>>,
    ) -> Columns {
        self.get(|lists| lists.at(rows), key, make)
    }

    /// States of the motion; the load in them counts for nobody.
    pub fn states(&self, make: impl FnOnce() -> Vec<FrictionState>) -> Arc<Vec<FrictionState>> {
        let mut lists = self.lock();
        (lists.states.get_or_insert_with(|| Arc::new(make()))).clone()
    }

    fn lock(&self) -> MutexGuard<'_, Lists> {
        self.all.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn get(
        &self,
        list: impl Fn(&mut Lists) -> &mut List,
        key: Key,
        make: impl FnOnce() -> Vec<Vec<f64>>,
    ) -> Columns {
        // Not held while columns are made: these may need others.
        let known = (list(&mut self.lock()).iter())
            .find(|own| own.0 == key)
            .map(|own| own.1.clone());
        if let Some(known) = known {
            return known;
        }
        let made = Arc::new(make());
        let mut lists = self.lock();
        let own = list(&mut lists);
        let count: usize = own.iter().map(|(_, columns)| columns.len()).sum();
        if count + made.len() > MOST {
            own.clear();
        }
        own.push((key, made.clone()));
        made
    }
}

impl Lists {
    /// What is kept at these rows; of three kinds of rows, with reversals, without, and
    /// without those that are not determined.
    fn at(&mut self, rows: &[usize]) -> &mut List {
        const KINDS: usize = 3;
        let known = self.filtered.iter().position(|own| own.0 == rows);
        let at = known.unwrap_or_else(|| {
            if self.filtered.len() >= KINDS {
                self.filtered.clear();
            }
            self.filtered.push((rows.to_vec(), Vec::new()));
            self.filtered.len() - 1
        });
        &mut self.filtered[at].1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_made_once_for_each_shape_and_rows() {
        let kept = Kept::default();
        let key = |shape: f64| Key::new("stribeck", &[shape], 0.0);
        let first = kept.filtered(&[1, 2], key(0.1), || vec![vec![1.0, 2.0]]);
        let again = kept.filtered(&[1, 2], key(0.1), || unreachable!());
        assert_eq!(first, again);
        let other = kept.filtered(&[1, 3], key(0.1), || vec![vec![1.0, 3.0]]);
        let shape = kept.filtered(&[1, 2], key(0.2), || vec![vec![5.0, 6.0]]);
        assert_ne!(other, first);
        assert_ne!(shape, first);
        assert_eq!(kept.working(key(0.1), || vec![vec![9.0]])[0], [9.0]);
    }

    #[test]
    fn no_more_are_kept_than_there_is_room_for() {
        let kept = Kept::default();
        for number in 0..100 {
            kept.working(Key::new("a", &[f64::from(number)], 0.0), || {
                vec![vec![0.0]; 2]
            });
        }
        let lists = kept.all.lock().unwrap();
        assert!((1..=MOST / 2).contains(&lists.working.len()));
    }
}
