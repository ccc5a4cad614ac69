//! `motif view`.

use std::io;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use serde::Serialize;

use crate::args::{Global, ViewArgs};
use crate::bundling;
use crate::failure::{Exit, Failure};
use crate::output::{Outcome, Voice};
use crate::templates;
use crate::view::{Config, View, listen};

/// Where the page is.
#[derive(Clone, Debug, Serialize)]
pub struct ViewResult {
    /// Such as `http://127.0.0.1:8080/`.
    pub address: String,
}

/// How long a search that nobody waits for any more may hold up the end.
const GRACE: Duration = Duration::from_secs(1);

/// Runs the command until it is interrupted.
///
/// # Errors
/// [`Failure`].
pub fn run(args: &ViewArgs, global: &Global) -> Result<Exit, Failure> {
    let templates = match &args.templates[..] {
        [] => Vec::new(),
        paths => templates::load_all(paths)?,
    };
    let config = Config {
        templates: templates
            .into_iter()
            .map(|(_, template)| template)
            .collect(),
        bundles: args.bundles.as_deref().map(bundling::load).transpose()?,
        options: global.read_options()?,
        threads: global.threads,
    };
    let view = View::open(&args.library, config)?;
    let failed = |e| Failure::io(Path::new("view"), e);
    let mut runtime = tokio::runtime::Builder::new_multi_thread();
    let runtime = runtime.enable_all().build().map_err(failed)?;
    let exit = runtime.block_on(async {
        let (listener, address) = listen(args.port).await?;
        // Before the address is told, so that who reads it can end the command.
        let interrupted = interrupted().map_err(failed)?;
        let address = format!("http://{address}/");
        let exit = tell(&address, global.voice())?;
        if args.open {
            open(&address, global.voice());
        }
        view.serve(listener, interrupted).await?;
        Ok(exit)
    });
    runtime.shutdown_timeout(GRACE);
    exit
}

fn tell(address: &str, voice: Voice) -> Result<Exit, Failure> {
    let outcome = Outcome {
        result: ViewResult {
            address: address.to_owned(),
        },
        skipped: Vec::new(),
        found: true,
    };
    let exit = voice.report("view", &outcome, |out| writeln!(out, "{address}"))?;
    voice.note("Ctrl-C ends it");
    Ok(exit)
}

/// Ends with Ctrl-C, or where there is such a thing, with the signal that asks programs to end.
fn interrupted() -> io::Result<impl Future<Output = ()>> {
    #[cfg(unix)]
    {
        use tokio::signal::unix::{SignalKind, signal};
        let mut interrupt = signal(SignalKind::interrupt())?;
        let mut terminate = signal(SignalKind::terminate())?;
        Ok(async move {
            tokio::select! {
                _ = interrupt.recv() => {}
                _ = terminate.recv() => {}
            }
        })
    }
    #[cfg(not(unix))]
    {
        Ok(async {
            if tokio::signal::ctrl_c().await.is_err() {
                // Then it ends as programs do that do not ask for the signal.
                std::future::pending::<()>().await;
            }
        })
    }
}

/// Shows the page in the browser; where there is none, the address was told.
fn open(address: &str, voice: Voice) {
    let (program, arguments): (&str, &[&str]) = match std::env::consts::OS {
        "macos" => ("open", &[]),
        "windows" => ("cmd", &["/C", "start", ""]),
        _ => ("xdg-open", &[]),
    };
    let mut command = Command::new(program);
    command.args(arguments).arg(address);
    let quiet = command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    if let Err(e) = quiet.spawn() {
        voice.note(&format!("--open: {program}: {e}; the address is {address}"));
    }
}
