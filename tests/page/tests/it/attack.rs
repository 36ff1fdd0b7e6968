//! What the page does with what is too large or too damaged for it: it says so, stays alive, and keeps the work.

use anyhow::{Result, ensure};

use crate::opened::Opened;

/// Asks whether the page is still alive and has said nothing of a fault.
fn ensure_alive(page: &Opened) -> Result<()> {
    page.tab.next_frame()?;
    let failure = page.tab.evaluate("document.querySelector('#loading[role=alert]')?.innerText ?? null")?;
    ensure!(failure.is_null(), "{failure}");
    Ok(())
}

#[test]
fn a_line_of_nearly_two_million_letters_is_edited_and_found_again() -> Result<()> {
    let page = Opened::planned()?;
    for text in [
        "'// ' + 'x'.repeat(1.8e6)",
        "'x'.repeat(1.8e6)",
        "'Drive(Rover1); '.repeat(1.2e5)",
        "'('.repeat(1.8e6)",
    ] {
        page.tab.evaluate(&format!("enroute.setSource({text})"))?;
        ensure_alive(&page)?;
        page.settle()?;
        ensure_alive(&page)?;
    }
    page.tab.click_widget("textbox", "Mission text")?;
    page.tab.type_text("A")?;
    page.tab.wait_until("enroute.source().includes('A')")?;
    ensure_alive(&page)?;
    page.tab.evaluate("window.isOldPage = true; location.reload()")?;
    page.tab.wait_until("!('isOldPage' in window) && 'enroute' in window")?;
    page.tab.wait_until_ready()?;
    page.tab.wait_until("enroute.source().length === 1800001")?;
    ensure_alive(&page)
}

/// Goes to a link that holds a text, as an earlier version of the page made it.
const GO_TO_LINK: &str = "(async (text) => {
    const packed = new Blob([text]).stream().pipeThrough(new CompressionStream('deflate-raw'));
    const bytes = new Uint8Array(await new Response(packed).arrayBuffer());
    const words = Array.from(bytes, (byte) => String.fromCharCode(byte)).join('');
    location.hash = 'source=' + btoa(words).replaceAll('+', '-').replaceAll('/', '_').replaceAll('=', '');
})";

#[test]
fn a_short_link_to_seven_megabytes_of_text_is_refused_with_words() -> Result<()> {
    let page = Opened::planned()?;
    page.tab.evaluate("window.sourceBefore = enroute.source()")?;
    for text in ["'x'.repeat(7e6)", "'primitive A()[1,2];\\n'.repeat(3.5e5)"] {
        page.tab.evaluate(&format!("{GO_TO_LINK}({text})"))?;
        page.wait_for("state.toasts.some((toast) => toast.includes('has more than 4 MB'))")?;
        ensure_alive(&page)?;
    }
    assert_eq!(page.tab.evaluate("enroute.source() === sourceBefore")?, true);
    // One that fits is opened, however well it was packed.
    page.tab.evaluate(&format!("{GO_TO_LINK}('// comment\\n'.repeat(1e5))"))?;
    page.tab.wait_until("enroute.source().length === 1.1e6")?;
    page.settle()?;
    ensure_alive(&page)
}

#[test]
fn a_link_of_a_later_version_is_refused_with_words() -> Result<()> {
    let page = Opened::with_fragment("source=3.AAAA")?;
    page.wait_for("state.toasts.some((toast) => toast.includes('later version of Enroute'))")?;
    ensure_alive(&page)
}

/// Drops a file on the page.
const DROP: &str = "((name, content) => {
    const dataTransfer = new DataTransfer();
    dataTransfer.items.add(new File([content], name));
    const options = { dataTransfer, bubbles: true, cancelable: true };
    document.getElementById('canvas').dispatchEvent(new DragEvent('drop', options));
})";

#[test]
fn a_dropped_file_of_65_megabytes_is_refused_by_name() -> Result<()> {
    let page = Opened::planned()?;
    page.tab.evaluate("window.sourceBefore = enroute.source()")?;
    let files = [
        ("letters.rmpl", "'x'.repeat(65e6)"),
        ("list.json", "'[' + '1,'.repeat(32e6) + '1]'"),
        ("lesson.md", "'# x\\n'.repeat(16e6)"),
        ("whole.enroute", "'{\"a\":\"' + 'x'.repeat(65e6)"),
        ("zeros.tif", "new Uint8Array(65e6)"),
        ("zeros.pgm", "new Uint8Array(65e6)"),
    ];
    for (name, content) in files {
        page.tab.evaluate(&format!("{DROP}('{name}', {content})"))?;
        page.wait_for(&format!("state.toasts.some((toast) => toast.includes('{name}'))"))?;
        ensure_alive(&page)?;
    }
    assert_eq!(page.tab.evaluate("enroute.source() === sourceBefore")?, true);
    page.settle()
}
