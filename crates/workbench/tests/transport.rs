//! Who is driven by the keys that play and step.

mod support;

use support::App;
use workbench::PanelKind;
use workbench::command::Command;
use workbench::state::growth::GrowthCommand;
use workbench::state::search::SearchCommand;
use workbench::state::terrain::TerrainCommand;
use workbench::transport::{Track, TransportCommand};
use workbench::workspace::Workspace;

/// A session in which the keys drive `track`.
fn driving(track: Track) -> App {
    let mut app = support::start();
    match track {
        Track::Plan => {}
        Track::Execution => app.run(Command::ShowWorkspace(Workspace::Execute)),
        Track::Search => app.run(Command::ShowWorkspace(Workspace::Teach)),
        Track::Growth => app.run(Command::Terrain(TerrainCommand::Growth(GrowthCommand::Toggle))),
        Track::Program => app.run(Command::OpenExample("orbit-insertion".into())),
    }
    assert_eq!(app.session.state().track(), track);
    app
}

const ALL: [Track; 5] = [Track::Plan, Track::Execution, Track::Search, Track::Growth, Track::Program];

/// What plays: time, the search, the growth, the program.
fn playing(app: &App) -> [bool; 4] {
    let state = app.session.state();
    [
        state.playback.is_playing,
        state.search.is_playing,
        state.terrain.growth.is_playing,
        state.automaton.is_playing,
    ]
}

/// Where time, the search, the growth and the program are.
fn places(app: &App) -> [f64; 4] {
    let state = app.session.state();
    [
        state.playback.time,
        state.search.step().map_or(-1.0, |step| step.step as f64),
        state.terrain.growth.shown().map_or(-1.0, |shown| f64::from(shown.samples())),
        state.automaton.at() as f64,
    ]
}

/// The place of a track in the two lists above.
fn index(track: Track) -> usize {
    match track {
        Track::Plan | Track::Execution => 0,
        Track::Search => 1,
        Track::Growth => 2,
        Track::Program => 3,
    }
}

/// Asks for something, and lets the core's answers come: it runs control programs.
fn drive(app: &mut App, command: TransportCommand) {
    app.run(Command::Transport(command));
}

#[test]
fn playing_starts_and_stops_what_is_driven_and_nothing_else() {
    for track in ALL {
        let mut app = driving(track);
        drive(&mut app, TransportCommand::TogglePlaying);
        let mut expected = [false; 4];
        expected[index(track)] = true;
        assert_eq!(playing(&app), expected, "{track:?}");
        assert!(app.session.state().is_playing(), "{track:?}");
        drive(&mut app, TransportCommand::TogglePlaying);
        assert_eq!(playing(&app), [false; 4], "{track:?}");
    }
}

#[test]
fn stepping_moves_what_is_driven_and_nothing_else_and_the_start_is_where_it_began() {
    for track in ALL {
        let mut app = driving(track);
        drive(&mut app, TransportCommand::Start);
        let start = places(&app);
        drive(&mut app, TransportCommand::Step(true));
        let stepped = places(&app);
        for (place, (before, after)) in start.into_iter().zip(stepped).enumerate() {
            assert_eq!(after > before, place == index(track), "{track:?}: {start:?} to {stepped:?}");
        }
        drive(&mut app, TransportCommand::Step(false));
        assert_eq!(places(&app), start, "{track:?}");
        drive(&mut app, TransportCommand::End);
        drive(&mut app, TransportCommand::Start);
        assert_eq!(places(&app), start, "{track:?}");
    }
}

#[test]
fn the_search_has_a_speed_of_its_own_and_the_others_share_one() {
    for track in ALL {
        let mut app = driving(track);
        let speeds =
            |app: &App| (app.session.state().playback.rate, app.session.state().search.steps_per_sec);
        let (rate, steps_per_sec) = speeds(&app);
        drive(&mut app, TransportCommand::Speed(2.0));
        let expected = match track {
            Track::Search => (rate, 2.0 * steps_per_sec),
            _ => (2.0 * rate, steps_per_sec),
        };
        assert_eq!(speeds(&app), expected, "{track:?}");
    }
}

#[test]
fn a_step_of_the_search_keeps_the_keys_until_the_user_turns_to_time() {
    let mut app = driving(Track::Search);
    app.run(Command::Search(SearchCommand::Step(1)));
    for (panel, track) in [
        (PanelKind::Network, Track::Search),
        (PanelKind::Timeline, Track::Plan),
        (PanelKind::Terrain, Track::Plan),
        (PanelKind::Search, Track::Search),
    ] {
        app.run(Command::Activate(panel));
        assert_eq!(app.session.state().track(), track, "{panel:?}");
    }
    app.run(Command::Activate(PanelKind::Network));
    app.run(Command::Search(SearchCommand::Close));
    assert_eq!(app.session.state().track(), Track::Plan);
}

#[test]
fn a_growth_has_the_keys_while_the_user_is_on_the_terrain() {
    let mut app = driving(Track::Growth);
    app.run(Command::Activate(PanelKind::Editor));
    assert_eq!(app.session.state().track(), Track::Plan);
    app.run(Command::Activate(PanelKind::Terrain));
    assert_eq!(app.session.state().track(), Track::Growth);
    app.run(Command::Terrain(TerrainCommand::Growth(GrowthCommand::Close)));
    assert_eq!(app.session.state().track(), Track::Plan);
}
