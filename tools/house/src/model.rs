//! What the rules look at: the workspace, read once, as plain values. Rules touch no disk, so tests plant a fault
//! in a value and see the rule find it.

use crate::rust_text::RustText;
use std::fmt;

/// Where a crate stands in the house.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Floor {
    /// Floors 1 to 5, bottom to top.
    Level(u8),
    /// What serves tests only.
    Wing,
    /// What serves the house itself.
    Tool,
}

/// The floor of the stages.
pub(crate) const STAGES: Floor = Floor::Level(4);

impl Floor {
    /// Reads what `[package.metadata.furrow]` says.
    pub(crate) fn parse(value: &serde_json::Value) -> Option<Self> {
        match (value.as_u64(), value.as_str()) {
            (Some(level @ 1..=5), _) => u8::try_from(level).ok().map(Self::Level),
            (_, Some("wing")) => Some(Self::Wing),
            (_, Some("tool")) => Some(Self::Tool),
            _ => None,
        }
    }

    /// The highest floor whose crates may be used from here.
    pub(crate) fn reach(self) -> u8 {
        match self {
            Self::Level(level) => level - 1,
            Self::Wing => 2,
            Self::Tool => 3,
        }
    }
}

impl fmt::Display for Floor {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Level(level) => write!(out, "floor {level}"),
            Self::Wing => write!(out, "the wing"),
            Self::Tool => write!(out, "the tools"),
        }
    }
}

/// How one crate uses another.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Dependency {
    pub(crate) name: String,
    /// Only tests use it.
    pub(crate) dev: bool,
}

/// What a stage says about the artifacts it handles.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Flow {
    pub(crate) reads: Vec<String>,
    pub(crate) writes: Vec<String>,
    /// Same kind in and out.
    pub(crate) edits: Vec<String>,
    /// A later artifact, used in a second pass.
    pub(crate) feedback: Vec<String>,
    /// Makes what others measure; may produce any kind.
    pub(crate) source: bool,
}

/// A crate of the workspace.
#[derive(Debug, Clone)]
pub(crate) struct Crate {
    pub(crate) name: String,
    /// Its folder, relative to the root, with `/`.
    pub(crate) folder: String,
    pub(crate) description: String,
    pub(crate) floor: Option<Floor>,
    pub(crate) paper: String,
    pub(crate) flow: Flow,
    pub(crate) dependencies: Vec<Dependency>,
    /// Whether it inherits the workspace's lints.
    pub(crate) lints: bool,
}

impl Crate {
    pub(crate) fn is_stage(&self) -> bool {
        self.floor == Some(STAGES)
    }
}

/// A text file of the repository.
#[derive(Debug, Clone)]
pub(crate) struct SourceFile {
    /// Relative to the root, with `/`.
    pub(crate) path: String,
    pub(crate) text: String,
    /// Code and comments apart, if it is Rust.
    pub(crate) rust: Option<RustText>,
}

impl SourceFile {
    pub(crate) fn new(path: impl Into<String>, text: impl Into<String>) -> Self {
        let (path, text) = (path.into(), text.into());
        let rust = path.ends_with(".rs").then(|| RustText::of(&text));
        Self { path, text, rust }
    }
}

/// The whole house.
#[derive(Debug, Clone, Default)]
pub(crate) struct House {
    pub(crate) crates: Vec<Crate>,
    /// Kinds that come from outside.
    pub(crate) sources: Vec<String>,
    /// Every path that git knows or would take, relative to the root.
    pub(crate) paths: Vec<String>,
    /// The texts among them.
    pub(crate) files: Vec<SourceFile>,
}

impl House {
    pub(crate) fn stages(&self) -> impl Iterator<Item = &Crate> {
        self.crates.iter().filter(|one| one.is_stage())
    }

    pub(crate) fn find(&self, name: &str) -> Option<&Crate> {
        self.crates.iter().find(|one| one.name == name)
    }

    /// The text of a file, if there is one.
    pub(crate) fn text(&self, path: &str) -> Option<&str> {
        self.files.iter().find(|file| file.path == path).map(|file| file.text.as_str())
    }

    pub(crate) fn has(&self, path: &str) -> bool {
        self.paths.iter().any(|other| other == path)
    }
}

/// Whether a finding fails the check.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Weight {
    Warning,
    Fault,
}

/// One thing that a rule found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Finding {
    pub(crate) weight: Weight,
    /// A crate, or a file with a line.
    pub(crate) place: String,
    /// What is wrong, and what to do where that is not plain.
    pub(crate) message: String,
}

impl Finding {
    pub(crate) fn fault(place: impl Into<String>, message: impl Into<String>) -> Self {
        Self { weight: Weight::Fault, place: place.into(), message: message.into() }
    }

    pub(crate) fn warning(place: impl Into<String>, message: impl Into<String>) -> Self {
        Self { weight: Weight::Warning, place: place.into(), message: message.into() }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let weight = match self.weight {
            Weight::Warning => "warning",
            Weight::Fault => "fault",
        };
        write!(out, "{weight}: {}: {}", self.place, self.message)
    }
}
