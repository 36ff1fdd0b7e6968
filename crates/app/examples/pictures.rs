//! Takes pictures of the app in all workspaces and themes, to look at: `cargo run -p app --example pictures -- FOLDER`.

#[path = "../tests/it/support/mod.rs"]
mod support;

use workbench::command::Command;
use workbench::state::settings::SettingsCommand;
use workbench::state::settings::ThemeChoice;
use workbench::workspace::Workspace;

fn main() {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().unwrap_or_else(|| "target/pictures".to_owned());
    let script: Vec<String> = arguments.collect();
    std::fs::create_dir_all(&folder).expect("the folder can be made");
    for theme in [ThemeChoice::Dark, ThemeChoice::Light] {
        let mut app = support::start_in(std::rc::Rc::default(), egui_kittest::HarnessBuilder::wgpu);
        app.harness.state_mut().run(Command::Settings(SettingsCommand::SetTheme(theme)));
        for workspace in Workspace::ALL {
            app.harness.state_mut().run(Command::ShowWorkspace(workspace));
            for step in &script {
                let (name, arguments) = step.split_once(' ').unwrap_or((step, "null"));
                let arguments = serde_json::from_str(arguments).expect("arguments are JSON");
                workbench::host_io::Remote::dispatch(app.harness.state_mut(), name, &arguments)
                    .expect("a command");
                app.settle();
            }
            app.settle();
            let image = app.harness.render().expect("the app can be drawn");
            let theme = if theme == ThemeChoice::Dark { "dark" } else { "light" };
            image
                .save(format!("{folder}/{}-{theme}.png", workspace.name()))
                .expect("the picture can be written");
        }
    }
}
