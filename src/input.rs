//! Input files: they are read up to a limit of their size, and what messages show of them is printable and short.
//!
//! Every module that reads a file that a user names reads it here. Knows no format.

mod guard;
mod similar;

use std::{
    borrow::Cow,
    fs::{self, File},
    io::{self, BufRead, Read},
    path::Path,
    sync::atomic::{AtomicBool, Ordering},
};

pub use guard::{guarded, is_decoding};
pub use similar::{did_you_mean, meant, meant_by, meant_by_value};

/// The path that stands for the standard input, in messages as well. Commands have it for the argument `-`.
pub const STDIN: &str = "<stdin>";

const MIB: u64 = 1 << 20;

/// The most bytes of a scenario, a task or a robot's description.
pub const MOST_TOML: u64 = 16 * MIB;

/// The most bytes of a plan, a verdict, a summary of a sweep, a baseline or a file of grasps.
pub const MOST_DOCUMENT: u64 = 64 * MIB;

/// The most bytes of a CSV file that a scenario names.
pub const MOST_CSV: u64 = 64 * MIB;

/// The most bytes of an MCAP file that a scenario names.
pub const MOST_MCAP: u64 = 256 * MIB;

/// The most bytes of a URDF or an SRDF.
pub const MOST_URDF: u64 = 64 * MIB;

/// The most bytes of a mesh.
pub const MOST_MESH: u64 = 256 * MIB;

/// The most bytes of a recording, or of the table of the runs of a sweep.
pub const MOST_RECORDING: u64 = 1024 * MIB;

/// The most bytes of a line of a stream of requests.
pub const MOST_LINE: u64 = MIB;

/// The most characters of a line of a message, and of a value that a message shows.
const MOST_SHOWN_OF_LINE: usize = 2000;
const MOST_SHOWN: usize = 300;

/// The bytes of a file. No more than `most_bytes` and one are read, so that endless files such as `/dev/zero` end, too.
///
/// # Errors
/// If the file cannot be read or is larger.
pub fn bytes(path: &Path, most_bytes: u64) -> io::Result<Vec<u8>> {
    bytes_if(path, most_bytes, 0, |_| Ok(()))
}

/// As [`bytes`], if the first `count` bytes pass a test: a large file of another kind is not read.
///
/// # Errors
/// As for [`bytes`], and the error of the test.
pub fn bytes_if<E: From<io::Error>>(
    path: &Path,
    most_bytes: u64,
    count: u64,
    test: impl FnOnce(&[u8]) -> Result<(), E>,
) -> Result<Vec<u8>, E> {
    let file = File::open(path).map_err(|error| similar::of_opening(path, error))?;
    let metadata = file.metadata()?;
    let length = metadata.is_file().then_some(metadata.len());
    rest_of(file, length, (most_bytes, count), test).map(|bytes| read(path, bytes))
}

/// As [`bytes`], of a file that an argument names: [`STDIN`] is the standard input. A file that another file names is never that.
///
/// # Errors
/// As for [`bytes`], and if the standard input was read before.
pub fn argument(path: &Path, most_bytes: u64) -> io::Result<Vec<u8>> {
    if path != Path::new(STDIN) {
        return bytes(path, most_bytes);
    }
    rest_of::<io::Error>(standard_input()?, None, (most_bytes, 0), |_| Ok(())).map(|bytes| read(path, bytes))
}

/// The bytes of a file that this program keeps for itself, such as a journal. Anything may have its name: what is no file, such as a
/// pipe that nobody writes to, is not opened.
///
/// # Errors
/// As for [`bytes`], and if it is no file.
pub fn kept(path: &Path, most_bytes: u64) -> io::Result<Vec<u8>> {
    match fs::metadata(path)?.is_file() {
        true => bytes(path, most_bytes),
        false => Err(io::Error::new(io::ErrorKind::InvalidInput, "found no file, expected one")),
    }
}

/// The bytes that were read from a file, and an event that says so.
fn read(path: &Path, bytes: Vec<u8>) -> Vec<u8> {
    tracing::info!(file = %path.display(), bytes = bytes.len(), "read");
    bytes
}

/// The standard input, which can be read once.
fn standard_input() -> io::Result<io::Stdin> {
    static IS_READ: AtomicBool = AtomicBool::new(false);
    match IS_READ.swap(true, Ordering::SeqCst) {
        true => Err(io::Error::other("found `-` twice, expected it once: the standard input can be read once")),
        false => Ok(io::stdin()),
    }
}

