//! Missions written at random by the grammar of SPEC 1.2, with blanks and comments in random places.

/// A mission without syntax errors; the same for the same seed.
pub(crate) fn mission(seed: u64) -> String {
    let mut writer = Writer { state: seed | 1, out: String::new() };
    for _ in 0..=writer.below(4) {
        writer.declaration();
    }
    writer.out
}

struct Writer {
    state: u64,
    out: String,
}

const BLANKS: [&str; 10] =
    [" ", " ", " ", " ", "  ", "\n", "\n\n\n", " /* note */ ", " // note\n", "\n  // own line\n"];
const NAMES: [&str; 6] = ["A", "B1", "Drive-To", "P_OK", "Q", "x_1"];

impl Writer {
    fn below(&mut self, limit: u64) -> u64 {
        self.state ^= self.state << 13;
        self.state ^= self.state >> 7;
        self.state ^= self.state << 17;
        (self.state >> 11) % limit
    }

    fn put(&mut self, token: &str) {
        let blank = BLANKS[self.below(BLANKS.len() as u64) as usize];
        self.out.push_str(token);
        self.out.push_str(blank);
    }

    fn all(&mut self, tokens: &[&str]) {
        for token in tokens {
            self.put(token);
        }
    }

    fn name(&mut self) {
        let name = NAMES[self.below(NAMES.len() as u64) as usize];
        self.put(name);
    }

    fn declaration(&mut self) {
        match self.below(14) {
            0 => self.all(&["var", "P", ":", "{", "OK", ",", "BAD", "}", ";"]),
            1 => self.all(&["primitive", "A", "(", "to", ")", "[", "1", ",", "2.5", "]", ";"]),
            2 => self.all(&["location", "SITE", "(", "1", ",", "-", "2", ")", ";"]),
            3 => self.all(&["option", "threat_gap", "=", "2", ";"]),
            13 => {
                self.all(&["keepout", "Area", "circle", "(", "1", ",", "2", ",", "3", ")", "for", "R", ";"]);
            }
            4 => self.all(&["obstacle", "Rock", "circle", "(", "1", ",", "2", ",", "3", ")", ";"]),
            5 => self.all(&["state", "P", ":", "{", "OK", ",", "BAD", "}", "=", "OK", ";"]),
            6 => self.all(&["resource", "R", "0", "..", "9", "*", "x", "=", "(", "3", ")", ";"]),
            7 => self.all(&[
                "objective",
                "minimize",
                "-",
                "2",
                "*",
                "cost",
                "+",
                "end",
                ",",
                "maximize",
                "reward",
                ";",
            ]),
            8 | 9 => {
                self.all(&["primitive", "A", "(", "to", ")", "[", "1", ",", "2.5", "]"]);
                for _ in 0..self.below(5) {
                    self.clause();
                }
                self.put(";");
            }
            10 => {
                self.all(&["scenario", "Day", "[", "0", ",", "90", "]", "="]);
                self.block(3);
            }
            _ => {
                self.name();
                self.all(&["(", "x", ")", "[", "l", ",", "u", "]", "="]);
                self.block(4);
                if self.below(2) == 0 {
                    self.put(";");
                }
            }
        }
    }

    fn clause(&mut self) {
        match self.below(6) {
            0 => {
                self.put("requires");
                if self.below(2) == 0 {
                    self.all(&["at", "start"]);
                }
                self.condition();
            }
            1 => self.all(&["sets", "X", "=", "to", ",", "V.at", "=", "to"]),
            2 => self.all(&["uses", "R", ",", "P", "2", "*", "to"]),
            3 => self.all(&["consumes", "R", "(", "2", "+", "to", ")", "per", "minute"]),
            4 => self.all(&["costs", "2", "per", "metre"]),
            _ => self.all(&["rewards", "to"]),
        }
    }

    fn block(&mut self, depth: u64) {
        self.put("{");
        for step in 0..self.below(4) {
            if step > 0 {
                self.put(";");
            }
            self.statement(depth);
            while self.below(4) == 0 {
                self.put(",");
                self.statement(depth);
            }
        }
        self.put("}");
    }

    fn statement(&mut self, depth: u64) {
        match self.below(if depth == 0 { 5 } else { 12 }) {
            0 => {
                self.name();
                self.all(&["(", "SITE", ",", "-", "3", ")"]);
                self.bounds();
            }
            1 => {
                self.condition();
                self.bounds();
            }
            2 => {
                self.put("delay");
                self.bounds();
            }
            3 => {
                self.put("tell");
                self.condition();
            }
            4 => {
                self.name();
                self.bounds();
            }
            5 => {
                self.block(depth - 1);
                self.bounds();
            }
            6 => {
                self.all(&["choose", "{"]);
                self.statement(depth - 1);
                while self.below(2) == 0 {
                    self.put(",");
                    self.statement(depth - 1);
                    if self.below(2) == 0 {
                        self.put(";");
                        self.statement(depth - 1);
                    }
                }
                self.put("}");
            }
            7 => {
                self.put("optional");
                self.block(depth - 1);
                self.bounds();
            }
            8 => {
                self.put("unordered");
                self.block(depth - 1);
                self.bounds();
            }
            9 => {
                self.put("do");
                self.statement(depth - 1);
                self.all(&["using", "R", "2", "*", "x"]);
                self.bounds();
            }
            10 => {
                self.put("do");
                self.statement(depth - 1);
                let word = if self.below(2) == 0 { "maintaining" } else { "watching" };
                self.put(word);
                self.condition();
                self.bounds();
            }
            _ => {
                self.put("if");
                self.condition();
                self.put("thennext");
                self.statement(depth - 1);
            }
        }
    }

    fn condition(&mut self) {
        match self.below(6) {
            0 => {
                self.put("not");
                self.condition();
            }
            1 => {
                self.put("(");
                self.condition();
                self.put(")");
            }
            2 => {
                self.put("!");
                self.condition();
            }
            3 => {
                self.name();
                let operator = if self.below(2) == 0 { "=" } else { "!=" };
                self.put(operator);
                self.name();
            }
            4 => self.all(&["V.at", "=", "SITE"]),
            _ => self.name(),
        }
    }

    fn bounds(&mut self) {
        match self.below(5) {
            0 => self.all(&["[", "l", "*", "90", "%", ",", "u", "-", "(", "l", "+", "1", ")", "]"]),
            1 => self.all(&["[", "0", ",", "inf", "]"]),
            2 => self.all(&["contingent", "[", "l", ",", "2", "*", "l", "]"]),
            _ => {}
        }
    }
}
