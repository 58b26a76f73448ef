//! Lexer: text to tokens.
//!
//! Characters that look like ASCII operators or digits are mapped to them, and
//! [`latex`](super::latex) says what a command such as `\frac` stands for. Left out are comments
//! (`// …`, `# …`, `/* … */`, `(* … *)`, and `% …` at the beginning of a line or statement), the
//! names of modules (`np.sin`), the points of `x.^2`, and the `f` of `1.0f`. Any other character
//! outside the language is an error that names its code point.

use super::elsewhere::{component_error, is_module, member};
use super::error::{FormulaError, FormulaErrorKind as ErrorKind};
use super::latex::{self, LatexCommand};
use super::spelling::is_known;
use super::token::{Bar, Comparison, Spanned, Token, slice};
use core::ops::Range;

/// Character that `c` stands for in a formula.
fn mapped(c: char) -> char {
    match c {
        // The full-width forms of ! … ~ are in ASCII order.
        '\u{FF01}'..='\u{FF5E}' => char::from_u32(u32::from(c) - 0xFEE0).unwrap_or(c),
        '\u{2212}' | '\u{2010}' | '\u{2011}' | '\u{2013}' | '\u{FE63}' => '-',
        '\u{00D7}' | '\u{00B7}' | '\u{22C5}' | '\u{2217}' | '\u{2219}' | '\u{2022}' => '*',
        '\u{00F7}' | '\u{2215}' | '\u{2044}' => '/',
        '\u{03D5}' => '\u{03C6}',
        // Spaces of every width, and the byte-order mark with which some editors begin a file.
        '\u{00A0}' | '\u{2000}'..='\u{200A}' | '\u{202F}' | '\u{205F}' | '\u{3000}' | '\u{FEFF}' => ' ',
        // INVISIBLE TIMES and INVISIBLE SEPARATOR.
        '\u{2062}' => '*',
        '\u{2063}' => ',',
        _ => c,
    }
}

/// The raised digits, from 0 to 9.
const SUPERSCRIPTS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];

fn superscript(c: char) -> Option<i64> {
    (0..).zip(SUPERSCRIPTS).find(|&(_, raised)| raised == c).map(|(digit, _)| digit)
}

/// Name of the constant or the function that one character stands for.
fn name_of(c: char) -> Option<&'static str> {
    match c {
        'π' => Some("pi"),
        'τ' => Some("tau"),
        'φ' => Some("phi"),
        '√' => Some("sqrt"),
        '∛' => Some("cbrt"),
        _ => None,
    }
}

/// The letters of names: Latin ones, and Greek ones but π, τ and φ, which are constants.
const LETTERS: [(char, char); 7] =
    [('A', 'Z'), ('a', 'z'), ('Α', 'Ω'), ('α', 'ο'), ('ρ', 'σ'), ('υ', 'υ'), ('χ', 'ω')];

fn starts_name(c: char) -> bool {
    LETTERS.iter().any(|&(first, last)| (first..=last).contains(&c))
}

fn continues_name(c: char) -> bool {
    starts_name(c) || c.is_ascii_digit() || c == '_'
}

/// The names that parameters may have, as a regular expression of JavaScript: a letter, then
/// letters, digits and `_`. Names of coordinates, constants and functions match it too, but are
/// refused.
#[must_use]
pub fn name_pattern() -> String {
    let letters: String = LETTERS.iter().map(|(first, last)| format!("{first}-{last}")).collect();
    format!("^[{letters}][{letters}0-9_]*$")
}

/// Whether `name` has the characters of a name. It may still be a reserved one.
pub(super) fn is_name(name: &str) -> bool {
    let mut letters = name.chars();
    letters.next().is_some_and(starts_name) && letters.all(continues_name)
}

