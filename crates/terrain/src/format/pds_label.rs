//! PDS3 labels as keywords with values: of the object that describes the image, and of what stands around it. What other objects of the
//! file say, tables and their columns for instance, is not of the image.

/// Returns whether a keyword stands in a label without a value.
pub(super) fn is_absent(written: &str) -> bool {
    ["N/A", "UNK", "NONE"].iter().any(|word| written.trim_matches('"').eq_ignore_ascii_case(word))
}

/// Objects around or beside the image that speak of it.
const AROUND: [&str; 6] = [
    "IMAGE_MAP_PROJECTION",
    "IMAGE_MAP_PROJECTION_CATALOG",
    "DATA_MAP_PROJECTION",
    "FILE",
    "UNCOMPRESSED_FILE",
    "COMPRESSED_FILE",
];

const MAX_LABEL_BYTES: usize = 1 << 20;

/// The keywords of a label and their values as written.
pub(super) struct Label {
    of_image: Vec<(String, String)>,
    around: Vec<(String, String)>,
}

impl Label {
    /// Reads up to `END`. Texts in quotation marks and lists in brackets may have several lines.
    pub(super) fn parse(bytes: &[u8]) -> Self {
        let text = String::from_utf8_lossy(&bytes[..bytes.len().min(MAX_LABEL_BYTES)]);
        let mut label = Self { of_image: Vec::new(), around: Vec::new() };
        let mut objects: Vec<String> = Vec::new();
        let mut values = Values::default();
        let mut rest = &*text;
        while !rest.is_empty() {
            let (line, after) = rest.split_once('\n').unwrap_or((rest, ""));
            let trimmed = line.trim();
            let upper = trimmed.get(..10).unwrap_or(trimmed).to_ascii_uppercase();
            if upper == "END" {
                break;
            }
            if upper.starts_with("END_OBJECT") || upper.starts_with("END_GROUP") {
                objects.pop();
                rest = after;
                continue;
            }
            let Some(equals) = line.find('=').filter(|_| !trimmed.starts_with("/*")) else {
                rest = after;
                continue;
            };
            let keyword = line[..equals].trim().to_ascii_uppercase();
            let (value, after) = values.first(&rest[equals + 1..]);
            rest = after;
            match keyword.as_str() {
                "OBJECT" => objects.push(value.trim_matches('"').to_ascii_uppercase()),
                // A group only puts together what belongs to the object around it.
                "GROUP" => objects.push("FILE".to_owned()),
                _ if objects.iter().any(|object| object == "IMAGE") => label.of_image.push((keyword, value)),
                _ if objects.iter().all(|object| AROUND.contains(&object.as_str())) => {
                    label.around.push((keyword, value));
                }
                _ => {}
            }
        }
        label
    }

    /// Returns what the label says of the image.
    pub(super) fn value(&self, keyword: &str) -> Option<&str> {
        let mut entries = self.of_image.iter().chain(&self.around);
        entries.find(|(word, _)| word == keyword).map(|(_, value)| value.as_str())
    }

    /// The number at the beginning of a value; what follows is its unit.
    pub(super) fn number(&self, keyword: &str) -> Option<f64> {
        let value = self.value(keyword)?.trim_matches('"').trim_start();
        value.split(|letter: char| letter.is_ascii_whitespace() || letter == '<').next()?.parse().ok()
    }
}

/// Takes values out of a label. What is not closed up to the end is looked for once only.
#[derive(Default)]
struct Values {
    unclosed: Vec<char>,
}

impl Values {
    /// The value at the beginning, and what follows its last line. One may stand in the line below its keyword.
    fn first<'a>(&mut self, text: &'a str) -> (String, &'a str) {
        let mut begun = text.trim_start_matches([' ', '\t', '\r']);
        if let Some(below) = begun.strip_prefix('\n') {
            let (line, _) = below.split_once('\n').unwrap_or((below, ""));
            if line.contains('=') || line.trim().eq_ignore_ascii_case("END") {
                return (String::new(), below);
            }
            begun = below.trim_start_matches([' ', '\t', '\r']);
        }
        let closing = match begun.chars().next() {
            Some('"') => Some('"'),
            Some('(') => Some(')'),
            Some('{') => Some('}'),
            _ => None,
        };
        if let Some(closing) = closing.filter(|closing| !self.unclosed.contains(closing)) {
            if let Some(length) = begun[1..].find(closing) {
                let (value, rest) = begun.split_at(length + 2);
                let value = value.lines().map(str::trim).collect::<Vec<_>>().join(" ");
                return (value, rest.split_once('\n').map_or("", |(_, rest)| rest));
            }
            self.unclosed.push(closing);
        }
        let (line, rest) = begun.split_once('\n').unwrap_or((begun, ""));
        let value = line.split("/*").next().unwrap_or_default();
        (value.trim().to_owned(), rest)
    }
}
