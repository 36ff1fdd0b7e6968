//! What the page does when something fails: it says so, and loses nothing.

use anyhow::Result;
use xtask::browser::Graphics;

use crate::opened::Opened;

const CALL_OF_CORE: &str = "core.handle(data.request);";

/// A text that the altered cores below stumble over, without plan or problem of its own.
const STUMBLING_BLOCK: &str = "Stumble()[l,u] = { Work()[1,2] }";

#[test]
fn without_graphics_the_page_explains_itself() -> Result<()> {
    let page = Opened::without_waiting(Graphics::Nothing, "")?;
    page.tab.wait_until("document.querySelector('#loading[role=alert]')?.innerText.includes('WebGL2')")?;
    let code = page.tab.evaluate("enroute.ready.then(() => 'ready', (error) => error.code)")?;
    assert_eq!(code, "no-graphics");
    Ok(())
}

#[test]
fn a_planning_core_that_cannot_be_loaded_leaves_the_editor_usable() -> Result<()> {
    let page = Opened::altered("web/core-worker.js", |text| {
        text.replace("../wasm/worker.js", "../wasm/missing.js")
    })?;
    page.wait_for("state.toasts.length > 0")?;
    page.tab.evaluate("enroute.setSource('A()[l,u] = { Work()[1,2] }')")?;
    assert_eq!(page.tab.evaluate("enroute.source()")?, "A()[l,u] = { Work()[1,2] }");
    Ok(())
}

#[test]
fn a_core_that_fails_is_reported_and_started_anew_with_nothing_lost() -> Result<()> {
    let page = Opened::altered("web/core-worker.js", |text| {
        let stumbling =
            "if (new TextDecoder().decode(data.request).includes('Stumble')) throw new Error('stumbled');";
        text.replace(CALL_OF_CORE, &format!("{stumbling} {CALL_OF_CORE}"))
    })?;
    page.wait_for("state.status === 'plan'")?;
    page.tab.evaluate(&format!("enroute.setSource('{STUMBLING_BLOCK}')"))?;
    page.wait_for("state.toasts.some((toast) => toast.includes('stumbled'))")?;
    assert_eq!(page.tab.evaluate("enroute.source()")?, STUMBLING_BLOCK);
    page.tab.evaluate("enroute.dispatch('edit.undo')")?;
    page.wait_for("state.status === 'plan' && state.answeredRevision === state.revision")
}

#[test]
fn a_core_that_never_ends_is_given_up_for_a_newer_text() -> Result<()> {
    let page = Opened::altered("web/core-worker.js", |text| {
        let spinning = "while (new TextDecoder().decode(data.request).includes('Stumble'));";
        text.replace(CALL_OF_CORE, &format!("{spinning} {CALL_OF_CORE}"))
    })?;
    page.wait_for("state.status === 'plan'")?;
    page.tab.evaluate(&format!("enroute.setSource('{STUMBLING_BLOCK}')"))?;
    page.wait_for("state.status === 'working'")?;
    page.tab.evaluate("enroute.dispatch('edit.undo')")?;
    page.wait_for("state.status === 'plan' && state.answeredRevision === state.revision")
}

#[test]
fn planning_that_never_ends_is_stopped_and_the_text_is_undecided() -> Result<()> {
    let page = Opened::altered("web/core-worker.js", |text| {
        let spinning = "while (new TextDecoder().decode(data.request).includes('Stumble'));";
        text.replace(CALL_OF_CORE, &format!("{spinning} {CALL_OF_CORE}"))
    })?;
    page.wait_for("state.status === 'plan'")?;
    page.tab.evaluate(&format!("enroute.setSource('{STUMBLING_BLOCK}')"))?;
    page.tab.wait_until("enroute.widgets('button', 'Stop planning').length > 0")?;
    page.tab.evaluate("enroute.dispatch('plan.stop')")?;
    page.wait_for("state.status === 'undecided'")?;
    assert_eq!(page.tab.evaluate("enroute.source()")?, STUMBLING_BLOCK);
    // The next text finds a core that works.
    page.tab.evaluate("enroute.dispatch('edit.undo')")?;
    page.wait_for("state.status === 'plan' && state.answeredRevision === state.revision")
}

#[test]
fn a_front_end_that_stops_gives_the_text_back_when_the_page_is_loaded_again() -> Result<()> {
    let page = Opened::planned()?;
    page.tab.evaluate("enroute.setSource('A()[l,u] = { Work()[1,2] }')")?;
    page.settle()?;
    page.tab.evaluate(
        "window.dispatchEvent(new ErrorEvent('error', { error: new WebAssembly.RuntimeError('unreachable') }))",
    )?;
    page.tab.wait_until(
        "document.querySelector('#loading[role=alert]')?.innerText.includes('Your text is kept')",
    )?;
    page.tab.evaluate("window.isOldPage = true; document.querySelector('#loading button').click()")?;
    page.tab.wait_until("!('isOldPage' in window) && 'enroute' in window")?;
    page.tab.wait_until_ready()?;
    page.tab.wait_until("enroute.source() === 'A()[l,u] = { Work()[1,2] }'")?;
    Ok(())
}

/// The page's policy lets nothing run that it did not bring itself, and itself breaks nothing of it.
#[test]
fn nothing_runs_that_the_page_did_not_bring() -> Result<()> {
    let page = Opened::planned()?;
    page.tab.evaluate(
        "window.refused = [];
         document.addEventListener('securitypolicyviolation', (event) => refused.push(event.violatedDirective))",
    )?;
    page.wait_for("state.status === 'plan'")?;
    page.tab.evaluate("enroute.dispatch('view.theme', { theme: 'light' })")?;
    page.tab.evaluate("new Promise((done) => setTimeout(done, 300))")?;
    assert_eq!(page.tab.evaluate("refused.join()")?, "");
    let script = "(async () => {
        const script = document.createElement('script');
        script.textContent = 'window.injected = true';
        document.body.append(script);
        document.body.insertAdjacentHTML('beforeend', '<img src=\"x\" onerror=\"window.injected = true\">');
        await new Promise((done) => setTimeout(done, 300));
        return window.injected === undefined && refused.length > 0;
    })()";
    assert_eq!(page.tab.evaluate(script)?, true);
    Ok(())
}