/// Tokens of `text`, ending with `End`.
///
/// A name in `declared` stays one token even where a run of coordinates such as `xy` would
/// otherwise be a product.
pub(super) fn tokens(text: &str, declared: &[&str]) -> Result<Vec<Spanned>, FormulaError> {
    let characters = text.char_indices().map(|(at, c)| (at, mapped(c))).collect();
    let mut lexer = Lexer { text, declared, characters, next: 0, tokens: Vec::new() };
    while let Some(c) = lexer.get(lexer.next) {
        lexer.token(c)?;
    }
    lexer.tokens.push(Spanned { token: Token::End, span: text.len()..text.len() });
    Ok(lexer.tokens)
}

struct Lexer<'a> {
    text: &'a str,
    declared: &'a [&'a str],
    /// Byte offset of each character, and the character that it stands for.
    characters: Vec<(usize, char)>,
    /// Index of the next character.
    next: usize,
    tokens: Vec<Spanned>,
}

impl Lexer<'_> {
    /// Character `index`, if the text is so long.
    fn get(&self, index: usize) -> Option<char> {
        self.characters.get(index).map(|&(_, c)| c)
    }

    /// Byte offset of character `index`.
    fn offset(&self, index: usize) -> usize {
        self.characters.get(index).map_or(self.text.len(), |&(at, _)| at)
    }

    /// Bytes of the characters `from..to`.
    fn span(&self, from: usize, to: usize) -> Range<usize> {
        self.offset(from)..self.offset(to)
    }

    /// The characters `from..to`, mapped.
    fn written(&self, from: usize, to: usize) -> String {
        self.characters[from..to].iter().map(|&(_, c)| c).collect()
    }

    /// Index of the first character from `index` on that is no digit.
    fn after_digits(&self, mut index: usize) -> usize {
        while self.get(index).is_some_and(|c| c.is_ascii_digit()) {
            index += 1;
        }
        index
    }

    /// Appends the token that begins with the next character, `c`, or skips white space and
    /// comments.
    fn token(&mut self, c: char) -> Result<(), FormulaError> {
        let start = self.next;
        self.next += 1;
        let following = self.get(self.next);
        let token = match (c, following) {
            _ if c.is_ascii_whitespace() => return Ok(()),
            ('/', Some('/')) => return self.remark(start),
            ('#', _) => {
                self.skip_line();
                return Ok(());
            }
            ('%', _) if self.constant_of_maxima(start).is_some() => {
                let name = self.constant_of_maxima(start).unwrap_or_default();
                self.next += name.len();
                Token::Name(name)
            }
            ('%', _) if self.begins_line(start) => {
                self.skip_line();
                return Ok(());
            }
            ('/', Some('*')) => return self.comment(start, ['*', '/']),
            ('(', Some('*')) => return self.comment(start, ['*', ')']),
            // MATLAB's element-wise operators, and its sign for a continued line.
            ('.', Some('^' | '*' | '/')) => return Ok(()),
            ('.', Some('.')) if self.get(self.next + 1) == Some('.') => {
                self.skip_line();
                return Ok(());
            }
            ('+', _) => Token::Plus,
            ('=' | '-', Some('>')) => self.pair(Token::Arrow),
            ('-', _) => Token::Minus,
            ('*', Some('*')) => self.pair(Token::Caret),
            ('*', _) => Token::Star,
            ('/', _) => Token::Slash,
            ('%', _) => Token::Percent,
            ('^', _) => Token::Caret,
            ('(' | '[' | '{' | '⌊' | '⌈', _) => Token::Open(c),
            (')' | ']' | '}' | '⌋' | '⌉', _) => Token::Close(c),
            ('|', _) => Token::Bar(Bar::Either),
            (',', _) => Token::Comma,
            (';', _) => Token::Separator,
            ('?', _) => Token::Question,
            (':', Some('=')) => self.pair(Token::Equals),
            (':', _) => Token::Colon,
            ('@', _) => Token::At,
            ('=', Some('=')) => self.pair(Token::Equals),
            ('=', _) => Token::Equals,
            ('≠', _) | ('!' | '~', Some('=')) => {
                self.next += usize::from(c != '≠');
                return Err(unequal(self.span(start, self.next)));
            }
            ('<', Some('=')) => self.pair(Token::Compare(Comparison::AtMost)),
            ('>', Some('=')) => self.pair(Token::Compare(Comparison::AtLeast)),
            ('<', _) => Token::Compare(Comparison::Less),
            ('>', _) => Token::Compare(Comparison::Greater),
            ('≤', _) => Token::Compare(Comparison::AtMost),
            ('≥', _) => Token::Compare(Comparison::AtLeast),
            ('!' | '~' | '¬', _) => Token::Not,
            ('&', Some('&')) => self.pair(Token::And),
            // LaTeX aligns lines at it.
            ('&', _) if self.text.contains('\\') => return Ok(()),
            ('&' | '∧', _) => Token::And,
            ('∨', _) => Token::Or,
            // Encloses a formula in LaTeX.
            ('$', _) => return Ok(()),
            ('\\', _) => return self.command(start),
            ('0'..='9' | '.', _) => Token::Number(self.number(start)?),
            _ if superscript(c).is_some() || c == '⁻' => Token::Superscript(self.superscript(start)?),
            _ if name_of(c).is_some() => Token::Name(name_of(c).unwrap_or_default().into()),
            _ if starts_name(c) => {
                let name = self.name(start);
                if is_module(&name)
                    && let Some(token) = self.member(start)?
                {
                    self.tokens.push(Spanned { token, span: self.span(start, self.next) });
                    return Ok(());
                }
                if self.is_product(&name) {
                    for (offset, letter) in name.chars().enumerate() {
                        let span = self.span(start + offset, start + offset + 1);
                        self.tokens.push(Spanned { token: Token::Name(letter.into()), span });
                    }
                    return Ok(());
                }
                match name.as_str() {
                    _ if self.declared.contains(&name.as_str()) => Token::Name(name),
                    "and" => Token::And,
                    "or" => Token::Or,
                    "not" => Token::Not,
                    "import" | "from" if self.begins_line(start) => {
                        self.skip_line();
                        return Ok(());
                    }
                    _ => Token::Name(name),
                }
            }
            _ => return Err(unexpected_character(self.text, c, self.span(start, self.next))),
        };
        self.tokens.push(Spanned { token, span: self.span(start, self.next) });
        Ok(())
    }

    /// Consumes the second character of a token.
    fn pair(&mut self, token: Token) -> Token {
        self.next += 1;
        token
    }

    /// Skips what is left of the line.
    fn skip_line(&mut self) {
        while self.get(self.next).is_some_and(|c| c != '\n' && c != '\r') {
            self.next += 1;
        }
    }

    /// Whether no token stands before character `start` in its line or its statement.
    fn begins_line(&self, start: usize) -> bool {
        self.tokens.last().is_none_or(|last| {
            let between = last.span.end..self.offset(start);
            last.token == Token::Separator || slice(self.text, &between).contains(['\n', '\r'])
        })
    }

    /// The constant of Maxima, such as `%pi`, whose `%` is character `start`. After an operand `%`
    /// is the remainder; at the beginning of a line it begins a comment, unless an operator follows
    /// the name.
    fn constant_of_maxima(&self, start: usize) -> Option<String> {
        let length = self.characters[start + 1..].iter().take_while(|(_, c)| continues_name(*c)).count();
        let name = self.written(start + 1, start + 1 + length);
        let is_operand = match self.tokens.last().map(|last| &last.token) {
            Some(Token::Number(_) | Token::Name(_) | Token::Close(_) | Token::Superscript(_)) => true,
            Some(Token::Bar(bar)) => *bar != Bar::Opening,
            _ => false,
        };
        let next = self.get(self.after_spaces(start + 1 + length));
        let is_comment = self.begins_line(start) && !next.is_some_and(|c| "+-*/^".contains(c));
        let is_constant = matches!(name.as_str(), "pi" | "e" | "phi" | "i");
        (is_constant && !is_comment && (!is_operand || self.begins_line(start))).then_some(name)
    }

    /// Skips the comment that `//` at character `start` begins. If its text could be the divisor of
    /// a floor division, as in Python, that is an error.
    fn remark(&mut self, start: usize) -> Result<(), FormulaError> {
        let begins_line = self.begins_line(start);
        self.skip_line();
        let rest = self.span(start + 2, self.next);
        let mut words = slice(self.text, &rest)
            .split(|c: char| !continues_name(c))
            .filter(|word| !word.is_empty())
            .peekable();
        let is_known =
            |word: &str| word.parse::<f64>().is_ok() || is_known(word) || self.declared.contains(&word);
        if begins_line || words.peek().is_none() || !words.all(is_known) {
            return Ok(());
        }
        let message = "`//` begins a comment: the whole part of a quotient is `floor(a/b)`";
        Err(FormulaError::new(ErrorKind::Ambiguous, self.span(start, start + 2), message))
    }

    /// Skips a comment up to these two characters.
    fn comment(&mut self, start: usize, end: [char; 2]) -> Result<(), FormulaError> {
        while let Some(c) = self.get(self.next + 1) {
            self.next += 1;
            if [c, self.get(self.next + 1).unwrap_or(' ')] == end {
                self.next += 2;
                return Ok(());
            }
        }
        let message = format!("This comment is not closed: `{}{}` ends it", end[0], end[1]);
        Err(FormulaError::new(ErrorKind::UnexpectedEnd, self.span(start, start + 2), message))
    }

    /// Consumes the member that follows the name of a module, and returns the token of its name
    /// here; none if nothing follows.
    fn member(&mut self, start: usize) -> Result<Option<Token>, FormulaError> {
        loop {
            let sign = match [self.get(self.next), self.get(self.next + 1)] {
                [Some('.'), _] => 1,
                [Some(':'), Some(':')] => 2,
                _ => return Ok(None),
            };
            let begin = self.next + sign;
            if !self.get(begin).is_some_and(starts_name) {
                return Ok(None);
            }
            self.next = begin;
            let name = self.name(begin);
            if is_module(&name) {
                continue;
            }
            return match member(&name) {
                Some(known) => Ok(Some(Token::Name(known))),
                None => {
                    let span = self.span(start, self.next);
                    let message = format!("`{}` is not known here", slice(self.text, &span));
                    Err(FormulaError::new(ErrorKind::UnknownFunction, span, message))
                }
            };
        }
    }

    /// Consumes the name that begins at character `start`; the subscript of `r_{12}` belongs to it.
    fn name(&mut self, start: usize) -> String {
        while self.get(self.next).is_some_and(continues_name) {
            self.next += 1;
        }
        let mut name = self.written(start, self.next);
        if name.ends_with('_')
            && self.get(self.next) == Some('{')
            && let Some((subscript, end)) = self.braced(self.next)
        {
            name.push_str(&subscript);
            self.next = end;
        }
        name
    }

    /// The characters of a name between the brace at character `open` and the one that closes it,
    /// and the index after that.
    fn braced(&self, open: usize) -> Option<(String, usize)> {
        let mut end = open + 1;
        while self.get(end).is_some_and(continues_name) {
            end += 1;
        }
        let inside = self.written(open + 1, end);
        (self.get(end) == Some('}') && !inside.is_empty()).then_some((inside, end + 1))
    }

    /// Skips a group in braces, if one follows.
    fn skip_group(&mut self) {
        let open = self.after_spaces(self.next);
        if self.get(open) == Some('{') {
            let rest = &self.characters[open..];
            self.next = rest.iter().position(|&(_, c)| c == '}').map_or(self.next, |close| open + close + 1);
        }
    }

    /// Index of the first character from `index` on that is no white space.
    fn after_spaces(&self, mut index: usize) -> usize {
        while self.get(index).is_some_and(|c| c.is_ascii_whitespace()) {
            index += 1;
        }
        index
    }

    /// The token of a named letter of Mathematica, `\[Pi]`, whose backslash is character `start`.
    fn named_letter(&mut self, start: usize) -> Option<Token> {
        let rest = self.written(start, self.characters.len().min(start + 24));
        let (name, _) = rest.strip_prefix("\\[")?.split_once(']')?;
        let token = match name {
            "Pi" | "Phi" | "Tau" => Token::Name(name.to_ascii_lowercase()),
            "Equal" => Token::Equals,
            _ => {
                let command = match name.strip_prefix("Capital") {
                    Some(capital) => capital.to_owned(),
                    None => name.to_ascii_lowercase(),
                };
                Token::Name(latex::greek(&command)?.into())
            }
        };
        self.next = start + name.chars().count() + 3;
        Some(token)
    }

    /// Appends the tokens of the LaTeX command whose backslash is character `start`.
    fn command(&mut self, start: usize) -> Result<(), FormulaError> {
        if let Some(token) = self.named_letter(start) {
            self.tokens.push(Spanned { token, span: self.span(start, self.next) });
            return Ok(());
        }
        while self.get(self.next).is_some_and(|c| c.is_ascii_alphabetic()) {
            self.next += 1;
        }
        // A command is a word or one other character.
        if self.next == start + 1 && self.get(self.next).is_some() {
            self.next += 1;
        }
        let word = self.written(start + 1, self.next);
        let command = latex::command(&word);
        let token = match command {
            Some(LatexCommand::Nothing) => return Ok(()),
            // `\left|` opens and `\right|` closes; other brackets say themselves which they do.
            Some(LatexCommand::Side(bar)) => {
                let at = self.after_spaces(self.next);
                if self.get(at) != Some('|') {
                    return Ok(());
                }
                self.next = at + 1;
                Token::Bar(bar)
            }
            Some(LatexCommand::Word) => {
                let open = self.after_spaces(self.next);
                let Some((name, end)) = (self.get(open) == Some('{')).then(|| self.braced(open)).flatten()
                else {
                    let message = format!("A name in braces follows `\\{word}`, as in `\\{word}{{atan}}`");
                    return Err(FormulaError::new(
                        ErrorKind::UnexpectedSymbol,
                        self.span(start, self.next),
                        message,
                    ));
                };
                self.next = end;
                match latex::command(&name) {
                    Some(LatexCommand::Token(token)) => token,
                    _ => Token::Name(name),
                }
            }
            Some(LatexCommand::Unequal) => return Err(unequal(self.span(start, self.next))),
            Some(LatexCommand::Label) => {
                let from = self.next;
                self.skip_group();
                let span = self.span(start, self.next);
                let name = self.written(from, self.next);
                if ["cases", "matrix", "array"].iter().any(|table| name.contains(table)) {
                    let message = "A choice is written `if(c, a, b)`: a where the condition c holds, else b";
                    return Err(FormulaError::new(ErrorKind::UnexpectedSymbol, span, message));
                }
                return Ok(());
            }
            Some(LatexCommand::Token(token)) => token,
            None => {
                let span = self.span(start, self.next);
                let message = format!("`{}` is no command that a formula can have", slice(self.text, &span));
                return Err(FormulaError::new(ErrorKind::UnexpectedSymbol, span, message));
            }
        };
        let is_fraction = token == Token::Fraction;
        self.tokens.push(Spanned { token, span: self.span(start, self.next) });
        // In `\frac12` every digit is a group of its own.
        for _ in 0..if is_fraction { 2 } else { 0 } {
            let at = self.after_spaces(self.next);
            let Some(digit) = self.get(at).and_then(|c| c.to_digit(10)) else { break };
            self.next = at + 1;
            let span = self.span(at, self.next);
            self.tokens.push(Spanned { token: Token::Number(f64::from(digit)), span });
        }
        Ok(())
    }

    /// Whether `name` is a run of coordinates that is read as a product.
    fn is_product(&self, name: &str) -> bool {
        let coordinates = name.len() > 1 && name.bytes().all(|b| matches!(b, b'x' | b'y' | b'z'));
        coordinates && !self.declared.contains(&name)
    }

    /// Consumes the number that begins at character `start`.
    fn number(&mut self, start: usize) -> Result<f64, FormulaError> {
        let mut i = self.after_digits(start);
        if self.get(i) == Some('.') {
            i = self.after_digits(i + 1);
        }
        // `2e3` is a number; `2e` and `2e x` are twice Euler's number.
        if matches!(self.get(i), Some('e' | 'E')) {
            let sign = usize::from(matches!(self.get(i + 1), Some('+' | '-')));
            let end = self.after_digits(i + 1 + sign);
            if end > i + 1 + sign {
                i = end;
            }
        }
        self.next = i;
        let written = self.written(start, i);
        // A number of C in single precision.
        if let Some(suffix @ ('f' | 'F')) = self.get(i)
            && written.len() > 1
            && written.contains(['.', 'e', 'E'])
            && !self.get(i + 1).is_some_and(continues_name)
            && !self.names(suffix)
        {
            self.next = i + 1;
        }
        let second_point = self.get(i) == Some('.');
        let value = if written == "." || second_point { None } else { written.parse::<f64>().ok() };
        let Some(value) = value else {
            let point = self.span(start, start).start;
            if let Some(error) = component_error(self.text, &self.tokens, point) {
                return Err(error);
            }
            let span = self.span(start, (i + usize::from(second_point)).max(start + 1));
            let message = format!("`{}` is not a number", slice(self.text, &span));
            return Err(FormulaError::new(ErrorKind::BadNumber, span, message));
        };
        if !value.is_finite() {
            let message = format!("`{written}` is too large to be a number");
            return Err(FormulaError::new(ErrorKind::NotFinite, self.span(start, i), message));
        }
        Ok(value)
    }

    /// Whether a letter is used somewhere as a name of its own, not after a number.
    fn names(&self, letter: char) -> bool {
        let is_alone = |at: usize| {
            let before = at.checked_sub(1).and_then(|before| self.get(before));
            !before.is_some_and(|c| continues_name(c) || c == '.')
                && !self.get(at + 1).is_some_and(continues_name)
        };
        let mut places = self.characters.iter().enumerate().filter(|&(_, &(_, c))| c == letter);
        self.declared.contains(&letter.to_string().as_str()) || places.any(|(at, _)| is_alone(at))
    }

    /// Consumes the superscript integer that begins at character `start`; a larger one counts as
    /// the largest `i32`.
    fn superscript(&mut self, start: usize) -> Result<i32, FormulaError> {
        let negative = self.get(start) == Some('⁻');
        let first = start + usize::from(negative);
        let mut value: i64 = 0;
        self.next = first;
        while let Some(digit) = self.get(self.next).and_then(superscript) {
            value = (value * 10 + digit).min(i64::from(i32::MAX));
            self.next += 1;
        }
        if self.next == first {
            let message = "A raised minus needs raised digits after it, as in `x⁻²`";
            let span = self.span(start, first);
            return Err(FormulaError::new(ErrorKind::UnexpectedSymbol, span, message));
        }
        let value = i32::try_from(value).unwrap_or(i32::MAX);
        Ok(if negative { -value } else { value })
    }
}

