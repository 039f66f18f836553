//! Text to statements.

use super::arguments::{Name, empty_argument};
use super::diagnostic::{Code, Diagnostic};
use super::parse::missing_parenthesis;
use super::scope::bad_name;
use super::source::{Source, Span};
use super::token::{self, Piece};

/// One argument, not yet read: its signature decides whether it is a word or an expression.
#[derive(Clone, Debug, PartialEq)]
pub struct Argument {
    /// Where it stands, quotes included.
    pub span: Span,
    /// Text without quotes and comments. Unless quoted, byte i of it is byte `span.start` + i of the
    /// script: comments inside are replaced by blanks.
    pub text: String,
    /// Was it in double quotes?
    pub quoted: bool,
}

impl Argument {
    /// An argument that is a text of its own.
    pub fn bare(text: &str) -> Self {
        Self { span: Span::new(0, text.len()), text: text.to_string(), quoted: false }
    }
}

/// One statement.
#[derive(Clone, Debug, PartialEq)]
pub enum Statement {
    /// `name = expression`
    Assign {
        /// Left of `=`.
        name: Name,
        /// Right of `=`.
        value: Argument,
    },
    /// `command(arg, ...)`
    Call {
        /// The command.
        name: Name,
        /// What stands between the commas.
        arguments: Vec<Argument>,
        /// From the name to the closing parenthesis; to the opening one if it is never closed.
        span: Span,
    },
    /// `quit`
    Quit {
        /// The word.
        span: Span,
    },
}

/// All statements up to `quit`, and all mistakes of form.
///
/// A statement with a mistake is kept where its meaning is clear, so that the names it declares are
/// known; reading it again may repeat the mistake at the same place
/// ([`super::diagnostic::ordered`] shows it once).
pub fn parse(source: &Source) -> (Vec<Statement>, Vec<Diagnostic>) {
    let mut reader =
        Reader { text: &source.text, at: 0, statements: Vec::new(), mistakes: Vec::new() };
    while let Some((piece, length)) = reader.piece() {
        match piece {
            piece if is_space(piece) => reader.at += length,
            _ => reader.statement(),
        }
        if let Some(Statement::Quit { .. }) = reader.statements.last() {
            break;
        }
    }
    (reader.statements, reader.mistakes)
}

/// A piece and where it stands.
type Placed = (Piece, Span);

/// How a list of arguments or a value ended.
enum Ending {
    /// At its end: the closing parenthesis, or the end of the line.
    Here,
    /// The parenthesis at this byte is still open, and the next statement begins.
    Open(usize),
    /// A quote is open; the rest of the line is lost.
    Broken,
}

struct Reader<'a> {
    text: &'a str,
    at: usize,
    statements: Vec<Statement>,
    mistakes: Vec<Diagnostic>,
}

