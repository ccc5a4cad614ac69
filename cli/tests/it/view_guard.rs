//! What the live viewer must not tell, and whom it must not answer.

use std::fs;
use std::path::{Path, PathBuf};

use cli::view::Config;
use tempfile::TempDir;

use crate::corpus::build;
use crate::library::takes;
use crate::view_client::{Reply, Server, encoded};

/// What a file has that nobody may see.
const SECRET: &str = "s3cr3t-w0rd";

/// Some clips of their own with a library, and a file beside them that is not in it.
struct Own {
    dir: TempDir,
    clips: Vec<PathBuf>,
    skeleton: PathBuf,
    server: Server,
}

impl Own {
    fn new() -> Own {
        let dir = tempfile::tempdir().unwrap();
        let folder = takes(dir.path(), "anna", 4);
        let library = dir.path().join("library");
        build(std::slice::from_ref(&folder), &library);
        fs::write(dir.path().join("secret.bvh"), secret()).unwrap();
        fs::write(dir.path().join("secret.scene"), format!("{SECRET} : 0 1")).unwrap();
        let files = fs::read_dir(&folder)
            .unwrap()
            .map(|entry| entry.unwrap().path());
        let mut clips: Vec<PathBuf> = files
            .filter(|file| file.extension().unwrap() == "amc")
            .collect();
        clips.sort();
        Own {
            server: Server::of(&library, Config::default()),
            skeleton: folder.join("anna.asf"),
            clips,
            dir,
        }
    }

    fn secret(&self) -> PathBuf {
        self.dir.path().join("secret.bvh")
    }

    /// What each route that reads the file of a clip says of it.
    fn replies(&self, id: usize) -> [Reply; 3] {
        ["", "/motion"]
            .map(|part| format!("/api/clips/{id}{part}"))
            .into_iter()
            .chain([format!("/api/search?clip={id}&mirror=1")])
            .map(|target| self.server.get_path(&target))
            .collect::<Vec<_>>()
            .try_into()
            .unwrap()
    }

    #[track_caller]
    fn check(&self, id: usize, status: u16) {
        for reply in self.replies(id) {
            assert_eq!(reply.status, status, "{}", reply.text());
            assert!(!reply.text().contains(SECRET), "{}", reply.text());
        }
        // It is listed all the same, by what the library knows.
        let listed = self.server.json("/api/clips");
        assert_eq!(listed["total"], self.clips.len());
        let clip = listed["clips"]
            .as_array()
            .unwrap()
            .iter()
            .find(|clip| clip["id"] == id);
        assert_eq!(clip.unwrap()["strip"].is_object(), status == 200);
        assert!(!listed.to_string().contains(SECRET));
    }
}

/// A BVH file whose joints tell something.
fn secret() -> String {
    crate::command::GOOD.replace("LeftUpLeg", SECRET)
}

#[test]
fn a_file_that_was_changed_is_not_shown() {
    let own = Own::new();
    let text = fs::read_to_string(&own.clips[1]).unwrap();
    fs::write(&own.clips[1], text + "\n").unwrap();
    fs::write(&own.clips[2], SECRET).unwrap();
    fs::remove_file(&own.clips[3]).unwrap();
    for (id, status) in [(0, 200), (1, 409), (2, 409), (3, 404)] {
        own.check(id, status);
    }
}

#[test]
fn a_skeleton_that_was_changed_shows_nothing() {
    let own = Own::new();
    let text = fs::read_to_string(&own.skeleton).unwrap();
    fs::write(&own.skeleton, text + "\n").unwrap();
    own.check(0, 409);
    fs::remove_file(&own.skeleton).unwrap();
    own.check(1, 409);
}

#[cfg(unix)]
#[test]
fn a_link_to_another_file_shows_nothing() {
    use std::os::unix::fs::symlink;

    let own = Own::new();
    let replace = |id: usize, target: &Path| {
        fs::remove_file(&own.clips[id]).unwrap();
        symlink(target, &own.clips[id]).unwrap();
    };
    replace(0, &own.secret());
    replace(1, Path::new("/etc/passwd"));
    // There is no end to read to.
    replace(2, Path::new("/dev/zero"));
    replace(3, own.dir.path());
    for id in 0..4 {
        own.check(id, 409);
    }
    replace(3, &own.dir.path().join("nothing"));
    own.check(3, 404);
}

