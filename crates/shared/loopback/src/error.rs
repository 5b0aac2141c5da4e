//! What can go wrong before a page is served.

use std::io;

/// Why nothing is served.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// Another program listens there.
    #[error(
        "port {port}: is taken by another program\n  to do: choose another one with --port, or leave it out for a free one"
    )]
    PortTaken {
        /// The port.
        port: u16,
    },
    /// The port cannot be had for another reason.
    #[error("port {port}: cannot be opened: {why}\n  to do: leave --port out for a free one")]
    Port {
        /// The port.
        port: u16,
        /// The system's reason.
        why: io::Error,
    },
    /// The system gives no random numbers, and without a secret address nothing is served.
    #[error("the system gives no random numbers: {why}\n  to do: look into the system's log")]
    Random {
        /// The system's reason.
        why: String,
    },
    /// The server could not be set up.
    #[error(
        "the server cannot start: {why}\n  to do: close programs that hold many files or connections open"
    )]
    Start {
        /// The system's reason.
        why: io::Error,
    },
}

/// Why a path below a [`Root`](crate::Root) is refused.
#[derive(Debug, thiserror::Error)]
pub enum PathError {
    /// Parts that no file of ours has: `..`, a drive, an empty name.
    #[error("'{path}': is no path below the folder")]
    Malformed {
        /// As it was asked for.
        path: String,
    },
    /// Nothing is there.
    #[error("'{path}': is not there")]
    Missing {
        /// As it was asked for.
        path: String,
    },
    /// A symbolic link leads out of the root.
    #[error("'{path}': leads out of the folder")]
    Outside {
        /// As it was asked for.
        path: String,
    },
    /// The root itself cannot be found.
    #[error("{root}: is no folder\n  to do: correct its name")]
    NoRoot {
        /// The root.
        root: String,
    },
}
