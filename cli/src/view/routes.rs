//! What can be asked, with GET or HEAD.
//!
//! | path | parameters | answer |
//! |---|---|---|
//! | `/` | | the page, with the library, bundles and templates |
//! | `/api/vocabulary` | | features, keywords of scenes, templates |
//! | `/api/clips` | `from`, `n`, `sort` (`name`, `label`, `seconds`), `down`, `label`, `text` | how many there are, and some of them |
//! | `/api/clips/ID` | | a document with the page of the clip |
//! | `/api/clips/ID/motion` | | its positions, see [`Motion`], as bytes; `Range` is honoured; headers `motif-rate`, `-frames`, `-points`, `-origin` |
//! | `/api/search` | `clip`, `start`, `end`, `features`, `mode` (`exact`, `fuzzy`, `adaptive`), `mismatches`, `mirror`, `top` | a document with the page of the hits |
//! | `/api/scene` | `text`, `top` | the same |
//! | `/api/template` | `name`, `tau`, `top` | a document with the pages of the template and of the hits |
//! | `/api/agreement`, `…/scene`, `…/template` | those of the search, and a hit; a hit's `ask` has them | `{agreement}`: a [`Picture`] or null |
//!
//! `ID`, `clip` and `hit` are numbers of clips, frames are those of the source file, end exclusive, lists have commas between
//! their parts, flags are 0 or 1. Answers are JSON but for the page and motions: documents are [`Document`]s, which are added to the
//! page. What is refused is told as `{error}`, with 400 for a question that is none, 404 for what is not there, 409 for a file
//! that is not what was indexed; of a scene also with `line`, `column`, `expected` and `found`.
//!
//! [`Document`]: crate::report::document::Document
//! [`Motion`]: crate::report::document::Motion
//! [`Picture`]: crate::report::document::Picture

use std::sync::Arc;

use axum::Router;
use axum::extract::rejection::QueryRejection;
use axum::extract::{Path, Query, State};
use axum::http::header::{self, HeaderMap, HeaderName, HeaderValue};
use axum::http::{StatusCode, Uri};
use axum::middleware::from_fn_with_state;
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::agreement::{OfExample, OfScene, OfTemplate};
use super::answer::{Refusal, json};
use super::clips::Moving;
use super::guard::{Names, guard};
use super::range::{Wanted, wanted};
use super::vocabulary::Vocabulary;
use super::work::Workers;
use super::{View, clip, list, search, template};

type Answer = Result<Response, Refusal>;

/// The routes, for a server of these names.
pub(super) fn routes(view: Arc<View>, names: Names) -> Router {
    Router::new()
        .route("/", get(page))
        .route("/api/vocabulary", get(vocabulary))
        .route("/api/clips", get(looked_up::<list::Asked>))
        .route("/api/clips/{id}", get(one_clip))
        .route("/api/clips/{id}/motion", get(motion))
        .route("/api/search", get(searched::<search::Example>))
        .route("/api/scene", get(searched::<search::Scene>))
        .route("/api/template", get(searched::<template::Asked>))
        .route("/api/agreement", get(looked_up::<OfExample>))
        .route("/api/agreement/scene", get(looked_up::<OfScene>))
        .route("/api/agreement/template", get(looked_up::<OfTemplate>))
        .fallback(nothing)
        .with_state(view)
        .layer(from_fn_with_state(names, guard))
}

async fn page(State(view): State<Arc<View>>) -> Response {
    let kind = HeaderValue::from_static("text/html; charset=utf-8");
    let headers = [
        (header::CONTENT_TYPE, kind),
        (header::CONTENT_SECURITY_POLICY, view.policy.clone()),
    ];
    (headers, view.page.clone()).into_response()
}

async fn nothing(uri: Uri) -> Refusal {
    Refusal::missing(format!("there is nothing at {}", uri.path()))
}

async fn vocabulary(State(view): State<Arc<View>>) -> Answer {
    json(&Vocabulary::new(&view))
}

/// What a query asks.
pub(super) trait Question: DeserializeOwned + Send + 'static {
    type Answer: Serialize;

    fn answer(&self, view: &View) -> Result<Self::Answer, Refusal>;
}