impl Reader<'_> {
    fn rest(&self) -> &str {
        &self.text[self.at..]
    }

    fn piece(&self) -> Option<(Piece, usize)> {
        token::piece(self.rest())
    }

    fn skip_blanks(&mut self) {
        while let Some((Piece::Blank, length)) = self.piece() {
            self.at += length;
        }
    }

    fn skip_line(&mut self) {
        self.at += self.rest().find('\n').unwrap_or(self.rest().len());
    }

    /// What is left of the line, without comment and blanks around.
    fn line_rest(&self) -> Span {
        let mut end = self.at;
        let mut at = self.at;
        while let Some((piece, length)) = token::piece(&self.text[at..]) {
            match piece {
                Piece::NewLine | Piece::Comment => break,
                Piece::Blank => at += length,
                _ => {
                    at += length;
                    end = at;
                }
            }
        }
        Span::new(self.at, end)
    }

    fn statement(&mut self) {
        let start = self.at;
        let head = self.rest().find(|c: char| token::is_blank(c) || "\n,()\"#=".contains(c));
        self.at += head.unwrap_or(self.rest().len());
        let name =
            Name { text: self.text[start..self.at].to_string(), span: Span::new(start, self.at) };
        self.skip_blanks();
        if name.text.is_empty() {
            return self.bad_statement(start);
        }
        let is_name = token::identifier(&name.text) == name.text.len();
        match self.rest().as_bytes() {
            [b'(', ..] => self.call(name),
            [b'=', second, ..] if *second == b'=' => self.bad_statement(start),
            [b'=', ..] if is_name => self.assignment(name),
            [b'=', ..] if !name.text.ends_with(['<', '>', '!']) => {
                self.mistakes.push(bad_name(&name));
                self.skip_line();
            }
            [] | [b'\n' | b'#', ..] if name.text == "quit" => {
                self.statements.push(Statement::Quit { span: name.span });
            }
            _ => self.bad_statement(start),
        }
    }

    fn bad_statement(&mut self, start: usize) {
        self.at = start;
        let span = self.line_rest();
        let word = token::identifier(&self.text[start..]);
        let word = &self.text[start..start + word];
        let error = Diagnostic::error(Code::BadStatement, span, "this is not a statement")
            .label("expected `name = expression`, `command(...)` or `quit`");
        let error = match word {
            "" => error,
            "quit" => error.help("`quit` stands alone on its line"),
            _ => error.help(format!("a command takes its arguments in parentheses: `{word}(...)`")),
        };
        self.mistakes.push(error);
        self.skip_line();
    }

    fn call(&mut self, name: Name) {
        let mut arguments = Vec::new();
        let open = Span::new(name.span.start, self.at + 1);
        let ending = self.arguments(&mut arguments);
        let closed = Span::new(name.span.start, self.at);
        let span = match ending {
            Ending::Here => closed,
            Ending::Open(_) => open,
            Ending::Broken => return,
        };
        match ending {
            Ending::Open(open) => {
                self.mistakes.push(missing_parenthesis(Span::new(open, open + 1)))
            }
            _ => self.nothing_more(&name),
        }
        if name.text == "quit" {
            let error = Diagnostic::error(Code::BadStatement, span, "`quit` takes no parentheses");
            self.mistakes.push(error.label("expected `quit` alone on its line"));
            return;
        }
        self.statements.push(Statement::Call { name, arguments, span });
    }

    fn nothing_more(&mut self, name: &Name) {
        self.skip_blanks();
        let span = self.line_rest();
        if span.start < span.end {
            let message = format!("text after the closing parenthesis of `{}`", name.text);
            let error =
                Diagnostic::error(Code::TextAfterCall, span, message).label("cannot stand here");
            self.mistakes.push(error.help("one statement per line"));
            self.skip_line();
        }
    }

    /// Reads from the opening to the closing parenthesis of a call.
    fn arguments(&mut self, arguments: &mut Vec<Argument>) -> Ending {
        let mut opens = vec![self.at];
        self.at += 1;
        let mut pieces: Vec<Placed> = Vec::new();
        let mut before = Span::new(self.at - 1, self.at);
        let mut last = before;
        loop {
            let Some((piece, length)) = self.piece() else {
                return self.open_ending(&pieces, before, opens, arguments);
            };
            let span = Span::new(self.at, self.at + length);
            self.at = span.end;
            if !is_space(piece) {
                last = span;
            }
            match piece {
                Piece::NewLine if self.statement_begins(last) => {
                    self.at = span.start;
                    return self.open_ending(&pieces, before, opens, arguments);
                }
                Piece::OpenQuote => return self.open_quote(span),
                Piece::Comma if opens.len() == 1 => {
                    let argument = self.argument(&pieces).unwrap_or_else(|| {
                        self.mistakes.push(
                            empty_argument(span).label("expected something before this comma"),
                        );
                        Argument { span, text: String::new(), quoted: false }
                    });
                    arguments.push(argument);
                    pieces.clear();
                    before = span;
                    continue;
                }
                Piece::Close if opens.len() == 1 => {
                    self.last_argument(&pieces, before, arguments);
                    return Ending::Here;
                }
                Piece::Open => opens.push(span.start),
                Piece::Close => {
                    opens.pop();
                }
                _ => {}
            }
            pieces.push((piece, span));
        }
    }

    fn open_ending(
        &mut self,
        pieces: &[Placed],
        before: Span,
        opens: Vec<usize>,
        arguments: &mut Vec<Argument>,
    ) -> Ending {
        // With a comma at the end, the open parenthesis is the mistake to tell.
        if opens.len() == 1 && significant(pieces).next().is_some() {
            self.last_argument(pieces, before, arguments);
        }
        Ending::Open(opens.last().copied().unwrap_or(before.start))
    }

    fn last_argument(&mut self, pieces: &[Placed], before: Span, arguments: &mut Vec<Argument>) {
        match self.argument(pieces) {
            Some(argument) => arguments.push(argument),
            None if arguments.is_empty() => {}
            None => {
                let error = Diagnostic::error(
                    Code::TrailingComma,
                    before,
                    "a comma stands before the closing parenthesis",
                );
                self.mistakes.push(error.label("nothing follows this comma"));
            }
        }
    }

    fn open_quote(&mut self, span: Span) -> Ending {
        let span = Span::new(span.start, span.start + 1);
        let error = Diagnostic::error(Code::OpenQuote, span, "a double quote is not closed");
        self.mistakes.push(error.label("opened here").help("quotes open and close on one line"));
        Ending::Broken
    }

    /// Does the next line begin a statement although a parenthesis is open? An assignment or `quit`
    /// always does, a call does where an operator or comma would have to stand first. `last` is
    /// the last piece that is no white space.
    fn statement_begins(&self, last: Span) -> bool {
        let goes_on = self.text[last.start..last.end].ends_with(|c| ",(+-*/^<>=!&|".contains(c));
        let mut line = self.rest();
        while let Some((Piece::Blank, length)) = token::piece(line) {
            line = &line[length..];
        }
        let name = token::identifier(line);
        if name == 0 {
            return false;
        }
        let after = line[name..].trim_start_matches(token::is_blank);
        let assigns = after.starts_with('=') && !after.starts_with("==");
        let quits = &line[..name] == "quit" && (after.is_empty() || after.starts_with(['\n', '#']));
        assigns || (!goes_on && (quits || after.starts_with('(')))
    }

    fn assignment(&mut self, name: Name) {
        let equals = Span::new(self.at, self.at + 1);
        self.at += 1;
        let mut opens: Vec<usize> = Vec::new();
        let mut pieces: Vec<Placed> = Vec::new();
        let mut last = equals;
        let ending = loop {
            let Some((piece, length)) = self.piece() else {
                break opens.last().map_or(Ending::Here, |open| Ending::Open(*open));
            };
            let span = Span::new(self.at, self.at + length);
            match piece {
                Piece::NewLine if opens.is_empty() => break Ending::Here,
                Piece::OpenQuote => {
                    self.at = span.end;
                    break self.open_quote(span);
                }
                Piece::Open => opens.push(span.start),
                Piece::Close => {
                    opens.pop();
                }
                _ => {}
            }
            self.at = span.end;
            if let (Piece::NewLine, Some(open)) = (piece, opens.last())
                && self.statement_begins(last)
            {
                break Ending::Open(*open);
            }
            if !is_space(piece) {
                last = span;
            }
            pieces.push((piece, span));
        };
        match ending {
            Ending::Here => {}
            Ending::Open(open) => {
                self.mistakes.push(missing_parenthesis(Span::new(open, open + 1)))
            }
            Ending::Broken => return,
        }
        let value = self.argument(&pieces).unwrap_or_else(|| {
            let message = format!("`{}` gets no value", name.text);
            let error = Diagnostic::error(Code::MissingExpression, equals, message);
            self.mistakes.push(error.label("expected an expression after this"));
            Argument { span: equals, text: String::new(), quoted: false }
        });
        self.statements.push(Statement::Assign { name, value });
    }

    /// What stands between two commas; `None` if that is nothing.
    fn argument(&mut self, pieces: &[Placed]) -> Option<Argument> {
        let (_, first) = significant(pieces).next()?;
        let (_, last) = significant(pieces).next_back()?;
        let span = Span::new(first.start, last.end);
        let inside =
            pieces.iter().filter(|(_, place)| span.start <= place.start && place.end <= span.end);
        let has = |wanted: Piece| pieces.iter().any(|(piece, _)| *piece == wanted);
        if has(Piece::Quoted) && !has(Piece::Open) && !has(Piece::Close) {
            return Some(self.quoted(span, inside.copied().collect()));
        }
        let mut text = String::with_capacity(span.end - span.start);
        for (piece, place) in inside {
            match piece {
                Piece::Comment => text.extend(std::iter::repeat_n(' ', place.end - place.start)),
                _ => text.push_str(&self.text[place.start..place.end]),
            }
        }
        Some(Argument { span, text, quoted: false })
    }

    /// One word of quoted and other text, the quotes dropped.
    fn quoted(&mut self, span: Span, pieces: Vec<Placed>) -> Argument {
        let mut text = String::new();
        for (piece, place) in &pieces {
            match piece {
                Piece::Quoted => text.push_str(&self.text[place.start + 1..place.end - 1]),
                Piece::Word => text.push_str(&self.text[place.start..place.end]),
                _ => {
                    let error =
                        Diagnostic::error(Code::BrokenQuote, span, "this is more than one word");
                    self.mistakes.push(
                        error.label("words side by side").help("put the quotes round all of it"),
                    );
                    break;
                }
            }
        }
        Argument { span, text, quoted: true }
    }
}

