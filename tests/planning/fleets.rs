//! Missions of fleets (SPEC 17) against the same missions with every vehicle written out: the networks are equal but for names,
//! and so are the plans. The generator writes both texts from one mission and expands nothing with the program's own code.

use std::collections::BTreeSet;

use acceptance::mission::{first_plan, network};
use kirk::{Options, Search, Status, Unlimited};
use tpn::exchange::Exchangeable;
use tpn::generate::Rng;
use tpn::{LabelId, Network, Occurrence, Plan};

/// Random missions.
const MISSIONS: u64 = 200;

/// Who does something: a vehicle by its index, or what represents a member, by how many are around it.
#[derive(Clone, Copy)]
enum Who {
    Vehicle(usize),
    Member(usize),
}

enum Node {
    Work(usize, Who),
    Both(Who),
    Group(&'static str, Vec<Node>),
    Optional(Box<Node>),
    /// `any` or one of the forms of `each`, over the fleet alone or over all vehicles.
    Members {
        form: usize,
        is_fleet: bool,
        body: Box<Node>,
    },
}

const FORMS: [(&str, &str); 4] =
    [("any", ""), ("each", ""), ("each", " in sequence"), ("each", " unordered")];

struct Mission {
    /// How many vehicles the fleet has; one more is alone.
    fleet: usize,
    /// Of each primitive what follows the parameters; `@` represents the vehicle.
    clauses: Vec<String>,
    level: i64,
    horizon: i64,
    root: Node,
}

struct Maker {
    rng: Rng,
    left: i64,
    fleet: usize,
}

impl Maker {
    fn mission(seed: u64, most: i64) -> Mission {
        let mut maker = Self { rng: Rng::new(seed ^ 0xF1EE), left: 0, fleet: 0 };
        maker.left = maker.rng.between(1, 4);
        maker.fleet = maker.rng.between(1, most) as usize;
        let clauses = (0..3).map(|_| maker.clauses()).collect();
        let (level, horizon) = (maker.rng.between(0, 9), maker.rng.between(4, 14));
        let branches = (0..maker.rng.between(1, 2)).map(|_| maker.node(0, 0)).collect();
        Mission { fleet: maker.fleet, clauses, level, horizon, root: Node::Group("all", branches) }
    }

    fn clauses(&mut self) -> String {
        let least = self.rng.between(0, 2);
        let mut text = format!("[{least},{}]", least + self.rng.between(0, 2));
        if self.rng.chance(40) {
            let when = if self.rng.chance(50) { "at start " } else { "" };
            text.push_str(&format!(" requires {when}@drill={}", self.value()));
        }
        if self.rng.chance(40) {
            text.push_str(&format!(" sets @drill={}", self.value()));
        }
        if self.rng.chance(40) {
            text.push_str(" uses @arm");
        }
        if self.rng.chance(40) {
            let change = if self.rng.chance(60) { "consumes" } else { "produces" };
            text.push_str(&format!(" {change} @battery {}", self.rng.between(1, 5)));
        }
        text
    }

    fn value(&mut self) -> &'static str {
        ["A", "B"][self.rng.below(2) as usize]
    }

    fn who(&mut self, members: usize) -> Who {
        if members > 0 && self.rng.chance(80) {
            Who::Member(self.rng.below(members as u64) as usize)
        } else {
            Who::Vehicle(self.rng.below(self.fleet as u64 + 1) as usize)
        }
    }

    fn node(&mut self, depth: usize, members: usize) -> Node {
        self.left -= 1;
        let is_leaf = depth > 2 || self.left <= 0;
        match self.rng.below(if is_leaf { 3 } else { 9 }) {
            0 | 1 => {
                let who = self.who(members);
                Node::Work(self.rng.below(3) as usize, who)
            }
            2 => Node::Both(self.who(members)),
            3 => Node::Optional(Box::new(self.node(depth + 1, members))),
            4 => {
                let kind = ["sequence", "choose", "all"][self.rng.below(3) as usize];
                Node::Group(kind, (0..2).map(|_| self.node(depth + 1, members)).collect())
            }
            _ => {
                let form = self.rng.below(4) as usize;
                let is_fleet = self.rng.chance(50);
                Node::Members { form, is_fleet, body: Box::new(self.node(depth + 1, members + 1)) }
            }
        }
    }
}

