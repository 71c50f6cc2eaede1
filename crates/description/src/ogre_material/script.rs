//! The syntax of Ogre's scripts: statements of words, each on a line, with blocks in braces.

use crate::diagnostics::{Problem, Severity, Source};
use std::path::Path;

/// A line of a script, with the block in braces that follows it, if any.
pub(super) struct Statement {
    pub(super) words: Vec<String>,
    pub(super) line: u32,
    pub(super) block: Vec<Statement>,
}

/// Parses a script that came from `path` into statements.
pub(super) fn statements(text: &str, path: &Path) -> Result<Vec<Statement>, Problem> {
    Parser { tokens: tokens(text), next: 0, path }.statements(0)
}

#[derive(PartialEq)]
enum Token {
    Word(String),
    Open,
    Close,
    EndOfLine,
}

/// Splits a script into words, braces and ends of lines, each with its line number.
fn tokens(text: &str) -> Vec<(Token, u32)> {
    let mut tokens = Vec::new();
    let mut in_comment = false;
    for (line, number) in text.lines().zip(1..) {
        let mut rest = line;
        while !rest.is_empty() {
            if in_comment {
                let Some(end) = rest.find("*/") else { break };
                rest = &rest[end + 2..];
                in_comment = false;
            } else if rest.starts_with("//") {
                break;
            } else if let Some(after) = rest.strip_prefix("/*") {
                rest = after;
                in_comment = true;
            } else if let Some(after) = rest.strip_prefix('{') {
                tokens.push((Token::Open, number));
                rest = after;
            } else if let Some(after) = rest.strip_prefix('}') {
                tokens.push((Token::Close, number));
                rest = after;
            } else if let Some(quoted) = rest.strip_prefix('"') {
                let end = quoted.find('"').unwrap_or(quoted.len());
                tokens.push((Token::Word(quoted[..end].to_owned()), number));
                rest = quoted.get(end + 1..).unwrap_or("");
            } else if rest.starts_with(char::is_whitespace) {
                rest = rest.trim_start();
            } else {
                let end = word_end(rest);
                tokens.push((Token::Word(rest[..end].to_owned()), number));
                rest = &rest[end..];
            }
        }
        tokens.push((Token::EndOfLine, number));
    }
    tokens
}

/// Returns where the first word of `text` ends. A single `/` belongs to names such as `Gazebo/Grey`; a colon
/// is a word of its own only between spaces.
fn word_end(text: &str) -> usize {
    let stop = |(at, c): (usize, char)| {
        let comment = text[at..].starts_with("//") || text[at..].starts_with("/*");
        (c.is_whitespace() || "{}\"".contains(c) || comment).then_some(at)
    };
    text.char_indices().find_map(stop).filter(|end| *end > 0).unwrap_or(text.len())
}

/// Greatest depth of nested blocks: each uses some of the stack.
const MOST_DEPTH: usize = 64;

struct Parser<'a> {
    tokens: Vec<(Token, u32)>,
    next: usize,
    path: &'a Path,
}

impl Parser<'_> {
    /// Parses the content of a block that is `depth` blocks deep; 0 is the whole script.
    fn statements(&mut self, depth: usize) -> Result<Vec<Statement>, Problem> {
        let mut statements: Vec<Statement> = Vec::new();
        let mut words = Vec::new();
        let mut words_line = 0;
        loop {
            let Some((token, line)) = self.tokens.get_mut(self.next) else {
                if depth > 0 {
                    return Err(self.problem(
                        self.last_line(),
                        "a '{' is never closed",
                        "add the missing '}'",
                    ));
                }
                return Ok(statements);
            };
            let line = *line;
            self.next += 1;
            match token {
                Token::Word(word) => {
                    if words.is_empty() {
                        words_line = line;
                    }
                    words.push(std::mem::take(word));
                }
                Token::EndOfLine => {
                    // The opening brace of a block may be on a later line than its words.
                    let ends =
                        self.tokens[self.next..].iter().take_while(|(token, _)| *token == Token::EndOfLine);
                    self.next += ends.count();
                    if !words.is_empty() && !self.opens_next() {
                        statements.push(Statement {
                            words: std::mem::take(&mut words),
                            line: words_line,
                            block: Vec::new(),
                        });
                    }
                }
                Token::Open if depth == MOST_DEPTH => {
                    return Err(self.problem(
                        line,
                        &format!("more than {MOST_DEPTH} nested blocks"),
                        "close some first: Ogre's own scripts have four",
                    ));
                }
                Token::Open => {
                    let words = std::mem::take(&mut words);
                    let block = self.statements(depth + 1)?;
                    statements.push(Statement { words, line: words_line.max(1), block });
                }
                Token::Close => {
                    if !words.is_empty() {
                        statements.push(Statement { words, line: words_line, block: Vec::new() });
                    }
                    if depth > 0 {
                        return Ok(statements);
                    }
                    return Err(self.problem(
                        line,
                        "a '}' closes nothing",
                        "remove it, or add the missing '{'",
                    ));
                }
            }
        }
    }

    /// Returns true if the next token is a brace that opens the block of the words just read.
    fn opens_next(&self) -> bool {
        self.tokens.get(self.next).is_some_and(|(token, _)| *token == Token::Open)
    }

    fn last_line(&self) -> u32 {
        self.tokens.last().map_or(0, |(_, line)| *line)
    }

    fn problem(&self, line: u32, what: &str, remedy: &str) -> Problem {
        problem(self.path, line, what.into(), remedy)
    }
}

pub(super) fn problem(path: &Path, line: u32, what: String, remedy: &str) -> Problem {
    Problem { severity: Severity::Error, source: Source::new(path, line), what, remedy: remedy.into() }
}