/// The pieces that are no white space and no comment.
fn significant(pieces: &[Placed]) -> impl DoubleEndedIterator<Item = &Placed> {
    pieces.iter().filter(|(piece, _)| !is_space(*piece))
}

fn is_space(piece: Piece) -> bool {
    matches!(piece, Piece::Blank | Piece::NewLine | Piece::Comment)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Code, first byte, end.
    type Found = (Code, usize, usize);

    fn read(text: &str) -> (Vec<Statement>, Vec<Found>) {
        let (statements, mistakes) = parse(&Source::new("a", text));
        let mistakes = mistakes.iter().map(|m| (m.code, m.span.start, m.span.end)).collect();
        (statements, mistakes)
    }

    /// Statements in one line each: `name=value`, `name[a|b]`, `quit`.
    fn form(text: &str) -> String {
        let (statements, mistakes) = read(text);
        assert_eq!(mistakes, [], "{text}");
        let words: Vec<String> = statements.iter().map(one_form).collect();
        words.join(" ")
    }

    fn one_form(statement: &Statement) -> String {
        match statement {
            Statement::Assign { name, value } => format!("{}={}", name.text, value.text),
            Statement::Call { name, arguments, .. } => {
                let list: Vec<&str> =
                    arguments.iter().map(|argument| argument.text.as_str()).collect();
                format!("{}[{}]", name.text, list.join("|"))
            }
            Statement::Quit { .. } => "quit".to_string(),
        }
    }

    #[test]
    fn statements_of_every_form() {
        assert_eq!(form(""), "");
        assert_eq!(form(" \t# only a comment"), "");
        assert_eq!(form("E   = 1e+3  # Young\r\n\tf ( a , b )\r\n"), "E=1e+3 f[a|b]");
        assert_eq!(form("run()"), "run[]");
        assert_eq!(
            form("a = max(1, 2)\nf(max(1, 2), work-piece, d.*.gz)"),
            "a=max(1, 2) f[max(1, 2)|work-piece|d.*.gz]"
        );
        assert_eq!(form("quit = 1"), "quit=1");
        assert_eq!(form("α = 1"), "α=1");
        assert_eq!(form("a = b == c"), "a=b == c");
    }

    #[test]
    fn quit_ends_the_script() {
        assert_eq!(form("a = 1\nquit # here\n)) \" = nonsense"), "a=1 quit");
        assert_eq!(form("quit"), "quit");
        assert_eq!(form("quit\r\n((("), "quit");
        assert_eq!(read("quit now").1[0].0, Code::BadStatement);
        assert_eq!(read("quit()").1[0].0, Code::BadStatement);
    }

    #[test]
    fn calls_go_on_over_lines_and_comments() {
        let text = "f(a, # first\n  # nothing\r\n  b +\n  c\n) # end\ng(1)";
        assert_eq!(form(text), "f[a|b +\n  c] g[1]");
        let (statements, _) = read("f(1 + # é\n 2)");
        let Statement::Call { arguments, span, .. } = &statements[0] else { panic!("a call") };
        assert_eq!((arguments[0].span, *span), (Span::new(2, 13), Span::new(0, 14)));
        assert_eq!(arguments[0].text, "1 +     \n 2", "bytes keep their places");
        assert_eq!(form("a = max(1,\n 2)\nb = 3"), "a=max(1,\n 2) b=3");
    }

    #[test]
    fn double_quotes_make_one_word() {
        let (statements, mistakes) = read("f(\"a, (b) #c\", xcm(\"g h\", x), \"my dir\"/file)");
        assert_eq!(mistakes, []);
        let Statement::Call { arguments, .. } = &statements[0] else { panic!("a call") };
        let found: Vec<_> =
            arguments.iter().map(|argument| (argument.text.as_str(), argument.quoted)).collect();
        assert_eq!(found, [("a, (b) #c", true), ("xcm(\"g h\", x)", false), ("my dir/file", true)]);
        assert_eq!(arguments[0].span, Span::new(2, 13));
    }

    #[test]
    fn mistakes_of_form_with_their_places() {
        let cases: [(&str, &[Found]); 22] = [
            ("f(a,,b)", &[(Code::EmptyArgument, 4, 5)]),
            ("f(,b)", &[(Code::EmptyArgument, 2, 3)]),
            ("f(a,)", &[(Code::TrailingComma, 3, 4)]),
            ("f(,)", &[(Code::EmptyArgument, 2, 3), (Code::TrailingComma, 2, 3)]),
            ("f(a) b # c", &[(Code::TextAfterCall, 5, 6)]),
            ("f(a))", &[(Code::TextAfterCall, 4, 5)]),
            ("f(a", &[(Code::MissingParenthesis, 1, 2)]),
            ("f(a\ng(b)", &[(Code::MissingParenthesis, 1, 2)]),
            ("f(a,\nb = 2", &[(Code::MissingParenthesis, 1, 2)]),
            ("f(g(a)\nquit", &[(Code::MissingParenthesis, 1, 2)]),
            ("a = (1 + (2)\nb = 3", &[(Code::MissingParenthesis, 4, 5)]),
            ("a = (1", &[(Code::MissingParenthesis, 4, 5)]),
            ("a =", &[(Code::MissingExpression, 2, 3)]),
            ("a = # b", &[(Code::MissingExpression, 2, 3)]),
            ("f(\"a)\ng(1)", &[(Code::OpenQuote, 2, 3)]),
            ("a = \"b", &[(Code::OpenQuote, 4, 5)]),
            ("f(a \"b\")", &[(Code::BrokenQuote, 2, 7)]),
            ("run 100 # x", &[(Code::BadStatement, 0, 7)]),
            ("a == 1", &[(Code::BadStatement, 0, 6)]),
            ("a <= 1", &[(Code::BadStatement, 0, 6)]),
            ("2a = 1", &[(Code::BadName, 0, 2)]),
            (") = 1", &[(Code::BadStatement, 0, 5)]),
        ];
        for (text, expected) in cases {
            assert_eq!(read(text).1, expected, "{text}");
        }
    }

    #[test]
    fn all_mistakes_are_found_in_one_pass() {
        let text = "f(a\nb = \ng(,1)\nh(\"a)\n= 3\nk(1) 2\na-b = 1\nlast(1)";
        let (statements, mistakes) = read(text);
        let codes: Vec<Code> = mistakes.iter().map(|mistake| mistake.0).collect();
        let expected = [
            Code::MissingParenthesis,
            Code::MissingExpression,
            Code::EmptyArgument,
            Code::OpenQuote,
            Code::BadStatement,
            Code::TextAfterCall,
            Code::BadName,
        ];
        assert_eq!(codes, expected);
        let kept: Vec<String> = statements.iter().map(one_form).collect();
        assert_eq!(kept, ["f[a]", "b=", "g[|1]", "k[1]", "last[1]"]);
    }

    #[test]
    fn nesting_costs_no_stack() {
        assert_eq!(
            read(&("f".to_string() + &"(".repeat(200_000))).1[0].0,
            Code::MissingParenthesis
        );
        assert_eq!(
            read(&("a = ".to_string() + &"(".repeat(200_000))).1[0].0,
            Code::MissingParenthesis
        );
    }
}
