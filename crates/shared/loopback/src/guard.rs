//! Who may ask: only a page of ours, in a browser that calls this machine by a name of its own.

use crate::token::Token;
use crate::{Method, path};
use hyper::header::{HOST, HeaderMap, HeaderName, ORIGIN};
use hyper::{Method as Verb, Uri};

/// Why a request is turned away.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Refusal {
    pub(crate) status: u16,
    pub(crate) why: &'static str,
}

const fn refusal(status: u16, why: &'static str) -> Refusal {
    Refusal { status, why }
}

/// Names of this machine to itself. The port may be another one: that of a tunnel.
const OWN_NAMES: [&str; 3] = ["127.0.0.1", "localhost", "[::1]"];

/// What is asked for, and its path below the token, if it may be.
pub(crate) fn check(
    verb: &Verb,
    uri: &Uri,
    headers: &HeaderMap,
    token: &Token,
) -> Result<(Method, String), Refusal> {
    let host = only(headers, &HOST).filter(|_| uri.authority().is_none());
    let host = host.ok_or(refusal(400, "say one Host, and a path only"))?;
    if !is_own(host) {
        return Err(refusal(403, "this machine is not called that: use the address that was printed"));
    }
    let method = match *verb {
        Verb::GET | Verb::HEAD => Method::Get,
        Verb::PUT => Method::Put,
        Verb::POST => Method::Post,
        _ => return Err(refusal(405, "only GET, HEAD, PUT and POST are understood")),
    };
    check_origin(method, host, headers)?;
    let names = path::names(uri.path()).ok_or(refusal(400, "the path leads nowhere"))?;
    let (first, below) = names.split_first().ok_or(refusal(400, "the path leads nowhere"))?;
    match token.is(first) && !below.is_empty() {
        true => Ok((method, below.join("/"))),
        false => Err(refusal(403, "use the whole address that was printed")),
    }
}

/// A page of another site must change nothing here, and must not use what is here as its own.
fn check_origin(method: Method, host: &str, headers: &HeaderMap) -> Result<(), Refusal> {
    const FOREIGN: Refusal = refusal(403, "another site's page asks");
    let is_own = |origin: &str| origin.strip_prefix("http://") == Some(host);
    match (headers.contains_key(ORIGIN), only(headers, &ORIGIN)) {
        (true, origin) if !origin.is_some_and(is_own) => return Err(FOREIGN),
        (false, _) if method != Method::Get => {
            return Err(refusal(403, "what changes something must say its Origin"));
        }
        _ => {}
    }
    let fetch = |part| only(headers, &HeaderName::from_static(part));
    // Following a link to the page is well; drawing it into another page, or loading a part of it there, is not.
    let is_visit = method == Method::Get
        && fetch("sec-fetch-mode") == Some("navigate")
        && fetch("sec-fetch-dest") == Some("document");
    match fetch("sec-fetch-site") {
        Some("cross-site" | "same-site") if !is_visit => Err(FOREIGN),
        _ => Ok(()),
    }
}

/// The value of a header that stands there exactly once.
fn only<'a>(headers: &'a HeaderMap, name: &HeaderName) -> Option<&'a str> {
    let mut values = headers.get_all(name).iter();
    let value = values.next()?;
    values.next().is_none().then(|| value.to_str().ok())?
}

fn is_own(host: &str) -> bool {
    OWN_NAMES.iter().any(|name| {
        host.strip_prefix(name).is_some_and(|rest| match rest.strip_prefix(':') {
            Some(port) => port.parse::<u16>().is_ok(),
            None => rest.is_empty(),
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_names_of_this_machine_are_its_own() {
        for host in ["127.0.0.1:80", "localhost", "localhost:9", "[::1]:8123"] {
            assert!(is_own(host), "{host}");
        }
        let foreign = [
            "example.org",
            "127.0.0.1.example.org",
            "localhost.example.org:80",
            "127.0.0.1:",
            "127.0.0.1:99999",
            "a@localhost",
            "",
        ];
        for host in foreign {
            assert!(!is_own(host), "{host}");
        }
    }
}
