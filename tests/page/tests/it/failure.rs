//! What the page does when something fails: it says so, and loses nothing.

use anyhow::Result;
use xtask::browser::Graphics;

use crate::opened::Opened;

/// How many frames are looked at before a page without drawing is taken to stay so.
const FRAMES_TO_COMPILE_SHADERS: u32 = 100;

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

/// A core that ends without a word, at every job about the text above or only at the first one.
fn dying(text: &str, once: bool) -> String {
    let is_asked = "new TextDecoder().decode(data.request).includes('Stumble')";
    let is_first = if once { "&& self.name && !(await caches.has('died'))" } else { "" };
    let dies = format!("if ({is_asked} {is_first}) {{ await caches.open('died'); self.close(); return; }}");
    text.replace(CALL_OF_CORE, &format!("{dies} {CALL_OF_CORE}"))
}

#[test]
fn a_core_that_dies_without_a_word_is_noticed_at_once_and_its_work_done_again() -> Result<()> {
    let page = Opened::altered("web/core-worker.js", |text| dying(&text, true))?;
    page.wait_for("state.status === 'plan'")?;
    let seconds = page.tab.evaluate(&format!(
        "(async () => {{
            const begun = performance.now();
            enroute.setSource('{STUMBLING_BLOCK}');
            while (!enroute.state().toasts.some((toast) => toast.includes('and restarted'))) {{
                await new Promise((done) => setTimeout(done, 10));
            }}
            return (performance.now() - begun) / 1000;
        }})()"
    ))?;
    // Without the browser's word for it, a core may be silent for a minute before it is taken for dead.
    assert!(seconds.as_f64().is_some_and(|seconds| seconds < 30.0), "{seconds}");
    page.settle()?;
    assert_eq!(page.tab.evaluate("enroute.source()")?, STUMBLING_BLOCK);
    Ok(())
}

#[test]
fn a_core_that_dies_each_time_leaves_the_text_undecided() -> Result<()> {
    let page = Opened::altered("web/core-worker.js", |text| dying(&text, false))?;
    page.wait_for("state.status === 'plan'")?;
    page.tab.evaluate(&format!("enroute.setSource('{STUMBLING_BLOCK}')"))?;
    page.wait_for("state.status === 'undecided'")?;
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
        "document.querySelector('#loading[role=alert]')?.innerText.includes('Your text is saved')",
    )?;
    page.tab.evaluate("window.isOldPage = true; document.querySelector('#loading button').click()")?;
    page.tab.wait_until("!('isOldPage' in window) && 'enroute' in window")?;
    page.tab.wait_until_ready()?;
    page.tab.wait_until("enroute.source() === 'A()[l,u] = { Work()[1,2] }'")?;
    Ok(())
}

#[test]
fn a_full_storage_hides_neither_the_failure_nor_the_text() -> Result<()> {
    let page = Opened::planned()?;
    page.tab.evaluate("enroute.setSource('// ' + 'long text '.repeat(3e5))")?;
    page.settle()?;
    let fill = "(() => {
        for (let size = 1 << 22; size > 0; size >>= 1) {
            try { for (let at = 0; ; at += 1) localStorage.setItem(`fill/${size}/${at}`, 'x'.repeat(size)); } catch {}
        }
        const saved = [];
        window.saved = saved;
        URL.createObjectURL = (blob) => { saved.push(blob.size); return 'blob:none'; };
        const error = new WebAssembly.RuntimeError('unreachable');
        window.dispatchEvent(new ErrorEvent('error', { error }));
    })()";
    page.tab.evaluate(fill)?;
    page.tab
        .wait_until("document.querySelector('#loading[role=alert]')?.innerText.includes('save your text')")?;
    page.tab.evaluate(
        "[...document.querySelectorAll('#loading button')].find((it) => it.innerText === 'Save text').click()",
    )?;
    assert_eq!(page.tab.evaluate("saved.join()")?, "3000003");
    Ok(())
}

