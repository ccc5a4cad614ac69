//! Answers and refusals.

use std::fmt;

use axum::body::Bytes;
use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::Serialize;

use crate::failure::Failure;
use crate::scene::{SceneTextError, SceneTextErrorKind};

/// Why something is not answered, as JSON.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Refusal {
    #[serde(skip)]
    status: StatusCode,
    /// What was expected and what was found.
    error: String,
    /// Of the text that was asked, 1-based.
    #[serde(skip_serializing_if = "Option::is_none")]
    line: Option<usize>,
    /// 1-based.
    #[serde(skip_serializing_if = "Option::is_none")]
    column: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    expected: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    found: Option<String>,
}

impl Refusal {
    pub(super) fn new(status: StatusCode, error: impl Into<String>) -> Refusal {
        Refusal {
            status,
            error: error.into(),
            line: None,
            column: None,
            expected: None,
            found: None,
        }
    }

    /// That the question is none.
    pub(super) fn question(error: impl Into<String>) -> Refusal {
        Refusal::new(StatusCode::BAD_REQUEST, error)
    }

    /// That there is no such thing.
    pub(super) fn missing(error: impl Into<String>) -> Refusal {
        Refusal::new(StatusCode::NOT_FOUND, error)
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(&self.error)
    }
}

impl From<Failure> for Refusal {
    fn from(failure: Failure) -> Refusal {
        let status = match failure {
            Failure::Usage(_) => StatusCode::BAD_REQUEST,
            Failure::Input { .. } | Failure::Io { .. } | Failure::Closed => {
                StatusCode::INTERNAL_SERVER_ERROR
            }
        };
        Refusal::new(status, failure.to_string())
    }
}

impl Refusal {
    /// Why `text` is no scene. The column counts as browsers do, in units of UTF-16.
    pub(super) fn of_scene(error: &SceneTextError, text: &str) -> Refusal {
        let (expected, found) = expected_and_found(&error.kind);
        let before = text.get(..error.at.byte()).unwrap_or(text);
        let line = before.rsplit(['\n', '\r']).next().unwrap_or_default();
        Refusal {
            line: error.at.line(),
            column: Some(line.encode_utf16().count() + 1),
            expected,
            found,
            ..Refusal::question(error.kind.to_string())
        }
    }
}

/// What a scene should have there and what it has, where that is a word each.
fn expected_and_found(kind: &SceneTextErrorKind) -> (Option<String>, Option<String>) {
    match kind {
        SceneTextErrorKind::Expected { expected, found } => {
            (Some((*expected).to_owned()), Some(found.clone()))
        }
        SceneTextErrorKind::UnknownFeature { found, nearest, .. }
        | SceneTextErrorKind::UnknownLine { found, nearest } => {
            (Some(nearest.clone()), Some(found.clone()))
        }
        SceneTextErrorKind::ManyFeatures { found, .. } => {
            (Some("one feature".to_owned()), Some(found.clone()))
        }
        SceneTextErrorKind::Position {
            n_positions, found, ..
        } => (
            Some(format!("a position from 1 to {n_positions}")),
            Some(found.clone()),
        ),
        SceneTextErrorKind::Twice { name, .. } => {
            (Some("another name".to_owned()), Some(name.clone()))
        }
        SceneTextErrorKind::Wildcard | SceneTextErrorKind::Unspecified => {
            (Some("0 or 1".to_owned()), Some("*".to_owned()))
        }
        SceneTextErrorKind::NoLines | SceneTextErrorKind::Never { .. } => (None, None),
    }
}

impl IntoResponse for Refusal {
    fn into_response(self) -> Response {
        match json(&self) {
            Ok(body) => (self.status, body).into_response(),
            // There is nothing in it that JSON could not say.
            Err(_) => self.status.into_response(),
        }
    }
}

/// An answer as JSON.
pub(super) fn json<T: Serialize>(answer: &T) -> Result<Response, Refusal> {
    let bytes = serde_json::to_vec(answer)
        .map_err(|e| Refusal::new(StatusCode::INTERNAL_SERVER_ERROR, e.to_string()))?;
    let kind = (
        header::CONTENT_TYPE,
        HeaderValue::from_static("application/json"),
    );
    Ok(([kind], Bytes::from(bytes)).into_response())
}
