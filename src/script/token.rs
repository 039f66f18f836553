//! Tokens: the smallest parts of a script and of an expression.
//!
//! A script is cut twice. [`piece`] cuts statements into arguments, where only white space,
//! comments, quotes, commas and parentheses count; [`token`] cuts an argument that its reader
//! takes as an expression. So `eos-strength` is a word or a subtraction, as its reader wants.

use super::function::Operator;
use nom::branch::alt;
use nom::bytes::complete::{tag, take_while, take_while1};
use nom::character::complete::{anychar, char, digit0, digit1, one_of, satisfy};
use nom::combinator::{map, opt, success, value};
use nom::error::Error;
use nom::{IResult, Parser};

/// Part of a statement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Piece {
    /// Blanks, tabs, carriage returns.
    Blank,
    /// The end of a line.
    NewLine,
    /// `#` and the rest of its line.
    Comment,
    /// Text in double quotes, both quotes included.
    Quoted,
    /// A double quote that is not closed on its line, with the rest of the line.
    OpenQuote,
    /// `(`
    Open,
    /// `)`
    Close,
    /// `,`
    Comma,
    /// Any run of other characters.
    Word,
}

/// Is it white space within a line?
pub fn is_blank(character: char) -> bool {
    matches!(character, ' ' | '\t' | '\r')
}

fn is_word(character: char) -> bool {
    !is_blank(character) && !matches!(character, '\n' | ',' | '(' | ')' | '"' | '#')
}

fn starts_identifier(character: char) -> bool {
    character == '_' || character.is_alphabetic()
}

fn continues_identifier(character: char) -> bool {
    character == '_' || character.is_alphanumeric()
}

fn line_rest(input: &str) -> IResult<&str, &str> {
    take_while(|character| character != '\n').parse(input)
}

fn any_piece(input: &str) -> IResult<&str, Piece> {
    let inside = take_while(|character| character != '"' && character != '\n');
    alt((
        value(Piece::Blank, take_while1(is_blank)),
        value(Piece::NewLine, char('\n')),
        value(Piece::Comment, (char('#'), line_rest)),
        value(Piece::Quoted, (char('"'), inside, char('"'))),
        value(Piece::OpenQuote, (char('"'), line_rest)),
        value(Piece::Open, char('(')),
        value(Piece::Close, char(')')),
        value(Piece::Comma, char(',')),
        value(Piece::Word, take_while1(is_word)),
    ))
    .parse(input)
}

/// The piece at the start of `input` and its length in bytes; `None` at the end.
pub fn piece(input: &str) -> Option<(Piece, usize)> {
    any_piece(input).ok().map(|(rest, piece)| (piece, input.len() - rest.len()))
}

/// Length in bytes of the word at the start of `input`, quotes and all; 0 if there is none.
pub fn word(input: &str) -> usize {
    match piece(input) {
        Some((Piece::Word | Piece::Quoted, length)) => length,
        _ => 0,
    }
}

/// Gives the text that a parser consumes. `recognize` of nom 8.0 measures by address and errs where
/// the input ends with a run that may be empty; lengths do not.
fn consumed<'a, P>(mut parser: P) -> impl Parser<&'a str, Output = &'a str, Error = Error<&'a str>>
where
    P: Parser<&'a str, Error = Error<&'a str>>,
{
    move |input: &'a str| {
        let (rest, _) = parser.parse(input)?;
        let (text, rest) = input.split_at(input.len() - rest.len());
        Ok((rest, text))
    }
}

fn identifier_text(input: &str) -> IResult<&str, &str> {
    consumed((satisfy(starts_identifier), take_while(continues_identifier))).parse(input)
}

/// Length in bytes of the variable name at the start of `input`; 0 if there is none.
pub fn identifier(input: &str) -> usize {
    identifier_text(input).map_or(0, |(_, name)| name.len())
}

/// Part of an expression.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Symbol {
    /// A literal.
    Number(f64),
    /// A name.
    Identifier,
    /// An operator of two operands; some serve as a sign.
    Operator(Operator),
    /// `!`
    Not,
    /// `(`
    Open,
    /// `)`
    Close,
    /// `,`
    Comma,
    /// Text in double quotes.
    Quoted,
    /// Digits, dots and letters that are no number, with the length of the number before them.
    Malformed(usize),
    /// A character that no expression has.
    Unexpected,
    /// The end.
    End,
}

/// A symbol and where it stands in its text, in bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Token {
    /// What it is.
    pub symbol: Symbol,
    /// First byte.
    pub start: usize,
    /// One past the last byte.
    pub end: usize,
}

fn literal(input: &str) -> IResult<&str, &str> {
    let exponent = (one_of("eE"), opt(one_of("+-")), digit1);
    let whole = value((), (digit1, opt((char('.'), digit0))));
    let fraction = value((), (char('.'), digit1));
    consumed((alt((whole, fraction)), opt(exponent))).parse(input)
}

fn number(input: &str) -> IResult<&str, Symbol> {
    let (rest, digits) = literal(input)?;
    let (rest, tail) = take_while(|c| continues_identifier(c) || c == '.').parse(rest)?;
    match digits.parse() {
        Ok(number) if tail.is_empty() => Ok((rest, Symbol::Number(number))),
        _ => Ok((rest, Symbol::Malformed(digits.len()))),
    }
}

