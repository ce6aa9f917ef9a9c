//! Two effects hidden at once, found by adding what is named.

use ferntast_benches::bench::BenchConfig;
use ferntast_identification::{Dataset, ModelSpec, Term, Verdict, add, diagnose};

use super::super::TestBench;

/// Hides two effects and adds what is named until nothing more is; gives how
/// many of the two were named.
pub(super) fn two_at_once<H: TestBench>(seed: u64) -> Result<usize, String> {
    let catalogue: Vec<H> = H::ALL
        .iter()
        .copied()
        .filter(|own| own.in_catalogue())
        .collect();
    let count = catalogue.len() as u64;
    // Neighbouring seeds take unrelated pairs; some pairs do not go together.
    for turn in 0..count {
        let mixed = seed.wrapping_add(turn).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 32;
        let pick = |number: u64| catalogue.get((number % count) as usize).copied();
        let (Some(first), Some(second)) = (pick(mixed), pick(mixed / count)) else {
            continue;
        };
        let config = BenchConfig {
            seed,
            hidden: vec![first, second],
            sessions: H::SESSIONS,
            ..BenchConfig::default()
        };
        let Ok(bench) = H::bench(&config) else {
            continue;
        };
        let failed = |error: String| format!("{first} and {second} hidden, seed {seed}: {error}");
        let recording = H::record(&bench).map_err(|error| failed(error.to_string()))?;
        let named = add_all(&H::dataset(&recording), H::model(&recording)).map_err(failed)?;
        let is_named = |effect: &H| {
            named
                .iter()
                .any(|name| effect.accepted().contains(&name.as_str()))
        };
        return Ok([first, second].iter().filter(|own| is_named(own)).count());
    }
    Err(format!("no two effects go together for seed {seed}"))
}

/// Diagnoses and adds as `ferntast lab auto` does; gives what was named.
fn add_all(dataset: &Dataset, mut model: ModelSpec) -> Result<Vec<String>, String> {
    const MOST: usize = 4;
    let mut named = Vec::new();
    while named.len() < MOST {
        let diagnosis =
            diagnose(dataset, &model, &mut |_| {}).map_err(|error| error.to_string())?;
        let (Verdict::Missing, Some(best)) = (diagnosis.verdict, diagnosis.candidates.first())
        else {
            break;
        };
        let term = Term::Catalogue(best.effect.clone());
        model = add(dataset, &model, &term)
            .map_err(|error| error.to_string())?
            .model;
        named.push(best.effect.clone());
    }
    Ok(named)
}