#[test]
fn lost_graphics_come_back_in_place_with_everything_as_it_was() -> Result<()> {
    let page = Opened::planned()?;
    page.place_caret_after("scenario")?;
    page.type_text("s")?;
    page.settle()?;
    let lose = "window.lostCanvas = document.getElementById('canvas');
                lostCanvas.getContext('webgl2').getExtension('WEBGL_lose_context').loseContext()";
    for turn in 1..=2 {
        page.tab.evaluate(lose)?;
        page.tab.wait_until("document.getElementById('canvas') !== lostCanvas")?;
        page.tab.wait_until("enroute.source().includes('scenarios')")?;
        page.settle()?;
        let failure =
            page.tab.evaluate("document.querySelector('#loading[role=alert]')?.innerText ?? null")?;
        assert!(failure.is_null(), "{failure}");
        // Its shaders are compiled again first, while frames go by.
        let mut colors = 0;
        for _ in 0..FRAMES_TO_COMPILE_SHADERS {
            colors = page.look()?.colors();
            if colors > 20 {
                break;
            }
        }
        assert!(colors > 20, "nothing is drawn after loss {turn}");
    }
    // The history is still there, and keys and clicks arrive.
    page.tab.evaluate("enroute.dispatch('edit.undo')")?;
    page.wait_for("state.status === 'plan' && state.answeredRevision === state.revision")?;
    page.place_caret_after("scenario")?;
    page.type_text("z")?;
    page.tab.wait_until("enroute.source().includes('scenarioz')")?;
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

#[test]
fn graphics_that_never_come_back_are_told_with_a_way_to_keep_the_text() -> Result<()> {
    let page = Opened::planned()?;
    page.tab.evaluate("HTMLCanvasElement.prototype.getContext = () => null")?;
    page.tab.evaluate("navigator.gpu && (navigator.gpu.requestAdapter = async () => null)")?;
    page.tab.evaluate("document.getElementById('canvas').dispatchEvent(new Event('webglcontextlost', { cancelable: true }))")?;
    page.tab.wait_until(
        "document.querySelector('#loading[role=alert]')?.innerText.includes('Graphics device lost')",
    )?;
    Ok(())
}

/// A browser that says that a page is isolated from others, and has no shared memory.
#[test]
fn without_shared_memory_the_page_starts_although_it_is_isolated() -> Result<()> {
    let page = Opened::after(
        "Object.defineProperty(window, 'crossOriginIsolated', { value: true }); delete window.SharedArrayBuffer;",
        Graphics::WebGl2,
    )?;
    page.tab.wait_until_ready()?;
    page.wait_for("state.status === 'plan'")
}

#[test]
fn what_throws_in_a_callback_while_the_page_starts_is_told_with_the_text_of_the_last_run() -> Result<()> {
    let page = Opened::altered("web/core.js", |text| {
        let start = "export function startCore(tell) {";
        let throws = "if (localStorage.getItem('throws')) throw new ReferenceError('thrown while starting');";
        text.replace(start, &format!("{start} {throws}"))
    })?;
    page.tab.evaluate("enroute.setSource('// kept')")?;
    page.wait_for("state.library.keeping === 'kept'")?;
    page.settle()?;
    page.tab.evaluate("localStorage.setItem('throws', 'yes'); location.reload()")?;
    page.tab.wait_until(
        "document.querySelector('#loading[role=alert]')?.innerText.includes('thrown while starting')",
    )?;
    page.tab.evaluate("URL.createObjectURL = (blob) => { window.saved = blob; return 'blob:none'; }")?;
    page.tab.evaluate(
        "[...document.querySelectorAll('#loading button')].find((it) => it.innerText === 'Save text').click()",
    )?;
    assert_eq!(page.tab.evaluate("window.saved.text()")?, "// kept");
    Ok(())
}

/// Each of these throws in some browser with some settings.
const REFUSED: &str = "
    const refuse = () => { throw new DOMException('refused', 'SecurityError'); };
    for (const [holder, names] of [
        [window, ['indexedDB', 'localStorage', 'sessionStorage', 'caches']],
        [navigator, ['locks', 'clipboard', 'storage', 'serviceWorker']],
    ]) {
        for (const name of names) Object.defineProperty(holder, name, { get: refuse, configurable: true });
    }
    window.BroadcastChannel = class { constructor() { refuse(); } };";

#[test]
fn whatever_the_browser_refuses_the_page_starts_plans_and_says_what_is_not_kept() -> Result<()> {
    let page = Opened::after(REFUSED, Graphics::WebGl2)?;
    page.tab.wait_until_ready()?;
    page.wait_for("state.status === 'plan'")?;
    // That nothing is saved shows with the first edit.
    page.wait_for("['nothing', 'latest-only'].includes(state.library.keeping)")?;
    page.tab.evaluate("enroute.setSource('// edited')")?;
    page.wait_for("state.library.keeping === 'nothing'")?;
    page.tab.wait_until("enroute.widgets('button', 'Not saved').length > 0")?;
    // Copying and pasting fail in words.
    page.tab.evaluate("enroute.dispatch('edit.copy')")?;
    page.tab.evaluate("enroute.dispatch('edit.paste')")?;
    page.wait_for("state.toasts.some((toast) => toast.includes('Ctrl+V'))")?;
    page.tab.evaluate("enroute.setSource('// still here')")?;
    page.tab.next_frame()?;
    assert_eq!(page.tab.evaluate("enroute.source()")?, "// still here");
    Ok(())
}

#[test]
fn without_workers_the_text_can_be_edited() -> Result<()> {
    let script =
        "window.Worker = class { constructor() { throw new DOMException('refused', 'SecurityError'); } };";
    let page = Opened::after(script, Graphics::WebGl2)?;
    page.tab.wait_until_ready()?;
    page.wait_for("state.toasts.length > 0")?;
    page.tab.evaluate("enroute.setSource('// still here')")?;
    assert_eq!(page.tab.evaluate("enroute.source()")?, "// still here");
    Ok(())
}

/// Firefox allows no larger textures where it resists fingerprinting.
#[test]
fn no_larger_texture_is_asked_for_than_there_is() -> Result<()> {
    let script = "const get = WebGL2RenderingContext.prototype.getParameter;
        WebGL2RenderingContext.prototype.getParameter = function (name) {
            const value = get.call(this, name);
            return name === this.MAX_TEXTURE_SIZE ? Math.min(value, 2048) : value;
        };";
    let page = Opened::after(script, Graphics::WebGl2)?;
    page.tab.wait_until_ready()?;
    page.wait_for("state.status === 'plan' && state.renderer === 'webgl2'")?;
    let side =
        page.tab.evaluate("document.getElementById('canvas').style.getPropertyValue('--largest-side')")?;
    assert_eq!(side, "2048");
    Ok(())
}

/// Lets a test lose the devices of WebGPU: `devices` has a function for each.
const LOSE_DEVICES: &str = "window.devices = [];
    const ask = window.GPUAdapter?.prototype.requestDevice;
    if (ask) GPUAdapter.prototype.requestDevice = async function (...all) {
        const device = await ask.apply(this, all);
        let lose;
        const lost = new Promise((resolve) => (lose = resolve));
        device.lost.then(lose);
        Object.defineProperty(device, 'lost', { value: lost });
        window.devices.push(() => lose({ reason: 'unknown', message: 'lost by a test' }));
        return device;
    };";

#[test]
#[expect(clippy::print_stdout, reason = "what was not tried is said")]
fn a_lost_device_is_followed_by_another_and_the_second_within_a_minute_by_webgl2() -> Result<()> {
    let page = Opened::after(LOSE_DEVICES, Graphics::WebGpu)?;
    page.tab.wait_until_ready()?;
    if page.tab.evaluate("devices.length")? == 0 {
        println!("not tried: this Chromium has no WebGPU");
        return Ok(());
    }
    page.tab.evaluate("enroute.setSource('// before')")?;
    // A device that the browser loses by itself, as its software adapter does, counts as well.
    page.tab.evaluate("window.lost = devices.length; devices.at(-1)()")?;
    page.tab.wait_until("devices.length > lost || enroute.state().renderer === 'webgl2'")?;
    page.tab.evaluate("devices.at(-1)()")?;
    page.wait_for("state.renderer === 'webgl2'")?;
    page.tab.next_frame()?;
    let failure = page.tab.evaluate("document.querySelector('#loading[role=alert]')?.innerText ?? null")?;
    assert!(failure.is_null(), "{failure}");
    assert_eq!(page.tab.evaluate("enroute.source()")?, "// before");
    page.tab.evaluate("enroute.setSource('// after')")?;
    page.wait_for("state.answeredRevision === state.revision")
}