#[cfg(unix)]
#[test]
fn a_link_to_the_same_bytes_is_as_good_as_the_file() {
    use std::os::unix::fs::symlink;

    let own = Own::new();
    let moved = own.dir.path().join("moved.amc");
    fs::rename(&own.clips[0], &moved).unwrap();
    symlink(&moved, &own.clips[0]).unwrap();
    own.check(0, 200);
}

#[cfg(unix)]
#[test]
fn a_pipe_is_not_waited_for() {
    let own = Own::new();
    fs::remove_file(&own.clips[0]).unwrap();
    let made = std::process::Command::new("mkfifo")
        .arg(&own.clips[0])
        .status()
        .unwrap();
    assert!(made.success());
    own.check(0, 409);
}

/// Ways to say a path.
fn spellings(path: &Path) -> Vec<String> {
    let plain = path.to_str().unwrap();
    let up = "../".repeat(12);
    let relative = format!("{up}{}", plain.trim_start_matches('/'));
    vec![
        plain.to_owned(),
        encoded(plain),
        encoded(plain).replace('%', "%25"),
        plain.replace('/', "%2f"),
        plain.replace('/', "\\"),
        plain.replace('/', "%5c"),
        relative.clone(),
        encoded(&relative),
        relative.replace("../", "%2e%2e/"),
        relative.replace("../", "%2e%2e%2f"),
        relative.replace("../", "..%2f"),
        relative.replace("../", "....//"),
        format!("0/{relative}"),
        format!("{plain}%00"),
        format!("file://{plain}"),
    ]
}

/// Every way to say where each file is that nobody may see.
fn secrets(own: &Own) -> impl Iterator<Item = String> {
    let beside = ["secret.scene", "library/library.toml"].map(|file| own.dir.path().join(file));
    let files = beside.into_iter().chain([own.secret()]);
    files.flat_map(|file| spellings(&file))
}

impl Own {
    /// Asks, and hears one of `expected` and nothing of what nobody may see.
    #[track_caller]
    fn check_silent(&self, target: &str, expected: &[u16]) {
        let reply = self.server.get_path(target);
        let is_expected = expected.contains(&reply.status);
        assert!(is_expected, "{target}: {}", reply.status);
        let text = reply.text();
        let is_silent = !text.contains(SECRET) && !text.contains("feature_set_toml");
        assert!(is_silent, "{target}: {text}");
    }
}

#[test]
fn no_path_leads_to_a_file() {
    let own = Own::new();
    for path in secrets(&own) {
        for target in [
            path.clone(),
            format!("/{path}"),
            format!("/api/{path}"),
            format!("/api/clips/{path}"),
            format!("/api/clips/{path}/motion"),
            format!("/api/clips/0/{path}"),
            format!("/api/agreement/{path}"),
        ] {
            // 400: no target at all. 421: one at another host.
            own.check_silent(&target, &[400, 404, 421]);
        }
    }
}

#[test]
fn no_parameter_is_a_path() {
    let own = Own::new();
    for path in secrets(&own) {
        for target in [
            format!("/api/search?clip={path}"),
            format!("/api/search?clip=0&features={path}"),
            format!("/api/search?clip=0&mode={path}"),
            format!("/api/search?clip=0&start={path}"),
            format!("/api/search?clip=0&mirror={path}"),
            format!("/api/search?clip=0&example={path}"),
            format!("/api/scene?text={path}"),
            format!("/api/scene?text={path}&top={path}"),
            format!("/api/template?name={path}"),
            format!("/api/agreement?clip=0&start=0&end=9&hit={path}&from=0&to=9"),
            format!("/api/agreement?clip={path}&start=0&end=9&hit=0&from=0&to=9"),
            format!("/api/agreement?clip=0&start=0&end=9&hit=0&from=0&to=9&features={path}"),
            format!("/api/agreement/scene?text={path}&hit=0&from=0&to=9"),
            format!("/api/agreement/template?name={path}&hit=0"),
            format!("/api/clips?from={path}"),
            format!("/api/clips?sort={path}"),
            format!("/api/clips?path={path}"),
        ] {
            own.check_silent(&target, &[400, 404]);
        }
        for target in [
            format!("/api/clips?label={path}"),
            format!("/api/clips?text={path}"),
        ] {
            own.check_silent(&target, &[200, 400]);
        }
    }
}

