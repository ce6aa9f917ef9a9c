//! Independent jobs on all cores, results in the order of the jobs.

use std::{
    num::NonZero,
    sync::{
        Mutex,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
    thread,
};

/// Runs `work` on every job, on as many threads as there are cores. After the
/// first error no new job is begun; that error is given.
///
/// # Errors
///
/// The error of the first job, in their order, that failed.
pub fn map<J: Sync, T: Send, E: Send>(
    jobs: &[J],
    work: impl Fn(usize, &J) -> Result<T, E> + Sync,
) -> Result<Vec<T>, E> {
    map_telling(jobs, work, &|_| {})
}

/// The same; `progress` is told how many are done.
///
/// # Errors
///
/// As [`map`].
pub fn map_telling<J: Sync, T: Send, E: Send>(
    jobs: &[J],
    work: impl Fn(usize, &J) -> Result<T, E> + Sync,
    progress: &(dyn Fn(usize) + Sync),
) -> Result<Vec<T>, E> {
    let threads = thread::available_parallelism()
        .map_or(1, NonZero::get)
        .min(jobs.len());
    let next = AtomicUsize::new(0);
    let failed = AtomicBool::new(false);
    let done: Mutex<Vec<(usize, Result<T, E>)>> = Mutex::new(Vec::new());
    thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some(job) = jobs.get(index) else {
                        return;
                    };
                    if failed.load(Ordering::Relaxed) {
                        return;
                    }
                    let result = work(index, job);
                    failed.fetch_or(result.is_err(), Ordering::Relaxed);
                    let mut done = done.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
                    done.push((index, result));
                    progress(done.len());
                }
            });
        }
    });
    let mut done = done
        .into_inner()
        .unwrap_or_else(|poisoned| poisoned.into_inner());
    done.sort_by_key(|(index, _)| *index);
    done.into_iter().map(|(_, result)| result).collect()
}

#[cfg(test)]
mod tests {
    use super::map;

    #[test]
    fn results_keep_the_order_of_the_jobs() {
        let jobs: Vec<u64> = (0..200).collect();
        let squares = map(&jobs, |index, job| {
            assert_eq!(index as u64, *job);
            Ok::<u64, ()>(job * job)
        });
        assert_eq!(squares, Ok(jobs.iter().map(|job| job * job).collect()));
    }

    #[test]
    fn an_error_ends_it() {
        let jobs: Vec<u64> = (0..200).collect();
        let result = map(&jobs, |_, job| if *job == 17 { Err(*job) } else { Ok(()) });
        assert_eq!(result, Err(17));
    }
}
