//! Expressions: text to operations in postfix order (operands before their operator).
//!
//! Precedence climbing (Pratt) over the table of language.md 2. The result is flat, so that long
//! expressions cost no stack, and nesting has a limit.

use super::diagnostic::{Code, Diagnostic};
use super::formula::GroupFunction;
use super::function::{self, Action, FUNCTIONS, Function, Operator, SIGN_LEVEL};
use super::source::Span;
use super::suggest;
use super::token::{self, Symbol, Token};

/// Parentheses, signs and powers nest at most so deep.
const DEEPEST: usize = 150;

/// One operation on the values before it.
#[derive(Clone, Debug)]
pub enum Node {
    /// A literal.
    Number(f64),
    /// A variable, a result or a protected name.
    Name(String),
    /// `-a`
    Negate,
    /// `!a`
    Not,
    /// Between the last two values.
    Operator(Operator),
    /// Of the last value.
    One(&'static Function, fn(f64) -> f64),
    /// Of the last two values.
    Two(&'static Function, fn(f64, f64) -> f64),
    /// `if` of the last three values.
    If,
    /// The last value, frozen.
    Value,
    /// A sum or mean over a group.
    Group {
        /// Which.
        function: GroupFunction,
        /// The group's name.
        group: String,
        /// 0, 1, 2 for x, y, z.
        axis: usize,
    },
}

/// A node and its place in the script.
#[derive(Clone, Debug)]
pub struct Placed {
    /// What to do.
    pub node: Node,
    /// The word or operator that says so.
    pub span: Span,
}

/// Parses an expression whose first byte is byte `base` of the script.
///
/// # Errors
/// The first mistake of form, at its own place.
pub fn parse(text: &str, base: usize) -> Result<Vec<Placed>, Diagnostic> {
    let current = token::token(text, 0);
    let mut parser = Parser { text, base, current, nodes: Vec::new(), depth: 0 };
    parser.expression(0)?;
    match parser.current.symbol {
        Symbol::End => Ok(parser.nodes),
        Symbol::Close => Err(parser.unexpected("this parenthesis was never opened")),
        _ => Err(parser.unexpected("cannot stand here")),
    }
}

struct Parser<'a> {
    text: &'a str,
    base: usize,
    current: Token,
    nodes: Vec<Placed>,
    depth: usize,
}

impl Parser<'_> {
    fn advance(&mut self) -> Token {
        let token = self.current;
        self.current = token::token(self.text, token.end);
        token
    }

    fn word(&self, token: Token) -> &str {
        &self.text[token.start..token.end]
    }

    fn span(&self, token: Token) -> Span {
        Span::new(self.base + token.start, self.base + token.end)
    }

    fn push(&mut self, node: Node, token: Token) {
        let span = self.span(token);
        self.nodes.push(Placed { node, span });
    }

    fn error(&self, code: Code, message: impl Into<String>) -> Diagnostic {
        Diagnostic::error(code, self.span(self.current), message)
    }

    fn unexpected(&self, label: &str) -> Diagnostic {
        let word = self.word(self.current);
        let error = self.error(Code::UnexpectedText, format!("unexpected `{word}`")).label(label);
        match word {
            "=" => error.help("a comparison is written `==`"),
            "&" | "|" => error.help(format!("logic is written `{word}{word}`")),
            "\"" => error.help("only words are quoted, not expressions"),
            _ => error,
        }
    }

    /// Operators of at least `weakest` binding strength: twice their level, plus one on the right of
    /// a left-associative one.
    fn expression(&mut self, weakest: u8) -> Result<(), Diagnostic> {
        if self.depth == DEEPEST {
            return Err(self
                .error(Code::TooDeep, format!("the expression is nested more than {DEEPEST} deep"))
                .help("give a part of it a name"));
        }
        self.depth += 1;
        self.operand()?;
        let mut compared = None;
        while let Some(operator) = self.operator()? {
            let level = operator.level();
            if 2 * level < weakest {
                break;
            }
            if operator.compares() && compared == Some(level) {
                return Err(self
                    .error(Code::ComparisonChain, "comparisons cannot be chained")
                    .label("a second comparison")
                    .help("write `a < b && b < c`, or use parentheses"));
            }
            compared = Some(level);
            let token = self.advance();
            self.expression(if operator == Operator::Power { 2 * level } else { 2 * level + 1 })?;
            self.push(Node::Operator(operator), token);
        }
        self.depth -= 1;
        Ok(())
    }

