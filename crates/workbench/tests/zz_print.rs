//! Prints.
mod support;
use support::start;
use workbench::command::Command;
use workbench::lesson::*;
use workbench::state::lesson::LessonCommand;
#[test]
fn print() {
    let mut app = start();
    let only = std::env::var("LESSON").ok();
    for lesson in COURSE.iter().flat_map(|c| c.lessons) {
        if only.as_ref().is_some_and(|it| it != lesson.name) {
            continue;
        }
        let (read, _) = Lesson::read(lesson.name, lesson.text);
        for stop in 0..read.stops.len() {
            app.run(Command::Lesson(LessonCommand::Open(lesson.name.into(), stop)));
            app.settle();
            let st = app.session.state();
            println!("=== {} {}: {}", lesson.name, stop + 1, read.stops[stop].title);
            for b in st.lesson_prose() {
                println!("   {}", b.plain());
            }
            if let Some(ask) = &read.stops[stop].ask {
                println!("   ? {}", st.lesson_line(&ask.text));
                println!("   = {:?}", ask.answer.right_now(st));
                println!("   hint {}", st.lesson_line(&ask.hint));
                println!("   because {}", st.lesson_line(&ask.because));
            }
            if std::env::var("TRACE").is_ok() && stop == 0 {
                for r in st.search.recordings(st.shown()) {
                    for (i, e) in r.trace().events.iter().enumerate() {
                        println!(
                            "      {} [{}] {}",
                            i + 1,
                            e.tree_node,
                            workbench::state::search::wording::event(r.network(), r.trace(), &e.event)
                        );
                    }
                }
            }
        }
    }
}
#[test]
fn arcs_and_moments() {
    let mut app = start();
    app.run(Command::Lesson(LessonCommand::Open("controllability".into(), 0)));
    let st = app.session.state();
    let shown = st.shown().expect("shown");
    let n = shown.network.as_deref().expect("net");
    for (i, a) in n.arcs.iter().enumerate() {
        println!(
            "ARC {} [{},{}]",
            workbench::state::selection::arc_name(n, tpn::ArcId::from_index(i)),
            a.lower,
            a.upper
        );
    }
    for fail in [false, true] {
        app.run(Command::Lesson(LessonCommand::Open("estimation".into(), 0)));
        for m in 0..10 {
            if m == 2 && fail {
                app.dispatch("program.inject", &serde_json::json!({"component":"EngineA","mode":"Failed"}));
            }
            let st = app.session.state();
            println!(
                "M{m} fail {fail} believed {} like {} cmds {} goals {} A {} trueA {} B {} conflicts {} {} ended {}",
                st.lesson_value("believed"),
                st.lesson_value("likelihood"),
                st.lesson_value("commands"),
                st.lesson_value("goals"),
                st.lesson_value("mode(EngineA)"),
                st.lesson_value("true-mode(EngineA)"),
                st.lesson_value("true-mode(EngineB)"),
                st.lesson_value("conflicts"),
                st.lesson_value("conflict"),
                st.lesson_value("ended")
            );
            app.dispatch("program.goTo", &serde_json::json!({"moment": m + 1}));
            app.settle();
        }
    }
}
