//! What a page gets.

use bytes::Bytes;
use serde::Serialize;

/// An answer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Response {
    pub(crate) status: u16,
    pub(crate) content_type: &'static str,
    pub(crate) body: Bytes,
}

impl Response {
    /// Bytes of a type, e.g. `image/png`.
    #[must_use]
    pub fn bytes(content_type: &'static str, body: impl Into<Bytes>) -> Self {
        Self { status: 200, content_type, body: body.into() }
    }

    /// A value as JSON; 500 if it has no such form.
    #[must_use]
    pub fn json(value: &impl Serialize) -> Self {
        match serde_json::to_vec(value) {
            Ok(body) => Self::bytes("application/json", body),
            Err(error) => Self::refused(500, &format!("the answer cannot be written: {error}")),
        }
    }

    /// Done, nothing to say.
    #[must_use]
    pub fn done() -> Self {
        Self { status: 204, content_type: "text/plain; charset=utf-8", body: Bytes::new() }
    }

    /// Nothing is there.
    #[must_use]
    pub fn missing() -> Self {
        Self::refused(404, "nothing is here")
    }

    /// A refusal with its reason. `status`: 400 to 599.
    #[must_use]
    pub fn refused(status: u16, why: &str) -> Self {
        let body = Bytes::from(format!("{why}\n"));
        Self { status, content_type: "text/plain; charset=utf-8", body }
    }
}

/// A file that ships with the program.
#[derive(Debug, Clone, Copy)]
pub struct Asset {
    /// Path below the token; `""` is the page itself.
    pub path: &'static str,
    /// Its type.
    pub content_type: &'static str,
    /// What it holds.
    pub bytes: &'static [u8],
}

/// The asset of a path, as an answer; none if there is none.
#[must_use]
pub fn asset(assets: &[Asset], path: &str) -> Option<Response> {
    let found = assets.iter().find(|asset| asset.path == path)?;
    Some(Response::bytes(found.content_type, found.bytes))
}