    /// The operator that follows an operand; none at the end of the expression.
    fn operator(&self) -> Result<Option<Operator>, Diagnostic> {
        match self.current.symbol {
            Symbol::Operator(operator) => Ok(Some(operator)),
            Symbol::Number(_) | Symbol::Identifier | Symbol::Open | Symbol::Malformed(_) => {
                Err(self
                    .error(
                        Code::MissingOperator,
                        format!("an operator is missing before `{}`", self.word(self.current)),
                    )
                    .label("expected an operator")
                    .help("a product is written `2*PI`"))
            }
            Symbol::Not | Symbol::Quoted | Symbol::Unexpected => {
                Err(self.unexpected("expected an operator"))
            }
            Symbol::Close | Symbol::Comma | Symbol::End => Ok(None),
        }
    }

    fn operand(&mut self) -> Result<(), Diagnostic> {
        match self.current.symbol {
            Symbol::Number(number) if number.is_finite() => {
                let token = self.advance();
                self.push(Node::Number(number), token);
            }
            Symbol::Number(_) => {
                return Err(self
                    .error(Code::NotFinite, "the number is too large")
                    .label("above 1.8e308"));
            }
            Symbol::Malformed(length) => return Err(self.malformed(length)),
            Symbol::Identifier => self.name()?,
            Symbol::Operator(Operator::Add) => {
                self.advance();
                self.expression(2 * SIGN_LEVEL)?;
            }
            Symbol::Operator(Operator::Subtract) => {
                let token = self.advance();
                self.expression(2 * SIGN_LEVEL)?;
                self.push(Node::Negate, token);
            }
            Symbol::Not => {
                let token = self.advance();
                self.expression(2 * SIGN_LEVEL)?;
                self.push(Node::Not, token);
            }
            Symbol::Open => {
                let open = self.advance();
                self.expression(0)?;
                self.close(open)?;
            }
            _ => return Err(self.missing_operand()),
        }
        Ok(())
    }

    fn missing_operand(&self) -> Diagnostic {
        match self.current.symbol {
            Symbol::Quoted => self.unexpected("expected a number or a name"),
            Symbol::Unexpected => self.unexpected("expected a number or a name"),
            Symbol::End => self
                .error(Code::MissingExpression, "the expression is not complete")
                .label("expected a number or a name here"),
            _ => {
                let word = self.word(self.current);
                self.error(Code::MissingExpression, format!("something is missing before `{word}`"))
                    .label("expected a number or a name")
            }
        }
    }

    fn malformed(&self, length: usize) -> Diagnostic {
        let word = self.word(self.current);
        let (number, rest) = word.split_at(length);
        if !rest.starts_with('.')
            && token::identifier(rest) == rest.len()
            && !matches!(rest, "e" | "E")
        {
            let span = self.span(Token { start: self.current.start + length, ..self.current });
            return Diagnostic::error(
                Code::MissingOperator,
                span,
                format!("an operator is missing before `{rest}`"),
            )
            .label("expected an operator")
            .help(format!("a product is written `{number}*{rest}`"));
        }
        self.error(Code::BadNumber, format!("`{word}` is not a number"))
            .label("not a number")
            .help("numbers look like `3`, `.5`, `1.`, `1e3`, `1.e-3`")
    }

    fn close(&mut self, open: Token) -> Result<(), Diagnostic> {
        match self.current.symbol {
            Symbol::Close => {
                self.advance();
                Ok(())
            }
            Symbol::Comma => Err(self.unexpected("expected `)`")),
            _ => Err(missing_parenthesis(self.span(open))),
        }
    }

