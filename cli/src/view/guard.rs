//! Who may ask, and what a browser may do with the answer.
//!
//! A page of any site can send requests to this machine, and by a name of its own that leads here (DNS rebinding) it
//! could read the answers. So the `Host` has to be ours, and whoever says where a request comes from has to say from here.

use axum::extract::{Request, State};
use axum::http::header::{self, HeaderMap, HeaderName, HeaderValue};
use axum::http::{Method, StatusCode};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

use super::answer::Refusal;

/// What the address of the server is called.
#[derive(Clone, Debug)]
pub(super) struct Names {
    /// `127.0.0.1:PORT` and `localhost:PORT`.
    hosts: Vec<String>,
}

const FETCH_SITE: HeaderName = HeaderName::from_static("sec-fetch-site");

/// The port that browsers leave out.
const HTTP_PORT: u16 = 80;

impl Names {
    pub(super) fn new(port: u16) -> Names {
        let names = ["127.0.0.1", "localhost"];
        let mut hosts: Vec<String> = names.iter().map(|name| format!("{name}:{port}")).collect();
        if port == HTTP_PORT {
            hosts.extend(names.map(str::to_owned));
        }
        Names { hosts }
    }

    fn is_host(&self, host: &str) -> bool {
        self.hosts
            .iter()
            .any(|ours| ours.eq_ignore_ascii_case(host))
    }

    fn check(&self, request: &Request) -> Result<(), Refusal> {
        let headers = request.headers();
        let host = only(headers, &header::HOST).flatten();
        let of_target = request
            .uri()
            .authority()
            .map(|authority| authority.as_str());
        if !host.is_some_and(|host| self.is_host(host))
            || !of_target.is_none_or(|host| self.is_host(host))
        {
            let expected = self.hosts.join(" or ");
            let error = format!("expected the Host {expected}, found another");
            return Err(Refusal::new(StatusCode::MISDIRECTED_REQUEST, error));
        }
        let is_ours = |origin: Option<&str>| {
            origin
                .and_then(|origin| origin.strip_prefix("http://"))
                .is_some_and(|host| self.is_host(host))
        };
        let is_here = |site: Option<&str>| matches!(site, Some("same-origin" | "none"));
        if !only(headers, &header::ORIGIN).is_none_or(is_ours)
            || !only(headers, &FETCH_SITE).is_none_or(is_here)
        {
            let error = "expected a request of this page, found one of another";
            return Err(Refusal::new(StatusCode::FORBIDDEN, error));
        }
        if !matches!(*request.method(), Method::GET | Method::HEAD) {
            let error = format!("expected GET or HEAD, found {}", request.method());
            return Err(Refusal::new(StatusCode::METHOD_NOT_ALLOWED, error));
        }
        Ok(())
    }
}

/// The value of a header, if it is there; `Some(None)` if there are several, or it is no text.
#[expect(
    clippy::option_option,
    reason = "absent and unreadable are not the same"
)]
fn only<'h>(headers: &'h HeaderMap, name: &HeaderName) -> Option<Option<&'h str>> {
    let mut values = headers.get_all(name).iter();
    let first = values.next()?;
    Some(match values.next() {
        None => first.to_str().ok(),
        Some(_) => None,
    })
}

/// Lets through who may ask, and adds to each answer what holds for all of them.
pub(super) async fn guard(State(names): State<Names>, request: Request, next: Next) -> Response {
    let mut response = match names.check(&request) {
        Ok(()) => next.run(request).await,
        Err(refusal) => refusal.into_response(),
    };
    let is_refused = response.status() == StatusCode::METHOD_NOT_ALLOWED;
    let headers = response.headers_mut();
    if is_refused {
        headers.insert(header::ALLOW, HeaderValue::from_static("GET, HEAD"));
    }
    for (name, value) in [
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::REFERRER_POLICY, "no-referrer"),
        (header::CACHE_CONTROL, "no-store"),
        (
            HeaderName::from_static("cross-origin-resource-policy"),
            "same-origin",
        ),
        (
            HeaderName::from_static("cross-origin-opener-policy"),
            "same-origin",
        ),
    ] {
        headers.insert(name, HeaderValue::from_static(value));
    }
    // The page has one of its own.
    let policy = headers.entry(header::CONTENT_SECURITY_POLICY);
    policy.or_insert(HeaderValue::from_static(NOTHING));
    response
}

/// For answers that are no page.
const NOTHING: &str = "default-src 'none'; frame-ancestors 'none'; sandbox";

#[cfg(test)]
mod tests {
    use axum::body::Body;

    use super::*;

    fn status(headers: &[(&str, &str)]) -> Option<StatusCode> {
        let mut request = Request::builder().method("GET").uri("/");
        for (name, value) in headers {
            request = request.header(*name, *value);
        }
        let request = request.body(Body::empty()).unwrap();
        let refusal = Names::new(8080).check(&request).err()?;
        Some(refusal.into_response().status())
    }

    #[test]
    fn a_host_is_ours_or_refused() {
        for host in ["127.0.0.1:8080", "localhost:8080", "LocalHost:8080"] {
            assert_eq!(status(&[("host", host)]), None, "{host}");
        }
        for host in [
            "",
            "127.0.0.1",
            "localhost",
            "127.0.0.1:8081",
            "evil.example:8080",
            "127.0.0.1:8080.evil.example",
            "127.0.0.1:8080@evil.example",
            "localhost.:8080",
            "[::1]:8080",
            "0.0.0.0:8080",
            "127.1:8080",
        ] {
            let found = status(&[("host", host)]);
            assert_eq!(found, Some(StatusCode::MISDIRECTED_REQUEST), "{host}");
        }
        let none = status(&[]);
        assert_eq!(none, Some(StatusCode::MISDIRECTED_REQUEST));
        let two = status(&[("host", "127.0.0.1:8080"), ("host", "evil.example")]);
        assert_eq!(two, Some(StatusCode::MISDIRECTED_REQUEST));
    }

    #[test]
    fn port_80_is_left_out_by_browsers() {
        assert!(Names::new(80).is_host("localhost"));
        assert!(Names::new(80).is_host("127.0.0.1:80"));
        assert!(!Names::new(80).is_host("localhost:8080"));
    }

    #[test]
    fn an_origin_is_ours_or_refused() {
        let of = |origin| status(&[("host", "127.0.0.1:8080"), ("origin", origin)]);
        for origin in ["http://127.0.0.1:8080", "http://localhost:8080"] {
            assert_eq!(of(origin), None, "{origin}");
        }
        for origin in [
            "null",
            "",
            "http://evil.example",
            "https://127.0.0.1:8080",
            "http://127.0.0.1",
            "http://127.0.0.1:8081",
            "http://127.0.0.1:8080/",
            "http://127.0.0.1:8080.evil.example",
            "file://",
        ] {
            assert_eq!(of(origin), Some(StatusCode::FORBIDDEN), "{origin}");
        }
    }

    #[test]
    fn other_sites_are_refused() {
        let of = |site| status(&[("host", "127.0.0.1:8080"), ("sec-fetch-site", site)]);
        assert_eq!(of("same-origin"), None);
        assert_eq!(of("none"), None);
        for site in ["cross-site", "same-site", "", "same-origin, cross-site"] {
            assert_eq!(of(site), Some(StatusCode::FORBIDDEN), "{site}");
        }
    }
}
