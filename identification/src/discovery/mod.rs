//! A formula where the catalogue ends: what the residual is as a short function of
//! the signals.
//!
//! Where a diagnosis ends with `unexplained`, terms c · f(x) · g(y) are searched over
//! the signals (`dictionary`), each a column under the filter of all columns
//! (`rows`), each function with its place and scale (`shape`, `constants`), so that
//! units work out (`dimension`). Terms are added, and multiplied by further
//! functions, as long as they explain more than chance does in the same search
//! (`search`, `significance`). What is found is printed (`term`), and judged as it is
//! printed: by the model with that very text, on rows left out, with shared
//! parameters (`proposals`), as when it is added. What reads signals that have noise of the
//! acceleration has to be there with a slower filter, too (`slower`).

mod constants;
mod dictionary;
mod dimension;
mod fitted;
mod map;
mod proposals;
mod results;
mod rows;
mod search;
mod shape;
mod significance;
mod slower;
mod state;
mod term;

use crate::data::error::PrepareError;
use crate::data::{Dataset, ModelSpec};
use crate::design::Design;
use crate::diagnosis::{Verdict, diagnose};
use crate::fit::fit;
use crate::preparation::Filtered;

use dictionary::Dictionary;
use fitted::Fitted;
pub use map::FormulaMap;
use proposals::Judge;
pub use results::{Discovery, Formula, NamedEffect};
use rows::Rows;
use search::search;

/// Proposes formulas for what the catalogue leaves unexplained; none where the model
/// is complete, and where an effect of the catalogue is missing only such as are
/// certainly better than it.
///
/// `seed` decides what chance is taken to be. `progress` is called with the share
/// done, 0 … 1.
///
/// # Errors
///
/// See [`PrepareError`].
pub fn discover(
    dataset: &Dataset,
    spec: &ModelSpec,
    seed: u64,
    progress: &mut dyn FnMut(f64),
) -> Result<Discovery, PrepareError> {
    let diagnosis = diagnose(dataset, spec, &mut |done| progress(0.3 * done))?;
    let mut discovery = Discovery::without_formulas(&diagnosis);
    if diagnosis.verdict == Verdict::Complete {
        progress(1.0);
        return Ok(discovery);
    }
    let filtered = Filtered::new(dataset);
    let prepared = filtered.bind(spec)?;
    let design = Design::new(&prepared);
    let depends_on: Vec<String> = (diagnosis.residual_depends_on.iter())
        .flat_map(|own| own.signals.clone())
        .collect();
    let rows = Rows::new(&prepared, &design, &depends_on);
    let triples = rows.triples(&diagnosis.residual_depends_on);
    let dictionary = Dictionary::new(&rows, &triples, &mut |done| progress(0.3 + 0.1 * done));
    let found = search(&rows, &dictionary, seed, &mut |done| {
        progress(0.4 + 0.4 * done);
    });
    let base = fit(&prepared, &design);
    let fitted = Fitted {
        filtered: &filtered,
        spec,
        prepared: &prepared,
        base: &base,
    };
    let judge = Judge::new(fitted, &rows);
    discovery.tried = dictionary.terms.len();
    discovery.formulas = judge.best(found, diagnosis.candidates.first(), &mut |done| {
        progress(0.8 + 0.2 * done);
    });
    progress(1.0);
    Ok(discovery)
}
