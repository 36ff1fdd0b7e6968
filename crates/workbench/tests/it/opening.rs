//! Opening what others wrote: networks, labels with their images, and what is too large or of no use.

use std::rc::Rc;

use serde_json::json;
use workbench::command::Command;
use workbench::host::{FileKind, HostEvent};
use workbench::host_io::Remote as _;
use workbench::limits::MAX_TEXT_BYTES;

use test_support::{App, World, start_in};

fn open(app: &mut App, name: &str, bytes: &[u8]) {
    app.world.news.borrow_mut().push_back(HostEvent::FileOpened {
        kind: FileKind::of_name(name),
        name: name.to_owned(),
        bytes: bytes.to_vec(),
        token: None,
    });
    app.settle();
}

fn started() -> App {
    let mut app = start_in(Rc::new(World::default()));
    app.settle();
    app
}

fn text_of(app: &App) -> String {
    app.session.state().document.text().to_owned()
}

const NETWORK: &str = r#"{:network-id :net
 :net {:uid :net :tpn-type :network :begin-node :n1 :end-node :n2}
 :n1 {:uid :n1 :tpn-type :state :activities #{:a1} :constraints #{}}
 :n2 {:uid :n2 :tpn-type :state :activities #{} :constraints #{}}
 :a1 {:uid :a1 :tpn-type :activity :name "Drive" :end-node :n2 :constraints #{:c1} :reward 3}
 :c1 {:uid :c1 :tpn-type :temporal-constraint :value [1 :infinity] :end-node :n2}}"#;

#[test]
fn networks_open_as_missions_in_whichever_way_and_are_saved_as_they_were_written() {
    for (name, kind) in [("day.tpn.edn", FileKind::Json), ("day.edn", FileKind::Mission)] {
        let mut app = started();
        app.world.news.borrow_mut().push_back(HostEvent::FileOpened {
            kind,
            name: name.to_owned(),
            bytes: NETWORK.as_bytes().to_vec(),
            token: Some(7),
        });
        app.settle();
        let state = app.json();
        assert_eq!((&state["mission"], &state["status"]), (&json!("day"), &json!("plan")), "{state}");
        assert_eq!(state["diagnostics"][0]["code"], "W-NETWORK");
        app.session.dispatch("file.save", &json!(null)).expect("it can be saved");
        app.settle();
        let saved = app.world.saved.borrow().last().cloned().expect("it was saved");
        assert_eq!(saved, ("day.tpn.edn".to_owned(), NETWORK.as_bytes().to_vec()));
    }
}

#[test]
fn a_network_is_turned_into_a_mission_in_rmpl_and_nothing_is_lost() {
    let mut app = started();
    let refused = app.session.dispatch("file.toRmpl", &json!(null)).expect_err("a mission in RMPL");
    let refused = refused.to_string();
    assert!(refused.contains("isn't an imported network"), "{refused}");
    open(&mut app, "day.tpn.edn", NETWORK.as_bytes());
    app.dispatch("file.toRmpl", &json!(null));
    let text = text_of(&app);
    assert!(text.starts_with("// ignored when planning"), "{text}");
    assert!(text.contains("Drive()[1,inf]"), "{text}");
    let state = app.json();
    assert_eq!((&state["status"], &state["diagnostics"]), (&json!("plan"), &json!([])), "{state}");
    let versions = |app: &App| {
        let library = &app.session.state().library;
        let mission = library.open_id().and_then(|id| library.mission(id)).expect("a mission of the library");
        let kept =
            mission.versions.iter().map(|version| (version.name.clone(), version.texts[0].text.clone()));
        kept.collect::<Vec<_>>()
    };
    assert_eq!(versions(&app), [("Network".to_owned(), NETWORK.to_owned())]);
    app.dispatch("edit.undo", &json!(null));
    assert_eq!(text_of(&app), NETWORK);
    assert_eq!(app.json()["status"], "plan");
}

#[test]
fn a_network_that_does_not_nest_says_what_is_in_the_way_and_stays() {
    // b continues to both ends of what a and c part into.
    let network = r#"{"network-id": "net", "net": {"tpn-type": "network", "begin-node": "s", "end-node": "e"},
        "s": {"tpn-type": "p-begin", "activities": ["sa", "sb"]}, "e": {"tpn-type": "p-end", "activities": []},
        "a": {"tpn-type": "state", "activities": ["ac", "ad"]}, "b": {"tpn-type": "state", "activities": ["bd"]},
        "c": {"tpn-type": "state", "activities": ["ce"]}, "d": {"tpn-type": "state", "activities": ["de"]},
        "sa": {"tpn-type": "activity", "name": "sa", "end-node": "a"},
        "sb": {"tpn-type": "activity", "name": "sb", "end-node": "b"},
        "ac": {"tpn-type": "activity", "name": "ac", "end-node": "c"},
        "ad": {"tpn-type": "activity", "name": "ad", "end-node": "d"},
        "bd": {"tpn-type": "activity", "name": "bd", "end-node": "d"},
        "ce": {"tpn-type": "activity", "name": "ce", "end-node": "e"},
        "de": {"tpn-type": "activity", "name": "de", "end-node": "e"}}"#;
    let mut app = started();
    open(&mut app, "crossing.tpn.json", network.as_bytes());
    app.dispatch("file.toRmpl", &json!(null));
    assert_eq!(text_of(&app), network);
    let toasts = app.json()["toasts"].to_string();
    assert!(toasts.contains("convert the network to RMPL") && toasts.contains("`ad#1`, `bd#1`"), "{toasts}");
}

#[test]
fn documents_that_are_no_mission_open_nothing_and_say_what_is_read() {
    let mut app = started();
    let before = text_of(&app);
    for (name, text) in [("list.json", "[1, 2]"), ("notes.enroute", "scribbles"), ("other.edn", "{:a 1}")] {
        open(&mut app, name, text.as_bytes());
        assert_eq!(text_of(&app), before, "{name}");
        assert!(app.json()["toasts"].to_string().contains(name), "{name}");
    }
}

#[test]
fn models_of_livingstone_and_pamela_open_as_text_of_enroute() {
    let mut app = started();
    let lamp = "class Lamp { enum M { on, gone } m; stateVector m; failure (on, gone, 0.1) {} transition (gone, on) { a = b; } }";
    open(&mut app, "lamp.jmpl", lamp.as_bytes());
    let text = text_of(&app);
    assert!(text.starts_with("; Not read: lamp.jmpl:1:") && text.contains("(FAULT on gone 0.1)"), "{text}");
    assert!(app.json()["toasts"].to_string().contains("without 1 line"), "{}", app.json()["toasts"]);
    open(&mut app, "day.pamela", b"(defpclass main [] :methods [(defpmethod day [] (delay :bounds [3 4]))])");
    assert!(text_of(&app).contains("scenario day = { delay[3,4] }"), "{}", text_of(&app));
    let before = text_of(&app);
    open(&mut app, "broken.jmpl", b"class {");
    assert!(app.json()["toasts"].to_string().contains("broken.jmpl, line 1"), "{}", app.json()["toasts"]);
    assert_eq!(text_of(&app), before);
}

/// An activity between two events, whose duration is the environment's.
const PTPN: &str = r#"<?xml version="1.0" ?>
<tpns xmlns="http://mers.csail.mit.edu/tpn"><tpn><id>survey</id><name>survey</name>
<start-event>s</start-event><end-event>e</end-event>
<events><event><id>s</id><name>s</name></event><event><id>e</id><name>e</name></event></events>
<episodes><episode><id>fly</id><name>fly</name><to-event>e</to-event><from-event>s</from-event>
<duration><set-bounded-uncertain-duration><lower-bound>2</lower-bound><upper-bound>5</upper-bound></set-bounded-uncertain-duration></duration>
<dispatch>(fly ridge)</dispatch></episode></episodes></tpn></tpns>"#;

#[test]
fn a_ptpn_opens_as_a_mission_and_is_written_as_it_was() {
    for name in ["survey.tpn", "survey.xml", "survey.ptpn"] {
        let mut app = started();
        open(&mut app, name, PTPN.as_bytes());
        let state = app.json();
        assert_eq!((&state["mission"], &state["status"]), (&json!("survey"), &json!("plan")), "{state}");
        assert!(state["diagnostics"].to_string().contains("duration that is not controllable"), "{state}");
        for command in ["file.save", "file.networkPtpn"] {
            app.dispatch(command, &json!(null));
            let saved = app.world.saved.borrow().last().cloned();
            assert_eq!(saved, Some(("survey.tpn".to_owned(), PTPN.as_bytes().to_vec())), "{command}");
        }
        app.dispatch("file.toRmpl", &json!(null));
        assert!(text_of(&app).contains("[2,5]"), "{}", text_of(&app));
        assert_eq!(app.json()["status"], "plan");
    }
    // What is not a pTPN, or not a sound one, is reported.
    let mut app = started();
    let before = text_of(&app);
    open(&mut app, "drawing.xml", b"<svg xmlns=\"http://www.w3.org/2000/svg\"/>");
    assert!(app.json()["toasts"].to_string().contains("Couldn't open drawing.xml"));
    assert_eq!(text_of(&app), before);
    open(&mut app, "broken.tpn", PTPN.replace("<to-event>e", "<to-event>x").as_bytes());
    let state = app.json();
    assert_eq!(state["status"], "broken", "{state}");
    assert!(state["diagnostics"].to_string().contains("`x`"), "{state}");
}

#[test]
fn a_plan_of_plandev_opens_as_a_mission_and_goes_back() {
    let directive = |id: i64, kind: &str, offset: &str, anchor: serde_json::Value| {
        json!({ "anchor_id": anchor, "anchored_to_start": false, "arguments": { "angle": 3 }, "id": id,
            "metadata": {}, "name": kind, "start_offset": offset, "tags": [], "type": kind })
    };
    let mut first = directive(1, "Slew", "00:30:00", json!(null));
    first["anchored_to_start"] = json!(true);
    first["metadata"] = json!({ "enroute_duration": "00:10:00" });
    let plan = json!({ "activities": [first, directive(2, "Image", "00:05:00", json!(1))], "duration": "02:00:00",
        "id": 1, "model_id": 1, "name": "Night", "simulation_arguments": {},
        "start_time": "2024-08-02T00:00:00+00:00", "tags": [], "version": "2" });
    let mut app = started();
    open(&mut app, "night.json", plan.to_string().as_bytes());
    let state = app.json();
    assert_eq!((&state["mission"], &state["status"]), (&json!("night"), &json!("plan")), "{state}");
    app.dispatch("export.schedule", &json!({ "as": "plandev", "epoch": "2024-08-02" }));
    let (name, bytes) = app.world.saved.borrow().last().cloned().expect("it was saved");
    assert_eq!(name, "night.plandev.json");
    let written: serde_json::Value = serde_json::from_slice(&bytes).expect("JSON");
    let starts: Vec<_> = written["activities"].as_array().expect("activities").iter().collect();
    let of = |kind: &str| starts.iter().find(|it| it["type"] == kind).expect(kind)["start_offset"].clone();
    assert_eq!([of("Slew"), of("Image")], ["00:30:00", "00:45:00"], "{written}");
    assert_eq!(starts[0]["arguments"], json!({ "angle": 3 }));
    let mut again = started();
    open(&mut again, &name, &bytes);
    assert_eq!((&again.json()["mission"], &again.json()["status"]), (&json!("night"), &json!("plan")));
}

#[test]
fn a_mission_is_written_as_networks_that_open_again() {
    let mut app = started();
    let mission = "primitive Drive()[2,5]; primitive Dig()[1,3];\nscenario S[0,9] = { Drive(); choose { Dig(), delay[2,2] } }\n";
    open(&mut app, "day.rmpl", mission.as_bytes());
    for (command, name) in [("file.networkPlanSchema", "day.tpn.json"), ("file.networkPtpn", "day.tpn")] {
        app.dispatch(command, &json!(null));
        let (saved, bytes) = app.world.saved.borrow().last().cloned().expect("it was saved");
        assert_eq!(saved, name);
        let mut other = started();
        open(&mut other, name, &bytes);
        assert_eq!(other.json()["status"], "plan", "{}", other.json()["diagnostics"]);
    }
}

#[test]
fn files_of_other_formats_are_refused_by_their_name_and_maps_are_known_by_what_they_hold() {
    let mut app = started();
    let before = text_of(&app);
    for (name, bytes, said) in [
        (
            "dem.xml",
            &b"<?xml version=\"1.0\"?>\n<Product_Observational xmlns=\"http://pds.nasa.gov/pds4/pds/v1\"/>"[..],
            "PDS4 label",
        ),
        ("dem.cub", b"Object = IsisCube\n  Object = Core\n", "ISIS cube"),
        ("dem.nc", b"CDF\x01\xff\xfe\x00", "NetCDF file"),
        ("noise.bin", b"\x80\x81\xff\xfe", "ESRI ASCII grid, MovingAI, ROS"),
        ("notes.doc", b"Dear all, [", "unrecognized format"),
    ] {
        open(&mut app, name, bytes);
        let toasts = app.json()["toasts"].to_string();
        assert!(
            toasts.contains(&format!("Couldn't open {name}")) && toasts.contains(said),
            "{name}: {toasts}"
        );
    }
    assert_eq!(text_of(&app), before);
    open(&mut app, "ground.grd", b"P5 2 1 255\n\x00\xff");
    assert_eq!(app.json()["library"]["missions"][0]["maps"], json!(["ground.grd"]));
}

#[test]
fn what_is_too_large_is_refused_with_its_size() {
    let mut app = started();
    let before = text_of(&app);
    let large = "x".repeat(MAX_TEXT_BYTES + 1);
    for name in ["large.rmpl", "large.json", "large.md"] {
        open(&mut app, name, large.as_bytes());
        assert!(
            app.json()["toasts"].to_string().contains(&format!("Couldn't open {name}: the size is 4.0 MB"))
        );
    }
    app.session.apply(vec![Command::SetSource(large)]);
    app.settle();
    assert_eq!(text_of(&app), before);
    assert!(app.json()["toasts"].to_string().contains("Text too long"));
}

fn label() -> Vec<u8> {
    let lines = [
        "PDS_VERSION_ID = PDS3",
        "^IMAGE = \"HILL.IMG\"",
        "LINES = 2",
        "LINE_SAMPLES = 2",
        "SAMPLE_TYPE = MSB_INTEGER",
        "SAMPLE_BITS = 16",
        "END",
    ];
    lines.join("\r\n").into_bytes()
}

#[test]
fn a_label_and_its_image_are_one_map_whichever_comes_first() {
    let image = [0, 1, 0, 2, 0, 3, 0, 4];
    let files = [("hill.lbl", label()), ("hill.img", image.to_vec())];
    for order in [[0, 1], [1, 0]] {
        let mut app = started();
        for at in order {
            let (name, bytes) = &files[at];
            open(&mut app, name, bytes);
        }
        let state = app.json();
        let maps = &state["library"]["missions"][0]["maps"];
        assert_eq!(maps, &json!(["hill.img"]), "{state}");
    }
    // Without its image it waits, and another image is not its own.
    let mut app = started();
    open(&mut app, "hill.lbl", &label());
    assert!(app.json()["toasts"].to_string().contains("hill.lbl is a label of HILL.IMG"));
    open(&mut app, "dale.img", &image);
    assert_eq!(app.json()["library"]["missions"], json!([]));
}

#[test]
fn a_map_of_ros_and_its_image_are_one_map_whichever_comes_first() {
    let yaml = b"image: maps/Site.pgm\nresolution: 0.1\norigin: [-1, 2, 0]\n".to_vec();
    let files = [("site.yaml", yaml), ("site.pgm", b"P5 2 1 255\n\x00\xff".to_vec())];
    for order in [[0, 1], [1, 0]] {
        let mut app = started();
        for at in order {
            let (name, bytes) = &files[at];
            open(&mut app, name, bytes);
        }
        let state = app.json();
        let maps = state["library"]["missions"][0]["maps"].as_array().cloned().unwrap_or_default();
        assert!(maps.contains(&json!("site.yaml")), "{state}");
        assert!(state["toasts"].to_string().contains("Imported map site.yaml: 2 × 1 cells"), "{state}");
    }
    // A map that is turned is refused once its image is there.
    let mut app = started();
    open(&mut app, "site.yaml", b"image: site.pgm\nresolution: 0.1\norigin: [0, 0, 0.5]\n");
    open(&mut app, "site.pgm", &files[1].1);
    assert!(app.json()["toasts"].to_string().contains("rotated by 0.5 rad"));
}

#[test]
fn places_in_geojson_become_a_file_of_the_mission() {
    let place = json!({ "type": "Point", "coordinates": [7.0, 8.0] });
    let feature = json!({ "type": "Feature", "properties": { "name": "Crater rim" }, "geometry": place });
    let file =
        json!({ "type": "FeatureCollection", "enroute_frame": { "units": "metres" }, "features": [feature] });
    for name in ["site.geojson", "site.json"] {
        let mut app = started();
        open(&mut app, name, file.to_string().as_bytes());
        let text = text_of(&app);
        assert!(
            text.contains("import \"site.rmpl\";") && text.ends_with("location Crater_rim (7, 8);\n"),
            "{text}"
        );
        let diagnostics = app.json()["diagnostics"].to_string();
        assert!(!diagnostics.contains("\"error\""), "{diagnostics}");
        app.session.dispatch("edit.undo", &json!(null)).expect("it can be undone");
        app.settle();
        assert!(!text_of(&app).contains("Crater_rim"));
    }
    let mut app = started();
    let before = text_of(&app);
    open(&mut app, "site.geojson", b"{\"type\": \"FeatureCollection\", \"features\": []}");
    assert!(app.json()["toasts"].to_string().contains("the file needs a Point, Polygon"));
    assert_eq!(text_of(&app), before);
}

#[test]
fn a_mission_that_is_too_long_for_a_link_is_saved_as_a_file_instead() {
    let mut app = started();
    let lines: String =
        (0_u32..6000).map(|at| format!("// {:x}\n", at.wrapping_mul(2_654_435_761))).collect();
    app.session.apply(vec![Command::SetSource(lines)]);
    app.settle();
    app.session.dispatch("file.share", &json!(null)).expect("a link is asked for");
    app.settle();
    assert!(app.json()["toasts"].to_string().contains("too long for a link"));
    let saved = app.world.saved.borrow();
    assert!(saved.last().is_some_and(|(name, _)| name.ends_with(".enroute")), "{}", saved.len());
}
