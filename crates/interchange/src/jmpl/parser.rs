//! From tokens to trees: one function for each production.

use super::error::JmplError;
use super::lexer::{Token, lex};
use super::syntax::{
    Arc, Attribute, Case, Class, Enum, Expression, File, Path, Place, Relation, Statement, StatementKind,
};

/// Statements and conditions nest at most this deep.
const MAX_DEPTH: usize = 100;

/// Reads the text of the file with the number `number`.
pub(super) fn parse(text: &str, name: &str, number: usize) -> Result<File, JmplError> {
    let tokens = lex(text, name)?;
    let mut parser = Parser { tokens: &tokens, at: 0, name, number, depth: 0 };
    let mut file = File::default();
    while parser.at < tokens.len() {
        if parser.eat_word("enum") {
            let (declared, _) = parser.enumeration()?;
            file.enums.push(declared);
        } else if parser.eat_word("class") {
            file.classes.push(parser.class()?);
        } else if !parser.eat(';') {
            return Err(parser.expected("`class` or `enum`"));
        }
    }
    Ok(file)
}

struct Parser<'text> {
    tokens: &'text [(Token, u32)],
    at: usize,
    name: &'text str,
    number: usize,
    depth: usize,
}

impl Parser<'_> {
    fn peek(&self) -> Option<&Token> {
        self.tokens.get(self.at).map(|(token, _)| token)
    }

    /// The line of the next token, or of the last one.
    fn line(&self) -> u32 {
        self.tokens.get(self.at).or_else(|| self.tokens.last()).map_or(1, |(_, line)| *line)
    }

    fn place(&self) -> Place {
        Place { file: self.number, line: self.line() }
    }

    fn error(&self, what: &str) -> JmplError {
        JmplError::shape(self.name, self.line(), what)
    }

    fn expected(&self, what: &str) -> JmplError {
        let found = self.peek().map_or_else(|| "the end of the file".to_owned(), ToString::to_string);
        self.error(&format!("expected {what}, found {found}"))
    }

    fn is(&self, sign: char) -> bool {
        self.peek() == Some(&Token::Sign(sign))
    }

    fn eat(&mut self, sign: char) -> bool {
        let is_next = self.is(sign);
        self.at += usize::from(is_next);
        is_next
    }

    fn need(&mut self, sign: char) -> Result<(), JmplError> {
        if self.eat(sign) { Ok(()) } else { Err(self.expected(&format!("`{sign}`"))) }
    }

    fn is_word(&self, word: &str) -> bool {
        matches!(self.peek(), Some(Token::Word(text)) if text.eq_ignore_ascii_case(word))
    }

    fn eat_word(&mut self, word: &str) -> bool {
        let is_next = self.is_word(word);
        self.at += usize::from(is_next);
        is_next
    }

    fn word(&mut self, what: &str) -> Result<String, JmplError> {
        match self.peek() {
            Some(Token::Word(text)) => {
                let text = text.clone();
                self.at += 1;
                Ok(text)
            }
            _ => Err(self.expected(what)),
        }
    }

    /// Reads what `read` reads, one level deeper.
    fn deeper<T>(&mut self, read: impl FnOnce(&mut Self) -> Result<T, JmplError>) -> Result<T, JmplError> {
        if self.depth == MAX_DEPTH {
            return Err(self.error(&format!("statements nest more than {MAX_DEPTH} deep")));
        }
        self.depth += 1;
        let answer = read(self);
        self.depth -= 1;
        answer
    }

    /// Reads `name { values } variables { relations } ;` after `enum`: the type, and the variables of it.
    fn enumeration(&mut self) -> Result<(Enum, Vec<String>), JmplError> {
        let (mut values, mut numbers, mut relations, mut variables) =
            (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let line = self.line();
        let name =
            if self.is('{') { format!("enumeration-{line}") } else { self.word("the name of a type")? };
        self.need('{')?;
        while !self.eat('}') {
            let value = self.word("a value")?;
            if self.eat('=') {
                let Some(Token::Text(number) | Token::Number(number)) = self.peek() else {
                    return Err(self.expected("a number"));
                };
                numbers.push((value.clone(), number.clone()));
                self.at += 1;
            }
            values.push(value);
            if !self.eat(',') && !self.is('}') {
                return Err(self.expected("`,` or `}`"));
            }
        }
        while matches!(self.peek(), Some(Token::Word(_))) && self.tokens_follow_a_variable() {
            variables.push(self.word("a name")?);
            self.eat(',');
        }
        if self.eat('{') {
            while !self.eat('}') {
                if !self.eat_word("relation") {
                    return Err(self.expected("`relation`"));
                }
                relations.push(self.relation()?);
            }
        }
        self.eat(';');
        Ok((Enum { name, values, numbers, relations }, variables))
    }

    /// Returns whether the word that follows is a variable of an enumeration, and not the start of something else.
    fn tokens_follow_a_variable(&self) -> bool {
        let next = self.tokens.get(self.at + 1).map(|(token, _)| token);
        matches!(next, Some(Token::Sign(',' | ';' | '{')))
    }

    fn class(&mut self) -> Result<Class, JmplError> {
        let place = self.place();
        let name = self.word("the name of a class")?;
        let parent = if self.eat_word("extends") { Some(self.word("the name of a class")?) } else { None };
        let mut class = Class {
            name,
            parent,
            enums: Vec::new(),
            attributes: Vec::new(),
            state: Vec::new(),
            arcs: Vec::new(),
            relations: Vec::new(),
            statements: Vec::new(),
            place,
        };
        self.need('{')?;
        while !self.eat('}') {
            self.class_entry(&mut class)?;
        }
        Ok(class)
    }

    fn class_entry(&mut self, class: &mut Class) -> Result<(), JmplError> {
        let place = self.place();
        let is_private = self.eat_word("private");
        if !is_private {
            self.eat_word("public");
        }
        if self.eat(';') {
        } else if self.is('{') {
            class.statements.push(self.statement()?);
        } else if self.eat_word("stateVector") {
            class.state = self.vector()?;
            self.need(';')?;
        } else if self.eat_word("transition") {
            class.arcs.push(self.arc(false)?);
        } else if self.eat_word("failure") {
            class.arcs.push(self.arc(true)?);
        } else if self.eat_word("relation") {
            class.relations.push(self.relation()?);
        } else if self.eat_word("enum") {
            let (declared, variables) = self.enumeration()?;
            let kind = declared.name.clone();
            class.enums.push(declared);
            let attribute = |name| Attribute { name, kind: kind.clone(), is_private, place };
            class.attributes.extend(variables.into_iter().map(attribute));
        } else {
            let kind = self.word("an attribute, a transition, a failure, a relation or `{`")?;
            loop {
                let name = self.word("the name of an attribute")?;
                class.attributes.push(Attribute { name, kind: kind.clone(), is_private, place });
                if !self.eat(',') {
                    break;
                }
            }
            self.need(';')?;
        }
        Ok(())
    }

    /// Reads `mode`, `*`, `+`, `.`, or such in brackets.
    fn vector(&mut self) -> Result<Vec<String>, JmplError> {
        if !self.eat('[') {
            return Ok(vec![self.state_name()?]);
        }
        let mut names = vec![self.state_name()?];
        while self.eat(',') {
            names.push(self.state_name()?);
        }
        self.need(']')?;
        Ok(names)
    }

    fn state_name(&mut self) -> Result<String, JmplError> {
        let sign = ['*', '+', '.'].into_iter().find(|sign| self.eat(*sign));
        sign.map_or_else(|| self.word("a mode, `*`, `+` or `.`"), |sign| Ok(sign.to_string()))
    }

    /// Reads a transition or a failure after its keyword.
    fn arc(&mut self, is_failure: bool) -> Result<Arc, JmplError> {
        let place = self.place();
        if matches!(self.peek(), Some(Token::Word(_))) {
            self.at += 1;
        }
        self.need('(')?;
        let from = self.vector()?;
        self.need(',')?;
        let to = self.vector()?;
        let mut weight = None;
        if self.eat(',') {
            match self.peek() {
                Some(Token::Word(text) | Token::Number(text)) => weight = Some(text.clone()),
                _ => return Err(self.expected("a number or its name")),
            }
            self.at += 1;
        }
        self.need(')')?;
        let body = if self.is('{') { self.block()? } else { Vec::new() };
        self.eat(';');
        Ok(Arc { is_failure, from, to, weight, body, place })
    }

    fn relation(&mut self) -> Result<Relation, JmplError> {
        let name = self.word("the name of a relation")?;
        let mut parameters = Vec::new();
        self.need('(')?;
        while !self.eat(')') {
            self.word("the type of a parameter")?;
            parameters.push(self.word("the name of a parameter")?);
            if !self.eat(',') && !self.is(')') {
                return Err(self.expected("`,` or `)`"));
            }
        }
        Ok(Relation { name, parameters, body: self.block()? })
    }

    /// Reads `{ statements }`.
    fn block(&mut self) -> Result<Vec<Statement>, JmplError> {
        self.need('{')?;
        let mut statements = Vec::new();
        while !self.eat('}') {
            statements.push(self.statement()?);
        }
        Ok(statements)
    }

    fn statement(&mut self) -> Result<Statement, JmplError> {
        self.deeper(Self::statement_here)
    }

    fn statement_here(&mut self) -> Result<Statement, JmplError> {
        let place = self.place();
        let kind = if self.eat(';') {
            StatementKind::Group(Vec::new())
        } else if self.is('{') {
            StatementKind::Group(self.block()?)
        } else if self.eat_word("if") {
            let condition = self.condition()?;
            let then = Box::new(self.statement()?);
            let otherwise = if self.eat_word("else") { Some(Box::new(self.statement()?)) } else { None };
            StatementKind::If { condition, then, otherwise }
        } else if self.eat_word("iff") {
            StatementKind::Iff { condition: self.condition()?, body: Box::new(self.statement()?) }
        } else if self.is_word("switch") {
            self.at += 1;
            self.need('(')?;
            let on = self.path()?;
            self.need(')')?;
            StatementKind::Switch { on, cases: self.cases()? }
        } else {
            let holds = self.expression()?;
            self.need(';')?;
            StatementKind::Holds(holds)
        };
        Ok(Statement { kind, place })
    }

    fn condition(&mut self) -> Result<Expression, JmplError> {
        self.need('(')?;
        let condition = self.expression()?;
        self.need(')')?;
        Ok(condition)
    }

    fn cases(&mut self) -> Result<Vec<Case>, JmplError> {
        let mut cases = Vec::new();
        self.need('{')?;
        while !self.eat('}') {
            let (mut values, mut body) = (Vec::new(), Vec::new());
            while self.eat_word("case") {
                values.push(self.word("a value")?);
                self.need(':')?;
            }
            if values.is_empty() {
                return Err(self.expected("`case`"));
            }
            while !self.is('}') && !self.is_word("case") {
                body.push(self.statement()?);
            }
            cases.push((values, body));
        }
        Ok(cases)
    }

    fn expression(&mut self) -> Result<Expression, JmplError> {
        self.deeper(|parser| parser.joined('|', Expression::Any, Self::conjunction))
    }

    fn conjunction(&mut self) -> Result<Expression, JmplError> {
        self.joined('&', Expression::All, Self::negation)
    }

    fn joined(
        &mut self,
        sign: char,
        join: fn(Vec<Expression>) -> Expression,
        part: fn(&mut Self) -> Result<Expression, JmplError>,
    ) -> Result<Expression, JmplError> {
        let mut parts = vec![part(self)?];
        while self.eat(sign) {
            parts.push(part(self)?);
        }
        Ok(if parts.len() == 1 { parts.swap_remove(0) } else { join(parts) })
    }

    fn negation(&mut self) -> Result<Expression, JmplError> {
        if self.eat('!') {
            return Ok(Expression::Not(Box::new(self.deeper(Self::negation)?)));
        }
        if self.eat('(') {
            let inside = self.expression()?;
            self.need(')')?;
            return Ok(inside);
        }
        let left = self.path()?;
        if self.eat('=') {
            return Ok(Expression::Equal(left, self.path()?));
        }
        if self.eat('≠') {
            return Ok(Expression::Not(Box::new(Expression::Equal(left, self.path()?))));
        }
        if !self.eat('(') {
            return Err(self.expected("`=`, `!=` or `(`"));
        }
        let mut arguments = Vec::new();
        while !self.eat(')') {
            arguments.push(self.path()?);
            if !self.eat(',') && !self.is(')') {
                return Err(self.expected("`,` or `)`"));
            }
        }
        Ok(Expression::Call(left, arguments))
    }

    fn path(&mut self) -> Result<Path, JmplError> {
        let mut path = vec![self.word("a name")?];
        while self.eat('.') {
            path.push(self.word("a name")?);
        }
        Ok(path)
    }
}
