//! The server: HTTP/1.1 on the loopback address.

use crate::guard::{self, Refusal};
use crate::token::Token;
use crate::{Error, Method, Request, Response};
use bytes::{Bytes, BytesMut};
use http_body_util::{BodyExt, Full};
use hyper::body::{Body, Incoming};
use hyper::header::{ALLOW, CONNECTION, CONTENT_TYPE, HeaderValue};
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::server::graceful::GracefulShutdown;
use std::convert::Infallible;
use std::io::ErrorKind;
use std::net::{Ipv4Addr, TcpListener};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{Semaphore, watch};

/// What clients may ask of the server.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Limits {
    /// Longest body, bytes.
    pub body: u64,
    /// Time for the head of a request, and between two parts of its body.
    pub patience: Duration,
    /// Connections at once; more wait.
    pub connections: usize,
}

impl Default for Limits {
    /// 64 MiB hold what a person paints or edits; browsers open six connections.
    fn default() -> Self {
        Self { body: 64 << 20, patience: Duration::from_secs(15), connections: 64 }
    }
}

/// What is served. Answers are asked for on threads of their own, several at once.
pub trait Site: Send + Sync + 'static {
    /// The answer to a request.
    fn answer(&self, request: &Request) -> Response;
}

impl<F: Fn(&Request) -> Response + Send + Sync + 'static> Site for F {
    fn answer(&self, request: &Request) -> Response {
        self(request)
    }
}

/// A server that listens, and answers as soon as it runs.
pub struct Server {
    listener: TcpListener,
    port: u16,
    token: Token,
    limits: Limits,
    stop: watch::Sender<bool>,
}

/// Stops a server from elsewhere.
#[derive(Clone)]
pub struct Stopper(watch::Sender<bool>);

impl Stopper {
    /// Lets the server answer what it was asked, and end.
    pub fn stop(&self) {
        self.0.send_replace(true);
    }
}

/// How long open answers may take once the server stops.
const FAREWELL: Duration = Duration::from_secs(2);

impl Server {
    /// A server on a port of 127.0.0.1 (0: a free one), under a new random address.
    ///
    /// # Errors
    /// [`Error`] if the port is taken, or the system gives no random numbers.
    pub fn bind(port: u16, limits: Limits) -> Result<Self, Error> {
        let refused = |why: std::io::Error| match why.kind() {
            ErrorKind::AddrInUse => Error::PortTaken { port },
            _ => Error::Port { port, why },
        };
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(refused)?;
        let found = listener.local_addr().map_err(|why| Error::Port { port, why })?.port();
        Ok(Self { listener, port: found, token: Token::random()?, limits, stop: watch::Sender::new(false) })
    }

    /// The address of the page, with the token.
    #[must_use]
    pub fn url(&self) -> String {
        format!("http://127.0.0.1:{}/{}/", self.port, self.token.text())
    }

    /// What stops it.
    #[must_use]
    pub fn stopper(&self) -> Stopper {
        Stopper(self.stop.clone())
    }

    /// Serves until it is stopped.
    ///
    /// # Errors
    /// [`Error::Start`] if the system refuses what a server needs.
    pub fn run(self, site: impl Site) -> Result<(), Error> {
        let start = |why| Error::Start { why };
        self.listener.set_nonblocking(true).map_err(start)?;
        let runtime =
            tokio::runtime::Builder::new_current_thread().enable_io().enable_time().build().map_err(start)?;
        let room = Room { site: Arc::new(site), token: self.token, limits: self.limits };
        let outcome = runtime.block_on(serve(self.listener, Arc::new(room), self.stop.subscribe()));
        // A site that still works on an answer nobody waits for does not hold the program up.
        runtime.shutdown_background();
        outcome.map_err(start)
    }
}

/// What answers need.
struct Room {
    site: Arc<dyn Site>,
    token: Token,
    limits: Limits,
}

