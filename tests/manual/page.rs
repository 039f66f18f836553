//! Markdown as far as the tests need it: fenced blocks, headings, links.

use std::path::{Path, PathBuf};

/// A fenced block.
pub struct Block {
    /// The word after the fence.
    pub language: String,
    /// The words after it: `file=two.mpm`, `exit=2`.
    pub words: Vec<String>,
    /// Line of the opening fence, from 1.
    pub line: usize,
    /// What stands inside.
    pub text: String,
}

impl Block {
    /// The value of `name=value` among its words.
    pub fn value(&self, name: &str) -> Option<&str> {
        self.words.iter().find_map(|word| word.strip_prefix(name)?.strip_prefix('='))
    }

    /// Is this one of its words?
    pub fn has(&self, word: &str) -> bool {
        self.words.iter().any(|known| known == word)
    }
}

/// A link: where it stands and where it leads.
pub struct Link {
    /// Line, from 1.
    pub line: usize,
    /// What stands in its parentheses.
    pub target: String,
}

/// A page.
pub struct Page {
    /// Its file.
    pub path: PathBuf,
    /// Fenced blocks.
    pub blocks: Vec<Block>,
    /// Anchors of its headings.
    pub anchors: Vec<String>,
    /// Links and pictures outside of blocks and code.
    pub links: Vec<Link>,
}

impl Page {
    /// Reads a page.
    pub fn read(path: &Path) -> Self {
        let text = std::fs::read_to_string(path).unwrap();
        Self::parse(path, &text)
    }

    /// Reads a page from its text.
    ///
    /// A fence is closed by a line of backticks alone, at least as many as have opened it.
    pub fn parse(path: &Path, text: &str) -> Self {
        let (path, blocks, anchors, links) = (path.to_path_buf(), vec![], vec![], vec![]);
        let mut page = Self { path, blocks, anchors, links };
        // The open block, how many backticks have opened it, and how far it is indented.
        let mut open: Option<(Block, usize, usize)> = None;
        for (index, line) in text.lines().enumerate() {
            let bare = line.trim_start_matches(' ');
            let ticks = bare.chars().take_while(|c| *c == '`').count();
            let rest = bare[ticks..].trim();
            match &mut open {
                Some((_, width, _)) if ticks >= *width && rest.is_empty() => {
                    page.blocks.extend(open.take().map(|(block, ..)| block));
                }
                Some((block, _, indent)) => {
                    let kept = line.len() - bare.len().max(line.len().saturating_sub(*indent));
                    block.text.push_str(&line[kept..]);
                    block.text.push('\n');
                }
                None if ticks >= 3 => {
                    let mut words = rest.split_whitespace().map(str::to_string);
                    let language = words.next().unwrap_or_default();
                    let (words, text) = (words.collect(), String::new());
                    let block = Block { language, words, line: index + 1, text };
                    open = Some((block, ticks, line.len() - bare.len()));
                }
                None => page.read_line(index + 1, line),
            }
        }
        assert!(open.is_none(), "{}: a fence is not closed", page.path.display());
        page
    }

    fn read_line(&mut self, line: usize, text: &str) {
        let level = text.chars().take_while(|c| *c == '#').count();
        if (1..=6).contains(&level) && text[level..].starts_with(' ') {
            let anchor = anchor(text[level..].trim());
            let same = self.anchors.iter().filter(|known| **known == anchor).count();
            assert_eq!(same, 0, "{}:{line}: a second heading `{anchor}`", self.path.display());
            self.anchors.push(anchor);
        }
        let text = without_code(text);
        for (at, _) in text.match_indices("](") {
            let target: String = text[at + 2..].chars().take_while(|c| *c != ')').collect();
            self.links.push(Link { line, target });
        }
    }
}

/// The line with blanks in place of what stands between backticks.
fn without_code(line: &str) -> String {
    let mut code = false;
    let blank = |c: char| {
        code ^= c == '`';
        if code { ' ' } else { c }
    };
    line.chars().map(blank).collect()
}

/// The anchor of a heading, as mdBook and the forges make it.
pub fn anchor(heading: &str) -> String {
    let mut anchor = String::new();
    for c in heading.to_lowercase().chars() {
        if c.is_whitespace() {
            anchor.push('-');
        } else if c.is_alphanumeric() || matches!(c, '-' | '_') {
            anchor.push(c);
        }
    }
    anchor
}

#[test]
fn blocks_headings_and_links_are_found() {
    let page = Page::parse(Path::new("a.md"), "1. a\n\n   ```text\n   b\n     c\n   ```\n");
    assert_eq!(page.blocks[0].text, "b\n  c\n");
    let text = "# A `b_c` (d)\n[x](y.md#z), `[no](link)` ![p](q.svg)\n````text\n```\n# no\n````\n\
        ```console exit=2 mpi\n$ a\n```\n";
    let page = Page::parse(Path::new("a.md"), text);
    assert_eq!(page.anchors, ["a-b_c-d"]);
    let targets: Vec<&str> = page.links.iter().map(|link| link.target.as_str()).collect();
    assert_eq!(targets, ["y.md#z", "q.svg"]);
    let [first, second] = &page.blocks[..] else { panic!("two blocks") };
    assert_eq!(first.text, "```\n# no\n");
    assert_eq!((second.value("exit"), second.has("mpi"), second.line), (Some("2"), true, 7));
}
