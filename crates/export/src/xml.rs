//! XML, indented.

use std::fmt::Write;

pub struct Xml {
    text: String,
    open: Vec<&'static str>,
}

/// Attributes in their order.
pub type Attributes<'a> = &'a [(&'a str, String)];

impl Xml {
    pub fn new() -> Xml {
        Xml { text: "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n".into(), open: Vec::new() }
    }

    fn tag(&mut self, name: &str, attributes: Attributes, end: &str) {
        let _ = write!(self.text, "{:width$}<{name}", "", width = 2 * self.open.len());
        for (key, value) in attributes {
            let _ = write!(self.text, " {key}=\"{}\"", escaped(value));
        }
        self.text.push_str(end);
    }

    pub fn comment(&mut self, text: &str) {
        let _ = writeln!(self.text, "{:width$}<!-- {} -->", "", text.replace("--", "—"), width = 2 * self.open.len());
    }

    /// An element without contents.
    pub fn leaf(&mut self, name: &str, attributes: Attributes) {
        self.tag(name, attributes, "/>\n");
    }

    /// An element with a text.
    pub fn text(&mut self, name: &str, text: &str) {
        self.tag(name, &[], &format!(">{}</{name}>\n", escaped(text)));
    }

    /// An element with what `contents` writes.
    pub fn element(&mut self, name: &'static str, attributes: Attributes, contents: impl FnOnce(&mut Xml)) {
        self.tag(name, attributes, ">\n");
        self.open.push(name);
        contents(self);
        self.open.pop();
        let _ = writeln!(self.text, "{:width$}</{name}>", "", width = 2 * self.open.len());
    }

    pub fn finish(self) -> String {
        self.text
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// Numbers one after another, each with all of its digits.
pub fn numbers(values: &[f64]) -> String {
    values.iter().map(|v| format!("{}", v + 0.0)).collect::<Vec<_>>().join(" ")
}