impl Mission {
    /// The names of the vehicles, as fleets write them, or as names of their own.
    fn names(&self, is_short: bool) -> Vec<String> {
        let of_fleet = (1..=self.fleet)
            .map(|number| if is_short { format!("S[{number}]") } else { format!("S-{number}") });
        std::iter::once("R".to_owned()).chain(of_fleet).collect()
    }

    fn short(&self) -> String {
        let primitives = self.clauses.iter().enumerate();
        let primitives: String = primitives
            .map(|(index, clauses)| format!("primitive P{index}(r){};\n", clauses.replace('@', "r.")))
            .collect();
        format!(
            "location BASE (0, 0);\nmodel Scout {{ resource battery 0..9 = {}; resource arm; state drill : {{A, B}} = A; }}\n\
             vehicle R, S[1..{}] : Scout at BASE;\ngroup G = R, S;\n{primitives}Both(r) = {{ P0(r); P1(r) }}\n\
             scenario Sol[0,{}] = {{ {} }}\n",
            self.level,
            self.fleet,
            self.horizon,
            self.written(&self.root, &mut Vec::new(), true),
        )
    }

    fn long(&self) -> String {
        let names = self.names(false);
        let mut text = "location BASE (0, 0);\n".to_owned();
        for name in &names {
            text.push_str(&format!(
                "resource {name}-battery 0..9 = {}; resource {name}-arm; state {name}-drill : {{A, B}} = A;\n\
                 vehicle {name} : ATRV at BASE;\nBoth-{name}() = {{ P0-{name}(); P1-{name}() }}\n",
                self.level
            ));
            for (index, clauses) in self.clauses.iter().enumerate() {
                text.push_str(&format!(
                    "primitive P{index}-{name}(){};\n",
                    clauses.replace('@', &format!("{name}-"))
                ));
            }
        }
        let body = self.written(&self.root, &mut Vec::new(), false);
        text + &format!("scenario Sol[0,{}] = {{ {body} }}\n", self.horizon)
    }

    /// A statement, with members around it by index: in the long form with every member written out.
    fn written(&self, node: &Node, members: &mut Vec<usize>, is_short: bool) -> String {
        let names = self.names(is_short);
        let who = |who: &Who, members: &[usize]| match *who {
            Who::Member(at) if is_short => format!("m{at}"),
            Who::Member(at) => names[members[at]].clone(),
            Who::Vehicle(index) => names[index].clone(),
        };
        match node {
            Node::Work(index, by) if is_short => format!("P{index}({})", who(by, members)),
            Node::Work(index, by) => format!("P{index}-{}()", who(by, members)),
            Node::Both(by) if is_short => format!("Both({})", who(by, members)),
            Node::Both(by) => format!("Both-{}()", who(by, members)),
            Node::Optional(body) => format!("optional {{ {} }}", self.written(body, members, is_short)),
            Node::Group(kind, parts) => {
                let parts: Vec<String> = parts
                    .iter()
                    .map(|part| format!("{{ {} }}", self.written(part, members, is_short)))
                    .collect();
                grouped(kind, &parts)
            }
            Node::Members { form, is_fleet, body } if is_short => {
                let (word, order) = FORMS[*form];
                let group = if *is_fleet { "S" } else { "G" };
                let depth = members.len();
                members.push(0);
                let body = self.written(body, members, is_short);
                members.pop();
                format!("{word} m{depth} in {group}{order} {{ {body} }}")
            }
            Node::Members { form, is_fleet, body } => {
                let range = usize::from(*is_fleet)..=self.fleet;
                let copies = range.map(|member| {
                    members.push(member);
                    let body = self.written(body, members, is_short);
                    members.pop();
                    if *form == 1 { format!("free {{ {body} }}") } else { format!("{{ {body} }}") }
                });
                let copies: Vec<String> = copies.collect();
                grouped(["choose", "all", "sequence", "unordered"][*form], &copies)
            }
        }
    }
}

