//! What a page asks for.

use crate::Response;
use bytes::Bytes;
use serde::de::DeserializeOwned;

/// What is to be done; `HEAD` comes as [`Method::Get`], and its answer loses its body on the way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Read.
    Get,
    /// Write a file.
    Put,
    /// Ask for work.
    Post,
}

/// A request that came with the token, from this machine and from our own page.
#[derive(Debug, Clone)]
pub struct Request {
    /// What is to be done.
    pub method: Method,
    /// Decoded path below the token, without a slash in front: names that hold no `..`, `/` in between; `""` is the page.
    pub path: String,
    /// What follows the `?`, as it came.
    pub query: Option<String>,
    /// Type of the body, in lower case and without its parameters.
    pub content_type: Option<String>,
    /// The body, whole.
    pub body: Bytes,
}

impl Request {
    /// The body as JSON.
    ///
    /// # Errors
    /// The answer to give: 415 if the body does not say that it is JSON, 400 if it is not what is wanted.
    pub fn json<T: DeserializeOwned>(&self) -> Result<T, Response> {
        if self.content_type.as_deref() != Some("application/json") {
            return Err(Response::refused(415, "the body must be application/json"));
        }
        serde_json::from_slice(&self.body)
            .map_err(|error| Response::refused(400, &format!("the body is not what is wanted: {error}")))
    }
}
