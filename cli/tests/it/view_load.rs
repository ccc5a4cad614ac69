//! The command `motif view` as a program: it ends when asked to, and a thousand searches at once are answered.

use std::fs;
use std::io::{BufRead, BufReader};
use std::net::SocketAddr;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use cli::library::Library;
use serde_json::Value;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;

use crate::corpus::Fixture;
use crate::view_client::Reply;

/// The program; it is ended when it is dropped.
struct Program {
    child: Child,
    address: SocketAddr,
}

impl Program {
    fn start() -> Program {
        let mut child = Command::new(assert_cmd::cargo::cargo_bin!("motif"))
            .args(["view", "--json"])
            .arg(Fixture::get().library())
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::inherit())
            .spawn()
            .unwrap();
        let mut line = String::new();
        let mut stdout = BufReader::new(child.stdout.take().unwrap());
        stdout.read_line(&mut line).unwrap();
        let document: Value = serde_json::from_str(&line).unwrap();
        assert_eq!(document["command"], "view");
        let address = document["result"]["address"].as_str().unwrap();
        let address = address
            .strip_prefix("http://")
            .unwrap()
            .strip_suffix('/')
            .unwrap();
        let address: SocketAddr = address.parse().unwrap();
        assert!(address.ip().is_loopback());
        Program { child, address }
    }

    /// Kilobytes of memory, the most so far; `None` where the system does not say.
    fn peak(&self) -> Option<u64> {
        let status = fs::read_to_string(format!("/proc/{}/status", self.child.id())).ok()?;
        let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
        line.split_whitespace().nth(1)?.parse().ok()
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// One request on a connection of its own.
async fn ask(address: SocketAddr, target: &str) -> (Reply, Duration) {
    let start = Instant::now();
    let mut stream = TcpStream::connect(address).await.unwrap();
    let request = format!("GET {target} HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\n\r\n");
    stream.write_all(request.as_bytes()).await.unwrap();
    let mut bytes = Vec::new();
    stream.read_to_end(&mut bytes).await.unwrap();
    (Reply::parse(&bytes), start.elapsed())
}

fn runtime() -> tokio::runtime::Runtime {
    let mut builder = tokio::runtime::Builder::new_current_thread();
    builder.enable_all().build().unwrap()
}

#[cfg(unix)]
#[test]
fn an_interrupt_ends_it_well() {
    for signal in ["-INT", "-TERM"] {
        let mut program = Program::start();
        // One that stays connected and asks for nothing.
        let idle = std::net::TcpStream::connect(program.address).unwrap();
        let (reply, _) = runtime().block_on(ask(program.address, "/api/vocabulary"));
        assert_eq!(reply.status, 200);
        let id = program.child.id().to_string();
        assert!(
            Command::new("kill")
                .args([signal, &id])
                .status()
                .unwrap()
                .success()
        );
        let status = program.child.wait().unwrap();
        assert_eq!(status.code(), Some(0), "{signal}");
        drop(idle);
    }
}

/// Searches at once.
const N_SEARCHES: usize = 1000;

/// A thousand searches may not take more memory, in kilobytes, than this beyond what one of each took: the motions and
/// strips that are kept (96 MB), and as much again for answers under way and for what the allocator does not give back.
const MEMORY: u64 = 192 << 10;

/// Answers of one search differ by nothing but are many: half by example, a quarter each by scene and by clips.
fn targets() -> Vec<String> {
    let library = Library::open(&Fixture::get().library()).unwrap();
    let clips = library.clips().unwrap();
    let features = [
        "rknee_bent,lknee_bent",
        "lower",
        "rfoot_raised,rknee_bent",
        "upper",
    ];
    let scene = "rfoot_raised%20:%200%201%200;rknee_bent%20:%200%201%200";
    let target = |k: usize| {
        let (id, clip) = (k % clips.len(), &clips[k % clips.len()]);
        match k % 4 {
            0 | 1 => {
                let end = clip.meta.source_frames / 2 + 1 + k as u64 % 7;
                format!(
                    "/api/search?clip={id}&start=0&end={end}&features={}",
                    features[k / 4 % 4]
                )
            }
            2 => format!("/api/search?clip={id}&features=F20,F21&mismatches=1&top=5"),
            _ => format!("/api/scene?text={scene}%3Bwithin%20{}s&top=10", 1 + k % 9),
        }
    };
    (0..N_SEARCHES).map(target).collect()
}

fn told(kilobytes: Option<u64>) -> String {
    kilobytes.map_or("not known".to_owned(), |n| format!("{n} kB"))
}

#[test]
fn a_thousand_searches_at_once_are_answered() {
    let program = Program::start();
    let (runtime, address) = (runtime(), program.address);
    for target in targets().iter().take(40) {
        let (reply, _) = runtime.block_on(ask(address, target));
        // Some clips have too few segments to let one differ.
        assert!(
            [200, 400].contains(&reply.status),
            "{target}: {}",
            reply.text()
        );
    }
    let before = program.peak();
    let start = Instant::now();
    let (mut took, at_once) = runtime.block_on(async {
        let mut asked = tokio::task::JoinSet::new();
        for target in targets() {
            asked.spawn(async move {
                let (reply, took) = ask(address, &target).await;
                let is_answered = match reply.status {
                    200 => reply.json()["pages"][0]["hits"].is_array(),
                    400 => reply.json()["error"]
                        .as_str()
                        .unwrap()
                        .starts_with("--mismatches"),
                    _ => false,
                };
                assert!(is_answered, "{target}: {} {}", reply.status, reply.text());
                took
            });
        }
        // The page goes on meanwhile.
        let (page, at_once) = ask(address, "/api/clips?n=5").await;
        assert_eq!(page.status, 200);
        (asked.join_all().await, at_once)
    });
    took.sort();
    assert_eq!(took.len(), N_SEARCHES);
    let of = |share: usize| took[(took.len() - 1) * share / 100].as_secs_f64();
    let after = program.peak();
    eprintln!(
        "{N_SEARCHES} searches at once in {:.2} s, none failed; median {:.3} s, p99 {:.3} s; a page meanwhile {:.3} s; \
         peak memory {} before, {} after",
        start.elapsed().as_secs_f64(),
        of(50),
        of(99),
        at_once.as_secs_f64(),
        told(before),
        told(after),
    );
    if let (Some(before), Some(after)) = (before, after) {
        assert!(
            after <= before + MEMORY,
            "{before} kB before, {after} kB after"
        );
    }
}
