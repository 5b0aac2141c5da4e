//! Outputs that appear whole or not at all: written to a temporary name, renamed when done.

use crate::{Error, Result};
use std::fs::File;
use std::io::{BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// Temporary files of this process, so that an interrupted run can remove them.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Removes every temporary file of this process; for a run that is being interrupted.
#[allow(clippy::disallowed_methods, reason = "this is the room where files end")]
pub fn discard_unfinished() {
    if let Ok(paths) = UNFINISHED.lock() {
        for path in paths.iter() {
            // Nothing can be done about a file that cannot be removed, and its name does not look complete.
            let _ = std::fs::remove_file(path);
        }
    }
}

/// Whether a path means standard input or output.
#[must_use]
pub fn is_standard_stream(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Refuses a name that stands for a folder, a pipe or a device: the finished file would take its place.
fn refuse_special(path: &Path) -> Result<()> {
    match path.exists() && !path.is_file() {
        true => {
            Err(Error::new(path, "exists and is not a file")
                .fix("give another name, or - for standard output"))
        }
        false => Ok(()),
    }
}

/// Refuses a folder that holds something already: what an earlier run left there would mix with what is to come. Side-cars
/// and files are checked alike; a folder that is not there yet is fine.
///
/// # Errors
/// Names the folder.
#[allow(clippy::disallowed_methods, reason = "this is the room where folders are looked at")]
pub fn require_new_folder(folder: &Path) -> Result<()> {
    if !folder.exists() {
        return Ok(());
    }
    let mut entries =
        std::fs::read_dir(folder).map_err(|cause| Error::io(folder, "read the folder", &cause))?;
    match entries.next() {
        None => Ok(()),
        Some(_) => Err(Error::new(folder, "holds files already")
            .fix("name a folder that is not there yet, or remove this one")),
    }
}

/// Removes the files `<name>.<anything>.<ending>` of a folder: what an earlier run left there.
///
/// # Errors
/// If the folder cannot be read or a file not removed.
#[allow(clippy::disallowed_methods, reason = "this is the room where files end")]
pub fn remove_frames(folder: &Path, name: &str, ending: &str) -> Result<()> {
    let fail = |cause: std::io::Error| Error::io(folder, "clear the folder", &cause);
    if !folder.exists() {
        return Ok(());
    }
    for entry in std::fs::read_dir(folder).map_err(fail)? {
        let entry = entry.map_err(fail)?;
        let file = entry.file_name().to_string_lossy().into_owned();
        if file.starts_with(&format!("{name}.")) && file.ends_with(&format!(".{ending}")) {
            std::fs::remove_file(entry.path()).map_err(fail)?;
        }
    }
    Ok(())
}

/// Takes away the artifact of an earlier run, before what it refers to is written over: a run that is killed then leaves
/// nothing that looks complete. Where there is none, nothing is done.
///
/// # Errors
/// If the file cannot be removed.
#[allow(clippy::disallowed_methods, reason = "this is the room where files end")]
pub fn withdraw(path: &Path) -> Result<()> {
    match std::fs::remove_file(path) {
        Err(cause) if cause.kind() != std::io::ErrorKind::NotFound => {
            Err(Error::io(path, "remove the earlier file", &cause))
        }
        _ => Ok(()),
    }
}

/// A file that is being written. It shows under its name only after [`Sink::finish`] and [`Staged::publish`].
pub struct Sink {
    path: PathBuf,
    out: Out,
}

enum Out {
    Stdout(std::io::Stdout),
    File { writer: BufWriter<File>, temporary: Temporary },
}

/// A complete output under its temporary name. Dropped unpublished, it goes.
#[must_use = "an output shows only after `publish`"]
pub struct Staged {
    path: PathBuf,
    temporary: Option<Temporary>,
}

struct Temporary {
    path: PathBuf,
    /// Of a file that can be resumed: what says from which inputs it was being made.
    key: Option<PathBuf>,
}

impl Drop for Temporary {
    #[allow(clippy::disallowed_methods, reason = "this is the room where files end")]
    fn drop(&mut self) {
        if self.key.is_some() {
            return;
        }
        let _ = std::fs::remove_file(&self.path);
        if let Ok(mut paths) = UNFINISHED.lock() {
            paths.retain(|path| path != &self.path);
        }
    }
}

fn refuse_pipe(path: &Path) -> Result<()> {
    match is_standard_stream(path) {
        true => Err(Error::new(path, "this format cannot be written to a pipe").fix("name a file")),
        false => Ok(()),
    }
}

fn with_suffix(path: &Path, suffix: &str) -> PathBuf {
    let mut name = path.as_os_str().to_os_string();
    name.push(suffix);
    name.into()
}

impl Sink {
    /// Starts an output; `-` is standard output. Missing folders are made.
    ///
    /// # Errors
    /// If the folder or the temporary file cannot be made.
    #[allow(clippy::disallowed_methods, reason = "this is the room where files begin")]
    pub fn create(path: &Path) -> Result<Self> {
        if is_standard_stream(path) {
            return Ok(Self { path: path.to_path_buf(), out: Out::Stdout(std::io::stdout()) });
        }
        let Some(name) = path.file_name() else {
            return Err(Error::new(path, "is not a file name").fix("name a file to write"));
        };
        refuse_special(path)?;
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        std::fs::create_dir_all(folder).map_err(|cause| Error::io(folder, "make the folder", &cause))?;
        let temporary = folder.join(format!(".{}.{}.part", name.to_string_lossy(), std::process::id()));
        if let Ok(mut paths) = UNFINISHED.lock() {
            paths.push(temporary.clone());
        }
        let temporary = Temporary { path: temporary, key: None };
        let file = File::create(&temporary.path).map_err(|cause| Error::io(path, "write", &cause))?;
        let writer = BufWriter::with_capacity(1 << 20, file);
        Ok(Self { path: path.to_path_buf(), out: Out::File { writer, temporary } })
    }

    /// Starts an output that is patched at its end, which a pipe cannot be.
    ///
    /// # Errors
    /// As [`Sink::create`], and on standard output.
    pub fn create_seekable(path: &Path) -> Result<Self> {
        refuse_pipe(path)?;
        Self::create(path)
    }

    /// Starts an output that outlives an interrupted run as `<name>.partial`: a name that says it is not complete. With
    /// `resume`, continues the one that a run with the same `key` left, and says how many bytes are there: none, or a
    /// head and whole blocks.
    ///
    /// # Errors
    /// If the file cannot be read or written.
    #[allow(clippy::disallowed_methods, reason = "this is the room where files begin")]
    pub fn resumable(path: &Path, key: &str, resume: bool, head: u64, block: u64) -> Result<(Self, u64)> {
        refuse_pipe(path)?;
        refuse_special(path)?;
        let fail = |cause: std::io::Error| Error::io(path, "write", &cause);
        let partial = with_suffix(path, ".partial");
        let key_path = with_suffix(path, ".partial.key");
        let same = resume && std::fs::read_to_string(&key_path).is_ok_and(|left| left == key);
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).map_err(fail)?;
        }
        let mut file =
            File::options().create(true).write(true).truncate(!same).open(&partial).map_err(fail)?;
        std::fs::write(&key_path, key).map_err(fail)?;
        let size = file.metadata().map_err(fail)?.len();
        let kept = if size < head { 0 } else { head + (size - head) / block * block };
        file.set_len(kept).map_err(fail)?;
        file.seek(SeekFrom::End(0)).map_err(fail)?;
        let writer = BufWriter::with_capacity(1 << 20, file);
        let temporary = Temporary { path: partial, key: Some(key_path) };
        Ok((Self { path: path.to_path_buf(), out: Out::File { writer, temporary } }, kept))
    }

    /// The name that the output will have.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Turns a failed write into an error that names the file.
    #[must_use]
    pub fn failed(&self, cause: &std::io::Error) -> Error {
        Error::io(&self.path, "write", cause)
    }

    /// Overwrites bytes at the start of the file, for formats that count in their header.
    ///
    /// # Errors
    /// If writing fails, or on standard output, which cannot go back.
    pub fn patch(&mut self, offset: u64, bytes: &[u8]) -> Result<()> {
        let path = self.path.clone();
        let Out::File { writer, .. } = &mut self.out else {
            return refuse_pipe(&path);
        };
        let mut patch = || {
            writer.flush()?;
            let file = writer.get_mut();
            file.seek(SeekFrom::Start(offset))?;
            file.write_all(bytes)?;
            file.seek(SeekFrom::End(0)).map(|_| ())
        };
        patch().map_err(|cause| Error::io(&path, "write", &cause))
    }

    /// Writes out what is buffered and makes it durable.
    ///
    /// # Errors
    /// If the disk is full or the write fails for another reason.
    pub fn finish(self) -> Result<Staged> {
        let path = self.path;
        let fail = |cause: std::io::Error| Error::io(&path, "write", &cause);
        let temporary = match self.out {
            Out::Stdout(mut stdout) => {
                stdout.flush().map_err(fail)?;
                None
            }
            Out::File { mut writer, temporary } => {
                writer.flush().map_err(fail)?;
                writer.get_ref().sync_data().map_err(fail)?;
                Some(temporary)
            }
        };
        Ok(Staged { path, temporary })
    }
}