fn operator(input: &str) -> IResult<&str, Symbol> {
    let two = alt((
        value(Operator::Power, tag("**")),
        value(Operator::LessEqual, tag("<=")),
        value(Operator::GreaterEqual, tag(">=")),
        value(Operator::Equal, tag("==")),
        value(Operator::NotEqual, tag("!=")),
        value(Operator::And, tag("&&")),
        value(Operator::Or, tag("||")),
    ));
    let one = alt((
        value(Operator::Power, char('^')),
        value(Operator::Multiply, char('*')),
        value(Operator::Divide, char('/')),
        value(Operator::Add, char('+')),
        value(Operator::Subtract, char('-')),
        value(Operator::Less, char('<')),
        value(Operator::Greater, char('>')),
    ));
    map(alt((two, one)), Symbol::Operator).parse(input)
}

fn symbol(input: &str) -> IResult<&str, Symbol> {
    let quoted = (char('"'), take_while(|c| c != '"' && c != '\n'), opt(char('"')));
    alt((
        number,
        value(Symbol::Identifier, identifier_text),
        operator,
        value(Symbol::Not, char('!')),
        value(Symbol::Open, char('(')),
        value(Symbol::Close, char(')')),
        value(Symbol::Comma, char(',')),
        value(Symbol::Quoted, quoted),
        value(Symbol::Unexpected, anychar),
        value(Symbol::End, success(())),
    ))
    .parse(input)
}

/// Number of bytes of white space, line ends included, at the start of `input`.
pub fn space(input: &str) -> usize {
    input.len() - input.trim_start_matches(|c| is_blank(c) || c == '\n').len()
}

/// The first token of `text` at or after byte `from`.
pub fn token(text: &str, from: usize) -> Token {
    let start = from + space(&text[from..]);
    let input = &text[start..];
    let (rest, symbol) = symbol(input).unwrap_or(("", Symbol::End));
    Token { symbol, start, end: start + input.len() - rest.len() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pieces(text: &str) -> Vec<(Piece, &str)> {
        let mut rest = text;
        let mut list = Vec::new();
        while let Some((piece, length)) = piece(rest) {
            list.push((piece, &rest[..length]));
            rest = &rest[length..];
        }
        list
    }

    fn symbols(text: &str) -> Vec<Symbol> {
        let mut from = 0;
        let mut list = Vec::new();
        loop {
            let token = token(text, from);
            if token.symbol == Symbol::End {
                return list;
            }
            list.push(token.symbol);
            from = token.end;
        }
    }

    #[test]
    fn statements_fall_into_pieces() {
        let expected = [
            (Piece::Word, "dump"),
            (Piece::Open, "("),
            (Piece::Word, "contact/hertz"),
            (Piece::Comma, ","),
            (Piece::Blank, "\t "),
            (Piece::Quoted, "\"a #b\""),
            (Piece::Close, ")"),
            (Piece::Comment, "#c\r"),
            (Piece::NewLine, "\n"),
            (Piece::OpenQuote, "\"é)"),
        ];
        assert_eq!(pieces("dump(contact/hertz,\t \"a #b\")#c\r\n\"é)"), expected);
    }

    #[test]
    fn every_form_of_literal() {
        let cases = [
            ("3", 3.0),
            ("1.25", 1.25),
            ("0.5", 0.5),
            (".5", 0.5),
            ("1.", 1.0),
            ("1e3", 1e3),
            ("1E+3", 1e3),
            ("1.e-3", 1e-3),
            ("4.9e-324", 5e-324),
        ];
        for (text, value) in cases {
            assert_eq!(symbols(text), [Symbol::Number(value)], "{text}");
        }
    }

    #[test]
    fn digits_that_are_no_number() {
        for (text, length) in
            [("1.2.3", 3), ("2PI", 1), ("1e", 1), ("1e+", 1), ("1..2", 2), ("0x1F", 1)]
        {
            assert_eq!(symbols(text)[0], Symbol::Malformed(length), "{text}");
        }
    }

    #[test]
    fn every_operator() {
        use Operator::*;
        let found = symbols("** ^ * / + - < <= > >= == != && ||");
        let all = [
            Power,
            Power,
            Multiply,
            Divide,
            Add,
            Subtract,
            Less,
            LessEqual,
            Greater,
            GreaterEqual,
            Equal,
            NotEqual,
            And,
            Or,
        ];
        assert_eq!(found, all.map(Symbol::Operator));
        let rest = [
            Symbol::Not,
            Symbol::Open,
            Symbol::Close,
            Symbol::Comma,
            Symbol::Unexpected,
            Symbol::Quoted,
        ];
        assert_eq!(symbols("!(),=\"a"), rest);
    }

    #[test]
    fn tokens_know_their_places() {
        let text = " \r\n\té1*x";
        let name = token(text, 0);
        assert_eq!((name.symbol, &text[name.start..name.end]), (Symbol::Identifier, "é1"));
        assert_eq!(token(text, text.len()), Token { symbol: Symbol::End, start: 9, end: 9 });
    }

    #[test]
    fn words_and_identifiers_end_where_they_should() {
        assert_eq!(word("work-piece, 2"), 10);
        assert_eq!(word("\"a b\" c"), 5);
        assert_eq!(word(" a"), 0);
        assert_eq!(identifier("_a1-b"), 3);
        assert_eq!(identifier("ab"), 2);
        assert_eq!(identifier_text("ab"), Ok(("", "ab")));
        assert_eq!(identifier("1a"), 0);
    }
}
