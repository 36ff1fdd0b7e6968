//! The files beside a model: the harness (`.hrn`) names what is observed and what is commanded, and another (`.ini`) the
//! modes in which the components start.

use super::error::JmplError;

/// What these files say. Paths begin with the name of the whole model.
#[derive(Clone, Debug, Default)]
pub(super) struct Harness {
    pub(super) observed: Vec<String>,
    pub(super) commanded: Vec<String>,
    /// Paths of attributes, with their values at the start.
    pub(super) initial: Vec<(String, String)>,
    /// Whether a file says what is observed and commanded.
    pub(super) has_interface: bool,
}

/// Returns whether a text is one of these files rather than JMPL.
pub(super) fn is_harness(text: &str) -> bool {
    ["<xmpl", "<mplHarness", "<mplInit"].iter().any(|tag| text.contains(tag))
}

impl Harness {
    /// Adds what a file says.
    pub(super) fn read(&mut self, name: &str, text: &str) -> Result<(), JmplError> {
        let wrong = |what: String| JmplError::Harness { file: name.to_owned(), what };
        let options = roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() };
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let document = roxmltree::Document::parse_with_options(text, options)
            .map_err(|error| wrong(error.to_string()))?;
        for node in document.descendants() {
            let attribute = |key: &str| {
                let value = node.attribute(key).map(str::to_owned);
                value.ok_or_else(|| wrong(format!("an element `{}` has no `{key}`", node.tag_name().name())))
            };
            match node.tag_name().name() {
                "mplHarness" => self.has_interface = true,
                "obs" => self.observed.push(attribute("name")?),
                "cmd" => self.commanded.push(attribute("name")?),
                "assign" => {
                    let text = attribute("eq")?;
                    let (path, value) = text
                        .split_once('=')
                        .ok_or_else(|| wrong(format!("`{text}` is not of the form `path=value`")))?;
                    self.initial.push((path.trim().to_owned(), value.trim().to_owned()));
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// The name of the whole model, if all paths begin with one.
    pub(super) fn root(&self) -> Option<&str> {
        let paths = self.observed.iter().chain(&self.commanded);
        let paths = paths.chain(self.initial.iter().map(|(path, _)| path));
        let mut names = paths.map(|path| path.split('.').next().unwrap_or_default());
        let first = names.next()?;
        names.all(|name| name == first).then_some(first)
    }
}