impl Write for Sink {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        match &mut self.out {
            Out::Stdout(stdout) => stdout.write(bytes),
            Out::File { writer, .. } => writer.write(bytes),
        }
    }

    fn flush(&mut self) -> std::io::Result<()> {
        match &mut self.out {
            Out::Stdout(stdout) => stdout.flush(),
            Out::File { writer, .. } => writer.flush(),
        }
    }
}

impl Staged {
    /// The name and the temporary name of an output that another library writes by itself, into a file of its own at
    /// [`Staged::temporary`]; that name keeps the ending, by which such libraries choose the format. Missing folders are
    /// made.
    ///
    /// # Errors
    /// If the name will not do, or the folder cannot be made.
    #[allow(clippy::disallowed_methods, reason = "this is the room where files begin")]
    pub fn reserve(path: &Path) -> Result<Self> {
        refuse_pipe(path)?;
        refuse_special(path)?;
        let (Some(stem), Some(ending)) = (path.file_stem(), path.extension()) else {
            return Err(
                Error::new(path, "has no ending that tells its format").fix("name a file like m1.avi")
            );
        };
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        std::fs::create_dir_all(folder).map_err(|cause| Error::io(folder, "make the folder", &cause))?;
        let (stem, ending) = (stem.to_string_lossy(), ending.to_string_lossy());
        let temporary = folder.join(format!(".{stem}.{}.part.{ending}", std::process::id()));
        if let Ok(mut paths) = UNFINISHED.lock() {
            paths.push(temporary.clone());
        }
        let temporary = Some(Temporary { path: temporary, key: None });
        Ok(Self { path: path.to_path_buf(), temporary })
    }

