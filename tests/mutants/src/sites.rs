//! Where the changes of a file are in its syntax: which operands an operator has, where a match arm takes its guard.

use std::collections::{HashMap, HashSet};
use std::ops::Range;

use proc_macro2::Span;
use syn::spanned::Spanned;
use syn::visit::{self, Visit};
use syn::{Expr, Member};

use crate::list::Mutant;

/// A stretch of the file, in bytes.
pub type Bytes = Range<usize>;

/// A place of the file with the changes that can be made there.
#[derive(Debug)]
pub struct Site {
    /// What is rewritten; empty where something is only put in.
    pub bytes: Bytes,
    pub kind: Kind,
    /// Numbers of the changes, and what each puts there.
    pub changes: Vec<(u32, String)>,
}

#[derive(Debug)]
pub enum Kind {
    /// The beginning of a function's body.
    Body,
    /// `left operator right`.
    Binary { left: Bytes, operator: String, right: Bytes },
    /// `operator operand`.
    Unary { operator: String, operand: Bytes },
    /// The guard of a match arm; the arm itself may be deleted, too.
    Guard { delete: Option<u32> },
    /// Behind the pattern of a match arm that has no guard.
    Arm,
    /// `name: value` in a struct expression with `..base`.
    Field { name: String, value: Option<Bytes>, base: Bytes },
}

/// A file with the offsets of its lines.
pub struct Text<'a> {
    pub text: &'a str,
    lines: Vec<usize>,
}

impl<'a> Text<'a> {
    pub fn new(text: &'a str) -> Self {
        Self { text, lines: std::iter::once(0).chain(text.match_indices('\n').map(|(at, _)| at + 1)).collect() }
    }

    /// The byte of a line (from 1) and a column (from 0, in characters).
    fn byte(&self, line: usize, column: usize) -> usize {
        let start = self.lines[line - 1];
        self.text[start..].char_indices().nth(column).map_or(self.text.len(), |(at, _)| start + at)
    }

    fn bytes(&self, span: Span) -> Bytes {
        let (start, end) = (span.start(), span.end());
        self.byte(start.line, start.column)..self.byte(end.line, end.column)
    }
}

/// The sites of the changes `wanted` (number and change) in a file. What the syntax has no site for is left out: the
/// values of constants, what stands in macros, and other iterators for `impl Iterator`.
///
/// # Errors
/// When the file is not Rust.
pub fn sites(text: &Text, wanted: &[(u32, &Mutant)]) -> Result<Vec<Site>, syn::Error> {
    let mut finder = Finder { text, at: HashMap::new(), sites: Vec::new() };
    for (number, mutant) in wanted {
        let byte = text.byte(mutant.line, mutant.column - 1);
        let change = (*number, mutant.replacement.clone());
        if mutant.replacement.starts_with("::std::iter::") {
            // `impl Iterator` is one type only: such a function cannot return another iterator early.
        } else if mutant.genre == "FnValue" {
            finder.sites.push(Site { bytes: byte..byte, kind: Kind::Body, changes: vec![change] });
        } else {
            finder.at.entry((byte, mutant.genre.clone())).or_default().push(change);
        }
    }
    finder.visit_file(&syn::parse_file(text.text)?);
    Ok(finder.sites)
}

/// The numbers of the changes that have a site.
pub fn numbers(sites: &[Site]) -> HashSet<u32> {
    let arms = sites.iter().filter_map(|site| if let Kind::Guard { delete } = site.kind { delete } else { None });
    sites.iter().flat_map(|site| &site.changes).map(|change| change.0).chain(arms).collect()
}

struct Finder<'a> {
    text: &'a Text<'a>,
    /// What is to be found: by its first byte and its kind.
    at: HashMap<(usize, String), Vec<(u32, String)>>,
    sites: Vec<Site>,
}

impl Finder<'_> {
    fn take(&mut self, byte: usize, genre: &str) -> Vec<(u32, String)> {
        self.at.remove(&(byte, genre.to_string())).unwrap_or_default()
    }

    fn add(&mut self, bytes: Bytes, kind: Kind, changes: Vec<(u32, String)>) {
        if !changes.is_empty() {
            self.sites.push(Site { bytes, kind, changes });
        }
    }
}

/// Whether an operand of a condition is `let pattern = ..`, which can stand in a chain of `&&` only.
fn has_let(expression: &Expr) -> bool {
    match expression {
        Expr::Let(_) => true,
        Expr::Binary(binary) => has_let(&binary.left) || has_let(&binary.right),
        _ => false,
    }
}

impl<'a> Visit<'a> for Finder<'_> {
    fn visit_expr_binary(&mut self, binary: &'a syn::ExprBinary) {
        let operator = self.text.bytes(binary.op.span());
        let changes = self.take(operator.start, "BinaryOperator");
        if !has_let(&binary.left) && !has_let(&binary.right) {
            let (left, right) = (self.text.bytes(binary.left.span()), self.text.bytes(binary.right.span()));
            let operator = self.text.text[operator].to_string();
            self.add(left.start..right.end, Kind::Binary { left, operator, right }, changes);
        }
        visit::visit_expr_binary(self, binary);
    }

    fn visit_expr_unary(&mut self, unary: &'a syn::ExprUnary) {
        let operator = self.text.bytes(unary.op.span());
        let changes = self.take(operator.start, "UnaryOperator");
        let operand = self.text.bytes(unary.expr.span());
        let bytes = operator.start..operand.end;
        self.add(bytes, Kind::Unary { operator: self.text.text[operator].to_string(), operand }, changes);
        visit::visit_expr_unary(self, unary);
    }

    fn visit_arm(&mut self, arm: &'a syn::Arm) {
        let deleted = self.take(self.text.bytes(arm.span()).start, "MatchArm");
        match &arm.guard {
            None => {
                let end = self.text.bytes(arm.pat.span()).end;
                self.add(end..end, Kind::Arm, deleted);
            }
            Some((_, guard)) if !has_let(guard) => {
                let bytes = self.text.bytes(guard.span());
                let changes = self.take(bytes.start, "MatchArmGuard");
                let delete = deleted.first().map(|change| change.0);
                if delete.is_some() || !changes.is_empty() {
                    self.sites.push(Site { bytes, kind: Kind::Guard { delete }, changes });
                }
            }
            Some(_) => {}
        }
        visit::visit_arm(self, arm);
    }

    fn visit_expr_struct(&mut self, literal: &'a syn::ExprStruct) {
        for field in &literal.fields {
            let bytes = self.text.bytes(field.span());
            let changes = self.take(bytes.start, "StructField");
            if let (Member::Named(name), Some(base)) = (&field.member, &literal.rest) {
                let value = field.colon_token.map(|_| self.text.bytes(field.expr.span()));
                let kind = Kind::Field { name: name.to_string(), value, base: self.text.bytes(base.span()) };
                self.add(bytes, kind, changes);
            }
        }
        visit::visit_expr_struct(self, literal);
    }

    // What is computed when the program is compiled cannot ask the environment.
    fn visit_item_const(&mut self, _: &'a syn::ItemConst) {}
    fn visit_item_static(&mut self, _: &'a syn::ItemStatic) {}
    fn visit_impl_item_const(&mut self, _: &'a syn::ImplItemConst) {}
}