/// The bytes of a stream of this length, if it is known, after a test of the first `count` ones.
fn rest_of<E: From<io::Error>>(
    stream: impl Read,
    length: Option<u64>,
    (most_bytes, count): (u64, u64),
    test: impl FnOnce(&[u8]) -> Result<(), E>,
) -> Result<Vec<u8>, E> {
    let mut file = stream.take(most_bytes + 1);
    let mut bytes = Vec::new();
    if count > 0 {
        file.by_ref().take(count).read_to_end(&mut bytes)?;
        test(&bytes)?;
    }
    if let Some(length) = length.filter(|length| *length > most_bytes) {
        return Err(too_large(&format!("{:.1} MiB", length as f64 / MIB as f64), most_bytes).into());
    }
    file.read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most_bytes {
        return Err(too_large("more", most_bytes).into());
    }
    Ok(bytes)
}

/// The text of a file.
///
/// # Errors
/// As for [`bytes`], and if the file is not text in UTF-8.
pub fn text(path: &Path, most_bytes: u64) -> io::Result<String> {
    text_of(bytes(path, most_bytes)?)
}

/// Bytes as text.
///
/// # Errors
/// If they are not UTF-8 or have a NUL, which no format of text has.
pub fn text_of(bytes: Vec<u8>) -> io::Result<String> {
    let line_of = |bytes: &[u8]| 1 + bytes.iter().filter(|&&byte| byte == b'\n').count();
    let wrong = |found: &str, before: &[u8]| {
        let problem = format!("found {found} in line {}, expected text in UTF-8", line_of(before));
        io::Error::new(io::ErrorKind::InvalidData, problem)
    };
    if let Some(place) = bytes.iter().position(|&byte| byte == 0) {
        return Err(wrong("a NUL byte", &bytes[..place]));
    }
    String::from_utf8(bytes).map_err(|error| {
        let place = error.utf8_error().valid_up_to();
        let byte = error.as_bytes()[place];
        wrong(&format!("the byte 0x{byte:02x}"), &error.as_bytes()[..place])
    })
}

/// The next line of a stream, without its end; `None` at the end of the stream.
///
/// # Errors
/// If the stream cannot be read, the line is longer than `most_bytes`, or is not UTF-8.
pub fn line(stream: &mut impl BufRead, most_bytes: u64) -> io::Result<Option<String>> {
    let mut line = Vec::new();
    // Two bytes more: those of the end of the line.
    stream.take(most_bytes + 2).read_until(b'\n', &mut line)?;
    if line.is_empty() {
        return Ok(None);
    }
    if line.pop_if(|last| *last == b'\n').is_some() {
        line.pop_if(|last| *last == b'\r');
    }
    if line.len() as u64 > most_bytes {
        return Err(too_large("more in a line", most_bytes));
    }
    text_of(line).map(Some)
}

fn too_large(found: &str, most_bytes: u64) -> io::Error {
    let problem = format!("found {found}, expected at most {} MiB", most_bytes / MIB);
    io::Error::new(io::ErrorKind::FileTooLarge, problem)
}

/// A value for a message: in one line, control characters as `\u001b`, and of a long one beginning and end.
#[must_use]
pub fn shown(value: &str) -> String {
    cut(&escaped(value, &[]), MOST_SHOWN)
}

/// A text for a message: in one line, with control characters as `\u001b`. Of a very long one beginning and end.
#[must_use]
pub fn one_line(text: &str) -> String {
    cut(&escaped(text, &[]), MOST_SHOWN_OF_LINE)
}

/// Text for a terminal: control characters but ends of lines and tabs as `\u001b`, so that it neither moves the cursor nor changes
/// colours. In a string of JSON this is the same character.
#[must_use]
pub fn printable(text: &str) -> Cow<'_, str> {
    escaped(text, &['\n', '\t'])
}

/// A message for a terminal: [`printable`], and of a long line beginning and end.
#[must_use]
pub fn message(text: &str) -> String {
    let lines: Vec<_> = text.split('\n').map(|line| cut(&printable(line), MOST_SHOWN_OF_LINE)).collect();
    lines.join("\n")
}

fn escaped<'a>(text: &'a str, kept: &[char]) -> Cow<'a, str> {
    let is_escaped = |c: char| acts_on_terminal(c) && !kept.contains(&c);
    if !text.contains(is_escaped) {
        return Cow::Borrowed(text);
    }
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        if is_escaped(c) {
            escaped.push_str(&format!("\\u{:04x}", u32::from(c)));
        } else {
            escaped.push(c);
        }
    }
    Cow::Owned(escaped)
}

