//! Missions on the disk: opened from files, saved to the same ones, and what is said where that fails.
//!
//! No headless browser lets anybody choose a file, so the choice is made here: of files in the page's private file system,
//! which are read and written as any others.

use anyhow::Result;
use serde_json::json;

use crate::opened::Opened;

/// Lets the pickers choose a private file, which `allowed` may be written or not.
const PICKERS: &str = r"(async () => {
    const root = await navigator.storage.getDirectory();
    window.asked = [];
    window.choose = async (name) => { window.chosen = await root.getFileHandle(name, { create: true }); };
    window.onDisk = async (name) => (await (await root.getFileHandle(name)).getFile()).text();
    window.writeOnDisk = async (name, text) => {
        const writable = await (await root.getFileHandle(name, { create: true })).createWritable();
        await writable.write(text);
        await writable.close();
    };
    window.showSaveFilePicker = async (options) => {
        window.asked.push(options.suggestedName);
        if (!window.chosen) throw new DOMException('', 'AbortError');
        return window.chosen;
    };
    window.showOpenFilePicker = async () => [window.chosen];
})()";

fn opened(fragment: &str) -> Result<Opened> {
    let page = Opened::with_fragment(fragment)?;
    page.tab.evaluate(PICKERS)?;
    Ok(page)
}

#[test]
fn a_mission_is_saved_to_the_file_that_was_chosen_once_also_after_a_reload() -> Result<()> {
    let page = opened("")?;
    page.tab.evaluate("enroute.setSource('// one')")?;
    page.tab.next_frame()?;
    // Whoever chooses no file has saved nothing, and is told nothing.
    page.tab.evaluate("enroute.dispatch('file.save')")?;
    page.tab.wait_until("asked.length === 1")?;
    page.tab.evaluate("choose('day.rmpl')")?;
    page.tab.evaluate("enroute.dispatch('file.save')")?;
    page.wait_for("state.toasts.includes('Saved to day.rmpl')")?;
    assert_eq!(page.tab.evaluate("onDisk('day.rmpl')")?, json!("// one"));
    page.tab.evaluate("enroute.setSource('// one and two')")?;
    page.tab.next_frame()?;
    page.tab.evaluate("window.isOldPage = true; location.reload()")?;
    page.tab.wait_until("!('isOldPage' in window) && 'enroute' in window")?;
    page.tab.wait_until_ready()?;
    page.tab.evaluate(PICKERS)?;
    page.tab.wait_until("enroute.source() === '// one and two'")?;
    page.tab.evaluate("enroute.dispatch('file.save')")?;
    page.tab.wait_until("onDisk('day.rmpl').then((text) => text === '// one and two')")?;
    assert_eq!(page.tab.evaluate("asked.length")?, 0, "nobody is asked again");
    // Save as asks, and the extension says what is written.
    page.tab.evaluate("choose('day.enroute')")?;
    page.tab.evaluate("enroute.dispatch('file.saveAs')")?;
    page.tab.wait_until("onDisk('day.enroute').then((text) => text.includes('enroute-mission/1'))")?;
    page.tab.evaluate("enroute.setSource('// three')")?;
    page.tab.next_frame()?;
    page.tab.evaluate("enroute.dispatch('file.save')")?;
    page.tab.wait_until("onDisk('day.enroute').then((text) => text.includes('// three'))")?;
    assert_eq!(page.tab.evaluate("onDisk('day.rmpl')")?, json!("// one and two"));
    Ok(())
}

#[test]
fn a_file_that_was_opened_is_saved_and_never_over_what_another_program_wrote() -> Result<()> {
    let page = opened("")?;
    page.tab.evaluate(
        "choose('own.rmpl').then(() => writeOnDisk('own.rmpl', 'scenario Own = { delay[1,2] }'))",
    )?;
    page.tab.evaluate("enroute.dispatch('file.open')")?;
    page.tab.wait_until("enroute.source() === 'scenario Own = { delay[1,2] }'")?;
    page.tab.evaluate("enroute.setSource('// mine')")?;
    page.tab.next_frame()?;
    page.tab.evaluate("enroute.dispatch('file.save')")?;
    page.tab.wait_until("onDisk('own.rmpl').then((text) => text === '// mine')")?;
    page.wait_for("state.toasts.includes('Saved to own.rmpl')")?;
    // Files know milliseconds.
    page.tab.evaluate(
        "new Promise((done) => setTimeout(done, 5)).then(() => writeOnDisk('own.rmpl', '// theirs'))",
    )?;
    page.tab.evaluate("enroute.dispatch('file.save')")?;
    page.wait_for("state.toasts.join().includes('own.rmpl: another program changed this file')")?;
    assert_eq!(page.tab.evaluate("onDisk('own.rmpl')")?, json!("// theirs"));
    page.tab.evaluate("enroute.dispatch('file.save')")?;
    page.tab.wait_until("onDisk('own.rmpl').then((text) => text === '// mine')")?;
    Ok(())
}

#[test]
fn a_file_that_is_gone_or_forbidden_is_said_plainly_and_the_text_stays() -> Result<()> {
    let page = opened("")?;
    page.tab.evaluate("enroute.setSource('// kept')")?;
    page.tab.next_frame()?;
    page.tab.evaluate("choose('gone.rmpl')")?;
    page.tab.evaluate("enroute.dispatch('file.save')")?;
    page.tab.wait_until("onDisk('gone.rmpl').then((text) => text === '// kept')")?;
    page.wait_for("state.toasts.includes('Saved to gone.rmpl')")?;
    page.tab.evaluate("navigator.storage.getDirectory().then((root) => root.removeEntry('gone.rmpl'))")?;
    page.tab.evaluate("enroute.dispatch('file.save')")?;
    page.wait_for("state.toasts.join().includes('gone.rmpl: file not found')")?;
    page.tab.evaluate(
        "FileSystemHandle.prototype.queryPermission = async () => 'prompt';
         FileSystemHandle.prototype.requestPermission = async () => 'denied';
         choose('closed.rmpl')",
    )?;
    page.tab.evaluate("enroute.dispatch('file.saveAs')")?;
    page.wait_for("state.toasts.join().includes('closed.rmpl: the browser denied write access')")?;
    assert_eq!(page.tab.evaluate("onDisk('closed.rmpl')")?, json!(""));
    assert_eq!(page.tab.evaluate("enroute.source()")?, json!("// kept"));
    page.wait_for("state.library.keeping === 'kept'")?;
    Ok(())
}
