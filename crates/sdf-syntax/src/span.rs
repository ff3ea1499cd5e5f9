//! Where something stands in the source: a file and a range of bytes.

use std::sync::OnceLock;

/// A file of one compilation: an index into [`Sources`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
pub struct FileId(pub u16);

/// A range of bytes in one file. `start <= end`; both lie on character boundaries of a valid file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
pub struct Span {
    /// The file.
    pub file: FileId,
    /// The first byte.
    pub start: u32,
    /// The byte after the last.
    pub end: u32,
}

impl Span {
    /// The span of the bytes `start..end`; a reversed range becomes empty.
    pub fn new(file: FileId, start: usize, end: usize) -> Span {
        let start = start.min(u32::MAX as usize) as u32;
        let end = end.min(u32::MAX as usize) as u32;
        Span { file, start, end: end.max(start) }
    }

    /// The smallest span that holds both. Both must lie in the same file; else the first is returned.
    pub fn to(self, other: Span) -> Span {
        if self.file != other.file {
            return self;
        }
        Span { file: self.file, start: self.start.min(other.start), end: self.end.max(other.end) }
    }
}

/// One file: the name that messages show, and its text.
#[derive(Debug, Clone)]
pub struct Source {
    /// The name as the user gave it, or `<name>` for a file of the library.
    pub name: String,
    /// The text, without a byte order mark.
    pub text: String,
}

/// All files of one compilation.
#[derive(Debug, Clone, Default)]
pub struct Sources {
    files: Vec<Source>,
    /// Where the lines of each file begin, once that was asked.
    lines: Vec<OnceLock<Vec<u32>>>,
}

impl Sources {
    /// Adds a file.
    pub fn add(&mut self, name: impl Into<String>, text: impl Into<String>) -> FileId {
        self.lines.push(OnceLock::new());
        self.files.push(Source { name: name.into(), text: text.into() });
        FileId((self.files.len() - 1) as u16)
    }

    /// The number that the next file will get.
    pub fn next(&self) -> FileId {
        FileId(self.files.len() as u16)
    }

    /// The file, or `None` where `id` belongs to another compilation.
    pub fn get(&self, id: FileId) -> Option<&Source> {
        self.files.get(id.0 as usize)
    }

    /// Where the lines of a file begin.
    fn lines(&self, file: FileId) -> Option<&[u32]> {
        let text = &self.files.get(file.0 as usize)?.text;
        let starts = || {
            let ends = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
            std::iter::once(0).chain(ends.map(|(at, _)| at as u32 + 1)).collect()
        };
        Some(self.lines[file.0 as usize].get_or_init(starts))
    }

    /// The line of a byte, from 1.
    pub fn line(&self, file: FileId, byte: u32) -> usize {
        self.lines(file).map_or(1, |starts| starts.partition_point(|start| *start <= byte))
    }

    /// The line and column of a byte, both from 1; the column counts characters.
    pub fn line_column(&self, file: FileId, byte: u32) -> (usize, usize) {
        let text = self.get(file).map_or("", |s| s.text.as_str());
        let mut end = (byte as usize).min(text.len());
        while !text.is_char_boundary(end) {
            end -= 1;
        }
        let line = self.line(file, end as u32);
        let start = self.lines(file).map_or(0, |starts| starts[line - 1] as usize);
        (line, text[start..end].chars().count() + 1)
    }
}

/// A span as the parser makes it; the file is its context.
impl chumsky::span::Span for Span {
    type Context = FileId;
    type Offset = u32;

    fn new(file: FileId, range: std::ops::Range<u32>) -> Span {
        Span { file, start: range.start, end: range.end.max(range.start) }
    }

    fn context(&self) -> FileId {
        self.file
    }

    fn start(&self) -> u32 {
        self.start
    }

    fn end(&self) -> u32 {
        self.end
    }
}