    fn name(&mut self) -> Result<(), Diagnostic> {
        let name = self.advance();
        if self.current.symbol != Symbol::Open {
            let node = Node::Name(self.word(name).to_string());
            self.push(node, name);
            return Ok(());
        }
        let Some(function) = function::find(self.word(name)) else {
            let word = self.word(name);
            let names = FUNCTIONS.iter().map(|function| function.name);
            return Err(Diagnostic::error(
                Code::UnknownName,
                self.span(name),
                format!("unknown function `{word}`"),
            )
            .label("not a function")
            .help(suggest::help(word, names, "a product is written `a*(b)`")));
        };
        let open = self.current;
        match function.action {
            Action::Group(group) => self.group_call(group, function),
            _ => {
                self.advance();
                self.call(function, name, open)
            }
        }
    }

    fn call(
        &mut self,
        function: &'static Function,
        name: Token,
        open: Token,
    ) -> Result<(), Diagnostic> {
        let mut count = 0;
        if self.current.symbol != Symbol::Close {
            loop {
                self.expression(0)?;
                count += 1;
                if let (Action::Fold(action), true) = (function.action, count > 1) {
                    self.push(Node::Two(function, action), name);
                }
                if self.current.symbol != Symbol::Comma {
                    break;
                }
                self.advance();
            }
        }
        self.close(open)?;
        let (fits, node) = match function.action {
            Action::One(action) => (count == 1, Some(Node::One(function, action))),
            Action::Two(action) => (count == 2, Some(Node::Two(function, action))),
            Action::If => (count == 3, Some(Node::If)),
            Action::Value => (count == 1, Some(Node::Value)),
            Action::Fold(_) | Action::Group(_) => (count >= 2, None),
        };
        if !fits {
            let message = format!("wrong number of arguments of `{}`: {count}", function.name);
            return Err(Diagnostic::error(Code::Arity, self.span(name), message)
                .label(format!("{count} given"))
                .help(format!("usage: {}", function.usage)));
        }
        if let Some(node) = node {
            self.push(node, name);
        }
        Ok(())
    }

    /// `xcm(work-piece, x)`: the group is a word, so it is not read as an expression.
    fn group_call(
        &mut self,
        function: GroupFunction,
        row: &'static Function,
    ) -> Result<(), Diagnostic> {
        let open = self.current;
        let usage = format!("usage: {}", row.usage);
        let start = open.end + token::space(&self.text[open.end..]);
        let end = start + token::word(&self.text[start..]);
        let group = self.text[start..end].trim_matches('"').to_string();
        if group.is_empty() {
            self.advance();
            return Err(self
                .error(Code::Arity, format!("`{}` needs a group", row.name))
                .label("expected a group")
                .help(usage));
        }
        self.current = token::token(self.text, end);
        if self.current.symbol != Symbol::Comma {
            return Err(self
                .error(Code::Arity, format!("`{}` needs a group and an axis", row.name))
                .label("expected `,`")
                .help(usage));
        }
        self.advance();
        let axis = match self.word(self.current) {
            "x" => 0,
            "y" => 1,
            "z" => 2,
            _ => {
                return Err(self
                    .error(Code::Type, "expected an axis: `x`, `y` or `z`")
                    .label("not an axis")
                    .help(usage));
            }
        };
        self.advance();
        self.close(open)?;
        let span = Span::new(self.base + start, self.base + end);
        self.nodes.push(Placed { node: Node::Group { function, group, axis }, span });
        Ok(())
    }
}