    /// The name that the output will have.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The complete bytes under their temporary name; `None` on standard output.
    #[must_use]
    pub fn temporary(&self) -> Option<&Path> {
        self.temporary.as_ref().map(|temporary| temporary.path.as_path())
    }

    /// Gives the output its name.
    ///
    /// # Errors
    /// If the file cannot be renamed.
    #[allow(clippy::disallowed_methods, reason = "this is the room where files are named")]
    pub fn publish(self) -> Result<()> {
        let Some(temporary) = &self.temporary else { return Ok(()) };
        let fail = |cause: std::io::Error| Error::io(&self.path, "write", &cause);
        std::fs::rename(&temporary.path, &self.path).map_err(fail)?;
        temporary.key.as_ref().map_or(Ok(()), |key| std::fs::remove_file(key).map_err(fail))
    }
}

/// Writes a whole small file at once.
///
/// # Errors
/// If writing fails.
pub fn stage_bytes(path: &Path, bytes: &[u8]) -> Result<Staged> {
    let mut sink = Sink::create(path)?;
    sink.write_all(bytes).map_err(|cause| Error::io(path, "write", &cause))?;
    sink.finish()
}

/// A file under another name without its bytes being written again where the file system can do that (a hard link), else
/// a copy.
///
/// # Errors
/// If the file cannot be read, or the other name not be made.
#[allow(clippy::disallowed_methods, reason = "this is the room where files begin")]
pub fn stage_link(path: &Path, from: &Path) -> Result<Staged> {
    let staged = Staged::reserve(path)?;
    let temporary = staged.temporary().unwrap_or(path);
    // What an earlier process of the same number left there.
    let _ = std::fs::remove_file(temporary);
    if std::fs::hard_link(from, temporary).is_err() {
        std::fs::copy(from, temporary).map_err(|cause| Error::io(from, "copy", &cause))?;
    }
    Ok(staged)
}