fn grouped(kind: &str, parts: &[String]) -> String {
    match kind {
        "choose" => format!("choose {{ {} }}", parts.join(", ")),
        "unordered" => format!("unordered {{ {} }}", parts.join("; ")),
        "sequence" => format!("{{ {} }}", parts.join("; ")),
        _ => format!("{{ {} }}", parts.join(", ")),
    }
}

/// Everything of a network but names and where it is written.
fn structure(network: &Network) -> Vec<String> {
    let arcs = network.arcs.iter().map(|arc| {
        format!("{}→{} [{},{}] {:?} {:?}", arc.from.0, arc.to.0, arc.lower, arc.upper, arc.kind, arc.labels)
    });
    let labels = network
        .labels
        .iter()
        .map(|it| format!("{:?} {:?} {:?} {:?}", it.arc, it.mode, it.extent, it.literal));
    let variables =
        network.variables.iter().map(|it| format!("{:?} {} {}", it.values, it.closed, it.is_lasting));
    let resources = network.resources.iter().map(|it| format!("{:?}", it.supply));
    let uses = network.uses.iter().map(|it| {
        format!("{:?} {:?} {} {:?} {:?} {:?}", it.resource, it.change, it.amount, it.arc, it.start, it.end)
    });
    let decisions = network.decisions.iter().map(|it| format!("{:?} {:?}", it.node, it.alternatives));
    arcs.chain(labels).chain(variables).chain(resources).chain(uses).chain(decisions).collect()
}

#[test]
fn a_fleet_means_what_its_vehicles_written_out_mean() {
    let (mut planned, mut failed) = (0, 0);
    for seed in 0..MISSIONS {
        let mission = Maker::mission(seed, 2);
        let (short, long) = (mission.short(), mission.long());
        let (of_short, of_long) = (network(&short), network(&long));
        assert_eq!(structure(&of_short), structure(&of_long), "mission {seed}:\n{short}\n{long}");
        for search in [Search::Chronological, Search::ConflictDirected] {
            let [one, other] = [&of_short, &of_long].map(|network| first_plan(network, search));
            assert_eq!(one.plans.len(), other.plans.len(), "mission {seed}:\n{short}\n{long}");
            for (one, other) in one.plans.iter().zip(&other.plans) {
                assert_eq!(one.choices, other.choices, "mission {seed}:\n{short}");
                assert_eq!(one.windows, other.windows, "mission {seed}:\n{short}");
                assert_eq!(one.causal_links, other.causal_links, "mission {seed}:\n{short}");
                assert_eq!(one.uses_ordered, other.uses_ordered, "mission {seed}:\n{short}");
            }
            *if one.plans.is_empty() { &mut failed } else { &mut planned } += 1;
        }
    }
    assert!(planned > 100 && failed > 50, "{planned} {failed}");
}

