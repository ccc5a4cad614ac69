//! Work that takes a while, so that no more of it is done at once than there are threads for it.

use std::sync::Arc;
use std::time::Duration;

use axum::http::StatusCode;
use rayon::ThreadPool;
use tokio::sync::Semaphore;

use super::answer::Refusal;
use crate::failure::Failure;

/// Threads that do one kind of work. So much of it is done at once as there are threads; the rest waits and takes up
/// no more than the question itself.
#[derive(Debug)]
pub(super) struct Workers {
    pool: Arc<ThreadPool>,
    free: Arc<Semaphore>,
}

/// The longest that an answer takes, waiting included: browsers give up after five minutes at the latest.
const LIMIT: Duration = Duration::from_secs(120);

impl Workers {
    /// `threads` of them; 0 is one per core.
    ///
    /// # Errors
    /// [`Failure::Usage`] if there cannot be so many.
    pub(super) fn new(threads: usize) -> Result<Workers, Failure> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.map_err(|e| Failure::Usage(format!("--threads {threads}: {e}")))?;
        Ok(Workers {
            free: Arc::new(Semaphore::new(pool.current_num_threads())),
            pool: Arc::new(pool),
        })
    }

    /// Does `work` as soon as a thread is free.
    ///
    /// # Errors
    /// What `work` refuses, that it takes too long, or that it broke off.
    pub(super) async fn do_work<T: Send + 'static>(
        &self,
        work: impl FnOnce() -> Result<T, Refusal> + Send + 'static,
    ) -> Result<T, Refusal> {
        let (pool, free) = (Arc::clone(&self.pool), Arc::clone(&self.free));
        let broken = |e: &dyn std::fmt::Display| {
            let error = format!("the work broke off: {e}");
            Refusal::new(StatusCode::INTERNAL_SERVER_ERROR, error)
        };
        let work = async {
            let permit = free.acquire_owned().await.map_err(|e| broken(&e))?;
            let work = move || {
                // Kept until the work is done, even if nobody waits for it any more.
                let _permit = permit;
                pool.install(work)
            };
            let done = tokio::task::spawn_blocking(work).await;
            done.map_err(|e| broken(&e))?
        };
        let done = tokio::time::timeout(LIMIT, work).await;
        done.unwrap_or_else(|_| {
            let error = format!("expected an answer within {} s", LIMIT.as_secs());
            Err(Refusal::new(StatusCode::SERVICE_UNAVAILABLE, error))
        })
    }
}