/// Answers what takes a look at the whole library.
async fn searched<Q: Question>(State(view): State<Arc<View>>, asked: Asked<Q>) -> Answer {
    let asked = question(asked)?;
    let of = Arc::clone(&view);
    work(&view.searchers, move || asked.answer(&of)).await
}

/// Answers what takes a look at single clips.
async fn looked_up<Q: Question>(State(view): State<Arc<View>>, asked: Asked<Q>) -> Answer {
    let asked = question(asked)?;
    let of = Arc::clone(&view);
    work(&view.readers, move || asked.answer(&of)).await
}

async fn one_clip(State(view): State<Arc<View>>, Path(id): Path<String>) -> Answer {
    let id = number(&id)?;
    let of = Arc::clone(&view);
    work(&view.readers, move || clip::answer(&of, id)).await
}

async fn motion(
    State(view): State<Arc<View>>,
    Path(id): Path<String>,
    headers: HeaderMap,
) -> Answer {
    let id = number(&id)?;
    let of = Arc::clone(&view);
    let moving = view.readers.do_work(move || of.clips.moving(id)).await?;
    Ok(part(&moving, &headers))
}

type Asked<T> = Result<Query<T>, QueryRejection>;

fn question<T: DeserializeOwned>(asked: Asked<T>) -> Result<T, Refusal> {
    match asked {
        Ok(Query(asked)) => Ok(asked),
        Err(e) => Err(Refusal::question(e.body_text())),
    }
}

/// A clip's number: digits and nothing else.
fn number(id: &str) -> Result<u32, Refusal> {
    let is_number = id.bytes().all(|byte| byte.is_ascii_digit());
    let number = is_number.then(|| id.parse().ok()).flatten();
    number.ok_or_else(|| Refusal::missing(format!("expected the number of a clip, found {id:?}")))
}

/// Does the work and gives its answer as JSON, which is a part of it.
async fn work<T: Serialize>(
    workers: &Workers,
    answer: impl FnOnce() -> Result<T, Refusal> + Send + 'static,
) -> Answer {
    workers.do_work(move || json(&answer()?)).await
}

/// A motion, or the part of it that is asked for.
fn part(moving: &Moving, asked: &HeaderMap) -> Response {
    let of_whole = || {
        let [x, y, z] = moving.origin;
        [
            ("motif-rate", moving.rate.to_string()),
            ("motif-frames", moving.frames.to_string()),
            ("motif-points", moving.points.to_string()),
            ("motif-origin", format!("{x},{y},{z}")),
            ("content-type", "application/octet-stream".to_owned()),
            ("accept-ranges", "bytes".to_owned()),
            ("etag", tag(moving)),
        ]
        .map(|(name, value)| (HeaderName::from_static(name), value))
    };
    let n_bytes = moving.bytes.len();
    let content_range =
        |range: String| [(header::CONTENT_RANGE, format!("bytes {range}/{n_bytes}"))];
    match wanted_of(moving, asked) {
        Wanted::Whole => (of_whole(), moving.bytes.clone()).into_response(),
        Wanted::Part(range) => {
            let content_range = content_range(format!("{}-{}", range.start, range.end - 1));
            let bytes = moving.bytes.slice(range);
            (
                StatusCode::PARTIAL_CONTENT,
                of_whole(),
                content_range,
                bytes,
            )
                .into_response()
        }
        Wanted::Nothing => {
            let error = format!("expected a part of {n_bytes} bytes");
            let refusal = Refusal::new(StatusCode::RANGE_NOT_SATISFIABLE, error);
            (content_range("*".to_owned()), refusal).into_response()
        }
    }
}

fn wanted_of(moving: &Moving, asked: &HeaderMap) -> Wanted {
    let text = |name| {
        asked
            .get(name)
            .and_then(|value: &HeaderValue| value.to_str().ok())
    };
    // A part of something else is of no use to who has the beginning of this.
    let is_same = text(header::IF_RANGE).is_none_or(|known| known == tag(moving));
    let n_ranges = asked.get_all(header::RANGE).iter().count();
    match text(header::RANGE) {
        Some(range) if is_same && n_ranges == 1 => wanted(range, moving.bytes.len()),
        _ => Wanted::Whole,
    }
}

/// What changes whenever the motion does.
fn tag(moving: &Moving) -> String {
    format!("\"{:016x}-{}\"", moving.content, moving.rate)
}