/// Returns what a plan does, and which vehicles do it: calls and links by where they are written, with their arguments,
/// where vehicles are exchanged.
fn done(network: &Network, plan: &Plan, exchanged: &dyn Fn(&str) -> String) -> Vec<String> {
    let call = |occurrence: &Occurrence| {
        let arguments: Vec<String> = occurrence.arguments.iter().map(|it| exchanged(it)).collect();
        format!("{:?} {arguments:?}", occurrence.span)
    };
    let label = |label: LabelId| {
        let label = &network.labels[label.index()];
        let owner = label.owner.map(|owner| call(&network.occurrences[owner.index()]));
        format!("{owner:?} {}", exchanged(&label.text))
    };
    let is_selected = |occurrence: &&Occurrence| {
        occurrence.arc.is_none_or(|arc| plan.selected_arcs[arc.index()])
            && plan.selected_nodes[occurrence.start.index()]
    };
    let calls = network.occurrences.iter().filter(is_selected).map(call);
    let links = plan.causal_links.iter().map(|link| format!("{} for {}", label(link.tell), label(link.ask)));
    let orders = plan.conflict_order.iter().map(|it| format!("{} < {}", label(it.first), label(it.then)));
    // What is first among those that give a value is compared in pairs.
    let changes = plan.state_order.iter().flat_map(|order| {
        let pairs = order.producers.iter().enumerate();
        pairs.flat_map(|(at, one)| order.producers[at + 1..].iter().map(move |other| (*one, *other)))
    });
    let changes = changes.map(|(one, other)| format!("{} before {}", label(one), label(other)));
    let mut done: Vec<String> = calls.chain(links).chain(orders).chain(changes).collect();
    done.sort();
    done
}

/// All ways in which so many vehicles take each other's place.
fn permutations(count: usize) -> Vec<Vec<usize>> {
    if count == 0 {
        return vec![Vec::new()];
    }
    let shorter = permutations(count - 1).into_iter();
    shorter
        .flat_map(|rest| {
            (0..count).map(move |at| {
                let mut all = rest.clone();
                all.insert(at, count - 1);
                all
            })
        })
        .collect()
}

/// Of the plans that a search lists without exchanging anything, one is left of those that are equal up to the names of the
/// fleet's vehicles, if the mission names none of these.
#[test]
fn plans_that_differ_in_exchanged_vehicles_are_listed_once() {
    let (mut exchanged, mut fewer, mut named) = (0, 0, 0);
    for seed in 0..16 * MISSIONS {
        let mission = Maker::mission(seed, 3);
        let text = mission.short();
        let scenario = &text[text.find("scenario").expect("a scenario")..];
        let network = network(&text);
        let mut plain = network.clone();
        plain.exchangeable = Exchangeable::default();
        let options =
            Options { all: true, max_plans: 200, explain: false, relax: false, ..Options::default() };
        let list = |network: &Network| kirk::plan(network, &options, &mut Unlimited);
        let all = list(&plain);
        if mission.fleet < 2 || all.status != Status::Plan {
            continue;
        }
        let listed = list(&network);
        if scenario.contains("S[") || scenario.contains("in sequence") {
            // What differs is told apart by the text, or by who is first.
            if scenario.contains("S[") && !scenario.contains("in sequence") && mission.fleet == 2 {
                named += 1;
                assert_eq!(listed.plans.len(), all.plans.len(), "mission {seed}:\n{text}");
            }
            continue;
        }
        let one = |plan: &Plan, order: &[usize]| {
            done(&network, plan, &|name| {
                let mut name = name.to_owned();
                for (from, to) in order.iter().enumerate() {
                    name = name.replace(&format!("S[{}]", from + 1), &format!("S<{}>", to + 1));
                }
                name.replace('<', "[").replace('>', "]")
            })
        };
        let orders = permutations(mission.fleet);
        let least = |plan: &Plan| orders.iter().map(|order| one(plan, order)).min();
        let mut distinct: Vec<Vec<String>> = all.plans.iter().map(|plan| one(plan, &[])).collect();
        distinct.sort();
        distinct.dedup();
        let is_told_by_calls = distinct.len() == all.plans.len();
        let classes = |plans: &[Plan]| plans.iter().filter_map(least).collect::<BTreeSet<_>>();
        assert_eq!(classes(&listed.plans), classes(&all.plans), "mission {seed}:\n{text}");
        if is_told_by_calls {
            exchanged += 1;
            fewer += u32::from(listed.plans.len() < all.plans.len());
            assert_eq!(listed.plans.len(), classes(&all.plans).len(), "mission {seed}:\n{text}");
        }
    }
    assert!(exchanged > 200 && fewer > 20 && named > 20, "{exchanged} {fewer} {named}");
}

