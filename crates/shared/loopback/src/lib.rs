//! Serves a stage's pages to a browser on the same machine, and to nobody else.
//!
//! Purpose: a stage that needs a person's eyes and hands shows them a page. The page can read and write what the stage lets it; so
//! nothing else may ask for it: no other machine, no other user who does not know the address, no page of another site in the same
//! browser.
//!
//! - Only 127.0.0.1 is listened on. The address holds a random token as the first name of its path: a browser adds it to no request by
//!   itself, as it would a cookie.
//! - `Host` must be a name of this machine (an outer name that is made to point here is refused), `Origin` and `Sec-Fetch-Site` must
//!   be our own page's wherever something is changed. Any port will do in them, so that SSH tunnels work.
//! - Paths are taken apart before they are decoded, and each name is checked ([`Root`] confines them to a folder, symbolic links
//!   included). Bodies have a limit, slow clients a time.
//! - Every answer carries a content security policy without inline code; see [`Server`] for who answers.
//!
//! ```
//! use loopback::{Limits, Request, Response, Server};
//! let server = Server::bind(0, Limits::default())?;
//! let (url, stopper) = (server.url(), server.stopper());
//! assert!(url.starts_with("http://127.0.0.1:"));
//! stopper.stop();
//! server.run(|request: &Request| match request.path.as_str() {
//!     "" => Response::bytes("text/html; charset=utf-8", "<!doctype html><title>here</title>"),
//!     "api/answer" => Response::json(&42),
//!     _ => Response::missing(),
//! })?;
//! # Ok::<(), loopback::Error>(())
//! ```

mod error;
mod guard;
mod open;
mod path;
mod request;
mod response;
mod root;
mod server;
mod token;

pub use error::{Error, PathError};
pub use open::open_in_browser;
pub use request::{Method, Request};
pub use response::{Asset, Response, asset};
pub use root::Root;
pub use server::{Limits, Server, Site, Stopper};
