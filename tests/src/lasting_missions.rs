//! Small random missions with state that lasts and with resources: few activities, whole bounds, a short horizon.

use tpn::generate::Rng;

/// What a mission has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kind {
    /// State variables, and who changes and requires them.
    pub has_states: bool,
    /// Reusable resources and reservoirs.
    pub has_resources: bool,
    /// Conditions on the level of the reservoir.
    pub has_levels: bool,
}

impl Kind {
    /// States without resources.
    pub const STATES: Self = Self { has_states: true, has_resources: false, has_levels: false };
    /// Resources without states.
    pub const RESOURCES: Self = Self { has_states: false, has_resources: true, has_levels: false };
    /// Both states and resources.
    pub const BOTH: Self = Self { has_states: true, has_resources: true, has_levels: false };
    /// Resources and conditions on levels.
    pub const LEVELS: Self = Self { has_states: false, has_resources: true, has_levels: true };
}

/// The text of mission number `seed` of a kind. All its bounds are whole and its horizon is at most 12.
pub fn lasting_mission(seed: u64, kind: Kind) -> String {
    let mut maker = Maker { rng: Rng::new(seed), kind, left: 0, capacity: 0, room: 0, has_second: false };
    maker.left = maker.rng.between(2, 5);
    let declared = maker.declarations();
    let primitives: Vec<String> = (0..PRIMITIVES).map(|index| maker.primitive(index)).collect();
    let threads: Vec<String> = (0..maker.rng.between(2, 3)).map(|_| maker.thread()).collect();
    let horizon = maker.rng.between(4, 12);
    let body = if kind.has_resources && maker.rng.chance(15) {
        format!("unordered {{ {} }}", threads.join("; "))
    } else {
        threads.join(", ")
    };
    format!("{declared}{}scenario S[0,{horizon}] = {{ {body} }}\n", primitives.concat())
}

const PRIMITIVES: u64 = 4;

struct Maker {
    rng: Rng,
    kind: Kind,
    /// How many more activities the mission may have.
    left: i64,
    /// Of the reusable resource.
    capacity: i64,
    /// Between the minimum and the maximum level of the reservoir.
    room: i64,
    /// Whether there is a second state variable.
    has_second: bool,
}

impl Maker {
    fn declarations(&mut self) -> String {
        let mut declared = String::new();
        if self.kind.has_states {
            declared.push_str("state X : {A, B, C} = A;\n");
            self.has_second = self.rng.chance(30);
            if self.has_second {
                declared.push_str("state DOOR : {OPEN, SHUT} = SHUT;\n");
            }
        }
        if self.kind.has_resources {
            self.capacity = self.rng.between(1, 4);
            self.room = self.rng.between(2, 5);
            let least = self.rng.between(0, 1);
            let (greatest, level) = (least + self.room, least + self.rng.between(0, self.room));
            declared.push_str(&format!("resource R capacity {};\n", self.capacity));
            declared.push_str(&format!("resource T {least}..{greatest} = {level};\n"));
        }
        declared
    }

    fn primitive(&mut self, index: u64) -> String {
        let mut clauses = String::new();
        if self.kind.has_states {
            if self.rng.chance(50) {
                clauses.push_str(&format!(" requires {}", self.condition()));
            }
            if self.rng.chance(25) {
                clauses.push_str(&format!(" requires at start {}", self.condition()));
            }
            if self.rng.chance(50) {
                clauses.push_str(&format!(" sets X={}", self.value()));
                if self.has_second && self.rng.chance(30) {
                    clauses.push_str(", DOOR=OPEN");
                }
            } else if self.has_second && self.rng.chance(40) {
                let value = if self.rng.chance(50) { "OPEN" } else { "SHUT" };
                clauses.push_str(&format!(" sets DOOR={value}"));
            }
        }
        if self.kind.has_resources {
            if self.rng.chance(60) {
                clauses.push_str(&format!(" uses R {}", self.rng.between(0, self.capacity)));
            }
            if self.rng.chance(35) {
                clauses.push_str(&format!(" consumes T {}", self.rng.between(0, self.room.min(3))));
            }
            if self.rng.chance(35) {
                clauses.push_str(&format!(" produces T {}", self.rng.between(0, self.room.min(3))));
            }
        }
        if self.kind.has_levels && self.rng.chance(50) {
            let moment = if self.rng.chance(40) { " at start" } else { "" };
            clauses.push_str(&format!(" requires {}{moment}", self.level()));
        }
        format!("primitive P{index}(){clauses};\n")
    }

    fn thread(&mut self) -> String {
        let count = self.rng.between(1, 2);
        let items: Vec<String> = (0..count).map(|_| self.statement()).collect();
        let lead = match self.rng.below(4) {
            0 => String::new(),
            1 => format!("delay[0,{}]; ", self.rng.between(1, 6)),
            _ => "delay; ".to_owned(),
        };
        format!("{{ {lead}{} }}", items.join("; "))
    }

    fn statement(&mut self) -> String {
        if self.left <= 0 {
            return "delay[0,1]".to_owned();
        }
        match self.rng.below(12) {
            0 | 1 => format!("choose {{ {}, {} }}", self.activity(), self.activity()),
            2 => format!("{{ {}, {{ delay; {} }} }}", self.activity(), self.activity()),
            3 if self.kind.has_resources => {
                let amount = self.rng.between(1, self.capacity);
                format!("do {{ {}; delay[0,1] }} using R {amount}", self.activity())
            }
            4 if self.kind.has_states => {
                let condition = self.condition();
                format!("if {condition} thennext {}", self.activity())
            }
            _ => self.activity(),
        }
    }

    fn activity(&mut self) -> String {
        self.left -= 1;
        let bounds = self.bounds();
        let call = format!("P{}(){bounds}", self.rng.below(PRIMITIVES));
        if self.kind.has_levels {
            return match self.rng.below(12) {
                0 => format!("ask {} {bounds}", self.level()),
                1 => format!("do {{ {call}; delay[0,1] }} maintaining {}", self.level()),
                2 => format!("if {} thennext {call}", self.level()),
                3 => format!("if {} thennext {call} else delay[0,1]", self.level()),
                _ => call,
            };
        }
        if !self.kind.has_states {
            return call;
        }
        match self.rng.below(12) {
            0 | 1 => {
                let bounds = if self.rng.chance(40) { "" } else { &bounds };
                format!("X={} {bounds}", self.value())
            }
            2 => format!("ask {} {bounds}", self.condition()),
            3 => format!("do {call} watching {}", self.condition()),
            4 => format!("do {call} maintaining {}", self.condition()),
            _ => call,
        }
    }

    fn level(&mut self) -> String {
        let order = ["<", "<=", ">", ">="][self.rng.below(4) as usize];
        let bound = self.rng.between(0, self.room + 1);
        format!("{}T {order} {bound}", if self.rng.chance(15) { "not " } else { "" })
    }

    fn condition(&mut self) -> String {
        if self.has_second && self.rng.chance(30) {
            return "DOOR=OPEN".to_owned();
        }
        match self.rng.below(6) {
            0 => format!("not X={}", self.value()),
            1 => "X in {A, C}".to_owned(),
            _ => format!("X={}", self.value()),
        }
    }

    fn value(&mut self) -> &'static str {
        ["A", "B", "C"][self.rng.below(3) as usize]
    }

    fn bounds(&mut self) -> String {
        let lower = self.rng.between(0, 4);
        match self.rng.below(5) {
            0 => "[0,0]".to_owned(),
            1 => format!("[{lower},{}]", lower + self.rng.between(1, 3)),
            _ => format!("[{lower},{lower}]"),
        }
    }
}
