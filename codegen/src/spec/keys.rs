//! What can be said about the format: tables, their keys, what a key holds, in which bounds and unit.
//!
//! The format itself is in `format.rs`. One definition serves the decoder, the help lines of messages and
//! the JSON schemas (`schema.rs`), so that they cannot drift apart.

/// A table of the format.
#[derive(Debug)]
pub(super) struct Table {
    /// What messages call it, with its article.
    pub noun: &'static str,
    pub doc: &'static str,
    pub keys: &'static [Key],
}

/// One key of a table.
#[derive(Debug)]
pub(super) struct Key {
    pub name: &'static str,
    pub kind: Kind,
    /// Unit of its numbers, empty where there is none.
    pub unit: &'static str,
    /// What is used where the key is absent; `None`: it must be given.
    pub default: Option<&'static str>,
    /// The only way to write a file in which the key stands, where there are two.
    pub way: Option<Way>,
    pub doc: &'static str,
}

/// Two ways to write the same; a file chooses one by the keys that it has. Where it has none of either, it is the short one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Way {
    Short,
    Long,
}

impl Way {
    pub const ALL: [Way; 2] = [Way::Short, Way::Long];
}

/// What a key holds.
#[derive(Debug)]
pub(super) enum Kind {
    /// Free text.
    Text,
    /// A name given elsewhere in the specification.
    Name,
    /// One of a few words.
    Choice(&'static [&'static str]),
    /// One of a few whole numbers.
    Order(&'static [i64]),
    Number(Bound),
    /// `[x, y, z]`.
    Vector(Bound),
    /// `[lowest, highest]`.
    Pair(Bound),
    /// A distance along the link, or `[x, y, z]`.
    Along(Bound),
    /// A list of some of a few words.
    Choices(&'static [&'static str]),
    /// Two lists of names.
    NameLists,
    /// `"platform"` or `"leg1.<joint>"`.
    Coordinate,
    /// Angles under names of joints.
    Angles,
    Table(&'static Table),
    /// A list of tables.
    Tables(&'static Table),
    /// Tables under names of the user's choice, each of one of these forms.
    Map(&'static [&'static Table]),
}

/// Bounds of a number. Every number is finite besides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Bound {
    Any,
    Positive,
    NonNegative,
    /// Within one turn to either side.
    Angle,
}

impl Bound {
    pub fn admits(self, x: f64) -> bool {
        match self {
            Self::Any => true,
            Self::Positive => x > 0.0,
            Self::NonNegative => x >= 0.0,
            Self::Angle => x.abs() <= std::f64::consts::TAU,
        }
    }

    /// The smallest number that is not zero. Quotients are taken of what is positive, so that must not only differ from
    /// zero itself but its products too: a mass times two lengths, a share of a mass. Of others, products of two with
    /// such a one must.
    pub const fn least(self) -> f64 {
        match self {
            Self::Positive => 1e-30,
            Self::Any | Self::NonNegative | Self::Angle => 1e-100,
        }
    }

    pub const fn text(self) -> &'static str {
        match self {
            Self::Any => "finite",
            Self::Positive => "greater than 0",
            Self::NonNegative => "0 or more",
            Self::Angle => "between -2π and 2π",
        }
    }
}

impl Key {
    pub const fn new(name: &'static str, kind: Kind, unit: &'static str, doc: &'static str) -> Self {
        Self { name, kind, unit, default: None, way: None, doc }
    }

    /// The key may be absent; then this is used.
    pub const fn or(mut self, default: &'static str) -> Self {
        self.default = Some(default);
        self
    }

    /// The key stands only in a file that is written in this way.
    pub const fn only(mut self, way: Way) -> Self {
        self.way = Some(way);
        self
    }

    /// Whether it can stand in a file that is written in this way.
    pub fn is_of(&self, way: Way) -> bool {
        self.way.is_none_or(|own| own == way)
    }

    /// Whether such a file must have it.
    pub fn is_required(&self, way: Way) -> bool {
        self.default.is_none() && self.is_of(way)
    }

    /// How the key is written in such a file, with its unit: `range = [lowest, highest]  # rad`.
    pub fn template(&self, way: Way) -> String {
        let comment = if self.unit.is_empty() { String::new() } else { format!("  # {}", self.unit) };
        match self.kind {
            Kind::Map(_) => format!("[{}.<name>]", self.name),
            _ => format!("{} = {}{comment}", self.name, self.kind.shape(way)),
        }
    }
}

impl Kind {
    /// A value of this kind with the user's part left open.
    pub fn shape(&self, way: Way) -> String {
        match self {
            Self::Text | Self::Name => "\"…\"".into(),
            Self::Choice(words) => words.iter().map(|w| format!("\"{w}\"")).collect::<Vec<_>>().join(" or "),
            Self::Order(orders) => orders.iter().map(i64::to_string).collect::<Vec<_>>().join(" or "),
            Self::Number(_) | Self::Along(_) => "…".into(),
            Self::Vector(_) => "[x, y, z]".into(),
            Self::Pair(_) => "[lowest, highest]".into(),
            Self::Choices(words) => {
                let some = &words[..words.len().saturating_sub(1)];
                let words: Vec<_> = some.iter().map(|w| format!("\"{w}\"")).collect();
                format!("[{}, …]", words.join(", "))
            }
            Self::NameLists => "[[\"…\", \"…\"], [\"…\", \"…\"]]".into(),
            Self::Coordinate => "\"platform\" or \"leg1.<joint>\"".into(),
            Self::Table(table) => {
                let keys = table.keys.iter().filter(|k| k.is_required(way));
                let parts: Vec<_> = keys.map(|k| format!("{} = {}", k.name, k.kind.shape(way))).collect();
                format!("{{ {} }}", parts.join(", "))
            }
            Self::Tables(table) => format!("[{}, …]", Self::Table(table).shape(way)),
            Self::Angles => "{ <joint> = … }".into(),
            Self::Map(_) => "{ <name> = { … } }".into(),
        }
    }

    /// The kind in words, for "expected …".
    pub const fn words(&self) -> &'static str {
        match self {
            Self::Text | Self::Name | Self::Choice(_) | Self::Coordinate => "a text in quotes",
            Self::Order(_) => "a whole number",
            Self::Number(_) => "a number",
            Self::Vector(_) => "three numbers",
            Self::Pair(_) => "two numbers",
            Self::Along(_) => "a number or three numbers",
            Self::Choices(_) => "a list of texts",
            Self::NameLists => "two lists of names",
            Self::Angles | Self::Table(_) | Self::Map(_) => "a table",
            Self::Tables(_) => "a list of tables",
        }
    }
}
