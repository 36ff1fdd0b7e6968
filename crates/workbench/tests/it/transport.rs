//! Who is driven by the keys that play and step.

use test_support::App;
use workbench::PanelKind;
use workbench::acts::Track;
use workbench::command::Command;
use workbench::state::growth::GrowthCommand;
use workbench::state::playback::TransportCommand;
use workbench::state::search::SearchCommand;
use workbench::state::terrain::TerrainCommand;
use workbench::state::window::WindowCommand;
use workbench::workspace::Workspace;

/// A session in which the keys drive `track`.
fn driving(track: Track) -> App {
    let mut app = test_support::start();
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

/// Returns what plays: time, the search, the growth, the program.
fn playing(app: &App) -> [bool; 4] {
    let state = app.session.state();
    [
        state.playback.is_playing,
        state.search.is_playing,
        state.terrain.growth.is_playing,
        state.automaton.is_playing,
    ]
}

/// Returns where time, the search, the growth and the program are.
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
        app.run(Command::Window(WindowCommand::Activate(panel)));
        assert_eq!(app.session.state().track(), track, "{panel:?}");
    }
    app.run(Command::Window(WindowCommand::Activate(PanelKind::Network)));
    app.run(Command::Search(SearchCommand::Close));
    assert_eq!(app.session.state().track(), Track::Plan);
}

#[test]
fn a_growth_has_the_keys_while_the_user_is_on_the_terrain() {
    let mut app = driving(Track::Growth);
    app.run(Command::Window(WindowCommand::Activate(PanelKind::Editor)));
    assert_eq!(app.session.state().track(), Track::Plan);
    app.run(Command::Window(WindowCommand::Activate(PanelKind::Terrain)));
    assert_eq!(app.session.state().track(), Track::Growth);
    app.run(Command::Terrain(TerrainCommand::Growth(GrowthCommand::Close)));
    assert_eq!(app.session.state().track(), Track::Plan);
}

/// Lets time go by; returns the seconds after which the next frame is due.
fn wait(app: &mut App, seconds: f64) -> Option<f64> {
    app.world.now_secs.set(app.world.now_secs.get() + seconds);
    app.session.begin_frame()
}

#[test]
fn what_plays_goes_on_by_itself_and_asks_for_frames_as_long_as_it_plays() {
    for track in ALL {
        let mut app = driving(track);
        drive(&mut app, TransportCommand::Start);
        app.settle();
        let start = places(&app);
        for _ in 0..20 {
            wait(&mut app, 0.25);
        }
        assert_eq!(places(&app), start, "{track:?} does not play");
        app.session.apply(vec![Command::Transport(TransportCommand::TogglePlaying)]);
        let due = wait(&mut app, 0.0);
        assert!(due.is_some_and(|secs| secs <= 0.05), "{track:?}: {due:?}");
        for _ in 0..20 {
            wait(&mut app, 0.25);
        }
        let later = places(&app);
        for (place, (before, after)) in start.into_iter().zip(later).enumerate() {
            assert_eq!(after > before, place == index(track), "{track:?}: {start:?} to {later:?}");
        }
    }
}

#[test]
fn time_goes_as_fast_as_it_is_set_within_limits_and_a_hidden_page_goes_on_where_it_was() {
    let mut app = driving(Track::Plan);
    app.session.apply(vec![Command::Transport(TransportCommand::TogglePlaying)]);
    let gone = |app: &mut App, seconds: f64| {
        let before = app.session.state().playback.time;
        wait(app, seconds);
        app.session.state().playback.time - before
    };
    // A whole mission takes half a minute.
    let normal = gone(&mut app, 0.15);
    let end = app.session.state().playback.end;
    assert!((normal - end * 0.15 / 30.0).abs() < 1e-9, "{normal} of {end}");
    app.session.apply(vec![Command::SetRate(4.0)]);
    let faster = gone(&mut app, 0.15);
    assert!((faster - 4.0 * normal).abs() < 1e-9, "{faster} and {normal}");
    app.session.apply(vec![Command::SetRate(1.0)]);
    let hidden = gone(&mut app, 3600.0);
    assert!((hidden - end * 0.25 / 30.0).abs() < 1e-9, "{hidden} of {end}");
    for (asked, rate) in [(1e9, 64.0), (1e-9, 0.125), (2.0, 2.0)] {
        app.session.apply(vec![Command::SetRate(asked)]);
        assert_eq!(app.session.state().playback.rate, rate);
    }
}

#[test]
fn a_step_of_time_goes_to_the_next_event_and_playing_at_the_end_starts_over() {
    let mut app = driving(Track::Plan);
    app.run(Command::OpenSource {
        name: "errand".into(),
        source: "scenario S[0,40] = { delay[5,20]; delay[3,9] }".into(),
    });
    let mut times = Vec::new();
    for _ in 0..3 {
        drive(&mut app, TransportCommand::Step(true));
        times.push(app.session.state().playback.time);
    }
    assert_eq!(times, [5.0, 8.0, 8.0]);
    drive(&mut app, TransportCommand::Step(false));
    assert_eq!(app.session.state().playback.time, 5.0);
    drive(&mut app, TransportCommand::End);
    app.session.apply(vec![Command::Transport(TransportCommand::TogglePlaying)]);
    assert_eq!((app.session.state().playback.time, app.session.state().is_playing()), (0.0, true));
}