/// Error for a sign such as `≠`.
fn unequal(span: Range<usize>) -> FormulaError {
    let message =
        "A surface is where two sides are equal: write `=`; a condition compares by `<`, `<=`, `>` or `>=`";
    FormulaError::new(ErrorKind::UnexpectedCharacter, span, message).suggest("=")
}

/// Error for a character that is not part of the language.
fn unexpected_character(text: &str, c: char, span: Range<usize>) -> FormulaError {
    let written = slice(text, &span);
    let point = u32::from(c);
    let name = match c {
        '\0' => "a null character",
        '\u{200B}'..='\u{200D}' | '\u{2060}' => "an invisible joiner or space",
        '\u{200E}' | '\u{200F}' | '\u{202A}'..='\u{202E}' | '\u{2066}'..='\u{2069}' | '\u{061C}' => {
            "an invisible text-direction mark"
        }
        '\u{FFFD}' => "a replacement character, left by a damaged text",
        _ if c.is_control() => "a control character",
        _ => "",
    };
    let message = if name.is_empty() {
        format!("`{written}` (U+{point:04X}) means nothing in a formula")
    } else {
        format!("U+{point:04X}, {name}, cannot stand in a formula")
    };
    let error = FormulaError::new(ErrorKind::UnexpectedCharacter, span, message);
    if name.is_empty() { error } else { error.suggest("") }
}
