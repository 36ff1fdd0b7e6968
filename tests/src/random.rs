//! Small random missions in which anything may happen: every construct, tight bounds, conditions, threats.

use tpn::generate::Rng;

/// The text of mission number `seed`. About half of them have a plan; most have at least one condition.
pub fn small_mission(seed: u64) -> String {
    let mut maker = Maker { rng: Rng::new(seed), leaves: 0 };
    maker.leaves = maker.rng.between(3, 8);
    let threads: Vec<String> = (0..maker.rng.between(1, 3)).map(|_| maker.thread()).collect();
    let horizon = match maker.rng.below(4) {
        0 => String::new(),
        1 => format!("[0,{}]", maker.rng.between(4, 12)),
        2 => format!("[0,{}]", maker.rng.between(10, 30)),
        _ => format!("[{},{}]", maker.rng.between(0, 10), maker.rng.between(10, 40)),
    };
    let declared = if maker.rng.chance(50) { "var MODE : {A, B, C};\n" } else { "" };
    format!("{declared}scenario S{horizon} = {{ {} }}\n", threads.join(", "))
}

/// The text of crowded mission number `seed`: several intervals that exclude each other, most of them touching in the
/// schedule that the mission is built around, so that it depends on the choices which of them may touch.
pub fn crowded_mission(seed: u64) -> String {
    let mut rng = Rng::new(seed ^ 0xC0_0D3D);
    let mut now = if rng.chance(70) { 0 } else { rng.between(1, 3) };
    let mut threads: Vec<String> = Vec::new();
    for index in 0..rng.between(3, 4) {
        let length = rng.between(0, 3);
        let longest = length + if rng.chance(20) { rng.between(1, 2) } else { 0 };
        let value = ["A", "B", "C"][(index as u64 + rng.below(2)) as usize % 3];
        let lead = lead(&mut rng, now);
        let end = if rng.chance(15) { format!("; delay{}", exactly(&mut rng)) } else { String::new() };
        threads.push(format!("{{ {lead}MODE={value} [{length},{longest}]{end} }}"));
        now += length + i64::from(rng.chance(25));
    }
    if rng.chance(30) {
        threads.push(format!("choose {{ P0(){}, P1(){} }}", exactly(&mut rng), exactly(&mut rng)));
    }
    if rng.chance(20) {
        threads.push(format!("{{ {}ask MODE=B [0,1] }}", lead(&mut rng, now)));
    }
    // In any textual order.
    for position in 0..threads.len() {
        let other = position + rng.below((threads.len() - position) as u64) as usize;
        threads.swap(position, other);
    }
    let horizon = (now + rng.between(-1, 1)).max(0);
    let bounds = if rng.chance(80) { format!("[0,{horizon}]") } else { String::new() };
    format!("var MODE : {{A, B, C}};\nscenario S{bounds} = {{ {} }}\n", threads.join(", "))
}

/// The text of mission number `seed` without any condition, state or resource: activities, sequences, parallel blocks and
/// choices, with bounds of which about half leave too little time.
pub fn timed_mission(seed: u64) -> String {
    let mut rng = Rng::new(seed ^ 0x71_3D);
    let body = timed_block(&mut rng, 3);
    let horizon = rng.between(4, 24);
    format!("scenario S[0,{horizon}] = {{ {body} }}\n")
}

fn timed_block(rng: &mut Rng, depth: u32) -> String {
    let (open, separator) = match rng.below(4) {
        0 => ("{", ", "),
        1 => ("{", "; "),
        _ => ("choose {", ", "),
    };
    let count = rng.between(2, 3);
    let items: Vec<String> = (0..count)
        .map(|_| {
            if depth > 0 && rng.chance(60) {
                return timed_block(rng, depth - 1);
            }
            let shortest = rng.between(0, 9);
            let bounds = format!("[{shortest},{}]", shortest + rng.between(0, 4));
            if rng.chance(20) { format!("delay{bounds}") } else { format!("P{}(){bounds}", rng.below(4)) }
        })
        .collect();
    let shortest = rng.between(0, 6);
    let bounds =
        if rng.chance(30) { format!("[{shortest},{}]", shortest + rng.between(0, 9)) } else { String::new() };
    format!("{open} {} }}{bounds}", items.join(separator))
}