/// What is answered to those who may ask.
const TARGETS: [&str; 4] = [
    "/",
    "/api/clips",
    "/api/clips/0/motion",
    "/api/agreement/template?name=squat&hit=0",
];

#[test]
fn only_our_own_host_is_answered() {
    let server = Server::get();
    let port = server.address.port();
    let ask = |target: &str, host: &str| {
        server.send(&format!(
            "GET {target} HTTP/1.1\r\n{host}Connection: close\r\n\r\n"
        ))
    };
    for target in TARGETS.into_iter().chain(["/nothing"]) {
        for host in [format!("127.0.0.1:{port}"), format!("localhost:{port}")] {
            let expected = if target == "/nothing" { 404 } else { 200 };
            assert_eq!(
                ask(target, &format!("Host: {host}\r\n")).status,
                expected,
                "{target} {host}"
            );
        }
        for host in [
            "Host: evil.example\r\n".to_owned(),
            format!("Host: evil.example:{port}\r\n"),
            "Host: 127.0.0.1\r\n".to_owned(),
            format!("Host: 127.0.0.1:{port}\r\nHost: evil.example\r\n"),
            format!("Host: 127.0.0.1:{port}.evil.example\r\n"),
            "Host: \r\n".to_owned(),
            String::new(),
        ] {
            assert_eq!(ask(target, &host).status, 421, "{target} {host}");
        }
    }
    let other = format!("http://evil.example:{port}/api/clips");
    assert_eq!(
        ask(&other, &format!("Host: 127.0.0.1:{port}\r\n")).status,
        421
    );
}

#[test]
fn other_sites_are_not_answered() {
    let server = Server::get();
    let port = server.address.port();
    for header in [
        "Origin: http://evil.example".to_owned(),
        "Origin: null".to_owned(),
        format!("Origin: http://127.0.0.1:{}", port ^ 1),
        format!("Origin: https://127.0.0.1:{port}"),
        "Sec-Fetch-Site: cross-site".to_owned(),
        "Sec-Fetch-Site: same-site".to_owned(),
    ] {
        for target in TARGETS {
            let reply = server.ask("GET", target, &format!("{header}\r\n"));
            assert_eq!(reply.status, 403, "{target} {header}");
            assert!(!reply.text().contains("amc"), "{target} {header}");
        }
    }
    for header in [
        format!("Origin: http://127.0.0.1:{port}"),
        format!("Origin: http://localhost:{port}"),
        "Sec-Fetch-Site: same-origin".to_owned(),
        "Sec-Fetch-Site: none".to_owned(),
    ] {
        assert_eq!(
            server
                .ask("GET", "/api/clips", &format!("{header}\r\n"))
                .status,
            200,
            "{header}"
        );
    }
}

#[test]
fn requests_without_end_are_cut_off() {
    let server = Server::get();
    let long = "x".repeat(100_000);
    // The connection may be cut before the answer is read.
    let refused = [0, 400, 414, 431];
    let target = server.get_path(&format!("/api/clips?text={long}"));
    assert!(refused.contains(&target.status), "{}", target.status);
    let header = server.ask("GET", "/api/clips", &format!("X-Long: {long}\r\n"));
    assert!(refused.contains(&header.status), "{}", header.status);
    let many = "X-Many: 1\r\n".repeat(1000);
    let headers = server.ask("GET", "/api/clips", &many);
    assert!(refused.contains(&headers.status), "{}", headers.status);
    let nonsense = server.send("\0\0\0\0\r\n\r\n");
    assert!(refused.contains(&nonsense.status), "{}", nonsense.status);
    assert_eq!(server.get_path("/api/clips").status, 200);
}