/// The mistake of a parenthesis that is never closed.
pub fn missing_parenthesis(open: Span) -> Diagnostic {
    Diagnostic::error(Code::MissingParenthesis, open, "a parenthesis is not closed")
        .label("opened here")
        .help("a closing `)` is missing")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The postfix form in one line.
    fn form(text: &str) -> String {
        let nodes = parse(text, 0).unwrap_or_else(|error| panic!("{text}: {}", error.message));
        let words: Vec<String> = nodes
            .iter()
            .map(|placed| match &placed.node {
                Node::Number(number) => number.to_string(),
                Node::Name(name) => name.clone(),
                Node::Negate => "neg".to_string(),
                Node::Not => "!".to_string(),
                Node::Operator(operator) => operator.text().to_string(),
                Node::One(function, _) | Node::Two(function, _) => function.name.to_string(),
                Node::If => "if".to_string(),
                Node::Value => "value".to_string(),
                Node::Group { group, axis, .. } => format!("{group}.{axis}"),
            })
            .collect();
        words.join(" ")
    }

    #[test]
    fn precedence_and_associativity() {
        let cases = [
            ("2^3^2", "2 3 2 ^ ^"),
            ("-x^2", "x 2 ^ neg"),
            ("2^-1*3", "2 1 neg ^ 3 *"),
            ("2^-3^2", "2 3 2 ^ neg ^"),
            ("a*-(b+c)", "a b c + neg *"),
            ("a-b-c", "a b - c -"),
            ("a/b*c", "a b / c *"),
            ("a+b*c", "a b c * +"),
            ("-a*b", "a neg b *"),
            ("!a==b", "a ! b =="),
            ("a<b==c>d", "a b < c d > =="),
            ("a||b&&c", "a b c && ||"),
            ("a==1&&!b", "a 1 == b ! &&"),
            ("2**3", "2 3 ^"),
            ("+a", "a"),
            ("--a", "a neg neg"),
        ];
        for (text, expected) in cases {
            assert_eq!(form(text), expected, "{text}");
        }
    }

    #[test]
    fn calls_nest_and_take_groups_by_word() {
        assert_eq!(form("max(1, min(a, b), 3)"), "1 a b min max 3 max");
        assert_eq!(form("if(a<b, x, hypot(x, y))"), "a b < x x y hypot if");
        assert_eq!(form("value(xcm(work-piece , z))"), "work-piece.2 value");
        assert_eq!(form("internal_force(\"a b\",x)+1"), "a b.0 1 +");
        assert_eq!(form("exp + 1"), "exp 1 +");
    }

    #[test]
    fn mistakes_have_code_and_place() {
        let cases = [
            ("1 2", Code::MissingOperator, 2, 3),
            ("2 PI", Code::MissingOperator, 2, 4),
            ("2PI", Code::MissingOperator, 1, 3),
            ("x y", Code::MissingOperator, 2, 3),
            ("(1)(2)", Code::MissingOperator, 3, 4),
            ("1.2.3", Code::BadNumber, 0, 5),
            ("1e+x", Code::BadNumber, 0, 2),
            ("a<b<c", Code::ComparisonChain, 3, 4),
            ("a==b==c", Code::ComparisonChain, 4, 6),
            ("1+", Code::MissingExpression, 2, 2),
            ("", Code::MissingExpression, 0, 0),
            ("()", Code::MissingExpression, 1, 2),
            ("max(1,,2)", Code::MissingExpression, 6, 7),
            ("max(1,2,)", Code::MissingExpression, 8, 9),
            ("*2", Code::MissingExpression, 0, 1),
            ("(1+2", Code::MissingParenthesis, 0, 1),
            ("1)", Code::UnexpectedText, 1, 2),
            ("1,2", Code::UnexpectedText, 1, 2),
            ("(1,2)", Code::UnexpectedText, 2, 3),
            ("a = b", Code::UnexpectedText, 2, 3),
            ("a & b", Code::UnexpectedText, 2, 3),
            ("a !b", Code::UnexpectedText, 2, 3),
            ("\"a\"", Code::UnexpectedText, 0, 3),
            ("1e999", Code::NotFinite, 0, 5),
            ("sine(x)", Code::UnknownName, 0, 4),
            ("hypot(1)", Code::Arity, 0, 5),
            ("min(1)", Code::Arity, 0, 3),
            ("exp()", Code::Arity, 0, 3),
            ("if(1,2)", Code::Arity, 0, 2),
            ("xcm(g)", Code::Arity, 5, 6),
            ("xcm()", Code::Arity, 4, 5),
            ("xcm(g, w)", Code::Type, 7, 8),
        ];
        for (text, code, start, end) in cases {
            let error = parse(text, 100).expect_err(text);
            assert_eq!(
                (error.code, error.span),
                (code, Span::new(100 + start, 100 + end)),
                "{text}"
            );
        }
    }

    #[test]
    fn nesting_has_a_limit_and_length_has_none() {
        for piece in ["(", "-", "2^", "!", "exp(", "value(", "if(1,2,", "max(1,"] {
            assert_eq!(parse(&piece.repeat(100_000), 0).expect_err(piece).code, Code::TooDeep);
        }
        let long = "1+".repeat(100_000) + "1";
        assert_eq!(parse(&long, 0).expect("long, but flat").len(), 200_001);
    }
}
