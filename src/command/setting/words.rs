//! The words of `method(...)` and what hangs on each of them.

use super::argument;
use crate::script::source::Span;
use crate::script::syntax::Argument;
use crate::shape::corners::DOMAINS;
use crate::transfer::{TRANSFERS, TransferKind};

/// Arguments of `method`.
pub(super) struct MethodWords {
    kind: Argument,
    /// The word, and the number of terms of XPIC.
    sub: Vec<Argument>,
    shape: Argument,
    blend: Vec<Argument>,
    options: Vec<Argument>,
}

/// A place and what is wrong there.
pub(super) type Wrong = (Span, String);

impl MethodWords {
    pub(super) fn read(arguments: &[Argument]) -> Option<Self> {
        let mut rest = arguments.iter().cloned().peekable();
        let kind = rest.next()?;
        let mut sub = vec![rest.next()?];
        if sub[0].text == "XPIC" {
            sub.push(rest.next()?);
        }
        let shape = rest.next()?;
        let mut blend = Vec::new();
        if takes_blend(&sub[0].text) {
            let count = if rest.peek().is_some_and(|a| a.text == "time-constant") { 2 } else { 1 };
            blend.extend(rest.by_ref().take(count));
        }
        Some(Self { kind, sub, shape, blend, options: rest.collect() })
    }

    pub(super) fn arguments(self) -> Vec<Argument> {
        let mut list = vec![self.kind];
        list.extend(self.sub);
        list.push(self.shape);
        list.extend(self.blend);
        list.extend(self.options);
        list
    }

    /// Another type; its domain goes when the type has none.
    pub(super) fn set_type(&mut self, value: &str) -> Result<(), Wrong> {
        self.kind.text = value.to_string();
        if !value.ends_with("cpdi") {
            self.options.retain(|option| !is_domain(&option.text));
        }
        Ok(())
    }

    pub(super) fn set_shape(&mut self, value: &str) -> Result<(), Wrong> {
        let side = if self.kind.text.starts_with("tl") { "tl" } else { "ul" };
        let domains = is_domain(value);
        self.options.retain(|option| !is_domain(&option.text));
        if domains {
            self.options.push(argument(value, self.shape.span));
        }
        if domains || self.kind.text.ends_with("cpdi") {
            let other = if domains { "cpdi" } else { "mpm" };
            self.kind.text = format!("{side}{other}");
        }
        self.shape.text = if domains { "linear".to_string() } else { value.to_string() };
        Ok(())
    }

    /// `WORD[:more[:more]]`.
    pub(super) fn set_transfer(&mut self, value: &str) -> Result<(), Wrong> {
        let span = self.sub[0].span;
        let mut words = value.split(':').map(str::trim).peekable();
        let word = words.next().unwrap_or("");
        let mut sub = vec![argument(word, span)];
        if word == "XPIC" {
            match (words.next(), self.sub.get(1)) {
                (Some(terms), _) => sub.push(argument(terms, span)),
                (None, Some(terms)) => sub.push(terms.clone()),
                (None, None) => {
                    return Err((span, "write the terms of XPIC: `XPIC:3`".to_string()));
                }
            }
        }
        self.sub = sub;
        let number = |word: Option<&&str>| word.is_some_and(|word| word.parse::<f64>().is_ok());
        if !takes_blend(word) {
            self.blend.clear();
        } else if words.peek() == Some(&"time-constant") {
            self.blend = words.by_ref().take(2).map(|word| argument(word, span)).collect();
        } else if number(words.peek()) {
            self.blend = words.by_ref().take(1).map(|word| argument(word, span)).collect();
        } else if self.blend.is_empty() {
            self.blend = vec![argument("1", span)];
        }
        self.options.extend(words.map(|word| argument(word, span)));
        Ok(())
    }

    pub(super) fn set_alpha(&mut self, value: &str) -> Result<(), Wrong> {
        if !takes_blend(&self.sub[0].text) {
            return Err((self.sub[0].span, format!("{} has no blend alpha", self.sub[0].text)));
        }
        let span = self.blend.first().map_or(self.shape.span, |old| old.span);
        self.blend = vec![argument(value, span)];
        Ok(())
    }
}

fn takes_blend(word: &str) -> bool {
    let row = TRANSFERS.iter().find(|row| row.name == word);
    row.and_then(|row| row.build).is_some_and(TransferKind::takes_blend)
}

fn is_domain(word: &str) -> bool {
    DOMAINS.iter().any(|row| row.name == word)
}
