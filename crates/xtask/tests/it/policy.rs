//! What the page may load and run: its Content-Security-Policy, as `serve` and `dist` give it to browsers.

use std::collections::BTreeMap;
use std::path::Path;

fn policy() -> BTreeMap<String, Vec<String>> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../index.html");
    let page = std::fs::read_to_string(file).expect("the page is there");
    let (before, rest) =
        page.split_once("http-equiv=\"Content-Security-Policy\" content=\"").expect("the page has a policy");
    // What is before it is not held to it.
    assert!(!["<script", "<link", "<style", "<img"].iter().any(|tag| before.contains(tag)), "{before}");
    let (policy, _) = rest.split_once('"').expect("it ends");
    let directive = |text: &str| {
        let mut words = text.split_whitespace().map(str::to_owned);
        (words.next().unwrap_or_default(), words.collect())
    };
    policy.split(';').map(directive).collect()
}

#[test]
fn the_page_loads_nothing_but_its_own_files_and_runs_no_text_as_a_script() {
    let policy = policy();
    assert_eq!(policy["default-src"], ["'none'"]);
    for closed in ["base-uri", "form-action"] {
        assert_eq!(policy[closed], ["'none'"], "{closed}");
    }
    let allowed = ["'self'", "'wasm-unsafe-eval'", "data:", "blob:", "'none'"];
    for (directive, sources) in &policy {
        for source in sources {
            assert!(allowed.contains(&source.as_str()), "{directive} {source}");
            let is_picture = directive == "img-src";
            assert!(is_picture || !source.ends_with(':'), "{directive} {source}");
        }
    }
}

#[test]
fn the_page_has_no_script_or_style_of_its_own_text() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../index.html");
    let page = std::fs::read_to_string(file).expect("the page is there");
    for script in page.split("<script").skip(1) {
        let (attributes, body) = script.split_once('>').expect("the tag ends");
        let body = body.split("</script>").next().unwrap_or_default().trim();
        assert!(attributes.contains("src=") && body.is_empty(), "{attributes} {body}");
    }
    assert!(!page.contains("<style") && !page.contains(" style=") && !page.contains(" onclick="));
}