/// True for control characters, and for those that end a line or change the direction of what follows.
fn acts_on_terminal(c: char) -> bool {
    c.is_control() || matches!(c, '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// Beginning and end of a text that is longer than `most` characters, and how much is left out.
fn cut(text: &str, most: usize) -> String {
    let length = text.chars().count();
    if length <= most {
        return text.to_owned();
    }
    let tail = most / 3;
    let head = most - tail;
    let place = |number: usize| text.char_indices().nth(number).map_or(text.len(), |(place, _)| place);
    let left_out = length - head - tail;
    format!("{} [... {left_out} characters ...] {}", &text[..place(head)], &text[place(length - tail)..])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_read_up_to_its_limit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        std::fs::write(&path, "12345").unwrap();
        assert_eq!(bytes(&path, 5).unwrap(), b"12345");
        let error = bytes(&path, 4).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::FileTooLarge);
        std::fs::File::create(&path).unwrap().set_len(3 * MIB).unwrap();
        let error = bytes(&path, 2 * MIB).unwrap_err().to_string();
        assert_eq!(error, "found 3.0 MiB, expected at most 2 MiB");
    }

    #[test]
    #[cfg(unix)]
    fn an_endless_file_is_refused() {
        let error = text(Path::new("/dev/zero"), MIB).unwrap_err().to_string();
        assert_eq!(error, "found more, expected at most 1 MiB");
    }

    #[test]
    fn a_test_of_the_first_bytes_comes_before_the_rest() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        std::fs::write(&path, "12345").unwrap();
        let refused = |first: &[u8]| Err::<(), _>(io::Error::other(String::from_utf8_lossy(first).into_owned()));
        assert_eq!(bytes_if(&path, 2, 3, refused).unwrap_err().to_string(), "123");
        assert_eq!(bytes_if(&path, 9, 9, |_| Ok::<_, io::Error>(())).unwrap(), b"12345");
    }

    #[test]
    #[cfg(unix)]
    fn what_is_kept_is_a_file_up_to_its_limit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("kept");
        // Reading it would not end.
        assert!(std::process::Command::new("mkfifo").arg(&path).status().unwrap().success());
        assert_eq!(kept(&path, 9).unwrap_err().to_string(), "found no file, expected one");
        assert!(kept(folder.path(), 9).is_err());
        std::fs::remove_file(&path).unwrap();
        assert_eq!(kept(&path, 9).unwrap_err().kind(), io::ErrorKind::NotFound);
        std::fs::write(&path, "123").unwrap();
        assert_eq!(kept(&path, 3).unwrap(), b"123");
        std::fs::File::create(&path).unwrap().set_len(1 << 40).unwrap();
        assert_eq!(kept(&path, 3).unwrap_err().kind(), io::ErrorKind::FileTooLarge);
    }

    #[test]
    fn what_is_no_text_is_told_with_its_line() {
        let problem = |bytes: &[u8]| text_of(bytes.to_vec()).unwrap_err().to_string();
        assert_eq!(problem(b"a\nb\xff"), "found the byte 0xff in line 2, expected text in UTF-8");
        assert_eq!(problem(b"\n\n\0"), "found a NUL byte in line 3, expected text in UTF-8");
    }

    #[test]
    fn lines_of_a_stream_have_a_limit() {
        let mut stream = io::Cursor::new(b"one\r\n\ntwo".to_vec());
        let mut next = || line(&mut stream, 3).unwrap();
        assert_eq!(
            [next(), next(), next(), next()],
            ["one", "", "two"].map(str::to_owned).map(Some).into_iter().chain([None]).collect::<Vec<_>>()[..]
        );
        let endless = line(&mut io::BufReader::new(io::repeat(b'x')), MIB).unwrap_err();
        assert_eq!(endless.to_string(), "found more in a line, expected at most 1 MiB");
    }

    #[test]
    fn what_acts_on_a_terminal_is_escaped() {
        assert_eq!(shown("a\x1b[31mb\nc\u{9b}\u{202e}"), "a\\u001b[31mb\\u000ac\\u009b\\u202e");
        assert_eq!(printable("a\tb\n\r"), "a\tb\n\\u000d");
        assert_eq!(printable("é \u{1f600}"), "é \u{1f600}");
    }

    #[test]
    fn long_text_is_cut() {
        let long = format!("{}{}", "a".repeat(1000), "é".repeat(1000));
        let cut = shown(&long);
        let (head, tail) = ("a".repeat(200), "é".repeat(100));
        assert_eq!(cut, format!("{head} [... 1700 characters ...] {tail}"));
        assert_eq!(message("short\nlines"), "short\nlines");
        assert!(message(&"x".repeat(10_000)).len() < 2100);
    }
}