async fn serve(
    listener: TcpListener,
    room: Arc<Room>,
    mut stop: watch::Receiver<bool>,
) -> std::io::Result<()> {
    let listener = tokio::net::TcpListener::from_std(listener)?;
    let seats = Arc::new(Semaphore::new(room.limits.connections));
    let open = GracefulShutdown::new();
    loop {
        let accepted = async {
            let seat = Arc::clone(&seats).acquire_owned().await;
            (listener.accept().await, seat)
        };
        let (stream, seat) = tokio::select! {
            (stream, seat) = accepted => (stream, seat),
            _ = stop.wait_for(|stopped| *stopped) => break,
        };
        let Ok((stream, _)) = stream else {
            // Out of file handles, or the client is gone already: the next one may be luckier.
            tokio::time::sleep(Duration::from_millis(20)).await;
            continue;
        };
        let own = Arc::clone(&room);
        let service = service_fn(move |request| {
            let room = Arc::clone(&own);
            async move { Ok::<_, Infallible>(room.answer(request).await) }
        });
        let mut http = http1::Builder::new();
        http.timer(TokioTimer::new()).header_read_timeout(room.limits.patience).max_buf_size(64 << 10);
        let connection = open.watch(http.serve_connection(TokioIo::new(stream), service));
        tokio::spawn(async move {
            // A client that breaks off is its own affair.
            let _ = connection.await;
            drop(seat);
        });
    }
    let _ = tokio::time::timeout(FAREWELL, open.shutdown()).await;
    Ok(())
}

type Answer = hyper::Response<Full<Bytes>>;

impl Room {
    async fn answer(&self, request: hyper::Request<Incoming>) -> Answer {
        match self.admitted(request).await {
            Ok(request) => {
                let site = Arc::clone(&self.site);
                let answer = tokio::task::spawn_blocking(move || site.answer(&request)).await;
                written(
                    answer.unwrap_or_else(|_| Response::refused(500, "the program failed over this")),
                    false,
                )
            }
            // What is left of a body that was refused is not waited for.
            Err(Refusal { status, why }) => written(Response::refused(status, why), true),
        }
    }

    async fn admitted(&self, request: hyper::Request<Incoming>) -> Result<Request, Refusal> {
        let (head, body) = request.into_parts();
        let (method, path) = guard::check(&head.method, &head.uri, &head.headers, &self.token)?;
        let kind = head.headers.get(CONTENT_TYPE).and_then(|kind| kind.to_str().ok());
        let content_type =
            kind.and_then(|kind| kind.split(';').next()).map(|kind| kind.trim().to_ascii_lowercase());
        let body = match method {
            Method::Get if !body.is_end_stream() => {
                return Err(Refusal { status: 400, why: "what is read has no body" });
            }
            Method::Get => Bytes::new(),
            _ => self.whole(body).await?,
        };
        Ok(Request { method, path, query: head.uri.query().map(str::to_string), content_type, body })
    }

    /// A body, as far as it is no longer than allowed; one that says it is too long is not read at all.
    async fn whole(&self, mut body: Incoming) -> Result<Bytes, Refusal> {
        const LONG: Refusal = Refusal { status: 413, why: "the body is too long" };
        const SLOW: Refusal = Refusal { status: 408, why: "the body did not come in time" };
        const BROKEN: Refusal = Refusal { status: 400, why: "the body broke off" };
        if body.size_hint().lower() > self.limits.body {
            return Err(LONG);
        }
        let mut whole = BytesMut::new();
        while let Some(part) =
            tokio::time::timeout(self.limits.patience, body.frame()).await.map_err(|_| SLOW)?
        {
            let Ok(part) = part.map_err(|_| BROKEN)?.into_data() else { continue };
            if (whole.len() + part.len()) as u64 > self.limits.body {
                return Err(LONG);
            }
            whole.extend_from_slice(&part);
        }
        Ok(whole.freeze())
    }
}

/// On every answer: scripts, styles and data from here only, no other page around it, nothing kept, no address told on.
const HEADERS: [(&str, &str); 6] = [
    (
        "content-security-policy",
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; connect-src 'self'; font-src 'self'; \
         base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    ),
    ("x-content-type-options", "nosniff"),
    ("referrer-policy", "no-referrer"),
    ("cross-origin-opener-policy", "same-origin"),
    ("cross-origin-resource-policy", "same-origin"),
    ("cache-control", "no-store"),
];

fn written(response: Response, close: bool) -> Answer {
    let mut answer = Answer::new(Full::new(response.body));
    *answer.status_mut() =
        hyper::StatusCode::from_u16(response.status).unwrap_or(hyper::StatusCode::INTERNAL_SERVER_ERROR);
    let headers = answer.headers_mut();
    headers.insert(CONTENT_TYPE, HeaderValue::from_static(response.content_type));
    for (name, value) in HEADERS {
        headers.insert(name, HeaderValue::from_static(value));
    }
    if response.status == 405 {
        headers.insert(ALLOW, HeaderValue::from_static("GET, HEAD, PUT, POST"));
    }
    if close {
        headers.insert(CONNECTION, HeaderValue::from_static("close"));
    }
    answer
}