/// Plans of three rovers, by what the scenario says: how many there are, and the first one's choices.
#[test]
fn exchanged_vehicles_make_no_other_plan() {
    let cases: [(&str, usize, &[u32]); 7] = [
        ("any r in S { Work(r) }; any r in S { Work(r) }", 2, &[0, 0]),
        ("any r in S { Work(r) }, any r in S { Work(r) }, any r in S { Work(r) }", 5, &[0, 0, 0]),
        ("each r in S { choose { Work(r), Rest(r) } }", 4, &[0, 0, 0]),
        ("each r in S unordered { Work(r) }", 1, &[]),
        ("each r in S { Turn(r) }", 1, &[]),
        ("each r in S in sequence { choose { Work(r), Rest(r) } }", 8, &[0, 0, 0]),
        // The mission names the second one, so only the others are equal.
        ("any r in S { Work(r) }; Rest(S[2])", 2, &[0]),
    ];
    for (scenario, count, first) in cases {
        let text = format!(
            "location BASE (0, 0); model Scout extends ATRV {{ state drill : {{IN, OUT}} = IN; }}
             vehicle S[1..3] : Scout at BASE; state ARM : {{FREE, BUSY}} = FREE;
             primitive Work(r)[1,2] requires r.drill=IN; primitive Rest(r : vehicle)[1,2];
             primitive Turn(r)[1,2] requires at start ARM=FREE sets ARM=FREE requires r.drill=IN;
             scenario Day[0,90] = {{ {scenario} }}"
        );
        let network = network(&text);
        let options = Options { all: true, ..Options::default() };
        let all = kirk::plan(&network, &options, &mut Unlimited);
        assert_eq!(all.plans.len(), count, "{scenario}");
        let choices: Vec<u32> = all.plans[0].choices.iter().map(|choice| choice.alternative).collect();
        assert_eq!(choices, first, "{scenario}");
        if !first.is_empty() {
            let best = kirk::plan(&network, &Options { best: 20, ..Options::default() }, &mut Unlimited);
            assert_eq!(best.plans.len(), count, "{scenario}");
        }
    }
}

/// Of equally good plans that differ in exchanged vehicles, the one is returned whose alternatives come first.
#[test]
fn the_first_alternatives_are_the_plan() {
    let text = "location BASE (0, 0); vehicle S[1..3] : ATRV at BASE;
         primitive Work(r : vehicle)[4,4] uses r.arm; model Scout extends ATRV { resource arm; }
         scenario Day[0,90] = { each site in Sites { any r in S { Work(r) } } }
         location A (1, 1); location B (2, 2); location C (3, 3); group Sites = A, B, C;
         objective minimize end;"
        .replace("S[1..3] : ATRV", "S[1..3] : Scout");
    let plan = first_plan(&network(&text), Search::ConflictDirected).plans.remove(0);
    let choices: Vec<u32> = plan.choices.iter().map(|choice| choice.alternative).collect();
    assert_eq!((choices, plan.quality.is_optimal), (vec![0, 1, 2], Some(true)));
}

/// Twenty rovers whose batteries last for four sites each, and sixty sites.
fn large_fleet() -> String {
    let mut rng = Rng::new(7);
    let mut sites = String::new();
    for site in 1..=60 {
        let (east, north) = (rng.between(0, 400), rng.between(0, 400));
        sites.push_str(&format!("location L{site} ({east}, {north});\n"));
    }
    let names: Vec<String> = (1..=60).map(|site| format!("L{site}")).collect();
    format!(
        "location BASE (200, 200);\n{sites}group Sites = {};
         model Scout extends ATRV {{ resource battery 0..100 = 90; resource arm; }}
         vehicle S[1..20] : Scout at BASE;
         primitive Drive(r, to)[1,120] moves r speed (0.1, 0.8) requires r.battery >= 30 at start consumes r.battery 5;
         primitive Survey(r, site)[10,15] requires r.at=site uses r.arm consumes r.battery 15;
         scenario Day[0,400] = {{ each site in Sites {{ any r in S {{ Drive(r, site); Survey(r, site) }} }} }}",
        names.join(", ")
    )
}

