//! From text to statements and formulas (language.md 1-4).

pub mod arguments;
mod compile;
pub mod diagnostic;
pub mod formula;
pub mod function;
pub mod history;
pub mod parse;
mod program;
#[cfg(test)]
mod properties;
pub mod scope;
pub mod source;
pub mod suggest;
pub mod syntax;
mod tape;
pub mod text;
pub mod token;
