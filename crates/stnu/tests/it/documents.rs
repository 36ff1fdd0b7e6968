//! The plain layout and `GraphML`: what is read, what is refused and where.

use exact::Scale;
use stnu::generate::{Kind, Shape};
use stnu::{Document, Edge, Layout, Link, PointId, generate};

const PLAIN: &str = "# KIND OF NETWORK\nSTNU\n# Num Time-Points\n3\n# Num Ordinary Edges\n2\n\
    # Num Contingent Links\n1\n# Names of Time-Points\nZ A C\n# Ordinary Edges\nZ 35 C\nC -30 Z\n\
    # Contingent Links\nA 20 40 C\n";

const GRAPHML: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<graphml xmlns="http://graphml.graphdrawing.org/xmlns/graphml">
<key id="Type" for="edge"><default>requirement</default></key>
<graph edgedefault="directed">
<data key="NetworkType">STNU</data>
<node id="Z"><data key="x">0.0</data><data key="Label">⊡</data></node>
<node id="A"/>
<node id="C"/>
<edge id="AC" source="A" target="C"><data key="Type">contingent</data><data key="LabeledValue">LC(C):20</data></edge>
<edge id="CA" source="C" target="A"><data key="Type">contingent</data><data key="LabeledValue">UC(C):-40</data></edge>
<edge id="ZC" source="Z" target="C"><data key="Value">35</data></edge>
<edge id="CZ" source="C" target="Z"><data key="Type">requirement</data><data key="Value">-30</data></edge>
<edge id="AZ" source="A" target="Z"><data key="Type">derived</data><data key="Value">-3</data></edge>
</graph>
</graphml>"#;

fn refused(text: &str) -> (usize, String) {
    let error = Document::parse(text).expect_err("malformed");
    (error.line, error.message)
}

#[test]
fn both_layouts_hold_the_same_network() {
    let plain = Document::parse(PLAIN).expect("well formed");
    assert_eq!(plain.names, ["Z", "A", "C"]);
    let (origin, start, end) = (PointId(0), PointId(1), PointId(2));
    assert_eq!(plain.network.links(), [Link { activation: start, end, lower: 20, upper: 40 }]);
    assert_eq!(
        plain.network.edges(),
        [Edge { from: origin, to: end, weight: 35 }, Edge { from: end, to: origin, weight: -30 }]
    );
    assert_eq!(Document::parse(GRAPHML).expect("well formed"), plain);
}

#[test]
fn what_is_written_is_read() {
    for seed in 0..20 {
        let shape = Shape { kind: Kind::Workflow, points: 40, links: 10, slack_percent: 0 };
        let network = generate::network(shape, seed);
        let names = (0..network.num_points()).map(|point| format!("<T&{point}>")).collect();
        let document = Document { names, network, scale: Scale::UNITS, is_rounded: false };
        for layout in [Layout::Plain, Layout::GraphMl] {
            let text = document.write(layout);
            assert_eq!(Layout::of(&text), layout);
            let mut read = Document::parse(&text).expect("well formed");
            // GraphML keeps no order among links.
            assert_eq!(read.names, document.names);
            assert_eq!(read.network.edges(), document.network.edges());
            let sorted = |links: &[Link]| {
                let mut links = links.to_vec();
                links.sort_unstable();
                links
            };
            assert_eq!(sorted(read.network.links()), sorted(document.network.links()));
            read.names.clear();
        }
    }
}

#[test]
fn kinds_and_titles_are_read_in_any_case() {
    let text = PLAIN.replace("STNU", "stnu").replace("# Names of Time-Points", "#names");
    assert_eq!(Document::parse(&text), Document::parse(PLAIN));
    let stn = "# Kind\nSTN\n# Points\n2\n# Edges\n1\n# Names\nA B\n# Edges\nA 3 B\n";
    let document = Document::parse(stn).expect("well formed");
    assert!(document.network.links().is_empty());
    assert_eq!(document.network.edges().len(), 1);
}

#[test]
fn what_is_wrong_with_plain_text_is_told_with_its_line() {
    assert_eq!(refused("STNU\n").0, 1);
    assert_eq!(refused(&PLAIN.replace("STNU", "CSTNU")).0, 2);
    assert_eq!(
        refused(&PLAIN.replace("\n1\n", "\n2\n")).1,
        "the header says 2 contingent links, but 1 are listed"
    );
    assert_eq!(refused(&PLAIN.replace("A 20 40 C", "A 40 20 C")).0, 15);
    assert_eq!(refused(&PLAIN.replace("A 20 40 C", "A 20 40 Q")).1, "Q is not a time point");
    assert_eq!(refused(&PLAIN.replace("A 20 40 C", "A 20 C")).0, 15);
    assert_eq!(refused(&PLAIN.replace("Z 35 C", "Z many C")).0, 12);
    assert_eq!(refused(&PLAIN.replace("\n3\n", "\n4\n")).1, "the header says 4 time points, but 3 are named");
    assert_eq!(refused(&PLAIN.replace("Z A C\n", "Z A A\n")).1, "duplicate name A");
    assert!(refused("# only\n").1.contains("empty"));
    assert_eq!(refused("STN\n").0, 1);
}

