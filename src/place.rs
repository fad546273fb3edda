//! Where something stands that a user wrote: a stretch of a file, or an argument of the command line.

use std::{fmt, ops::Range, path::PathBuf, sync::Arc};

use miette::{SourceCode, SourceSpan};

/// A text that was read: a file, or an argument of the command line.
#[derive(Debug)]
pub(crate) struct Origin {
    /// File name or argument, as the user wrote it.
    pub name: String,
    /// What it says.
    pub text: String,
    /// The folder to which its file names are relative.
    pub folder: PathBuf,
    /// True for arguments, which have no line numbers worth naming.
    pub argument: bool,
}

/// A stretch of a file, or an argument of the command line.
#[derive(Debug, Clone)]
pub struct Place {
    pub(crate) origin: Arc<Origin>,
    pub(crate) span: Range<usize>,
}

impl PartialEq for Place {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.origin, &other.origin) && self.span == other.span
    }
}

impl Place {
    /// That of an argument of the command line, as typed.
    pub(crate) fn argument(shown: &str) -> Self {
        let (name, text) = (shown.to_owned(), shown.to_owned());
        Self { origin: Arc::new(Origin { name, text, folder: PathBuf::new(), argument: true }), span: 0..shown.len() }
    }

    /// The line, from 1.
    pub fn line(&self) -> usize {
        let end = self.span.start.min(self.origin.text.len());
        1 + self.origin.text.as_bytes()[..end].iter().filter(|b| **b == b'\n').count()
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.origin.argument {
            write!(f, "{}", self.origin.name)
        } else {
            write!(f, "{}:{}", self.origin.name, self.line())
        }
    }
}

impl SourceCode for Place {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        before: usize,
        after: usize,
    ) -> Result<Box<dyn miette::SpanContents<'a> + 'a>, miette::MietteError> {
        let inner = self.origin.text.read_span(span, before, after)?;
        Ok(Box::new(miette::MietteSpanContents::new_named(
            self.origin.name.clone(),
            inner.data(),
            *inner.span(),
            inner.line(),
            inner.column(),
            inner.line_count(),
        )))
    }
}
