//! `motif view`: the pages of a report, live, with searches.
//!
//! A server for the browsers of this machine. It answers with what the library holds and with the motions of the files
//! that were indexed, named by number, and with nothing else: see `guard` for who may ask, `clips` for what is
//! read. What is done at once is bounded: connections in `server`, threads in `work`, motions in memory in `clips`.

mod agreement;
mod answer;
mod bundles;
mod cache;
mod clip;
mod clips;
mod fragment;
mod guard;
mod list;
mod range;
mod routes;
mod search;
mod server;
mod template;
mod vocabulary;
mod work;

use std::future::Future;
use std::net::SocketAddr;
use std::path::Path;
use std::sync::Arc;

use axum::body::Bytes;
use axum::http::{HeaderValue, StatusCode};
use mtemplate::ClassTemplate;
use tokio::net::{TcpListener, TcpSocket};

use self::answer::Refusal;
use self::clips::Clips;
use self::guard::Names;
use self::work::Workers;
use crate::bundling::Bundled;
use crate::failure::Failure;
use crate::library::Library;
use crate::recording::ReadOptions;
use crate::report::document::{Document, LibraryPage, Page};
use crate::report::html;
use crate::report::make::template_page;
use crate::templates;

/// What is shown.
#[derive(Debug)]
pub struct View {
    library: Library,
    clips: Clips,
    templates: Vec<ClassTemplate>,
    page: Bytes,
    /// What the page may load.
    policy: HeaderValue,
    /// Who searches.
    searchers: Workers,
    /// Who reads clips: others, so that the page goes on while a search takes its time.
    readers: Workers,
}

/// What is shown beside a library, and how.
#[derive(Debug, Default)]
pub struct Config {
    /// Classes that can be searched for.
    pub templates: Vec<ClassTemplate>,
    /// Motion bundles to show.
    pub bundles: Option<Bundled>,
    /// How files are read: as they were when they were indexed.
    pub options: ReadOptions,
    /// Threads that search, and threads that read clips; 0 is one per core.
    pub threads: usize,
}

impl View {
    /// Opens a library.
    ///
    /// # Errors
    /// [`Failure`]: a damaged library, templates for other features or two of one name.
    pub fn open(dir: &Path, config: Config) -> Result<View, Failure> {
        let library = Library::open(dir)?;
        for (i, template) in config.templates.iter().enumerate() {
            templates::for_set(template, &library.features.set)?;
            let mut before = config.templates[..i].iter();
            if before.any(|other| other.name == template.name) {
                let name = &template.name;
                return Err(Failure::Usage(format!(
                    "expected templates with names of their own, found two {name:?}"
                )));
            }
        }
        let policy = html::content_security_policy(true) + "; frame-ancestors 'none'";
        let policy = HeaderValue::try_from(policy).map_err(|e| Failure::Usage(e.to_string()))?;
        let mut view = View {
            clips: Clips::new(&library, config.options)?,
            library,
            templates: config.templates,
            page: Bytes::new(),
            policy,
            searchers: Workers::new(config.threads)?,
            readers: Workers::new(config.threads)?,
        };
        let first = view.first(config.bundles.as_ref());
        let first = first.map_err(|refusal| Failure::Usage(refusal.to_string()))?;
        view.page = html::page(&first).into();
        Ok(view)
    }

    /// Answers at `listener` until `end` is there.
    ///
    /// # Errors
    /// [`Failure::Io`] if the listener has no address.
    pub async fn serve(
        self,
        listener: TcpListener,
        end: impl Future<Output = ()>,
    ) -> Result<(), Failure> {
        let address = listener.local_addr();
        let address = address.map_err(|e| Failure::io(Path::new("127.0.0.1"), e))?;
        let names = Names::new(address.port());
        server::serve(listener, routes::routes(Arc::new(self), names), end).await;
        Ok(())
    }

    /// What the page shows before anything is asked: the library without its clips, but for those that bundles are of.
    fn first(&self, bundled: Option<&Bundled>) -> Result<Document, Refusal> {
        let rows = self.clips.rows();
        let mut pages = vec![Page::Library(LibraryPage {
            path: self.library.dir.display().to_string(),
            set: self.library.features.set.name().to_owned(),
            rate: self.library.rate,
            n_clips: rows.len(),
            seconds: rows.iter().map(|row| row.seconds).sum(),
            labels: self.clips.labels.clone(),
            note: None,
        })];
        let mut ids = Vec::new();
        if let Some(bundled) = bundled {
            let page = bundles::page(bundled, &self.clips);
            let spans = page.nodes.iter().flat_map(|node| &node.spans);
            ids.extend(spans.map(|span| span.clip));
            pages.push(Page::Bundles(page));
        }
        pages.extend(self.templates.iter().filter_map(template_page));
        fragment::fragment(self, &ids, pages)
    }

    fn title(&self) -> String {
        self.library.dir.display().to_string()
    }

    /// The number of a clip that was found.
    fn id_of(&self, name: &str) -> Result<u32, Refusal> {
        let unknown = || {
            let error = format!("{name}: found, but not listed");
            Refusal::new(StatusCode::INTERNAL_SERVER_ERROR, error)
        };
        self.clips.id(name).ok_or_else(unknown)
    }
}

/// Connections that the system keeps until they are taken. Of the 128 that are usual some are lost when hundreds come
/// at once.
const WAITING: u32 = 4096;

/// A listener on this machine alone; port 0 is any that is free.
///
/// # Errors
/// [`Failure::Io`], such as for a port that is taken.
pub async fn listen(port: u16) -> Result<(TcpListener, SocketAddr), Failure> {
    let asked = SocketAddr::from(([127, 0, 0, 1], port));
    let listener = async {
        let socket = TcpSocket::new_v4()?;
        // Elsewhere this would let two servers have one port.
        #[cfg(unix)]
        socket.set_reuseaddr(true)?;
        socket.bind(asked)?;
        let listener = socket.listen(WAITING)?;
        let address = listener.local_addr()?;
        Ok((listener, address))
    };
    let listener = listener.await;
    listener.map_err(|e| Failure::io(Path::new(&asked.to_string()), e))
}
