//! Every reader, attacked for a bounded time: what once broke it, its seeds, and mutations of these. Whatever is found is
//! written down where cargo keeps the outputs of tests; keep it in `broken/`, named for what it does.

use std::fs;
use std::path::Path;

use fuzz::attack::attack;
use fuzz::readers::{READERS, by_name, matching};

#[test]
fn every_pattern_names_a_file() {
    for reader in READERS {
        for pattern in reader.seeds {
            assert!(!matching(pattern).is_empty(), "{}: nothing is named {pattern}", reader.name);
        }
    }
}

fn holds(name: &str) {
    let reader = by_name(name).expect("a reader of this name");
    assert!(!reader.seeds().is_empty(), "nothing can be mutated without seeds");
    let tally = attack(reader, reader.tested, 1, &mut |_| {});
    assert!(tally.outcomes > 1 && tally.read > 0, "all inputs led to the same");
    if let Some(breaking) = tally.breaking.first() {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}-{}", breaking.number));
        let kept = fs::write(&path, &breaking.input).map(|()| path.display().to_string());
        panic!(
            "input {} breaks {name}: {kept:?}: {:?}",
            breaking.number,
            breaking.input.escape_ascii().to_string()
        );
    }
}

macro_rules! each {
    ($($test:ident $name:literal),* $(,)?) => {
        $(
            #[test]
            fn $test() {
                holds($name);
            }
        )*

        #[test]
        fn no_reader_is_left_out() {
            let tested = [$($name),*];
            let all: Vec<&str> = READERS.iter().map(|reader| reader.name).collect();
            assert_eq!(all, tested);
        }
    };
}

each! {
    missions "missions",
    missions_planned "missions-planned",
    exports "exports",
    rules "rules",
    control_programs "control-programs",
    control_runs "control-runs",
    networks "networks",
    ptpn "ptpn",
    uncertain_networks "uncertain-networks",
    plans "plans",
    jmpl "jmpl",
    pamela "pamela",
    observations "observations",
    disturbances "disturbances",
    uncertainty "uncertainty",
    geojson "geojson",
    reviews "reviews",
    flight_rules "flight-rules",
    archives "archives",
    links "links",
    lessons "lessons",
    settings "settings",
    dropped_files "dropped-files",
    commands "commands",
    png "png",
    tiff "tiff",
    pgm "pgm",
    ascii_grid "ascii-grid",
    moving_ai "moving-ai",
    pds "pds",
    pds_detached "pds-detached",
    ros_maps "ros-maps",
    maps "maps",
}