/// Returns what comes before an interval that begins at `time` in the schedule that a mission is built around: that
/// time, any time, or a choice.
fn lead(rng: &mut Rng, time: i64) -> String {
    let (exact, other) = (format!("[{time},{time}]"), exactly(rng));
    match rng.below(7) {
        0 => "delay[0,inf]; ".to_owned(),
        1 => format!("delay{exact}; "),
        2 | 3 => format!("choose {{ delay[0,inf], delay{exact} }}; "),
        4 => format!("choose {{ delay{other}, delay{exact} }}; "),
        5 => format!("choose {{ delay{other}, delay[0,{}], delay{exact} }}; ", time + 1),
        _ => format!("choose {{ delay{exact}, delay{other} }}; "),
    }
}

fn exactly(rng: &mut Rng) -> String {
    let time = rng.between(0, 6);
    format!("[{time},{time}]")
}

struct Maker {
    rng: Rng,
    /// How many more leaves the mission may have.
    leaves: i64,
}

impl Maker {
    fn thread(&mut self) -> String {
        let count = self.rng.between(1, 3);
        let items: Vec<String> = (0..count).map(|_| self.statement(2)).collect();
        let lead = match self.rng.below(3) {
            0 => "delay[0,inf]; ".to_owned(),
            1 => format!("delay[0,{}]; ", self.rng.between(1, 8)),
            _ => String::new(),
        };
        format!("{{ {lead}{} }}", items.join("; "))
    }

    fn statement(&mut self, depth: u32) -> String {
        if depth == 0 || self.leaves <= 1 {
            return self.leaf();
        }
        match self.rng.below(12) {
            0 => self.block("; ", depth),
            1 => self.block(", ", depth),
            2 | 3 => {
                let count = self.rng.between(2, 3);
                let alternatives: Vec<String> = (0..count).map(|_| self.statement(depth - 1)).collect();
                let bounds = self.maybe_bounds();
                format!("choose {{ {} }}{bounds}", alternatives.join(", "))
            }
            4 => {
                let body = self.block("; ", depth - 1);
                let condition = self.condition();
                format!(
                    "do {body} {} {condition}",
                    if self.rng.chance(60) { "maintaining" } else { "watching" }
                )
            }
            5 => {
                let condition = self.condition();
                format!("if {condition} thennext {}", self.statement(depth - 1))
            }
            _ => self.leaf(),
        }
    }

    fn block(&mut self, separator: &str, depth: u32) -> String {
        let count = self.rng.between(1, 2) + i64::from(separator == ", ");
        let items: Vec<String> = (0..count).map(|_| self.statement(depth.saturating_sub(1))).collect();
        let bounds = self.maybe_bounds();
        format!("{{ {} }}{bounds}", items.join(separator))
    }

    fn leaf(&mut self) -> String {
        self.leaves -= 1;
        let bounds = self.bounds();
        match self.rng.below(10) {
            0 | 1 => format!("P{}(){bounds}", self.rng.below(3)),
            2 => format!("delay{bounds}"),
            3..=6 => format!("{} {}", self.condition(), if self.rng.chance(85) { &bounds } else { "" }),
            7 => format!("ask {} {}", self.condition(), if self.rng.chance(70) { &bounds } else { "" }),
            8 => format!("do P{}(){bounds} maintaining {}", self.rng.below(3), self.condition()),
            _ => format!("do P{}(){bounds} watching {}", self.rng.below(3), self.condition()),
        }
    }

    fn condition(&mut self) -> String {
        let negation = if self.rng.chance(25) { "not " } else { "" };
        match self.rng.below(5) {
            0 | 1 => format!("{negation}c"),
            2 => format!("{negation}MODE_A"),
            3 => format!("MODE={}", ["A", "B", "C"][self.rng.below(3) as usize]),
            _ => format!("{negation}MODE=A"),
        }
    }

    fn bounds(&mut self) -> String {
        let lower = self.rng.between(0, 5);
        match self.rng.below(5) {
            0 => format!("[{lower},{lower}]"),
            1 => format!("[{lower},inf]"),
            _ => format!("[{lower},{}]", lower + self.rng.between(0, 6)),
        }
    }

    fn maybe_bounds(&mut self) -> String {
        if self.rng.chance(30) { self.bounds() } else { String::new() }
    }
}
