//! A server in this process, and a client that sends what it is told, byte by byte.

use std::collections::BTreeMap;
use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::path::Path;
use std::sync::OnceLock;
use std::thread::JoinHandle;

use cli::view::{Config, View, listen};
use serde_json::Value;
use tokio::sync::oneshot;

use crate::corpus::Fixture;
use crate::learn::Learned;

/// A server of a library; it ends when it is dropped.
pub(crate) struct Server {
    pub(crate) address: SocketAddr,
    end: Option<oneshot::Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Server {
    pub(crate) fn of(library: &Path, config: Config) -> Server {
        let view = View::open(library, config).unwrap();
        let (end, ended) = oneshot::channel();
        let (tell, told) = std::sync::mpsc::channel();
        let thread = std::thread::spawn(move || {
            let runtime = tokio::runtime::Builder::new_multi_thread()
                .worker_threads(1)
                .enable_all()
                .build()
                .unwrap();
            runtime.block_on(async {
                let (listener, address) = listen(0).await.unwrap();
                tell.send(address).unwrap();
                let ended = async {
                    ended.await.unwrap();
                };
                view.serve(listener, ended).await.unwrap();
            });
        });
        Server {
            address: told.recv().unwrap(),
            end: Some(end),
            thread: Some(thread),
        }
    }

    /// Of the built-in corpus with two templates, for all tests.
    pub(crate) fn get() -> &'static Server {
        static SERVER: OnceLock<Server> = OnceLock::new();
        SERVER.get_or_init(|| {
            let templates = ["squat", "kick_left"].map(|class| Learned::get().template(class));
            let config = Config {
                templates: templates.into(),
                ..Config::default()
            };
            Server::of(&Fixture::get().library(), config)
        })
    }

    /// Sends a request as it stands and reads all that comes back.
    pub(crate) fn send(&self, request: &str) -> Reply {
        let mut stream = TcpStream::connect(self.address).unwrap();
        stream.write_all(request.as_bytes()).unwrap();
        let mut bytes = Vec::new();
        // A server that refuses to read on may cut the connection; what it said before counts.
        let _ = stream.read_to_end(&mut bytes);
        Reply::parse(&bytes)
    }

    /// A request with further headers, each line ended.
    pub(crate) fn ask(&self, method: &str, target: &str, headers: &str) -> Reply {
        let host = self.address;
        self.send(&format!(
            "{method} {target} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n{headers}\r\n"
        ))
    }

    pub(crate) fn get_path(&self, target: &str) -> Reply {
        self.ask("GET", target, "")
    }

    /// The JSON of an answer that has to be there.
    #[track_caller]
    pub(crate) fn json(&self, target: &str) -> Value {
        let reply = self.get_path(target);
        assert_eq!(reply.status, 200, "{target}: {}", reply.text());
        assert_eq!(reply.header("content-type"), Some("application/json"));
        reply.json()
    }

    /// The JSON of a refusal.
    #[track_caller]
    pub(crate) fn refused(&self, target: &str, status: u16) -> Value {
        let reply = self.get_path(target);
        assert_eq!(reply.status, status, "{target}: {}", reply.text());
        let json = reply.json();
        assert!(json["error"].is_string(), "{target}: {json}");
        json
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        if let (Some(end), Some(thread)) = (self.end.take(), self.thread.take()) {
            end.send(()).unwrap();
            thread.join().unwrap();
        }
    }
}

#[derive(Debug)]
pub(crate) struct Reply {
    /// 0 if there was no answer.
    pub(crate) status: u16,
    pub(crate) headers: BTreeMap<String, String>,
    pub(crate) body: Vec<u8>,
}

impl Reply {
    pub(crate) fn parse(bytes: &[u8]) -> Reply {
        let end = bytes.windows(4).position(|four| four == b"\r\n\r\n");
        let (head, body) = bytes.split_at(end.map_or(bytes.len(), |end| end + 4));
        let head = String::from_utf8(head.to_vec()).unwrap();
        let mut lines = head.lines();
        let status = lines.next().and_then(|line| line.split(' ').nth(1));
        let headers = lines.filter_map(|line| {
            let (name, value) = line.split_once(": ")?;
            Some((name.to_lowercase(), value.to_owned()))
        });
        Reply {
            status: status.map_or(0, |status| status.parse().unwrap()),
            headers: headers.collect(),
            body: body.to_vec(),
        }
    }

    pub(crate) fn header(&self, name: &str) -> Option<&str> {
        self.headers.get(name).map(String::as_str)
    }

    pub(crate) fn text(&self) -> String {
        String::from_utf8_lossy(&self.body).into_owned()
    }

    #[track_caller]
    pub(crate) fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap()
    }
}

/// A text for a query.
pub(crate) fn encoded(text: &str) -> String {
    let bytes = text.bytes();
    bytes.map(|byte| format!("%{byte:02X}")).collect()
}