#[test]
fn a_large_fleet_shares_its_sites_without_trying_each_vehicle_for_each_site() {
    let network = network(&large_fleet());
    let plan = first_plan(&network, Search::ConflictDirected);
    assert_eq!(plan.plans.len(), 1);
    assert!(plan.stats.expanded < 20_000, "{:?}", plan.stats);
}

#[test]
fn that_a_large_fleet_has_too_little_is_proven() {
    // Each vehicle has enough for one site, and there are three for each.
    let network = network(&large_fleet().replace("consumes r.battery 15", "consumes r.battery 50"));
    let options = Options { explain: false, relax: false, ..Options::default() };
    assert_eq!(kirk::plan(&network, &options, &mut Unlimited).status, Status::NoPlan);
}

/// The same rovers without batteries, for which a site takes 20 minutes at least.
fn fleet_in_time(horizon: u32, objective: &str) -> String {
    let text = large_fleet()
        .replace(" requires r.battery >= 30 at start consumes r.battery 5", "")
        .replace(" consumes r.battery 15", "")
        .replace("[1,120] moves", "[10,120] moves")
        .replace("scenario Day[0,400]", &format!("scenario Day[0,{horizon}]"));
    format!("{text}{objective}")
}

#[test]
fn a_large_fleet_shares_its_sites_where_only_time_is_short() {
    // Three sites for each rover: no other share fits.
    let plan = first_plan(&network(&fleet_in_time(60, "")), Search::ConflictDirected);
    assert_eq!(plan.plans.len(), 1);
    assert!(plan.stats.conflicts < 1_000, "{:?}", plan.stats);
}

#[test]
fn that_a_large_fleet_has_too_little_time_is_proven() {
    let options = Options { explain: false, relax: false, ..Options::default() };
    let answer = kirk::plan(&network(&fleet_in_time(59, "")), &options, &mut Unlimited);
    assert_eq!(answer.status, Status::NoPlan);
    assert!(answer.stats.conflicts < 100, "{:?}", answer.stats);
}

#[test]
fn that_a_large_fleet_cannot_be_done_sooner_is_proven() {
    let network = network(&fleet_in_time(400, " objective minimize end;"));
    let answer = kirk::plan(&network, &Options::default(), &mut Unlimited);
    let plan = &answer.plans[0];
    let end = plan.windows[network.end.index()].map(|window| window.earliest);
    assert_eq!((end, plan.quality.is_optimal), (Some(exact::Time::from(60)), Some(true)));
    assert!(answer.stats.conflicts < 1_000, "{:?}", answer.stats);
}

/// One more than there are vehicles that can do one thing each.
#[test]
fn that_each_vehicle_has_room_for_one_is_proven() {
    let names: Vec<String> = (0..=10).map(|site| format!("L{site}")).collect();
    let sites: String = names.iter().map(|name| format!("location {name} (5, 5);\n")).collect();
    let text = format!(
        "location BASE (0, 0);\n{sites}group Sites = {};
         model Scout extends ATRV {{ resource memory 0..1 = 0; }}
         vehicle S[1..10] : Scout at BASE;
         primitive Look(r, site)[10,15] produces r.memory 1;
         scenario Day[0,1000] = {{ each site in Sites {{ any r in S {{ Look(r, site) }} }} }}",
        names.join(", ")
    );
    let options = Options { explain: false, relax: false, ..Options::default() };
    let answer = kirk::plan(&network(&text), &options, &mut Unlimited);
    assert_eq!(answer.status, Status::NoPlan);
    assert!(answer.stats.conflicts < 100, "{:?}", answer.stats);
}
