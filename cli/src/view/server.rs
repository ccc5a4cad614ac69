//! Connections.

use std::future::Future;
use std::io;
use std::pin::pin;
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{Semaphore, watch};
use tokio::task::JoinSet;

/// Connections at once; further ones wait until the system has one of them taken.
const MAX_CONNECTIONS: usize = 512;

/// How long a request may take to arrive, and a connection to do nothing.
const ARRIVAL: Duration = Duration::from_secs(30);

/// Bytes of a request, without a body, which is never read.
const MAX_REQUEST: usize = 16 << 10;

/// How long answers under way may still take when the server is to end.
const GRACE: Duration = Duration::from_secs(2);

/// How long to wait when no connection can be taken, such as for want of file handles.
const BREATH: Duration = Duration::from_millis(100);

/// Answers requests by `router` until `end` is there.
pub(super) async fn serve(listener: TcpListener, router: Router, end: impl Future<Output = ()>) {
    let free = Arc::new(Semaphore::new(MAX_CONNECTIONS));
    let (ending, _) = watch::channel(());
    let mut connections = JoinSet::new();
    let mut end = pin!(end);
    loop {
        let next = async {
            let permit = Arc::clone(&free).acquire_owned().await;
            let accepted = listener.accept().await;
            permit
                .map_err(io::Error::other)
                .and_then(|permit| Ok((permit, accepted?.0)))
        };
        tokio::select! {
            () = &mut end => break,
            next = next => match next {
                Ok((permit, stream)) => {
                    let answered = answer(stream, router.clone(), ending.subscribe());
                    connections.spawn(async move {
                        answered.await;
                        drop(permit);
                    });
                }
                Err(_) => tokio::time::sleep(BREATH).await,
            }
        }
        while connections.try_join_next().is_some() {}
    }
    drop(listener);
    // Without connections nobody listens.
    let _ = ending.send(());
    let all_gone = async { while connections.join_next().await.is_some() {} };
    let _ = tokio::time::timeout(GRACE, all_gone).await;
}

/// Answers the requests of a connection. That it breaks off is no failure.
async fn answer(stream: TcpStream, router: Router, mut ending: watch::Receiver<()>) {
    // Answers are written as a whole; a failure would only make them slower.
    let _ = stream.set_nodelay(true);
    let mut connection = pin!(
        http1::Builder::new()
            .timer(TokioTimer::new())
            .header_read_timeout(ARRIVAL)
            .max_buf_size(MAX_REQUEST)
            .serve_connection(TokioIo::new(stream), TowerToHyperService::new(router))
    );
    tokio::select! {
        _ = &mut connection => return,
        _ = ending.changed() => connection.as_mut().graceful_shutdown(),
    }
    let _ = connection.await;
}