#[test]
fn decimals_are_read_exactly_and_written_as_they_were() {
    let text = PLAIN.replace("Z 35 C", "Z 35.25 C").replace("A 20 40 C", "A 20.0 4.05e1 C");
    let document = Document::parse(&text).expect("well formed");
    assert_eq!(document.scale.ticks_per_unit(), 4);
    assert_eq!(document.network.edges()[0].weight, 141);
    assert_eq!(document.time(141).to_string(), "35.25");
    let link = document.network.links()[0];
    assert_eq!(
        (document.time(link.lower).to_string(), document.time(link.upper).to_string()),
        ("20".into(), "40.5".into())
    );
    let decimal = GRAPHML.replace(">35<", ">35.25<").replace("UC(C):-40", "UC(C):-40.5");
    assert_eq!(Document::parse(&decimal), Ok(document.clone()));
    for layout in [Layout::Plain, Layout::GraphMl] {
        assert_eq!(Document::parse(&document.write(layout)), Ok(document.clone()));
    }
}

#[test]
fn times_without_common_ticks_are_rounded_to_the_safe_side() {
    let fine = PLAIN
        .replace("Z 35 C", "Z 35.0000000000000001 C")
        .replace("C -30 Z", "C -91/3 Z")
        .replace("A 20 40 C", "A 2000/7 900.1 C");
    let document = Document::parse(&fine).expect("well formed");
    assert!(document.is_rounded);
    assert_eq!(
        document.network.edges().iter().map(|edge| edge.weight).collect::<Vec<_>>(),
        [35_000_000_000, -30_333_333_334]
    );
    let link = document.network.links()[0];
    assert_eq!((link.lower, link.upper), (285_714_285_714, 900_100_000_000));
    assert_eq!(
        refused(&PLAIN.replace("Z 35 C", "Z 9000000000000000000 C").replace("-30", "-1/3")).1,
        "a time is too large to represent exactly"
    );
}

#[test]
fn an_infinite_edge_constrains_nothing() {
    let text = PLAIN.replace("Z 35 C", "Z inf C");
    assert_eq!(Document::parse(&text).expect("well formed").network.edges().len(), 1);
}

#[test]
fn what_is_wrong_with_graphml_is_told_with_its_line() {
    assert!(refused("<graphml>").1.starts_with("not well-formed XML"));
    assert_eq!(refused("<graphml/>").1, "expected a `graph` element");
    assert_eq!(
        refused(&GRAPHML.replace("target=\"Z\"", "target=\"Q\"")),
        (12, "Q is not a time point".into())
    );
    assert_eq!(refused(&GRAPHML.replace(">35<", ">many<")).0, 11);
    let one_side = GRAPHML.replace("LC(C):20", "");
    assert_eq!(refused(&one_side).1, "the contingent link between A and C needs a minimum and a maximum");
    let observing = GRAPHML.replace("<node id=\"A\"/>", "<node id=\"A\"><data key=\"Obs\">p</data></node>");
    let conditional = |what: &str| {
        format!(
            "{what}, so this is a conditional network (CSTN or CSTNU), which is not supported; only STN and STNU are"
        )
    };
    assert_eq!(refused(&observing), (7, conditional("A observes p")));
    let labeled = GRAPHML.replace("<node id=\"A\"/>", "<node id=\"A\"><data key=\"Label\">p¬q</data></node>");
    assert_eq!(refused(&labeled), (7, conditional("A exists only under the condition p¬q")));
}

#[test]
fn other_ways_to_write_a_contingent_link_in_graphml_are_read() {
    let plain = Document::parse(PLAIN).expect("well formed");
    let values = GRAPHML
        .replace("<data key=\"LabeledValue\">LC(C):20</data>", "<data key=\"Value\">40</data>")
        .replace("<data key=\"LabeledValue\">UC(C):-40</data>", "<data key=\"Value\">-20</data>");
    assert_eq!(Document::parse(&values), Ok(plain.clone()));
    let labeled = GRAPHML
        .replace("LabeledValue\">LC(C):20", "LowerCaseLabeledValues\">{(C, 20, ⊡) }")
        .replace("LabeledValue\">UC(C):-40", "UpperCaseLabeledValues\">{(C, -40, ⊡) }")
        .replace("Value\">35", "LabeledValues\">{(35, ⊡) }");
    assert_eq!(Document::parse(&labeled), Ok(plain.clone()));
    let conditional = labeled.replace("(35, ⊡)", "(35, p)");
    let (line, told) = refused(&conditional);
    assert!(
        line == 11 && told.contains("holds only under the condition p, so this is a conditional network"),
        "{told}"
    );
    let keyed = GRAPHML
        .replace("<key id=\"Type\"", "<key id=\"d1\" for=\"edge\" attr.name=\"Value\"/>\n<key id=\"Type\"")
        .replace("key=\"Value\"", "key=\"d1\"");
    assert_eq!(Document::parse(&keyed), Ok(plain));
}
